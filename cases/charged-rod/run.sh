#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A charged rod in a charged tube, on its axis and beside it: charge, force and energy compared with Bessel functions.
#
#   cases/charged-rod/run.sh [--ranks N] [--levels N] [--max-cells N] [--out FOLDER] [--tools FOLDER]
#
#   --levels N     refinements at most (default 3)
#   --max-cells N  cells at most (default 60000)
set -euo pipefail

declare -A values=([--levels]=levels [--max-cells]=max_cells)
levels=3
max_cells=60000
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

status=0
for name in case eccentric; do
  folder=$out/$name
  mkdir -p "$folder"
  pamr-mesh "$case_folder/$name.toml" -o "$folder/mesh.hdf" --force --quiet
  "$root/cases/goal_loop.sh" "$case_folder/$name.toml" "$folder/mesh.hdf" "$folder" "$ranks" "$levels" \
    "$max_cells" --bulk-of goal_error:0.5
  echo "$name"
  columns=("charge=best.rod.charge.value" "+-=best.rod.charge.error")
  if [ $name = eccentric ]; then columns+=("f_x=best.rod.force-x.value" "+-=best.rod.force-x.error"); fi
  energy=$([ $name = case ] && echo 1 || echo 2)
  python3 "$root/cases/goal_levels.py" "$folder" "${columns[@]}" "energy=goals.$energy.corrected" \
    "+-=goals.$energy.error_bar" --expected "$case_folder/expected.csv" --case "$name" || status=1
done
exit $status
