#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Vibration in pamr-dsmc: relaxation and equilibrium beside what is known, and what it changes about the blunt cone on its
# level 1. The table is printed; docs/reports/dsmc-vibration.md has it.
#
#   qualification/validation/vibration.sh [--ranks N] [--out FOLDER] [--tools FOLDER] [CASE...]
#
#   --ranks N       MPI processes (default 2)
#   --out FOLDER    where meshes and results go (default out/vibration beside this script); runs that are there are not repeated
#   --tools FOLDER  takes the tools from there and sets nothing up
#   CASE            only these: relaxation equilibrium tunnel hot
set -euo pipefail

subfolder=vibration
arguments=()
. "$(dirname -- "${BASH_SOURCE[0]}")/../../cases/start.sh"
python=/usr/bin/python3  # the one that sees Debian's h5py
[ -x "$python" ] || python=python3
exec "$python" -B "$case_folder/vibration.py" "$out" "$ranks" "${arguments[@]}"
