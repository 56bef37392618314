#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What quality control costs: the time of `removable` over that of `none` for each cell that comes out, on W2, at every
# level of W3 and at four levels of the blunt cone (the marks of scaling.sh). Each policy refines its own meshes, one
# rank. Prints medians; of the cone, the processor time of the steps from close to transfer by the tool's report.
# Usage: quality_cost.sh [BUILD] [REPEATS]   (default: build/release, 5; four minutes)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/release}
repeats=${2:-5}
bench=$build/bench/bench_refine
PATH=$build/bin:$PATH
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

workload() { # NAME NONE REMOVABLE
  for name in "$2" "$3"; do
    "$bench" "--benchmark_filter=^$name\$" "--benchmark_repetitions=$repeats" --benchmark_format=json \
      >"$work/$([ "$name" = "$2" ] && echo none || echo removable).json" 2>/dev/null
  done
  python3 - "$1" "$work" <<'EOF'
import json, sys
def median(policy):
    runs = json.load(open(f"{sys.argv[2]}/{policy}.json"))["benchmarks"]
    return next(run for run in runs if run.get("aggregate_name") == "median")
none, removable = median("none"), median("removable")
nanoseconds = [1e3 / run["Mcells_per_cpu_s"] for run in (none, removable)]
print(f"| {sys.argv[1]} | {none['cells_out']:,.0f} | {removable['cells_out']:,.0f} | {nanoseconds[0]:.1f} |"
      f" {nanoseconds[1]:.1f} | {nanoseconds[1] / nanoseconds[0]:.2f} |")
EOF
}

cone() { # LEVEL MB MARKS...   MB: some 1 KB for each cell that comes out
  local level=$1 megabytes=$2
  shift 2
  for policy in none removable; do
    pamr-mark "$work/$policy.hdf" -o "$work/marked.hdf" --force --quiet "$@"
    for ((run = 0; run < repeats; ++run)); do
      python3 -B "$root/bench/compare/warm_memory.py" "$megabytes"
      pamr-refine "$work/marked.hdf" -o "$work/$policy.hdf" --force --quiet --quality-control "$policy" \
        --json "$work/$policy-$run.json"
    done
  done
  python3 - "$level" "$work" "$repeats" <<'EOF'
import json, statistics, sys
level, work, repeats = sys.argv[1], sys.argv[2], int(sys.argv[3])
steps = ["close", "number", "project", "subdivide", "relink", "transfer"]
cells, nanoseconds = [], []
for policy in "none", "removable":
    runs = [json.load(open(f"{work}/{policy}-{run}.json")) for run in range(repeats)]
    seconds = statistics.median(sum(run["cpu_seconds"][step]["max"] for step in steps) for run in runs)
    cells.append(runs[0]["cells_out"])
    nanoseconds.append(1e9 * seconds / cells[-1])
print(f"| blunt cone, level {level} | {cells[0]:,} | {cells[1]:,} | {nanoseconds[0]:.1f} | {nanoseconds[1]:.1f} |"
      f" {nanoseconds[1] / nanoseconds[0]:.2f} |")
EOF
}

echo "| workload | cells out, \`none\` | \`removable\` | ns of CPU a cell out, \`none\` | \`removable\` | ratio |"
echo "|---|---|---|---|---|---|"
workload W2 W2/n:56/policy:0/.* W2/n:56/policy:3/.*
for level in 1 2 3 4 5; do workload "W3, level $level" "W3-none/n:14/level:$level/.*" "W3/n:14/level:$level/.*"; done

pamr-mesh --shape blunt-cone -o "$work/none.hdf" --force --quiet
cp "$work/none.hdf" "$work/removable.hdf"
nose=(--centroid-shell 0.002,0,0,0,0.010)
shock=(--centroid-shell 0.066,0,0,0.070)
cone 1 200 --patch forebody "${nose[@]}" "${shock[@]},0.0100"
cone 2 1100 --patch forebody "${nose[@]}" "${shock[@]},0.0096"
cone 3 2700 "${nose[@]}" "${shock[@]},0.0053"
cone 4 4000 "${nose[@]}" "${shock[@]},0.0020"
echo
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD), $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg), medians of $repeats"
