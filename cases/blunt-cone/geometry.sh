#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The shape alone, in seconds: meshes the half space about the 70-degree blunt cone, refines it three times at the
# fore-body, about the nose and along a sphere like the bow shock, checks every level against the exact areas and volume
# and prints one table. Installs and builds what is missing first.
#
#   cases/blunt-cone/geometry.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels N      refinements (default 3; each makes the mesh two to four times larger)
#   --out FOLDER    where meshes and reports go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A values=([--levels]=levels)
subfolder=geometry
levels=3
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

# Runs a tool on all ranks; its report goes to out/<report>.json, its summary line to the terminal.
on_ranks() { # REPORT TOOL ARGUMENT...
  local report=$out/$1.json tool=$2
  shift 2
  printf '%-13s ' "$tool"
  mpirun -n "$ranks" "$tool" "$@" --json "$report"
}

# No inverted cell, and every boundary node on its surface.
gates=(--gate inverted_cells:max:0)
for patch in forebody base sting inflow outflow symmetry; do
  gates+=(--gate "patches.$patch.off_surface_nodes:max:0")
done
quality() { # LEVEL
  on_ranks "quality$1" pamr-quality "$out/level$1.hdf" "${gates[@]}"
}

# What to split, meters: a shell about the sphere that lies where the bow shock may stand, thinner from level to level;
# a ball about the nose (a shell of radius 0); and in the first two refinements the cells at the fore-body.
region() { # LEVEL
  case $1 in
    1) echo --patch forebody --centroid-shell 0.002,0,0,0,0.010 --centroid-shell 0.066,0,0,0.070,0.0050 ;;
    2) echo --patch forebody --centroid-shell 0.002,0,0,0,0.010 --centroid-shell 0.066,0,0,0.070,0.0025 ;;
    *) echo --centroid-shell 0.002,0,0,0,0.007 --centroid-shell 0.066,0,0,0.070,0.0006 ;;
  esac
}

pamr-mesh --version >"$out/version.txt"
on_ranks mesh pamr-mesh "$case_folder/case.toml" -o "$out/level0.hdf" --force
quality 0
for ((level = 1; level <= levels; ++level)); do
  coarse=$((level - 1))
  # shellcheck disable=SC2046  # the options hold no blanks
  on_ranks "mark$coarse" pamr-mark "$out/level$coarse.hdf" -o "$out/marked$coarse.hdf" --force $(region "$level")
  on_ranks "refine$level" pamr-refine "$out/marked$coarse.hdf" -o "$out/level$level.hdf" --force
  quality "$level"
done

echo
python3 -B "$case_folder/geometry.py" "$out" "$levels"
echo
echo "Meshes to open in ParaView: $out/level0.hdf ... $out/level$levels.hdf"
echo "Reports: $out/*.json"
