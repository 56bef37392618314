#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Damaged files against every reader, under the address and undefined-behavior sanitizers, for a given time or number.
# Prints a line a reader: files, accepted, refused, failed. Each seed that failed is printed with what went wrong;
# `fuzz_FORMAT --one SEED FILE` writes its file again.
#
#   tests/campaign/fuzz.sh [--files N] [--minutes M] [--first SEED] [FORMAT...]
#
#   --files N      at least so many of each (default 100000)
#   --minutes M    at most so long for each (default: no limit)
#   --first SEED   the first seed (default 0); the files are the same for the same seeds
#
# Environment: PAMR_ASAN_BUILD (default build/asan).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
build=${PAMR_ASAN_BUILD:-$root/build/asan}
files=100000 minutes= first=0
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
status=0 piece=2000
for format in "${formats[@]}"; do
  program=$(find "$build" -type f -name "fuzz_$format" -perm -u+x | head -n 1)
  begin=$SECONDS done=0 bad=0
  while [ $done -lt "$files" ] && { [ -z "$minutes" ] || [ $((SECONDS - begin)) -lt $((60 * minutes)) ]; }; do
    ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 "$program" $piece $((first + done)) || bad=$((bad + 1))
    done=$((done + piece))
  done
  printf '== fuzz_%s: %d files from seed %d, %d of %d pieces with failures, %d s\n' "$format" $done "$first" $bad \
    $((done / piece)) $((SECONDS - begin))
  if [ $bad -gt 0 ]; then status=1; fi
done
exit $status
