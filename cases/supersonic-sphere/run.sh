#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Supersonic argon past a sphere: solve, mark where cells are larger than the mean free path, refine with each quality control, carry the flow, solve.
#
#   cases/supersonic-sphere/run.sh [--ranks N] [--full] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --full          the numbers of README.md; without it a shorter run with larger standard errors
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

case_folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$case_folder/../.." && pwd)
out=$case_folder/out
ranks=2
full=no
tools=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?run.sh: --ranks needs a number}; shift 2 ;;
    --full) full=yes; shift ;;
    --out) out=${2:?run.sh: --out needs a folder}; shift 2 ;;
    --tools) tools=${2:?run.sh: --tools needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,10s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
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
on_ranks() { mpirun -q -n "$ranks" "$@"; }

sampling=300
[ $full = yes ] && sampling=4000
case_file=$out/case.toml
sed -e "s|\.\./species.toml|$case_folder/../species.toml|" -e "s/^sampling = .*/sampling = $sampling/" "$case_folder/case.toml" >"$case_file"
on_ranks pamr-mesh --shape sphere-in-box -o "$out/level0.hdf" --force
on_ranks pamr-dsmc "$case_file" --mesh "$out/level0.hdf" -o "$out/flow0.hdf" --force --checkpoint "$out/flow0.checkpoint" \
  --surface "$out/wall0.vtu" --history "$out/history0.csv" --json "$out/flow0.json"
# Larger than the local mean free path, and in gas denser than 1.05 times the free stream.
on_ranks pamr-mark "$out/flow0.hdf" -o "$out/marked.hdf" --size-over lambda --ratio 1 --only-where n:above:6.7599e18 --force
for control in none isotropic short-edge removable; do
  on_ranks pamr-refine "$out/marked.hdf" -o "$out/$control.hdf" --quality-control $control --force
  on_ranks pamr-quality "$out/$control.hdf" --json "$out/$control-quality.json" --quiet
  on_ranks pamr-dsmc "$case_file" --mesh "$out/$control.hdf" -o "$out/$control-flow.hdf" --force \
    --carry "$out/flow0.checkpoint" --surface "$out/$control-wall.vtu" --json "$out/$control.json"
done
python3 "$case_folder/check.py" "$out"
