#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# dolfinx solves, PAMR marks and refines, in one program: an edge, the Fichera corner and a ball, with known solutions.
#
#   cases/dolfinx-loop/run.sh [--ranks N] [--levels N] [--short] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes of the parallel runs (default 2)
#   --levels N      refinements of the adaptive runs (default 6)
#   --short         fewer levels and no comparison with dolfinx's own refinement: what the tests run
#   --out FOLDER    where tables and meshes go (default out/ beside this script)
#   --tools FOLDER  takes the tools and the Python package from there and sets nothing up
#
# Needs the Debian packages python3-dolfinx and python3-mpi4py, and PAMR's Python package.
set -euo pipefail

declare -A values=([--levels]=levels)
declare -A flags=([--short]=short)
levels=6
short=no
python=yes
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
. "$root/cases/python.sh" dolfinx python3-dolfinx
uniform_levels=3
if [ "$short" = yes ]; then levels=3 uniform_levels=2; fi

loop() { # RANKS TABLE PROBLEM OPTIONS...
  local on=$1 table=$2
  shift 2
  echo "$table: $* on $on"
  mpirun -n "$on" /usr/bin/python3 -B -m mpi4py "$case_folder/loop.py" "$@" --table "$out/$table.csv"
}

loop "$ranks" edge edge --levels "$levels"
loop 1 edge-alone edge --levels "$levels"
loop "$ranks" edge-uniform edge --levels "$uniform_levels" --uniform
loop "$ranks" fichera fichera --levels "$levels" --record "$out/marks.npz"
for n in 1 2 3; do
  echo "recorded-$n: fichera with the marks of that run on $n"
  mpirun -n "$n" /usr/bin/python3 -B -m mpi4py "$case_folder/loop.py" fichera --levels "$levels" \
    --replay "$out/marks.npz" --mesh "$out/recorded-$n.hdf"
done
loop "$ranks" ball ball --levels "$levels"
loop "$ranks" ball-no-project ball --levels "$levels" --no-project
if [ "$short" = no ]; then
  loop "$ranks" fichera-uniform fichera --levels "$uniform_levels" --uniform
  loop 1 ball-alone ball --levels 5
  loop 1 ball-dolfinx ball --levels 5 --refiner dolfinx
fi
/usr/bin/python3 -B "$case_folder/check.py" "$out" "$short"
