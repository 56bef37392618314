#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a damaged scan to a mesh refined three times: looks at the scan, mends, smooths and decimates it, meshes its inside and
# refines at the wall.
#
#   cases/scan-repair/run.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels N      refinements at the wall (default 3)
#   --out FOLDER    where the surfaces and the meshes go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A values=([--levels]=levels)
levels=3
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

/usr/bin/python3 "$case_folder/make_scan.py" "$out/scan.stl"
if pamr-surface info "$out/scan.stl" --json "$out/scan.json"; then
  echo "run.sh: expected faults in the scan, found none" >&2
  exit 1
fi
pamr-surface repair "$out/scan.stl" -o "$out/repaired.ply" --close-holes 0.5 --json "$out/repair.json" --force
pamr-surface smooth "$out/repaired.ply" -o "$out/smooth.ply" --steps 3 --max-move 0.002 --force
pamr-surface decimate "$out/smooth.ply" -o "$out/body.ply" --error 0.001 --json "$out/decimate.json" --force
pamr-surface info "$out/body.ply"
cp "$case_folder/case.toml" "$out/case.toml"
pamr-mesh "$out/case.toml" -o "$out/level0.hdf" --force
for level in $(seq 1 "$levels"); do
  on_ranks pamr-mark "$out/level$((level - 1)).hdf" -o "$out/marked.hdf" --force --quiet --patch body
  on_ranks pamr-refine "$out/marked.hdf" -o "$out/level$level.hdf" --force
done
rm -f "$out/marked.hdf"
on_ranks pamr-convert "$out/level$levels.hdf" "$out/wall.vtp" --patch body --force
/usr/bin/python3 "$case_folder/check.py" "$out" "$levels"
