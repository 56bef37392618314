#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The plate alone, refined where the estimated error is; compares charge and energy with the exact profile.
#
#   cases/plate/run.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
set -euo pipefail

case_folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$case_folder/../.." && pwd)
out=$case_folder/out
ranks=2
tools=
levels=5
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?run.sh: --ranks needs a number}; shift 2 ;;
    --levels) levels=${2:?run.sh: --levels needs a number}; shift 2 ;;
    --out) out=${2:?run.sh: --out needs a folder}; shift 2 ;;
    --tools) tools=${2:?run.sh: --tools needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "run.sh: unknown option $1 (see run.sh --help)" >&2; exit 2 ;;
  esac
done
if [ -z "$tools" ]; then
  "$root/scripts/setup.sh"
  tools=${PAMR_BUILD:-$root/build/release}/bin
fi
. "$root/scripts/mpi_environment.sh"
PATH=$tools:$PATH
mkdir -p "$out"

pamr-mesh --shape kuhn-cube --n 6 -o "$out/mesh.hdf" --force --quiet
"$root/cases/charged-spheres/loop.sh" "$case_folder/cube.toml" "$out/mesh.hdf" "$out" "$ranks" "$levels" 400000 \
  --bulk-of indicator:0.6
python3 "$root/cases/charged-spheres/levels.py" "$out" slope=charge_densities.zmin energy=energy \
  "estimate=error_estimate.relative" "newton=newton_iterations" --expected "$case_folder/expected.csv" --case plate
