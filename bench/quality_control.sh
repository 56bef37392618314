#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The table of the four quality-control policies: cells, smallest and mean quality per level, on the Kuhn cube K(7) and
# on the blunt cone. Usage: quality_control.sh [BUILD] [LEVELS]   (default: build/release, 6 levels, about two minutes)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/release}
levels=${2:-6}
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

echo "Kuhn cube K(7), cells cut by the sphere r = 0.35"
"$build/bench/bench_quality_control" kuhn:7 sphere:0.5,0.5,0.5,0.35 "$levels"
echo
echo "Blunt cone, cells in a box of 1 mm at the shoulder, at the symmetry plane"
"$build/bin/pamr-mesh" "$root/cases/blunt-cone/case.toml" -o "$work/cone.hdf" --quiet
"$build/bench/bench_quality_control" "$work/cone.hdf" box:8.672e-3,-1,24.5e-3,9.672e-3,0.5e-3,25.5e-3 "$levels"
