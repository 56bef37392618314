#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The paper's Table 5 in its own set-up (cases/charged-spheres/paper.toml): its criterion, its surface form of the force, meshes of its sizes; then
# the same form on meshes that are finer and finer at the sphere.
#
#   studies/charged-spheres/table5.sh [--ranks N] [--out FOLDER] [--tools FOLDER]
set -euo pipefail

subfolder=table5
check_options() { :; }
. "$(dirname -- "${BASH_SOURCE[0]}")/../../cases/start.sh"

# Nearly every cell exceeds the criterion's bound; the paper's numbers of cells are what stops each level.
cells=275534,698093,872534,963419,1019692,1020243
columns=("surface_x=forces.sphere.surface.dimensionless.0" "recovered_x=forces.sphere.surface_recovered.dimensionless.0"
  "reaction_x=forces.sphere.surface_reaction.dimensionless.0" "volume_x=forces.sphere.volume.dimensionless.0"
  "surface_z=forces.sphere.surface.dimensionless.2" "volume_z=forces.sphere.volume.dimensionless.2"
  "newton_x=forces.sphere.surface.newton.0" "estimate=error_estimate.relative")

pamr-mesh "$root/cases/charged-spheres/paper.toml" -o "$out/mesh.hdf" --force
"$root/cases/goal_loop.sh" "$root/cases/charged-spheres/paper.toml" "$out/mesh.hdf" "$out" "$ranks" 6 "$cells" --field error_ratio --above 9e-8 \
  2>"$out/warnings.txt"
status=0
python3 "$root/cases/goal_levels.py" "$out" "${columns[@]}" --expected "$case_folder/expected.csv" --case table5 || status=1

echo "level 0 with edges of 0.4, 0.2, 0.12, 0.08, 0.05 and 0.035 Debye lengths at the sphere:"
mkdir -p "$out/graded"
number=0
for edge in 0.4 0.2 0.12 0.08 0.05 0.035; do
  sed "s/^sphere = .*/sphere = $edge/" "$root/cases/charged-spheres/paper.toml" >"$out/graded/case.toml"
  pamr-mesh "$out/graded/case.toml" -o "$out/graded/mesh.hdf" --force --quiet
  on_ranks pamr-pb "$out/graded/case.toml" --mesh "$out/graded/mesh.hdf" -o "$out/graded/solved.hdf" --force --quiet \
    --json "$out/graded/solve$number.json" 2>>"$out/warnings.txt"
  number=$((number + 1))
done
python3 "$root/cases/goal_levels.py" "$out/graded" "${columns[@]}"
echo "What the solver warned of: $out/warnings.txt"
exit $status
