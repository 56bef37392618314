#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The flow of a rarefied gas about a body of one's own, on a mesh that follows the flow: run.sh [FOLDER]
set -euo pipefail
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

if [ ! -e body.stl ]; then awk -f "$here/make_body.awk" -f "$here/../closed_body.awk" >body.stl; fi
cp "$here/case.toml" .
step pamr-mesh case.toml -o level0.hdf --force
step pamr-dsmc case.toml --mesh level0.hdf -o flow0.hdf --plan
step mpirun -n 2 pamr-dsmc case.toml --mesh level0.hdf -o flow0.hdf --checkpoint flow0.state --json flow0.json --force
step mpirun -n 2 pamr-mark flow0.hdf -o marked.hdf --size-over lambda --ratio 1 --only-where n:above:2.25e20 --error n_stderr --max-cells 22000 --force
step mpirun -n 2 pamr-refine marked.hdf -o level1.hdf --force
step mpirun -n 2 pamr-dsmc case.toml --mesh level1.hdf -o flow1.hdf --carry flow0.state --surface wall.vtu --json flow1.json --force
picture density.png flow0.hdf flow1.hdf --label "First mesh" --label "Refined by the flow" --cut y=0 --field n --log \
  --isolines 6 --streamlines u --size 1500x760
picture heat.png wall.vtu --field q --camera -1,-0.8,0.6 --size 900x700
