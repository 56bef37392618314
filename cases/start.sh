#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced at the start of a case's script: reads its options, sets PAMR up unless --tools says where its tools are, and leaves
#
#   case_folder   folder of the script             ranks      number of MPI processes (--ranks)
#   out           folder for results, made         on_ranks   runs a tool on that many
#
# Besides --ranks, --out and --tools a script has those options that it has declared before, with its defaults set:
#
#   declare -A values=([--levels]=levels)   options with a value, and the variables that take it
#   declare -A flags=([--full]=full)        options without: the variable becomes yes
#   arguments=()                            takes what is not an option
#   check_options() { ... }                 called when they are read; may set `subfolder` of out/
#
#   uses="pamr-mesh pamr-refine"            the tools that it starts; else all are built
#
#   draw NAME TOOL...   a picture of that name in the folder for results, by a tool or script that has -o; says where it is.
#                       Nothing where the packages for pictures are missing
#
# With a flag `picture` these packages are installed, with `python=yes` the Python package is built too. --help prints the
# comment at the head of the script.
script=${BASH_SOURCE[1]}
name=$(basename -- "$script")
case_folder=$(cd -- "$(dirname -- "$script")" && pwd)
root=$case_folder
until [ -e "$root/scripts/setup.sh" ]; do root=$(dirname -- "$root"); done
declare -p values &>/dev/null || declare -A values
declare -p flags &>/dev/null || declare -A flags
values+=([--ranks]=ranks [--out]=out [--tools]=tools)
ranks=${ranks:-2}
out=
tools=
while [ $# -gt 0 ]; do
  if [ -n "${values[$1]:-}" ]; then
    if [ $# -lt 2 ]; then
      echo "$name: $1 needs a value" >&2
      exit 2
    fi
    printf -v "${values[$1]}" %s "$2"
    shift
  elif [ -n "${flags[$1]:-}" ]; then
    printf -v "${flags[$1]}" yes
  elif [ "$1" = -h ] || [ "$1" = --help ]; then
    sed -n -e '3,$!d' -e '/^#/!q' -e 's/^# \{0,1\}//p' "$script"
    exit 0
  elif declare -p arguments &>/dev/null && [[ $1 != -* ]]; then
    arguments+=("$1")
  else
    echo "$name: unknown option $1 (see $name --help)" >&2
    exit 2
  fi
  shift
done
if declare -F check_options >/dev/null; then check_options; fi
out=${out:-$case_folder/out${subfolder:+/$subfolder}}
if [ -z "$tools" ]; then
  setup=()
  if [ -n "${uses:-}" ]; then setup+=(--only "$uses"); fi
  if [ "${picture:-no}" = yes ]; then setup+=(--picture); fi
  if [ "${python:-no}" = yes ]; then setup+=(--python); fi
  "$root/scripts/setup.sh" "${setup[@]}"
  tools=${PAMR_BUILD:-$root/build/release}/bin
fi
tools=$(cd -- "$tools" && pwd) # some scripts work in other folders
. "$root/scripts/mpi_environment.sh"
export OMPI_MCA_orte_execute_quiet=1 # the tools say themselves what went wrong
PATH=$tools:$PATH
mkdir -p "$out"
on_ranks() {
  local code=0
  mpirun -n "$ranks" "$@" || code=$?
  [ $code = 0 ] || echo "$1 ended with exit code $code" >&2 # mpirun does not say so here of a tool that a signal ends
  return $code
}
can_draw() {
  command -v Xvfb >/dev/null && command -v pamr-picture >/dev/null && /usr/bin/python3 - 2>/dev/null <<'PYTHON'
import importlib.util
import sys

sys.exit(any(importlib.util.find_spec(name) is None for name in ("vtk", "matplotlib", "h5py")))
PYTHON
}
# A picture that fails says why, and the case goes on: its numbers are there.
draw() { # NAME TOOL ARGUMENT...
  local picture=$out/$1
  shift
  if can_draw; then
    rm -f "$picture"
    if "$@" -o "$picture" >/dev/null; then echo "picture: $picture"; fi
  fi
}
