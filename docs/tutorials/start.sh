#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the tutorials: leaves `here` (the tutorial's folder), `out` (the folder for results: the script's first argument,
# or one of the tutorial's name where it is started), the tools in PATH, and MPI that runs as root and on few cores.
#
#   step COMMAND...          shows a command and runs it
#   picture NAME OPTION...   a picture by pamr-picture, if its packages are installed
here=$(cd -- "$(dirname -- "${BASH_SOURCE[1]}")" && pwd)
out=${1:-$(basename -- "$here")}
mkdir -p "$out"
out=$(cd -- "$out" && pwd)
project=$here/../../..
if ! command -v pamr-refine >/dev/null && [ -x "$project/build/release/bin/pamr-refine" ]; then
  PATH=$project/build/release/bin:$PATH
  PYTHONPATH=$project/build/release/python${PYTHONPATH:+:$PYTHONPATH}
  export PYTHONPATH
fi
for settings in "$project/scripts/mpi_environment.sh" "$here/../../mpi_environment.sh"; do
  if [ -e "$settings" ]; then . "$settings"; fi
done
cd -- "$out"

step() {
  printf '\n$ %s\n' "$*"
  "$@"
}

picture() { # NAME OPTION...
  local name=$1
  shift
  if command -v Xvfb >/dev/null && /usr/bin/python3 -c 'import vtk, matplotlib, h5py' 2>/dev/null; then
    step pamr-picture "$@" -o "$name" --force
  else
    echo "no picture $name: python3-vtk9 python3-matplotlib python3-h5py xvfb are not installed"
  fi
}
