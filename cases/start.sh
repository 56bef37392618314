#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced at the start of a case's script: reads the options that such scripts have in common, sets PAMR up unless told
# where its tools are, and leaves
#
#   case_folder   folder of the script             ranks      number of MPI processes
#   out           folder for results, made         on_ranks   runs a tool on that many
#   full          yes after --full, where the script has set it to no before
#   levels        of --levels, where the script has set its default before
#
# A script may set `subfolder` of out/ before. --help prints the comment at the head of the script.
script=${BASH_SOURCE[1]}
name=$(basename -- "$script")
case_folder=$(cd -- "$(dirname -- "$script")" && pwd)
root=$(cd -- "$case_folder/../.." && pwd)
out=$case_folder/out${subfolder:+/$subfolder}
ranks=2
tools=
while [ $# -gt 0 ]; do
  option=$1
  # not an option of scripts that have set no such variable
  if [ "$1" = --full ] && [ -z "${full:-}" ]; then option=none; fi
  if [ "$1" = --levels ] && [ -z "${levels:-}" ]; then option=none; fi
  case $option in
    --ranks) ranks=${2:?$name: --ranks needs a number}; shift 2 ;;
    --full) full=yes; shift ;;
    --levels) levels=${2:?$name: --levels needs a number}; shift 2 ;;
    --out) out=${2:?$name: --out needs a folder}; shift 2 ;;
    --tools) tools=${2:?$name: --tools needs a folder}; shift 2 ;;
    -h | --help) sed -n -e '3,$!d' -e '/^#/!q' -e 's/^# \{0,1\}//p' "$script"; exit 0 ;;
    *) echo "$name: unknown option $1 (see $name --help)" >&2; exit 2 ;;
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
