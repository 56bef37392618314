#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The force between two isolated spheres by the mid-plane form, refined with that force as goal, compared with tabulated values.
#
#   cases/sphere-pair/run.sh [--ranks N] [--levels N] [--max-cells N] [--out FOLDER] [--tools FOLDER] [CASE...]
#
# CASE is RADIUS-DISTANCE-POTENTIAL-EQUATION as in expected.csv (default 1-3-3-sinh); `all`: all of them.
set -euo pipefail

declare -A values=([--levels]=levels [--max-cells]=max_cells)
levels=5
max_cells=300000
arguments=()
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
cases=("${arguments[@]:-1-3-3-sinh}")
if [ "${cases[0]}" = all ]; then
  mapfile -t cases < <(grep -oE '^[0-9][^,]*' "$case_folder/expected.csv")
fi

for name in "${cases[@]}"; do
  folder=$out/$name
  mkdir -p "$folder"
  python3 "$case_folder/pair_case.py" "$name" > "$folder/case.toml"
  pamr-mesh "$folder/case.toml" -o "$folder/mesh.hdf" --force --quiet
  echo "$name"
  "$root/cases/goal_loop.sh" "$folder/case.toml" "$folder/mesh.hdf" "$folder" "$ranks" "$levels" \
    "$max_cells" --bulk-of goal_error:0.5
  expected=()  # of a pair that nobody has tabulated
  if grep -q "^$name," "$case_folder/expected.csv"; then expected=(--expected "$case_folder/expected.csv" --case "$name"); fi
  python3 "$root/cases/goal_levels.py" "$folder" force=forces.sphere.midplane.dimensionless.0 \
    correction=goal.correction volume=forces.sphere.volume.dimensionless.0 charge=charge_densities.sphere "${expected[@]}"
  rm -f "$folder"/*.hdf
done
