#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Force and charge of a charged body of one's own over a plate, with error bars: run.sh [FOLDER]
set -euo pipefail
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

if [ ! -e body.stl ]; then awk -f "$here/make_body.awk" -f "$here/../closed_body.awk" >body.stl; fi
cp "$here/case.toml" .
step pamr-mesh case.toml -o mesh.hdf --force
step mpirun -n 2 pamr-pb case.toml --mesh mesh.hdf -o first.hdf --force
step mpirun -n 2 pamr-pb case.toml --mesh first.hdf -o refined.hdf --start potential --levels 2 --max-cells 80000 \
  --plot levels.svg --force
step pamr-quality refined.hdf --gate inverted_cells:max:0
picture potential.png first.hdf refined.hdf --label "First mesh" --label "Refined for the force" --cut y=0.1 --field potential \
  --isolines 8 --edges --size 1500x720
