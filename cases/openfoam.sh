#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced after start.sh by a case with solvers of OpenFOAM: openfoam.sh SOLVER... ends the script with one line where one of them is
# missing, and leaves
#
#   foam PROGRAM CASE LOG OPTIONS...   runs it on the ranks of the case; where it fails the end of its log is shown, and the script ends
#   step ARGUMENTS...                  step.py of the case on as many
. "$root/cases/python.sh" mpi4py python3-mpi4py
for program in checkMesh "$@"; do
  if ! command -v "$program" >/dev/null; then
    echo "$name: this case needs OpenFOAM's $program (Debian: apt install openfoam)" >&2
    exit 2
  fi
done
if [ -z "${WM_PROJECT_DIR:-}" ] && [ -d /usr/share/openfoam/etc ]; then export WM_PROJECT_DIR=/usr/share/openfoam; fi

foam() {
  local program=$1 case=$2 log=$3
  shift 3
  if [ "$ranks" = 1 ]; then
    "$program" -case "$case" "$@" >"$log" 2>&1
  else
    on_ranks "$program" -parallel -case "$case" "$@" >"$log" 2>&1
  fi || { echo "$name: $program failed in $case; the end of $log:" >&2; tail -n 20 "$log" >&2; exit 1; }
}
step() { on_ranks /usr/bin/python3 -B -m mpi4py "$case_folder/step.py" "$@"; }
