#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Validates pamr-dsmc against closed forms: the cases that take longer than a test. The table goes to OUT/results.csv; its
# numbers are in docs/results/dsmc-validation.md. Shocks: cases/shock/run.sh --full.
#
#   tests/validation/dsmc.sh [--ranks N] [--seeds N] [--out FOLDER] [--tools FOLDER] [CASE...]
#
#   --ranks N       MPI processes (default 2)
#   --seeds N       runs of every stochastic case (default 3)
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
#   CASE            only these: collision-rate relaxation equilibrium flux plate sphere newton fourier couette transition tube conductivity viscosity steps trace
set -euo pipefail

folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$folder/../.." && pwd)
out=$folder/out
ranks=2
seeds=3
tools=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?dsmc.sh: --ranks needs a number}; shift 2 ;;
    --seeds) seeds=${2:?dsmc.sh: --seeds needs a number}; shift 2 ;;
    --out) out=${2:?dsmc.sh: --out needs a folder}; shift 2 ;;
    --tools) tools=${2:?dsmc.sh: --tools needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,13s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "dsmc.sh: unknown option $1 (see dsmc.sh --help)" >&2; exit 2 ;;
    *) break ;;
  esac
done
if [ -z "$tools" ]; then
  "$root/scripts/setup.sh"
  tools=${PAMR_BUILD:-$root/build/release}/bin
fi
. "$root/scripts/mpi_environment.sh"
PATH=$tools:$PATH
python=/usr/bin/python3  # the one that sees Debian's h5py
[ -x "$python" ] || python=python3
mkdir -p "$out"
exec "$python" -B "$folder/dsmc_cases.py" "$out" "$ranks" "$seeds" "$@"
