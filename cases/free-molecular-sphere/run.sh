#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Drag and heat of a sphere in free-molecular flow, on a mesh and its refinements at the wall, compared with kinetic theory.
#
#   cases/free-molecular-sphere/run.sh [--ranks N] [--full] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --full          the numbers of README.md; without it a shorter run with larger standard errors
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A flags=([--full]=full)
full=no
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

steps=600 levels=1
[ $full = yes ] && steps=4000 levels=2
case_file=$out/case.toml
sed -e "s/^sampling = .*/sampling = $steps/" \
  -e "s/^block = .*/block = $((steps / 20))/" "$case_folder/case.toml" >"$case_file"
on_ranks pamr-mesh --shape sphere-in-box -o "$out/level0.hdf" --force
for ((level = 0; level <= levels; ++level)); do
  if [ "$level" -gt 0 ]; then
    on_ranks pamr-mark "$out/level$((level - 1)).hdf" -o "$out/marked.hdf" --patch sphere --force
    on_ranks pamr-refine "$out/marked.hdf" -o "$out/level$level.hdf" --force
  fi
  on_ranks pamr-dsmc "$case_file" --mesh "$out/level$level.hdf" -o "$out/flow$level.hdf" --force \
    --surface "$out/wall$level.vtu" --history "$out/history$level.csv" --json "$out/level$level.json"
done
python3 "$case_folder/check.py" "$out" "$levels"
