#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Both commands of README.md in bare systems of several Debian releases, which debootstrap makes: one row of a table each, with the versions
# that were found there, seconds and tests. The tests compare the fingerprints of meshes with one list (tests/tools/fingerprints.csv).
#
#   qualification/matrix.sh [NAME...]    debian12, debian13 (default: both); as root; an hour each on two cores
#
# What is committed is tried. Exit code 1 if a command failed. In build/matrix (PAMR_MATRIX: another folder): table.md, and of each
# system NAME.log. Environment: PAMR_MIRROR (Debian's archive), PAMR_MATRIX_ROOTS (folder for the systems, kept and used again;
# default: temporary ones).
set -euo pipefail

declare -A suites=([debian12]=bookworm [debian13]=trixie)
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
case ${1:-} in -h | --help) sed -n '3,11s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;; esac
for name in "$@"; do
  [ -n "${suites[$name]:-}" ] || { echo "matrix.sh: expected names of systems (debian12, debian13), found $name" >&2; exit 2; }
done
. "$root/scripts/bare_debian.sh"
in_own_mounts "${BASH_SOURCE[0]}" "$@"
out=${PAMR_MATRIX:-$root/build/matrix}
mkdir -p "$out"

# The first two lines of the first block under "Start", without their comments.
mapfile -t commands < <(awk '/^## / { is_start = /Start/ } is_start && /^```/ { ++n } is_start && n == 1 && !/^```/ { sub(/ *#.*/, ""); print }' \
  "$root/README.md" | head -n 2)

seconds_of() { # command in the sources, its log; prints the seconds
  local begin=$SECONDS code=0
  inside sh -c "cd /pamr && $1" >>"$2" 2>&1 </dev/null || code=$?
  echo $((SECONDS - begin))
  return $code
}
version_of() { inside dpkg-query -W -f='${Version}\n' "$1" 2>/dev/null | sed 's/^[0-9]*://; s/[-+].*//' | head -n 1; }

# A row of the table; what fails is a row, too.
try() { # name
  local log=$out/$1.log first=failed tests=failed summary
  : >"$log"
  inside sh -c 'apt-get -q update && apt-get -q install -y --no-install-recommends git ca-certificates' >>"$log" 2>&1
  rm -rf --one-file-system "$bare/pamr"
  inside git init -q /pamr # a repository, as a clone would be
  git -c safe.directory='*' -C "$root" archive HEAD | tar -x -C "$bare/pamr"
  first=$(seconds_of "${commands[0]}" "$log") || { first="$first, failed" && failed=yes; }
  tests=$(seconds_of "${commands[1]}" "$log") || { tests="$tests, failed" && failed=yes; }
  summary=$(sed -n 's/^.*% tests passed, \([0-9]*\) tests failed out of \([0-9]*\).*/\1 of \2/p' "$log" | tail -n 1)
  echo "| $1 | $(inside gcc -dumpfullversion) | $(version_of cmake) | $(version_of openmpi-bin) | $(version_of libhdf5-openmpi-dev) |" \
    "$(version_of libcgal-dev) | $(version_of libptscotch-dev) | $(version_of petsc-dev) | $(version_of libocct-foundation-dev) |" \
    "$(version_of python3-numpy) | $first | $tests | ${summary:-none ran} |" >>"$out/table.md"
}

failed=no
echo "| system | GCC | CMake | Open MPI | HDF5 | CGAL | Scotch | PETSc | OpenCASCADE | NumPy | ${commands[0]}, s | ${commands[1]}, s | tests failed |
|---|---|---|---|---|---|---|---|---|---|---|---|---|" >"$out/table.md"
[ $# -gt 0 ] || set -- debian12 debian13
for name in "$@"; do
  if [ -n "${PAMR_MATRIX_ROOTS:-}" ]; then
    bare=$PAMR_MATRIX_ROOTS/$name
    mkdir -p "$bare"
    trap leave_bare EXIT
  else
    bare=$(mktemp -d -t "pamr-$name.XXXXXX")
    trap 'leave_bare; rm -rf --one-file-system "$bare"' EXIT
  fi
  enter_bare "${suites[$name]}" "$bare" "$out/$name.debootstrap.log"
  try "$name"
  leave_bare
  if [ -z "${PAMR_MATRIX_ROOTS:-}" ]; then rm -rf --one-file-system "$bare"; fi
done
cat "$out/table.md"
[ $failed = no ]
