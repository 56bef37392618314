#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A scanned body from the STL file to the refined mesh: makes the scan, meshes the space around it, refines at the wall.
#
#   cases/scanned-body/run.sh [--ranks N] [--levels N] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels N      refinements at the wall (default 3)
#   --out FOLDER    where the scan and the meshes go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A values=([--levels]=levels)
levels=3
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

/usr/bin/python3 "$case_folder/make_body.py" "$out/scan.stl" --levels 4
cp "$case_folder/case.toml" "$out/case.toml"
pamr-mesh "$out/case.toml" -o "$out/level0.hdf" --force
for level in $(seq 1 "$levels"); do
  on_ranks pamr-mark "$out/level$((level - 1)).hdf" -o "$out/marked.hdf" --force --quiet \
    --patch body_1 --patch body_2 --patch body_3
  on_ranks pamr-refine "$out/marked.hdf" -o "$out/level$level.hdf" --force
done
rm -f "$out/marked.hdf"
status=0
/usr/bin/python3 "$case_folder/check.py" "$out" "$levels" || status=$?
draw levels.png pamr-picture "$out/scan.stl" "$out/level0.hdf" "$out/level1.hdf" --label Scan --label "Level 0" \
  --label "Level 1" --patch body_1 --patch body_2 --patch body_3 --camera -4,-1.6,2.6 --camera 4,-2.5,3.2 --size 1500x1050
exit $status
