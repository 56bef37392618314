#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What particles, time step, cells, the choice of partners and the domain change in the flow about the blunt cone:
# many small runs on the meshes of `run.sh --full`, one after another, and tables of them with 95 % bounds. A run that
# has ended is not repeated, an interrupted one goes on from its last checkpoint. 25 CPU minutes.
#
#   studies/blunt-cone/studies.sh [--full-run FOLDER] [--ranks N] [--out FOLDER] [--tools FOLDER]
#                               [STUDY...]
#
#   --full-run FOLDER   results of `cases/blunt-cone/run.sh --full` (default cases/blunt-cone/out)
#   --ranks N           MPI processes (default 2)
#   --out FOLDER        where runs go (default out/ beside this script)
#   --tools FOLDER      takes the tools from there and sets nothing up
#   STUDY               only these: particles step cells seeds partner coarse levels domain (default: these), paper (partners
#                       from the whole cell with the paper's particles to level 3: two CPU hours; --full-run needs a level 3),
#                       or runs by the names in studies.py; tables: none, only the tables of what there is
set -euo pipefail

declare -A values=([--full-run]=full_run)
full_run=
arguments=()
. "$(dirname -- "${BASH_SOURCE[0]}")/../../cases/start.sh"
python=/usr/bin/python3  # the one that sees Debian's h5py
[ -x "$python" ] || python=python3
exec "$python" -B "$case_folder/studies.py" "${full_run:-$root/cases/blunt-cone/out}" "$out" "$ranks" "${arguments[@]}"
