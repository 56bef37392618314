#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What a second core brings: W2 (docs/reports/performance.md) on two ranks against one, and two copies of `limit` side by side
# against one, by the wall clock; medians of 5. A bar: two ranks at least 1.7 times one, or 0.85 of what the two copies
# of `limit` reach, where memory is the bound. To be run on a machine with two idle cores.
# Usage: two_ranks.sh [BUILD] [W2 SIZE]   (default: build/release, 56). Exit code 1 when the bar is missed.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
bench=${1:-$root/build/release}/bench/bench_refine
size=${2:-56}
. "$root/scripts/mpi_environment.sh"
# Ranks have a core each, so they need not give it up while they wait.
export OMPI_MCA_mpi_yield_when_idle=0

rate() { # RANKS WORKLOAD: millions of cells out a second of wall clock, median
  mpirun -n "$1" "$bench" "--benchmark_filter=^$2/" --benchmark_format=csv 2>/dev/null | python3 -c '
import csv, sys
rows = list(csv.DictReader(sys.stdin))
print(next(row["Mcells_per_wall_s"] for row in rows if row["name"].endswith("_median")))'
}

w2=W2/n:$size/policy:3
one=$(rate 1 "$w2")
two=$(rate 2 "$w2")
limit=$(rate 1 limit/55)
side_by_side=$(rate 2 limit/55)
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), load $(cut -d' ' -f1 /proc/loadavg)." \
  "Command: bench/two_ranks.sh, medians of 5."
python3 - "$one" "$two" "$limit" "$side_by_side" <<'PYTHON'
import sys
one, two, limit, side_by_side = map(float, sys.argv[1:])
print("\n| M cells a second | 1 rank | 2 ranks | ratio |\n|---|---|---|---|")
print(f"| W2 | {one:.1f} | {two:.1f} | {two / one:.2f} |")
print(f"| limit | {limit:.1f} | {side_by_side:.1f} | {side_by_side / limit:.2f} |\n")
wanted = min(1.7, 0.85 * side_by_side / limit)
kept = two / one >= wanted
print(f"two ranks over one: found {two / one:.2f}, at least {wanted:.2f}: {'pass' if kept else 'FAIL'}")
sys.exit(0 if kept else 1)
PYTHON
