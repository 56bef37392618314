#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# OpenFOAM's laplacianFoam in the loop: heat conduction between two concentric spheres, refined by its own solution.
#
#   cases/openfoam-loop/run.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes of PAMR and of the solver (default 2; 1 runs the solver without MPI)
#   --levels N      refinements (default 3)
#   --out FOLDER    where cases and meshes go (default out/ beside this script)
#   --tools FOLDER  takes the tools and the Python package from there and sets nothing up
#
# Needs the Debian packages openfoam and python3-mpi4py, and PAMR's Python package.
set -euo pipefail

declare -A values=([--levels]=levels)
levels=3
python=yes
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
. "$root/cases/python.sh" mpi4py python3-mpi4py
if ! command -v laplacianFoam >/dev/null; then
  echo "$name: this case needs OpenFOAM's laplacianFoam and checkMesh (Debian: apt install openfoam)" >&2
  exit 2
fi
if [ -z "${WM_PROJECT_DIR:-}" ] && [ -d /usr/share/openfoam/etc ]; then export WM_PROJECT_DIR=/usr/share/openfoam; fi

step() { on_ranks /usr/bin/python3 -B -m mpi4py "$case_folder/step.py" "$@"; }
foam() { # PROGRAM CASE LOG OPTIONS...
  local program=$1 case=$2 log=$3
  shift 3
  if [ "$ranks" = 1 ]; then
    "$program" -case "$case" "$@" >"$log" 2>&1
  else
    on_ranks "$program" -parallel -case "$case" "$@" >"$log" 2>&1
  fi || { echo "$name: $program failed in $case; the end of $log:" >&2; tail -n 20 "$log" >&2; exit 1; }
}

step start "$out"
for level in $(seq 0 "$levels"); do
  case=$out/level$level
  checkMesh -case "$case" -constant >"$case/log.checkMesh" 2>&1
  [ "$ranks" = 1 ] || foam checkMesh "$case" "$case/log.checkMesh-parallel" -constant
  foam laplacianFoam "$case" "$case/log"
  if [ "$level" -lt "$levels" ]; then step next "$out" "$level"; else step last "$out" "$level"; fi
done
/usr/bin/python3 -B "$case_folder/check.py" "$out" "$levels" "$ranks"
