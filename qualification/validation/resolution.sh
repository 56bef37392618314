#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Coverage of pamr-dsmc --check-resolution: how often the bounds of C_D and C_H contain the values of a run with many more
# particles, for three bodies, three numbers of particles and ten seeds each; and with --check-cells, beside runs with finer
# cells at the wall too. The table is printed.
#
#   qualification/validation/resolution.sh [--ranks N] [--out FOLDER] [--tools FOLDER] [BODY...]
#
#   --ranks N       MPI processes (default 2)
#   --out FOLDER    where meshes and results go (default out/resolution beside this script); runs that are there are not repeated
#   --tools FOLDER  takes the tools from there and sets nothing up
#   BODY            only these: sphere thin plate sphere-cells plate-cells
set -euo pipefail

subfolder=resolution
arguments=()
. "$(dirname -- "${BASH_SOURCE[0]}")/../../cases/start.sh"
exec python3 -B "$case_folder/resolution.py" "$out" "$ranks" "${arguments[@]}"
