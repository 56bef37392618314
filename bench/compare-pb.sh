#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The Poisson-Boltzmann equation on one mesh by this library and by dolfinx with PETSc (Debian's python3-dolfinx), the
# latter as one would write it by hand for speed (compare_pb.py), on one rank, in turn: P1, nodal quadrature, inexact
# Newton, conjugate gradients with Jacobi and with BoomerAMG. Both begin with points and cells in memory. Prints CPU
# seconds (user and system) of each stage, medians, ratios with and without topology, and memory.
#
#   bench/compare-pb.sh [BUILD] [--cells N] [--repeats N] [--out FOLDER]
#
#   BUILD      build folder with bench_pb (-DPAMR_BENCH=ON; default build/release)
#   --cells N  about so many cells (default 1000000): a cube of Kuhn's tetrahedra over a plate at 5 kT/Ze
#   --repeats  runs of each (default 3)
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$here/.." && pwd)
build=$root/build/release
out=${TMPDIR:-/tmp}/pamr-compare-pb
cells=1000000
repeats=3
while [ $# -gt 0 ]; do
  case $1 in
    --cells) cells=${2:?}; shift 2 ;;
    --repeats) repeats=${2:?}; shift 2 ;;
    --out) out=${2:?}; shift 2 ;;
    -h | --help) sed -n '3,13s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "compare-pb.sh: unknown option $1 (see compare-pb.sh --help)" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
. "$root/scripts/mpi_environment.sh"
export OMP_NUM_THREADS=1
mkdir -p "$out"
rm -f "$out"/ours-*.json "$out"/theirs-*.json

n=$(awk -v cells="$cells" 'BEGIN { printf "%.0f", (cells / 6) ^ (1 / 3) }')
"$build/bin/pamr-mesh" --shape kuhn-cube --n "$n" -o "$out/mesh.hdf" --force --quiet
for preconditioner in jacobi boomeramg; do
  {
    printf '[solver]\npreconditioner = "%s"\n' "$preconditioner"
    cat "$root/cases/plate/cube.toml"
  } > "$out/$preconditioner.toml"
done
for ((run = 1; run <= repeats; ++run)); do
  for preconditioner in jacobi boomeramg; do
    "$build/bench/bench_pb" --arrays "$out/$preconditioner.toml" "$out/mesh.hdf" \
      > "$out/ours-$preconditioner-$run.json"
    /usr/bin/python3 "$here/compare_pb.py" "$out/mesh.hdf" "$preconditioner" > "$out/theirs-$preconditioner-$run.json"
  done
done
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc --all) cores, load $(cut -d' ' -f1 /proc/loadavg)." \
  "Command: bench/compare-pb.sh --repeats $repeats (medians)."
python3 "$here/compare_pb_table.py" "$out"
