#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# PAMR with MPICH, on Debian beside Open MPI: builds the refiner, its tools and the gas solver with HDF5 for MPICH, without
# PT-Scotch, PETSc and mpi4py, which Debian has for Open MPI alone, and tries them on 1 to 4 ranks.
#
#   qualification/mpich.sh [BUILD]    build folder (default build/mpich); installs MPICH as root
#
# Exit code 1 if a test fails, ranks write different bytes, or a mesh has another fingerprint than with Open MPI
# (tests/tools/fingerprints.csv).
set -euo pipefail
case ${1:-} in -h | --help) sed -n '3,10s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;; esac
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/mpich}
packages=(mpich libmpich-dev libhdf5-mpich-dev)
dpkg-query -W "${packages[@]}" >/dev/null 2>&1 || apt-get -q install -y --no-install-recommends "${packages[@]}"
cmake -G Ninja -S "$root" -B "$build" -DMPI_C_COMPILER=mpicc.mpich -DMPI_CXX_COMPILER=mpicxx.mpich -DPAMR_BATCHES=ON -DPAMR_BENCH=OFF
ninja -C "$build" all
ctest --test-dir "$build" --parallel $((3 * $(nproc))) --output-on-failure --no-label-summary \
  -R '^((assemble|mesh|par|balance|refine|adapt|coarsen|io|dsmc|check)_np[13]|tool_(refine|coarsen|mark|same_cases|dsmc)_np[13]|same_bytes_.*|tool_fingerprints.*)$'
