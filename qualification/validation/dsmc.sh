#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Validates pamr-dsmc against closed forms: the cases that take longer than a test. The table goes to OUT/results.csv; its
# numbers are in docs/reports/dsmc-validation.md and the pages that it names. Shocks: cases/shock/run.sh --full.
#
#   qualification/validation/dsmc.sh [--ranks N] [--seeds N] [--out FOLDER] [--tools FOLDER] [CASE...]
#
#   --ranks N       MPI processes (default 2)
#   --seeds N       runs of every stochastic case (default 3)
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
#   CASE            only these: collision-rate relaxation equilibrium flux plate sphere newton fourier couette transition tube conductivity viscosity slow-couette steps trace subcell partners
set -euo pipefail

declare -A values=([--seeds]=seeds)
seeds=3
arguments=()
. "$(dirname -- "${BASH_SOURCE[0]}")/../../cases/start.sh"
python=/usr/bin/python3  # the one that sees Debian's h5py
[ -x "$python" ] || python=python3
exec "$python" -B "$case_folder/dsmc_cases.py" "$out" "$ranks" "$seeds" "${arguments[@]}"
