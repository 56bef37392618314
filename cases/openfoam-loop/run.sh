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
. "$root/cases/openfoam.sh" laplacianFoam

step start "$out"
for level in $(seq 0 "$levels"); do
  case=$out/level$level
  checkMesh -case "$case" -constant >"$case/log.checkMesh" 2>&1
  [ "$ranks" = 1 ] || foam checkMesh "$case" "$case/log.checkMesh-parallel" -constant
  foam laplacianFoam "$case" "$case/log"
  if [ "$level" -lt "$levels" ]; then step next "$out" "$level"; else step last "$out" "$level"; fi
done
/usr/bin/python3 -B "$case_folder/check.py" "$out" "$levels" "$ranks"
