#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A solver of one's own in Python, in memory: run.sh [FOLDER]
set -euo pipefail
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

rm -f solution.hdf
step /usr/bin/python3 -B "$here/solver.py" "$out"
step pamr-quality solution.hdf --gate inverted_cells:max:0
picture solution.png solution.hdf --cut z=0.1 --whole-cells --camera 0.3,-0.4,1 --size 900x800
