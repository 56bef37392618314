#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Compares pamr-dsmc with SPARTA, an independent code (https://github.com/sparta/sparta), on the same gas, bodies and streams:
# builds SPARTA from a checkout, serially and outside of it, runs both, prints tables with 95 % bounds. Exit code 1 if a difference is
# not as sparta.csv has it.
#
#   qualification/validation/sparta.sh [--quick] [--ranks N] [--seed N] [--out FOLDER] [--tools FOLDER] CHECKOUT [CASE...]
#
#   --quick         few particles and steps: shows in two minutes that all of it works; its numbers mean little
#   --ranks N       MPI processes of pamr-dsmc (default 2); SPARTA runs alone
#   --seed N        of the random numbers of both (default 1)
#   --out FOLDER    where SPARTA is built and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
#   CHECKOUT        folder of SPARTA's sources, with src/ in it; needs g++ and make
#   CASE            only these (default: the first three):
#                   box sphere cone
#                   cone-10 (at 10 degrees of incidence, half an hour), cone-cells (smaller cells in both),
#                   cone-sector (also a sixteenth of a turn in pamr-dsmc, its particles closer together)
#                   sphere-4 (four times the particles), sphere-cells (smaller cells too), sphere-finest (SPARTA's smaller still,
#                   four times the particles again), sphere-3d (SPARTA in three dimensions), sphere-any (SPARTA's partners from the
#                   whole cell), sphere-mach-8 (Mach 8, Kn 0.03)
set -euo pipefail

declare -A values=([--seed]=seed)
declare -A flags=([--quick]=quick)
seed=1 quick=no
arguments=()
check_options() {
  if [ ${#arguments[@]} -eq 0 ] || [ ! -e "${arguments[0]}/src/MAKE/Makefile.serial" ]; then
    echo "sparta.sh: expected a checkout of SPARTA, a folder with src/MAKE/Makefile.serial, found ${arguments[0]:-none}" >&2
    exit 2
  fi
}
. "$(dirname -- "${BASH_SOURCE[0]}")/../../cases/start.sh"

if [ ! -x "$out/sparta/src/spa_serial" ]; then
  mkdir -p "$out/sparta"
  cp -R "${arguments[0]}/src" "$out/sparta/"
  echo "building SPARTA: $out/sparta/build.log"
  make -C "$out/sparta/src" -j "$ranks" serial >"$out/sparta/build.log" 2>&1 ||
    { tail -n 20 "$out/sparta/build.log" >&2; exit 1; }
fi
python=/usr/bin/python3  # the one that sees Debian's numpy
[ -x "$python" ] || python=python3
exec "$python" -B "$case_folder/sparta_cases.py" "$out" "$out/sparta/src/spa_serial" "$ranks" "$seed" $quick "${arguments[@]:1}"
