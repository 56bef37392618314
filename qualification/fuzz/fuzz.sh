#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Damaged files against every reader, under the address and undefined-behavior sanitizers, for a given time or number.
# Prints a line of a table a reader: files, failures, seconds, commit, date. Each seed that failed is printed with what
# went wrong; `fuzz_FORMAT --one SEED FILE` writes its file again.
#
#   qualification/fuzz/fuzz.sh [--files N] [--minutes M] [--first SEED] [FORMAT...]
#
#   --files N      at least so many of each (default 100000; 10000 of step, iges and brep, 1000 of surface_mesh)
#   --minutes M    at most so long for each (default: no limit)
#   --first SEED   the first seed (default 0); the files are the same for the same seeds
#   FORMAT         native, gmsh, case_dsmc, ... (default: all that the build has)
#
# Environment: PAMR_ASAN_BUILD (default build/asan).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
build=${PAMR_ASAN_BUILD:-$root/build/asan}
files='' minutes='' first=0
while [ $# -gt 0 ]; do
  case $1 in
    --files) files=$2 && shift 2 ;;
    --minutes) minutes=$2 && shift 2 ;;
    --first) first=$2 && shift 2 ;;
    -*) echo "fuzz.sh: unknown option $1 (see its head)" >&2 && exit 2 ;;
    *) break ;;
  esac
done
cd -- "$root"
cmake --preset asan -B "$build" -DPAMR_BENCH=OFF -DPAMR_BATCHES=ON >/dev/null
if [ $# = 0 ]; then
  formats=$(cmake --build "$build" --target help | sed -n 's/^\.* *fuzz_\([a-z_]*\):.*/\1/p; s/^\.\.\. fuzz_\([a-z_]*\)$/\1/p' | sort -u)
  read -r -d '' -a formats <<<"$formats" || true
else
  formats=("$@")
fi
. "$root/scripts/mpi_environment.sh"
cmake --build "$build" --target "${formats[@]/#/fuzz_}"
# Files of this size belong into memory.
if [ -w /dev/shm ]; then export TMPDIR=/dev/shm; fi
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1
commit=$(git rev-parse --short HEAD)
status=0 log=$(mktemp)
trap 'rm -f "$log"' EXIT
for format in "${formats[@]}"; do
  program=$(find "$build" -type f -name "fuzz_$format" -perm -u+x | head -n 1)
  case $format in
    step | iges | brep) number=10000 piece=500 ;;
    surface_mesh) number=1000 piece=100 ;;
    *) number=100000 piece=10000 ;;
  esac
  number=${files:-$number}
  begin=$SECONDS done=0 deaths=0
  : >"$log"
  while [ "$done" -lt "$number" ] && { [ -z "$minutes" ] || [ $((SECONDS - begin)) -lt $((60 * minutes)) ]; }; do
    if [ $piece -gt $((number - done)) ]; then piece=$((number - done)); fi
    "$program" $piece $((first + done)) >>"$log" || deaths=$((deaths + 1))
    done=$((done + piece))
  done
  # lines of progress end in \r
  tr '\r' '\n' <"$log" | sed -n "/seed [0-9]*: /p" | sort -u
  # 'N damaged files: ..., F failures', once for each piece, of surfaces once for each format, with its name in front
  tr '\r' '\n' <"$log" |
    sed -n 's/^\(.*: \)\{0,1\}\([0-9]*\) damaged files.* \([0-9]*\) failures.*/\1;\2;\3/p' |
    awk -F';' -v format="$format" -v seconds=$((SECONDS - begin)) -v commit="$commit" -v date="$(date -u +%F)" '
      { files[$1] += $2; failures[$1] += $3 }
      END { for (name in files) printf "| %s | %d | %d | %d | %s | %s |\n",
              format (name == "" ? "" : ", " substr(name, 1, length(name) - 2)), files[name], failures[name], seconds,
              commit, date }' | sort
  if [ $deaths -gt 0 ]; then
    echo "fuzz_$format: $deaths runs failed"
    status=1
  fi
done
exit $status
