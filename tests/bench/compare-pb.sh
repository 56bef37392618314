#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The full Poisson-Boltzmann solve of one mesh by pamr-pb and by dolfinx with PETSc (Debian's python3-dolfinx), on one
# rank, one after the other in one run: P1, nodal quadrature, Newton's method, conjugate gradients with Jacobi. Prints
# seconds of processor and wall time of both, their Newton steps, iterations and peak memory, and compares the charges.
#
#   tests/bench/compare-pb.sh [--cells N] [--tools FOLDER] [--out FOLDER]
#
#   --cells N   about so many cells (default 1000000): a cube of Kuhn's tetrahedra over a plate at 5 kT/Ze
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$here/../.." && pwd)
tools=$root/build/release/bin
out=${TMPDIR:-/tmp}/pamr-compare-pb
cells=1000000
while [ $# -gt 0 ]; do
  case $1 in
    --cells) cells=${2:?}; shift 2 ;;
    --tools) tools=${2:?}; shift 2 ;;
    --out) out=${2:?}; shift 2 ;;
    -h | --help) sed -n '3,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "compare-pb.sh: unknown option $1 (see compare-pb.sh --help)" >&2; exit 2 ;;
  esac
done
. "$root/scripts/mpi_environment.sh"
export OMP_NUM_THREADS=1
mkdir -p "$out"

n=$(python3 -c "print(round(($cells / 6) ** (1 / 3)))")
"$tools/pamr-mesh" --shape kuhn-cube --n "$n" -o "$out/mesh.hdf" --force --quiet
"$tools/pamr-pb" "$root/cases/plate/cube.toml" --mesh "$out/mesh.hdf" -o "$out/psi.hdf" --force --quiet \
  --json "$out/pamr.json"
/usr/bin/python3 "$here/compare_pb.py" "$out/mesh.hdf" "$out/pamr.json"
