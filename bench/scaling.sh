#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Scaling by counting: refines a mesh of the gas about the blunt cone (1,035,168 cells) once, to 2,566,317 cells (the
# paper's Table 2: 3 and 5 % more), with the whole tool, file to file, on 1 to 64 ranks that share the cores there are. Prints
# what each step computes, sends and holds on the ranks, the time that follows on a cluster, and the bars, with pass or
# FAIL. Docs: docs/reports/scaling.md.
#
#   bench/scaling.sh [BUILD] [--ranks "1 2 4"] [--repeats N] [--balance METHOD] [--own-marks]
#                          [--mesh MARKED | --small | --tiny] [--counts] [--out FOLDER]
#
#   BUILD       build folder (default build/release)
#   --ranks     numbers of processes (default "1 2 4 8 16 32 64"; the first is what the others are compared with)
#   --repeats   runs of each, of which the medians count (default 3)
#   --balance   auto, scotch, curve, blocks or none (default auto, as pamr-refine's)
#   --own-marks without the field refine_work, which pamr-mark writes and a solver that marks by itself does not
#   --mesh      a marked mesh of yours instead, and no bars: the marks of a flow, for example
#   --small     a cube of 82,944 cells instead, and --counts: for hundreds of ranks on few cores
#   --tiny      a small cube instead, and no bars: shows that all this works
#   --counts    only the bars of what is counted: where ranks share cores and have no real-time priority, or other programs
#               run, those of times are missed by chance
#   --out       where reports and tables go (default BUILD/bench/scaling-out); meshes stay there for the next time
#
# Exit code 1 when a bar is missed, 2 when a run fails.
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$folder/.." && pwd)
build=$root/build/release
ranks="1 2 4 8 16 32 64"
repeats=3
balance=auto
size=cone
own_marks=no
counts=no
given=
out=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?scaling.sh: --ranks needs numbers}; shift 2 ;;
    --repeats) repeats=${2:?scaling.sh: --repeats needs a number}; shift 2 ;;
    --balance) balance=${2:?scaling.sh: --balance needs a method}; shift 2 ;;
    --own-marks) own_marks=yes; shift ;;
    --mesh) given=${2:?scaling.sh: --mesh needs a marked mesh}; shift 2 ;;
    --small) size=small counts=yes; shift ;;
    --tiny) size=tiny; shift ;;
    --counts) counts=yes; shift ;;
    --out) out=${2:?scaling.sh: --out needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,24s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "scaling.sh: unknown option $1 (see scaling.sh --help)" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
out=${out:-$build/bench/scaling-out}
PATH=$build/bin:$PATH
. "$root/scripts/mpi_environment.sh"
mkdir -p "$out"
rm -f "$out"/run-*.json "$out"/base-*.json "$out"/own-*.txt
trap 'echo "scaling.sh: a run failed" >&2; exit 2' ERR

refine() { # RANKS REPORT MESH
  case $size,$2 in # where seconds count
    tiny,* | small,* | *,base-*) ;;
    *) python3 -B "$folder/compare/warm_memory.py" ;;
  esac
  mpirun -n "$1" pamr-refine "$3" -o "$out/refined.hdf" --force --quiet --balance "$balance" --each-rank \
    --json "$out/$2.json"
  rm -f "$out/refined.hdf"
}

# The same with our own memory counted, without that of the libraries written in C (own_memory.cpp).
count_own() { # RANKS MESH
  local library=$build/bench/libpamr_own_memory.so
  [ -s "$library" ] || return 0
  mpirun -n "$1" -x LD_PRELOAD="$library" -x PAMR_OWN_MEMORY="$out/own-$1.txt" pamr-refine "$2" -o "$out/refined.hdf" \
    --force --quiet --balance "$balance"
  rm -f "$out/refined.hdf"
}

# A mesh of next to nothing: what the processes hold before they hold any cells.
if [ ! -s "$out/nothing.hdf" ]; then
  pamr-mesh --shape kuhn-cube --n 6 -o "$out/cube.hdf" --force --quiet
  pamr-mark "$out/cube.hdf" -o "$out/nothing.hdf" --force --quiet --crossing-sphere 0,0,0,0.6
fi
mesh=$out/nothing.hdf
if [ $size = small ]; then
  mesh=$out/small.hdf
  if [ ! -s "$mesh" ]; then
    pamr-mesh --shape kuhn-cube --n 24 -o "$out/cube.hdf" --force --quiet
    pamr-mark "$out/cube.hdf" -o "$mesh" --force --quiet --crossing-sphere 0,0,0,0.6
  fi
fi
if [ -n "$given" ]; then mesh=$given size=given; fi
if [ $size = cone ]; then
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

if [ $own_marks = yes ]; then
  cp "$mesh" "$out/own-marks.hdf"
  mesh=$out/own-marks.hdf
  # needs h5py
  "${PAMR_PYTHON:-python3}" -c 'import h5py, sys; del h5py.File(sys.argv[1], "r+")["VTKHDF/CellData/refine_work"]' "$mesh"
fi

for p in $ranks; do
  refine "$p" "base-$p" "$out/nothing.hdf"
  count_own "$p" "$out/nothing.hdf"
  for ((run = 1; run <= repeats; ++run)); do refine "$p" "run-$p-$run" "$mesh"; done
done
trap - ERR

bars=()
if [ $counts = yes ]; then bars=(--counts); fi
if [ $size = tiny ] || [ $size = given ]; then bars=(--no-bars); fi
marks=
[ $own_marks = no ] || marks=" --own-marks"
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg)." \
  "Command: bench/scaling.sh --balance $balance --repeats $repeats$marks${given:+ --mesh $(basename -- "$given")} (medians)."
python3 "$folder/scaling/summarize.py" "$out" "${bars[@]}"
