#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Speed and memory of one refinement: `limit`, W1, W2, W3, each in a process of its own so that peaks do not mix: a
# part of report.sh (table one-rank).
# Usage: run.sh [BUILD] [RANKS] [tiny]   (default: build/release, 1 rank; tiny: small meshes, which show that it works)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bench=${1:-$root/build/release}/bench/bench_refine
ranks=${2:-1}
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_btl_vader_single_copy_mechanism=none

echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD), $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $ranks rank(s), load $(cut -d' ' -f1 /proc/loadavg)"
echo
columns='Mcells_per_cpu_s Mcells_per_wall_s cells_out bytes_at_rest_per_cell peak_bytes_per_cell largest_rank_peak_MB'
echo "| workload (medians of 5) | ${columns// / | } |"
echo "|---|---|---|---|---|---|---|"
workloads="limit/55 W1/55 W2/n:56/policy:0 W2/n:56/policy:3 $(echo W3/n:14/level:{1,2,3,4,5})"
[ "${3:-}" != tiny ] || workloads="limit/20 W1/20 W2/n:20/policy:3 W3/n:14/level:1"
for workload in $workloads; do
  mpirun -n "$ranks" "$bench" "--benchmark_filter=^$workload/" --benchmark_format=csv 2>/dev/null |
    python3 -c '
import csv, sys
rows = list(csv.DictReader(sys.stdin))
median = next(row for row in rows if row["name"].endswith("_median"))
print("|", sys.argv[1], "|", " | ".join("%.4g" % float(median.get(c) or "nan") for c in sys.argv[2:]), "|")
' "$workload" $columns
done
