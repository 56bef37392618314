#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A part by Gmsh, refined until every cell is as small as a field asks: run.sh [FOLDER]
set -euo pipefail
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

if [ ! -e part.msh ]; then
  command -v gmsh >/dev/null || { echo "this tutorial needs gmsh (apt install gmsh) or a part.msh in $out" >&2; exit 2; }
  step gmsh -3 -format msh41 -v 2 "$here/part.geo" -o part.msh
fi
step pamr-convert part.msh level0.hdf --surfaces "$here/surfaces.toml" --force
for level in 1 2 3; do
  coarser=level$((level - 1)).hdf
  step /usr/bin/python3 "$here/wanted_size.py" "$coarser"
  step pamr-mark "$coarser" -o marked.hdf --size-over wanted --ratio 1 --size longest-edge --force
  step mpirun -n 2 pamr-refine marked.hdf -o "level$level.hdf" --force
done
step pamr-quality level3.hdf --gate inverted_cells:max:0 --gate mean_ratio.min:min:0.15
step pamr-convert level3.hdf refined.msh --force
picture levels.png level0.hdf level3.hdf --label "Gmsh's mesh" --label "Refined three times" --camera -1,-2,2.5 --size 1500x720
