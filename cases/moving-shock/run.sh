#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A shock that a piston drives through argon, on a mesh that follows it, and on uniform meshes.
#
#   cases/moving-shock/run.sh [--ranks N] [--smoke] [--picture] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --smoke         a few seconds: a thinner box, fewer particles, and only the mesh that follows the shock
#   --picture       installs what pictures need
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A flags=([--smoke]=smoke [--picture]=picture)
smoke=no
picture=no
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
python=/usr/bin/python3 # the one that sees Debian's h5py
[ -x "$python" ] || python=python3

runs="adapted coarse fine" seeds=3 bricks="32 2 1" area=0.005 per_cell=300 steps=1000 first=300
[ $smoke = yes ] && runs="smoke" bricks="32 1 1" area=0.0025 per_cell=120 steps=600 first=240

# shellcheck disable=SC2086  # three numbers
"$python" "$root/cases/box_mesh.py" "$out/box.msh" $bricks 0 1.6
pamr-convert "$out/box.msh" "$out/box.hdf" --force --quiet
cp "$out/box.hdf" "$out/fine.hdf"
for name in $runs; do
  [ "$name" = fine ] || continue
  for _ in 1 2; do # as deep as the mesh that follows the shock
    pamr-mark "$out/fine.hdf" -o "$out/marked.hdf" --all --force --quiet
    pamr-refine "$out/marked.hdf" -o "$out/fine.hdf" --force --quiet
  done
done

number=0 # no two runs have the same random numbers
for name in $runs; do
  mesh=$out/box.hdf particles="per_cell = $per_cell"
  # The fine mesh has 64 times the cells, and the same particles.
  if [ "$name" = fine ]; then mesh=$out/fine.hdf particles="per_cell = $(awk "BEGIN { print $per_cell / 64 }")"; fi
  for ((seed = 1; seed <= seeds; ++seed)); do
    number=$((number + 1))
    to=$out/$name-$seed
    mkdir -p "$to"
    sed -e "s|\.\./species.toml|$case_folder/../species.toml|" -e "s/^seed = .*/seed = $number/" \
      -e "s/^per_cell = .*/$particles/" -e "s/^sampling = .*/sampling = $steps/" -e "s/^area = .*/area = $area/" \
      "$case_folder/case.toml" >"$to/case.toml"
    # On the other meshes nothing is adapted.
    case $name in coarse | fine) sed -i '/^\[adapt\]/,$d' "$to/case.toml" ;; esac
    on_ranks pamr-dsmc "$to/case.toml" --mesh "$mesh" -o "$to/flow.hdf" --series "$to/window" --history "$to/history.csv" \
      --json "$to/report.json" --force --quiet
  done
done
if [ $smoke = no ]; then
  frames=()
  for step in 0000200 0000500 0000800; do frames+=("$out/adapted-1/window-$step.hdf"); done
  draw shock.png pamr-picture "${frames[@]}" --cut 0,0,1=0.02 --up x --size 1000x1500 --field n --edges
fi
# shellcheck disable=SC2086
"$python" -B "$case_folder/measure.py" "$out" $first $runs
