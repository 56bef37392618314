#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scaling by counting: refines a mesh of the gas about the blunt cone (1,070,179 cells) once, to about 2.7 million cells
# as the paper's Table 2, with the whole tool, file to file, on 1 to 64 ranks that share the cores there are. Prints
# what each step computes, sends and holds on the ranks, the time that follows on a cluster, and the bars, with pass or
# FAIL. Docs: docs/performance.md, "Scaling".
#
#   tests/bench/scaling.sh [BUILD] [--ranks "1 2 4"] [--repeats N] [--balance METHOD] [--mesh MARKED | --tiny]
#                          [--out FOLDER]
#
#   BUILD       build folder (default build/release)
#   --ranks     numbers of processes (default "1 2 4 8 16 32 64"; the first is what the others are compared with)
#   --repeats   runs of each, of which the medians count (default 3)
#   --balance   auto, scotch, blocks or none (default auto, as pamr-refine's)
#   --mesh      a marked mesh of yours instead, and no bars: the marks of a flow, for example
#   --tiny      a small cube instead, and no bars: shows that all this works
#   --out       where reports and tables go (default BUILD/tests/bench/scaling-out); meshes stay there for the next time
#
# Exit code 1 when a bar is missed, 2 when a run fails.
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$folder/../.." && pwd)
build=$root/build/release
ranks="1 2 4 8 16 32 64"
repeats=3
balance=auto
tiny=no
given=
out=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?scaling.sh: --ranks needs numbers}; shift 2 ;;
    --repeats) repeats=${2:?scaling.sh: --repeats needs a number}; shift 2 ;;
    --balance) balance=${2:?scaling.sh: --balance needs a method}; shift 2 ;;
    --mesh) given=${2:?scaling.sh: --mesh needs a marked mesh}; shift 2 ;;
    --tiny) tiny=yes; shift ;;
    --out) out=${2:?scaling.sh: --out needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,20s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "scaling.sh: unknown option $1 (see scaling.sh --help)" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
out=${out:-$build/tests/bench/scaling-out}
PATH=$build/bin:$PATH
. "$root/scripts/mpi_environment.sh"
. "$folder/warm_memory.sh"
mkdir -p "$out"
rm -f "$out"/run-*.json "$out"/base-*.json
trap 'echo "scaling.sh: a run failed" >&2; exit 2' ERR

refine() { # RANKS REPORT MESH
  warm_memory
  mpirun -q -n "$1" pamr-refine "$3" -o "$out/refined.hdf" --force --quiet --balance "$balance" --each-rank \
    --json "$out/$2.json"
  rm -f "$out/refined.hdf"
}

# A mesh of next to nothing: what the processes hold before they hold any cells.
if [ ! -s "$out/nothing.hdf" ]; then
  pamr-mesh --shape kuhn-cube --n 6 -o "$out/cube.hdf" --force --quiet
  pamr-mark "$out/cube.hdf" -o "$out/nothing.hdf" --force --quiet --crossing-sphere 0,0,0,0.6
fi
mesh=${given:-$out/nothing.hdf}
if [ $tiny = no ] && [ -z "$given" ]; then
  # Marked where the paper's gas wants it: the fore-body, the nose, the shell where the bow shock stands. The last two
  # refinements split closure cells of the one before, as those of the paper's levels 2 to 4.
  mesh=$out/cone.hdf
  nose="--centroid-shell 0.002,0,0,0,0.010"
  shock="--centroid-shell 0.066,0,0,0.070"
  if [ ! -s "$mesh" ]; then
    pamr-mesh --shape blunt-cone -o "$out/level0.hdf" --force --quiet
    # shellcheck disable=SC2086  # several words
    {
      pamr-mark "$out/level0.hdf" -o "$out/marked.hdf" --force --quiet --patch forebody $nose $shock,0.0100
      pamr-refine "$out/marked.hdf" -o "$out/level1.hdf" --force --quiet
      pamr-mark "$out/level1.hdf" -o "$out/marked.hdf" --force --quiet --patch forebody $nose $shock,0.0096
      pamr-refine "$out/marked.hdf" -o "$out/level2.hdf" --force --quiet
      pamr-mark "$out/level2.hdf" -o "$out/unready.hdf" --force --quiet $nose $shock,0.0053
    }
    mv "$out/unready.hdf" "$mesh"
    rm -f "$out"/level?.hdf "$out/marked.hdf"
  fi
fi

for p in $ranks; do
  refine "$p" "base-$p" "$out/nothing.hdf"
  for ((run = 1; run <= repeats; ++run)); do refine "$p" "run-$p-$run" "$mesh"; done
done
trap - ERR

bars=()
if [ $tiny = yes ] || [ -n "$given" ]; then bars=(--no-bars); fi
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg)." \
  "Command: tests/bench/scaling.sh --balance $balance --repeats $repeats${given:+ --mesh $(basename -- "$given")} (medians)."
python3 "$folder/scaling/summarize.py" "$out" "${bars[@]}"
