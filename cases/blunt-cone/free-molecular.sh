#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The blunt cone without collisions: the fore-body is refined twice, kinetic theory is integrated over the facets of each
# level, and the last level is run. Fails when a coefficient is not that of the exact surface.
#
#   cases/blunt-cone/free-molecular.sh [--ranks N] [--seed N] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --seed N        of the random numbers (default 1)
#   --out FOLDER    where meshes and reports go (default out/free-molecular beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A values=([--seed]=seed)
seed=1
subfolder=free-molecular
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

sed -e "s|\"\.\./species.toml\"|\"$root/cases/species.toml\"|" -e "s/^\[run\]/[run]\nseed = $seed/" \
  "$case_folder/free-molecular.toml" >"$out/free-molecular.toml"
on_ranks pamr-mesh "$case_folder/case.toml" -o "$out/level0.hdf" --force
for level in 0 1 2; do
  if [ $level -gt 0 ]; then
    on_ranks pamr-mark "$out/level$((level - 1)).hdf" -o "$out/marked.hdf" --patch forebody --force --quiet
    on_ranks pamr-refine "$out/marked.hdf" -o "$out/level$level.hdf" --force
  fi
  on_ranks pamr-quality "$out/level$level.hdf" --json "$out/quality$level.json" --quiet
  on_ranks pamr-dsmc "$out/free-molecular.toml" --mesh "$out/level$level.hdf" -o "$out/flow.hdf" --plan --quiet \
    --json "$out/plan$level.json" --force
done
on_ranks pamr-dsmc "$out/free-molecular.toml" --mesh "$out/level2.hdf" -o "$out/flow.hdf" --force \
  --surface "$out/wall.vtu" --json "$out/flow.json"
python3 -B "$case_folder/free_molecular.py" "$out"
