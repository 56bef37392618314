#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Tubes, slits, vessels and ducts of pamr-dsmc beside what is known. The table is printed and written to
# OUT/ducts-and-vessels.md, which is the report in docs/reports.
#
#   qualification/validation/ducts.sh [--ranks N] [--out FOLDER] [--tools FOLDER] [CASE...]
#
#   --ranks N       MPI processes (default 2)
#   --out FOLDER    where meshes and results go (default out/ducts beside this script); runs that are there are not repeated
#   --tools FOLDER  takes the tools from there and sets nothing up
#   CASE            only these: tube slit vessel flow bars channel
set -euo pipefail

subfolder=ducts
arguments=()
. "$(dirname -- "${BASH_SOURCE[0]}")/../../cases/start.sh"
python=/usr/bin/python3  # the one that sees Debian's h5py
[ -x "$python" ] || python=python3
exec "$python" -B "$case_folder/ducts.py" "$out" "$ranks" "${arguments[@]}"
