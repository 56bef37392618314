#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The plate alone, refined where the estimated error is; compares charge and energy with the exact profile.
#
#   cases/plate/run.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
set -euo pipefail

declare -A values=([--levels]=levels)
levels=5
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

pamr-mesh --shape kuhn-cube --n 6 -o "$out/mesh.hdf" --force --quiet
"$root/cases/goal_loop.sh" "$case_folder/cube.toml" "$out/mesh.hdf" "$out" "$ranks" "$levels" 400000 \
  --bulk-of indicator:0.6
python3 "$root/cases/goal_levels.py" "$out" slope=charge_densities.zmin energy=energy \
  "estimate=error_estimate.relative" "newton=newton_iterations" --expected "$case_folder/expected.csv" --case plate
