#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Patches inside: a ball of another material in a box, whose interface is curved, and a rectangular sheet in one region, by Gmsh, and
# an assembly of three solids, from a STEP file. All are refined and coarsened back; the sheet is then a thin plate in free-molecular
# gas, and goes to OpenFOAM, and to dolfinx where it is.
#
#   cases/inner-patches/run.sh [--ranks N] [--levels N] [--picture] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2); meshes are made on 1, 3 and 7 in any case and compared
#   --levels N      refinements at the patches (default 3)
#   --picture       installs what pictures need; where it is there, pictures are made in any case
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools and the Python package from there and sets nothing up
#
# Needs the Debian packages python3-gmsh and python3-mpi4py, and PAMR's Python package.
set -euo pipefail

declare -A values=([--levels]=levels)
declare -A flags=([--picture]=picture)
levels=3 python=yes
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
. "$root/cases/python.sh" gmsh python3-gmsh

/usr/bin/python3 -B "$case_folder/make_meshes.py" "$out"
nowhere=(--box 9,9,9,10,10,10 --coarsen-rest)
# The levels of a mesh, finest last, and the way back, on a number of ranks. OPTIONS: of the tool that makes level 0.
there_and_back() { # NAME PATCH RANKS OPTIONS...
  local folder=$out/$1-$3 level
  mkdir -p "$folder"
  ranks=$3
  if [ -e "$out/$1.step" ]; then
    on_ranks pamr-mesh "$out/$1.step" -o "$folder/level0.hdf" "${@:4}" --force --quiet
  else
    on_ranks pamr-convert "$out/$1.msh" "$folder/level0.hdf" "${@:4}" --force --quiet
  fi
  for ((level = 0; level < levels; ++level)); do
    on_ranks pamr-mark "$folder/level$level.hdf" -o "$folder/marked.hdf" --patch "$2" --force --quiet
    on_ranks pamr-refine "$folder/marked.hdf" -o "$folder/level$((level + 1)).hdf" --force --quiet
  done
  cp "$folder/level$levels.hdf" "$folder/back.hdf"
  for ((level = 0; level < levels; ++level)); do
    on_ranks pamr-mark "$folder/back.hdf" -o "$folder/marked.hdf" "${nowhere[@]}" --force --quiet
    on_ranks pamr-refine "$folder/marked.hdf" -o "$folder/back.hdf" --force --quiet
  done
  rm "$folder/marked.hdf"
}
wanted=$ranks
for some in 1 3 7; do
  there_and_back ball interface "$some" --surfaces "$case_folder/ball.toml"
  there_and_back sheet sheet "$some"
  there_and_back assembly "solid_1_*" "$some" --size 0.4
done
ranks=$wanted
for ((level = 0; level <= levels; ++level)); do
  for name in ball sheet assembly; do
    pamr-quality "$out/$name-1/level$level.hdf" --json "$out/$name$level.json" --quiet
  done
done
on_ranks pamr-dsmc "$case_folder/plate.toml" --mesh "$out/sheet-1/level0.hdf" -o "$out/gas.hdf" --json "$out/gas.json" --force --quiet
pamr-convert "$out/sheet-1/level$levels.hdf" "$out/foam" --force --quiet
if /usr/bin/python3 -c "import dolfinx" 2>/dev/null; then
  mpirun -n "$ranks" /usr/bin/python3 -B "$case_folder/sheet_in_dolfinx.py" "$out" "$levels"
else
  echo "dolfinx was not found (Debian: python3-dolfinx): no integrals over the sheet"
  rm -f "$out/dolfinx.json"
fi
draw ball.png pamr-picture "$out/ball-1/level0.hdf" "$out/ball-1/level$levels.hdf" --label "Level 0" --label "Level $levels" --cut y=0 \
  --field region --edges --size 1500x760
draw assembly.png pamr-picture "$out/assembly-1/level0.hdf" "$out/assembly-1/level$levels.hdf" --label "Level 0" --label "Level $levels" \
  --cut y=0 --field region --edges --size 1500x860
draw sheet.png pamr-picture "$out/sheet-1/level0.hdf" "$out/sheet-1/level2.hdf" --label "Level 0" --label "Level 2" --cut y=0 --edges \
  --size 1500x760
draw gas.png pamr-picture "$out/gas.hdf" --cut y=0 --field n --size 900x760
/usr/bin/python3 -B "$case_folder/check.py" "$out" "$levels"
