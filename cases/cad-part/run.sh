#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a STEP file to a mesh refined three times at all its walls, measured by Gmsh and OpenCASCADE: once from Gmsh's mesh, once
# from one of pamr-mesh.
#
#   cases/cad-part/run.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels N      refinements at the walls (default 3)
#   --out FOLDER    where the part and the meshes go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A values=([--levels]=levels)
levels=3
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

if ! /usr/bin/python3 -c "import gmsh" 2>/dev/null; then
  echo "run.sh: this case needs the Python module gmsh (Debian: apt install python3-gmsh)" >&2
  exit 2
fi
/usr/bin/python3 "$case_folder/make_part.py" "$out" >/dev/null
on_ranks pamr-convert "$out/part.msh" "$out/level0.hdf" --cad "$out/part.step" --json "$out/convert.json" --force
cp "$case_folder/case.toml" "$out/case.toml"
on_ranks pamr-mesh "$out/case.toml" -o "$out/own0.hdf" --force
for mesh in level own; do
  for level in $(seq 1 "$levels"); do
    on_ranks pamr-mark "$out/$mesh$((level - 1)).hdf" -o "$out/marked.hdf" --force --quiet \
      --patch boss --patch wave --patch spike --patch plate
    on_ranks pamr-refine "$out/marked.hdf" -o "$out/$mesh$level.hdf" --force
  done
  rm -f "$out/marked.hdf"
  if command -v checkMesh >/dev/null; then
    on_ranks pamr-convert "$out/$mesh$levels.hdf" "$out/${mesh}_foam" --force --quiet
  fi
done
/usr/bin/python3 "$case_folder/check.py" "$out" "$levels"
