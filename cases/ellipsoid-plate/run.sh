#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A charged ellipsoid from an STL over a charged plate: force, torque and charge compared with another code's.
#
#   cases/ellipsoid-plate/run.sh [--ranks N] [--levels N] [--max-cells N] [--out FOLDER] [--tools FOLDER]
#
#   --levels N     refinements at most (default 3)
#   --max-cells N  cells at most (default 120000)
set -euo pipefail

declare -A values=([--levels]=levels [--max-cells]=max_cells)
levels=3
max_cells=120000
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

python3 "$case_folder/make_body.py" "$out/ellipsoid.stl"
cp "$case_folder/case.toml" "$out/case.toml"
pamr-mesh "$out/case.toml" -o "$out/mesh.hdf" --force
"$root/cases/goal_loop.sh" "$out/case.toml" "$out/mesh.hdf" "$out" "$ranks" "$levels" "$max_cells" \
  --bulk-of goal_error:0.5
python3 "$root/cases/goal_levels.py" "$out" "f_z=best.ellipsoid.force-z.value" \
  "+-=best.ellipsoid.force-z.error" "torque_y=best.ellipsoid.torque-y.value" "+-=best.ellipsoid.torque-y.error" \
  "f_x=best.ellipsoid.force-x.value" "charge=best.ellipsoid.charge.value" "+-=best.ellipsoid.charge.error" \
  "surface_z=forces.ellipsoid.surface_reaction.dimensionless.2" --expected "$case_folder/expected.csv" \
  --case ellipsoid-plate
