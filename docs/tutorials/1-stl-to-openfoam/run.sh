#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From an STL file to a mesh of OpenFOAM that is fine at the body: run.sh [FOLDER]
set -euo pipefail
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

if [ ! -e body.stl ]; then awk -f "$here/make_body.awk" -f "$here/../closed_body.awk" >body.stl; fi
cp "$here/case.toml" .
if command -v pamr-surface >/dev/null; then step pamr-surface info body.stl; fi
step pamr-mesh case.toml -o level0.hdf --force
step mpirun -n 2 pamr-mark level0.hdf -o marked.hdf --patch "body*" --layers 2 --force
step mpirun -n 2 pamr-refine marked.hdf -o level1.hdf --force
step pamr-quality level1.hdf --gate inverted_cells:max:0 --gate mean_ratio.min:min:0.2
step pamr-convert level1.hdf foam --force
if command -v checkMesh >/dev/null; then
  if [ -z "${WM_PROJECT_DIR:-}" ] && [ -d /usr/share/openfoam/etc ]; then export WM_PROJECT_DIR=/usr/share/openfoam; fi
  cp -r "$here/system" foam
  step checkMesh -case foam -constant | tee checkMesh.log | tail -n 25
  grep -q "Mesh OK" checkMesh.log
fi
picture levels.png level0.hdf level1.hdf --label "Level 0" --label "Level 1" --cut z=0 --whole-cells --focus 0.02,0,0 \
  --zoom 2 --size 1600x800
