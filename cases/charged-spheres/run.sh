#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Two charged spheres near a charged plate: the coupled loop of meshing, solving, marking and refining by the stage tools,
# a table of its levels, and the same forces on the last mesh without the plate's potential.
#
#   cases/charged-spheres/run.sh [--reading a|b] [--ranks N] [--levels N] [--max-cells N] [--out FOLDER] [--tools FOLDER]
#                                [--picture]
#
#   --reading a|b  the paper's lengths in micrometers (a) or in Debye lengths (b, default)
#   --levels N     refinements at most (default 5)
#   --max-cells N  cells at most (default 700000)
#   --picture      installs what pictures need; where it is there, pictures are made and named in any case
set -euo pipefail

declare -A values=([--reading]=reading [--levels]=levels [--max-cells]=max_cells)
declare -A flags=([--picture]=picture)
reading=b
full_levels=5
full_cells=700000
levels=$full_levels
max_cells=$full_cells
picture=no
check_options() {
  case $reading in a | b) ;; *) echo "run.sh: expected --reading a or b, found $reading" >&2; exit 2 ;; esac
  subfolder=reading-$reading
}
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
case_file=$case_folder/reading-$reading.toml

# The error of the mid-plane force decides in reading A; in reading B the entire error has a part in it, so that the
# volume form, the vertical force and the charges converge too.
criteria=(--bulk-of goal_error:0.5)
if [ "$reading" = b ]; then criteria=(--bulk-of goal_error:0.4 --bulk-of indicator:0.3); fi

pamr-mesh "$case_file" -o "$out/mesh.hdf" --force
"$root/cases/goal_loop.sh" "$case_file" "$out/mesh.hdf" "$out" "$ranks" "$levels" "$max_cells" "${criteria[@]}"
# With fewer levels or cells other bounds hold, with very few none.
expected=(--expected "$case_folder/expected.csv" --case "reading-$reading")
if [ "$levels" -lt 2 ] || [ "$max_cells" -lt 60000 ]; then
  expected=()
  echo "Fewer than two levels, or than 60,000 cells: nothing is compared with expected.csv."
elif [ "$levels" -lt $full_levels ] || [ "$max_cells" -lt $full_cells ]; then
  expected[3]+=-short
fi
status=0
python3 "$root/cases/goal_levels.py" "$out" "f_x=best.sphere.force-x.value" "+-=best.sphere.force-x.error" \
  "f_z=best.sphere.force-z.value" "+-=best.sphere.force-z.error" \
  "midplane=forces.sphere.midplane.dimensionless.0" "correction=goal.correction" \
  "newton=forces.sphere.midplane.newton.0" "volume_x=forces.sphere.volume.dimensionless.0" \
  "surface_x=forces.sphere.surface.dimensionless.0" "volume_z=forces.sphere.volume.dimensionless.2" \
  "plate_z=forces.plate.volume.dimensionless.2" "estimate=error_estimate.relative" \
  "${expected[@]}" || status=1

# The last mesh again, with nothing where the plate was: what the plate changes, free of most of the mesh's error.
solved=("$out"/solve*.json)  # of this run; levels of a longer one before may lie beside
last=$out/level$((${#solved[@]} - 1)).hdf
mpirun -n "$ranks" pamr-pb "$case_folder/reading-$reading-without-plate.toml" --mesh "$last" \
  -o "$out/without-plate.hdf" --force --quiet --json "$out/without-plate.json"
python3 - "$out/without-plate.json" "${last%.hdf}" <<'PYTHON'
import json
import re
import sys

without = json.load(open(sys.argv[1], encoding="utf-8"))
number = re.search(r"(\d+)$", sys.argv[2]).group(1)
with_plate = json.load(open(sys.argv[2].rsplit("/", 1)[0] + f"/solve{number}.json", encoding="utf-8"))
force = [r["forces"]["sphere"]["midplane"]["dimensionless"][0] for r in (with_plate, without)]
print(f"force with plate {force[0]:.6g}, without {force[1]:.6g}: the plate changes it by {force[0] - force[1]:.3e} "
      f"({100 * (force[0] / force[1] - 1):.2f} %)")
PYTHON
sphere=$(python3 - "$case_file" <<'PYTHON'
import sys
import tomllib

shape = tomllib.load(open(sys.argv[1], "rb"))["mesh"]["geometry"]
print(f"{shape['distance'] / 2},0,{shape['height']}")
PYTHON
)
draw levels.png pamr-picture "$out/level0.hdf" "$last" --patch sphere --patch plate --mirror xy --size 1480x1100 \
  --label Before --label After --camera -6,-8,3 --focus "$sphere" --zoom 18 --camera 1,-9,4.2 --focus 0,0,0 --zoom 2
draw potential.png pamr-picture "$last" --cut y=0 --mirror x --field potential --isolines 0.1,0.2,0.5,1,2,3,4
echo "For ParaView: $last"
exit $status
