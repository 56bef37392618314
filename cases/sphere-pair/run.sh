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
  # case.toml with the numbers of this pair, its mesh sizes in proportion.
  python3 - "$name" "$case_folder/case.toml" > "$folder/case.toml" <<'PYTHON'
import re
import sys

radius, distance, potential, equation = sys.argv[1].split("-")
gap = float(distance) - 2 * float(radius)
text = open(sys.argv[2], encoding="utf-8").read()
text = text.replace("radius = 1.0", f"radius = {radius}").replace("distance = 3.0", f"distance = {distance}")
text = text.replace("value = 3.0", f"value = {potential}")
sphere = min(0.4 * float(radius), 0.45 if gap > 3 else 0.5 * gap if gap < 1 else 0.3)
text = re.sub("(?m)^sphere = .*$", f"sphere = {sphere:g}", text)
text = re.sub("(?m)^far = .*$", f"far = {1.0 if gap > 6 else 1.5}", text)
if equation == "linear":
    text = text.replace("[force]", "[equation]\nlinear = true\n\n[force]", 1)
sys.stdout.write(text)
PYTHON
  pamr-mesh "$folder/case.toml" -o "$folder/mesh.hdf" --force --quiet
  echo "$name"
  "$root/cases/charged-spheres/loop.sh" "$folder/case.toml" "$folder/mesh.hdf" "$folder" "$ranks" "$levels" \
    "$max_cells" --bulk-of goal_error:0.5
  python3 "$root/cases/charged-spheres/levels.py" "$folder" force=forces.sphere.midplane.dimensionless.0 \
    correction=goal.correction volume=forces.sphere.volume.dimensionless.0 charge=charge_densities.sphere \
    --expected "$case_folder/expected.csv" --case "$name"
  rm -f "$folder"/*.hdf
done
