#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scaling of the gas solver by counting: one gas on 1 to 64 ranks that share the cores there are. Prints what a step
# computes, sends and holds on the ranks, and whether crossings and collisions are the same on all, with pass or FAIL.
# Docs: docs/tools/pamr-dsmc.md, "Speed".
#
#   bench/scaling-dsmc.sh [BUILD] [--ranks "1 2 4"] [--cubes N] [--steps N] [--mach M] [--out FOLDER]
#
#   BUILD     build folder with bench_dsmc (-DPAMR_BENCH=ON; default build/release)
#   --ranks   numbers of processes (default "1 2 4 8 16 32 64"; the first is what the others are compared with)
#   --cubes   along an edge, 72 particles each (default 11: 95,832 particles)
#   --steps   counted (default 40)
#   --mach    a stream instead of a gas at rest
#   --out     where reports go (default BUILD/bench/scaling-dsmc-out)
#
# Exit code 1 when a bar is missed or results differ, 2 when a run fails.
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$folder/.." && pwd)
build=$root/build/release
ranks="1 2 4 8 16 32 64"
cubes=11
steps=40
mach=0
out=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?}; shift 2 ;;
    --cubes) cubes=${2:?}; shift 2 ;;
    --steps) steps=${2:?}; shift 2 ;;
    --mach) mach=${2:?}; shift 2 ;;
    --out) out=${2:?}; shift 2 ;;
    -h | --help) sed -n '3,18s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "scaling-dsmc.sh: unknown option $1 (see scaling-dsmc.sh --help)" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
out=${out:-$build/bench/scaling-dsmc-out}
. "$root/scripts/mpi_environment.sh"
mkdir -p "$out"
rm -f "$out"/run-*.txt
trap 'echo "scaling-dsmc.sh: a run failed" >&2; exit 2' ERR
for p in $ranks; do
  mpirun -n "$p" "$build/bench/bench_dsmc" "$cubes" "$steps" 12 "$mach" > "$out/run-$p.txt"
done
trap - ERR
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores." \
  "Command: bench/scaling-dsmc.sh --cubes $cubes --steps $steps --mach $mach."
python3 "$folder/scaling/summarize_dsmc.py" "$out"
