#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# PAMR with MPICH, on Debian beside Open MPI: builds the refiner, its tools and the gas solver with HDF5 for MPICH, without
# PT-Scotch, PETSc and mpi4py, which Debian has for Open MPI alone, and runs tests of them on 1 to 7 ranks: the same bytes on any, and
# the fingerprints of Open MPI's meshes (tests/tools/fingerprints.csv).
#
#   qualification/mpich.sh [BUILD]    build folder (default build/mpich); installs MPICH as root
set -euo pipefail
case ${1:-} in -h | --help) sed -n '3,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;; esac
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/mpich}
packages=(mpich libmpich-dev libhdf5-mpich-dev)
dpkg-query -W "${packages[@]}" >/dev/null 2>&1 || apt-get -q install -y --no-install-recommends "${packages[@]}"
cmake -G Ninja -S "$root" -B "$build" -DMPI_C_COMPILER=mpicc.mpich -DMPI_CXX_COMPILER=mpicxx.mpich -DPAMR_BATCHES=ON -DPAMR_BENCH=OFF
ninja -C "$build" pamr-mesh pamr-mark pamr-refine pamr-quality pamr-convert pamr-partition pamr-diff pamr-surface pamr-dsmc test_par test_balance
# Without the scripts that end runs by signals of a terminal or a limit on files, which MPICH's launcher handles otherwise (docs/building.md).
ctest --test-dir "$build" --parallel $((3 * $(nproc))) --output-on-failure --no-label-summary --no-tests=error \
  -R '^((par|balance)_np[13]|same_bytes_removable|tool_(fingerprints|refine|mark|coarsen)_np[13]|tool_dsmc_np3)$'
