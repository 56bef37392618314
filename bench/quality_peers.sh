#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Cells and shapes level by level, ours beside the adaptive peers of compare.sh (netgen, dolfinx, UG), on one mesh with
# the same marks. Walls are flat: peers know no surfaces. Prints one Markdown table.
#
#   bench/quality_peers.sh MESH LAW LEVELS [FLOORS] [BUILD]
#
#   MESH     kuhn:N, or a Gmsh file of format 2.2, text
#   LAW      sphere:X,Y,Z,R: the cells cut by that sphere are marked at every level; box:X0,Y0,Z0,X1,Y1,Z1: those in it
#   FLOORS   shape floors of ours (default 0.35,0.5)
#   BUILD    folder with the benchmarks (default build/release)
#
# PEERS in the environment names the peers, some of "netgen dolfinx ug". compare.sh --install installs them.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
if [ $# -lt 3 ]; then
  sed -n '3,14s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
mesh=$1 law=$2 levels=$3 floors=${4:-0.35,0.5} build=${5:-$root/build/release}
here=$root/bench/compare
. "$here/build_peers.sh"
results=$(mktemp -d)
trap 'rm -rf -- "$results"' EXIT

"$build/bench/bench_quality_control" "$mesh" "$law" "$levels" "$floors" >"$results/pamr"
for peer in ${PEERS-netgen dolfinx ug}; do
  if ! is_installed "$peer"; then
    echo "quality_peers.sh: $peer is not installed (${packages[$peer]})" >&2
    continue
  fi
  program=("$python" "$here/${peer}_peer.py")
  if [ -e "$here/${peer}_peer.cpp" ]; then
    "build_$peer"
    program=("$results/${peer}_peer")
  fi
  "${program[@]}" shapes "$mesh" "$law" "$levels" >"$results/$peer.json" ||
    echo "quality_peers.sh: $peer ended with code $?" >&2
done
python3 -B "$here/quality_table.py" "$results"
