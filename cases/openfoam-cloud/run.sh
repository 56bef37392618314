#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# OpenFOAM's scalarTransportFoam with a mesh that follows what it computes: a cloud of dye is carried through a box and spreads. Cells are
# split before it and put together behind it, ten times a run; the cloud at the end is compared with the exact one.
#
#   cases/openfoam-cloud/run.sh [--ranks N] [--levels N] [--scheme NAME] [--picture] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes of PAMR and of the solver (default 2; 1 runs the solver without MPI)
#   --levels N      runs with 1, 2, ... N levels of refinement at the cloud, each with half the edges of the one before (default 2)
#   --scheme NAME   OpenFOAM's interpolation of the carried dye (default linear; upwind is of first order and misses the bounds)
#   --picture       installs what pictures need; where it is there, pictures of the cloud and its mesh are made in any case
#   --out FOLDER    where cases and meshes go (default out/ beside this script)
#   --tools FOLDER  takes the tools and the Python package from there and sets nothing up
#
# Needs the Debian packages openfoam and python3-mpi4py, and PAMR's Python package.
set -euo pipefail

declare -A values=([--levels]=levels [--scheme]=scheme)
declare -A flags=([--picture]=picture)
levels=2 scheme=linear python=yes
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
. "$root/cases/openfoam.sh" scalarTransportFoam

rm -f "$out/table.csv"
/usr/bin/python3 -B "$root/cases/box_mesh.py" "$out/box.msh" 16 12 12 0 2.4
turns=10
for level in $(seq 1 "$levels"); do
  step start "$out" "$level" "$scheme"
  for turn in $(seq 0 $((turns - 1))); do
    case=$out/levels$level/turn$turn
    foam scalarTransportFoam "$case" "$case/log"
    if [ "$turn" -lt $((turns - 1)) ]; then step next "$out" "$level" "$turn" "$scheme"; fi
  done
  foam checkMesh "$case" "$case/log.checkMesh" -constant
  step last "$out" "$level" $((turns - 1))
done
last=$out/levels$levels
seen=("$last"/turn{0,4,9}-seen.hdf --label "t = 0.1 s" --label "t = 0.5 s" --label "t = 1 s" --cut z=0.9)
draw mesh.png pamr-picture "${seen[@]}" --size 1800x620
draw cloud.png pamr-picture "${seen[@]}" --field T --range 0,0.6 --size 1800x620
/usr/bin/python3 -B "$case_folder/check.py" "$out" "$levels"
