#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced at the start of a case's run.sh: reads the options that such scripts have in common, sets PAMR up unless told
# where its tools are, and leaves
#
#   case_folder   folder of the script             ranks      number of MPI processes
#   out           folder for results, made         full       yes after --full
#   on_ranks      runs a tool on that many
#
# --help prints the comment at the head of the script.
script=${BASH_SOURCE[1]}
case_folder=$(cd -- "$(dirname -- "$script")" && pwd)
root=$(cd -- "$case_folder/../.." && pwd)
out=$case_folder/out
ranks=2
full=no
tools=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?run.sh: --ranks needs a number}; shift 2 ;;
    --full) full=yes; shift ;;
    --out) out=${2:?run.sh: --out needs a folder}; shift 2 ;;
    --tools) tools=${2:?run.sh: --tools needs a folder}; shift 2 ;;
    -h | --help) sed -n -e '3,$!d' -e '/^#/!q' -e 's/^# \{0,1\}//p' "$script"; exit 0 ;;
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
