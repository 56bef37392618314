#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A pulse crosses a cube on a mesh that follows it, refined and coarsened in memory every second step, and the same on
# uniform meshes.
#
#   cases/moving-front/run.sh [--ranks N] [--levels L] [--picture] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels L      of refinement at the pulse (default 3)
#   --picture       installs what pictures need
#   --out FOLDER    where history and meshes go (default out/ beside this script)
#   --tools FOLDER  takes the programs from there and sets nothing up
set -euo pipefail

declare -A values=([--levels]=levels) flags=([--picture]=picture)
levels=3
picture=no
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

mkdir -p "$out/uniform"
rm -f "$out"/front_*.hdf
echo "following the pulse, $levels levels:"
on_ranks moving-front --levels "$levels" --frames 4 --out "$out" | tee "$out/run.txt"
echo "uniform, $((levels - 1)) levels:"
on_ranks moving-front --levels $((levels - 1)) --uniform --out "$out/uniform" | tee "$out/uniform/run.txt"
plane=(--cut 0,-0.4,0.6=0.1 --size 2000x620) # the pulse stays in it
draw pulse.png pamr-picture "$out"/front_00[0-3].hdf "${plane[@]}" --field c --range 0,1
draw meshes.png pamr-picture "$out"/front_00[0-3].hdf "${plane[@]}"
/usr/bin/python3 -B "$case_folder/check.py" "$out"
