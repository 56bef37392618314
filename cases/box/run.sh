#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A closed box of gas: the collision rate of argon and the rotational relaxation of nitrogen, beside kinetic theory.
#
#   cases/box/run.sh [--ranks N] [--full] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --full          the numbers of README.md; without it a shorter run with larger standard errors
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

case_folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$case_folder/../.." && pwd)
out=$case_folder/out
ranks=2
full=no
tools=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?run.sh: --ranks needs a number}; shift 2 ;;
    --full) full=yes; shift ;;
    --out) out=${2:?run.sh: --out needs a folder}; shift 2 ;;
    --tools) tools=${2:?run.sh: --tools needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,10s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "run.sh: unknown option $1 (see run.sh --help)" >&2; exit 2 ;;
  esac
done
if [ -z "$tools" ]; then
  "$root/scripts/setup.sh"
  tools=${PAMR_BUILD:-$root/build/release}/bin
fi
. "$root/scripts/mpi_environment.sh"
PATH=$tools:$PATH
mkdir -p "$out"
on_ranks() { mpirun -q -n "$ranks" "$@"; }

cubes=12
[ $full = yes ] && cubes=24
pamr-mesh --shape kuhn-cube --n $cubes -o "$out/box.hdf" --force
for name in collision-rate case; do
  sed "s|\.\./species.toml|$case_folder/../species.toml|" "$case_folder/$name.toml" >"$out/$name.toml"
  on_ranks pamr-dsmc "$out/$name.toml" --mesh "$out/box.hdf" -o "$out/$name.hdf" --force --history "$out/$name.csv"
done
python3 "$case_folder/check.py" "$out"
