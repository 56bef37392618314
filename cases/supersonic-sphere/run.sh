#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Supersonic argon past a sphere: solve, mark where cells are larger than the mean free path, refine with each quality control, carry the flow, solve.
#
#   cases/supersonic-sphere/run.sh [--ranks N] [--full] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --full          the numbers of README.md; without it a shorter run with larger standard errors
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A flags=([--full]=full)
full=no
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

sampling=300
[ $full = yes ] && sampling=4000
case_file=$out/case.toml
sed -e "s|\.\./species.toml|$case_folder/../species.toml|" -e "s/^sampling = .*/sampling = $sampling/" "$case_folder/case.toml" >"$case_file"
on_ranks pamr-mesh --shape sphere-in-box -o "$out/level0.hdf" --force
on_ranks pamr-dsmc "$case_file" --mesh "$out/level0.hdf" -o "$out/flow0.hdf" --force --checkpoint "$out/flow0.checkpoint" \
  --surface "$out/wall0.vtu" --history "$out/history0.csv" --json "$out/flow0.json"
# Larger than the local mean free path, and in gas denser than 1.05 times the free stream.
on_ranks pamr-mark "$out/flow0.hdf" -o "$out/marked.hdf" --size-over lambda --ratio 1 --only-where n:above:6.7599e18 --force
for control in none isotropic short-edge removable; do
  on_ranks pamr-refine "$out/marked.hdf" -o "$out/$control.hdf" --quality-control $control --force
  on_ranks pamr-quality "$out/$control.hdf" --json "$out/$control-quality.json" --quiet
  on_ranks pamr-dsmc "$case_file" --mesh "$out/$control.hdf" -o "$out/$control-flow.hdf" --force \
    --carry "$out/flow0.checkpoint" --surface "$out/$control-wall.vtu" --json "$out/$control.json"
done
python3 "$case_folder/check.py" "$out"
