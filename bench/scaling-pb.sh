#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scaling of the Poisson-Boltzmann solver by counting: one case on 1 to 16 ranks that share the cores there are. Prints
# what each step computes, sends and holds on the ranks, iterations, and whether forces and charges are the same, with
# pass or FAIL. Docs: docs/reports/poisson-boltzmann-speed.md.
#
#   bench/scaling-pb.sh [BUILD] [--ranks "1 2 4"] [--cells N] [--repeats N] [--preconditioners "NAMES"] [--out FOLDER]
#
#   BUILD              build folder with bench_pb (-DPAMR_BENCH=ON; default build/release)
#   --ranks            numbers of processes (default "1 2 4 8 16"; the first is what the others are compared with)
#   --cells            about so many, a cube of Kuhn's tetrahedra over a plate at 5 kT/Ze (default 1000000)
#   --case, --mesh     another case on another mesh
#   --repeats          runs of each, of which the medians count (default 3)
#   --preconditioners  as in a case file (default "jacobi boomeramg")
#   --out              where reports go (default BUILD/bench/scaling-pb-out)
#
# Exit code 1 when iterations grow or results differ, 2 when a run fails.
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$folder/.." && pwd)
build=$root/build/release
ranks="1 2 4 8 16"
cells=1000000
repeats=3
preconditioners="jacobi boomeramg"
case=$root/cases/plate/cube.toml
mesh=
out=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?}; shift 2 ;;
    --cells) cells=${2:?}; shift 2 ;;
    --case) case=${2:?}; shift 2 ;;
    --mesh) mesh=${2:?}; shift 2 ;;
    --repeats) repeats=${2:?}; shift 2 ;;
    --preconditioners) preconditioners=${2:?}; shift 2 ;;
    --out) out=${2:?}; shift 2 ;;
    -h | --help) sed -n '3,18s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "scaling-pb.sh: unknown option $1 (see scaling-pb.sh --help)" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
out=${out:-$build/bench/scaling-pb-out}
. "$root/scripts/mpi_environment.sh"
mkdir -p "$out"
rm -f "$out"/run-*.json
if [ -z "$mesh" ]; then
  mesh=$out/cube.hdf
  n=$(awk -v cells="$cells" 'BEGIN { printf "%.0f", (cells / 6) ^ (1 / 3) }')
  "$build/bin/pamr-mesh" --shape kuhn-cube --n "$n" -o "$mesh" --force --quiet
fi
trap 'echo "scaling-pb.sh: a run failed" >&2; exit 2' ERR
for preconditioner in $preconditioners; do
  {
    printf '[solver]\npreconditioner = "%s"\n' "$preconditioner"
    cat "$case"
  } > "$out/case-$preconditioner.toml"
done
for ((run = 1; run <= repeats; ++run)); do
  for p in $ranks; do
    for preconditioner in $preconditioners; do
      mpirun -n "$p" "$build/bench/bench_pb" "$out/case-$preconditioner.toml" "$mesh" \
        > "$out/run-$preconditioner-$p-$run.json"
    done
  done
done
trap - ERR
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg)." \
  "Command: bench/scaling-pb.sh --repeats $repeats (medians)."
python3 "$folder/scaling/summarize_pb.py" "$out"
