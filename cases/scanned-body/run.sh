#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A scanned body from the STL file to the refined mesh: makes the scan, meshes the space round it, refines at the wall.
#
#   cases/scanned-body/run.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels N      refinements at the wall (default 3)
#   --out FOLDER    where the scan and the meshes go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

case_folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$case_folder/../.." && pwd)
out=$case_folder/out
ranks=2
levels=3
tools=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?run.sh: --ranks needs a number}; shift 2 ;;
    --levels) levels=${2:?run.sh: --levels needs a number}; shift 2 ;;
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

/usr/bin/python3 "$case_folder/make_body.py" "$out/scan.stl" --levels 4
cp "$case_folder/case.toml" "$out/case.toml"
pamr-mesh "$out/case.toml" -o "$out/level0.hdf" --force
for level in $(seq 1 "$levels"); do
  on_ranks pamr-mark "$out/level$((level - 1)).hdf" -o "$out/marked.hdf" --force --quiet \
    --patch body_1 --patch body_2 --patch body_3
  on_ranks pamr-refine "$out/marked.hdf" -o "$out/level$level.hdf" --force
done
rm -f "$out/marked.hdf"
/usr/bin/python3 "$case_folder/check.py" "$out" "$levels"
