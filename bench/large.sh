#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# One refinement as large as the machine allows, file to file: a mesh of the gas around the blunt cone is refined until it
# has an eighth of the cells that are wanted, then once more but for the fortieth of its cells that lies farthest from
# the nose, and the file is checked in slabs by a program of its own (large/check_in_slabs.py), which never holds the
# cells. Prints time, memory and bytes of the last refinement. Docs: docs/reports/performance-calls.md, "The largest run".
#
# With --cube the mesh is Kuhn's cube, and all its cells are split.
#
#   bench/large.sh [BUILD] [--cells N | --cube N] [--ranks P] [--mesh FILE] [--min-free MB] [--out FOLDER]
#
#   BUILD         build folder (default build/release)
#   --cells       cells of the result, about (default 150000000: takes 14 GB of disk twice and some 12 GB of memory)
#   --cube        cubes a side, for 48 cells each in the result (174: 253 million take 24 GB of disk and 19 GB of memory)
#   --ranks       processes (default 2)
#   --mesh        mesh to begin with (default: made by pamr-mesh)
#   --min-free  the last refinement is ended when the machine has less memory available (default 1500)
#   --out         where meshes and reports go (default BUILD/bench/large-out); the meshes are removed at the end
#
# Needs Python with h5py and numpy (PAMR_PYTHON, else python3). Exit code 1 when the check finds anything.
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$folder/.." && pwd)
build=$root/build/release
cells=150000000
cube=
ranks=2
mesh=
min_free=1500
out=
while [ $# -gt 0 ]; do
  case $1 in
    --cells) cells=${2:?large.sh: --cells needs a number}; shift 2 ;;
    --cube) cube=${2:?large.sh: --cube needs a number}; shift 2 ;;
    --ranks) ranks=${2:?large.sh: --ranks needs a number}; shift 2 ;;
    --mesh) mesh=${2:?large.sh: --mesh needs a file}; shift 2 ;;
    --min-free) min_free=${2:?large.sh: --min-free needs a number}; shift 2 ;;
    --out) out=${2:?large.sh: --out needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,21s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "large.sh: unknown option $1 (see large.sh --help)" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
if [ -n "$cube" ] && [ -n "$mesh" ]; then
  echo "large.sh: expected --cube or --mesh, found both" >&2
  exit 2
fi
out=${out:-$build/bench/large-out}
python=${PAMR_PYTHON:-python3}
PATH=$build/bin:$PATH
. "$root/scripts/mpi_environment.sh"
mkdir -p "$out"
trap 'rm -f "$out"/*.hdf' EXIT

count() { "$python" -c 'import h5py, sys; print(h5py.File(sys.argv[1])["VTKHDF/Types"].shape[0])' "$1"; }
# The point in the middle of the face of the box at the least x, and the distance from it that 39 of 40 cells keep.
reach() {
  "$python" - "$1" <<'PYTHON'
import sys
import h5py
import numpy as np
with h5py.File(sys.argv[1]) as file:
    x, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
center = 0.5 * (x.min(axis=0) + x.max(axis=0))
center[0] = x[:, 0].min()
r = np.quantile(np.linalg.norm(x[cells].mean(axis=1) - center, axis=1), 0.975)
print(",".join(f"{v:.9g}" for v in [*center, 0, r]))
PYTHON
}
refine_all() { # the mesh $now, in place
  pamr-mark "$now" -o "$out/marked.hdf" --force --quiet --all "$@"
  mpirun -n "$ranks" pamr-refine "$out/marked.hdf" -o "$now" --force --quiet --json "$out/step.json"
}

mark_part_of_cone() { # the mesh $now, refined until it has an eighth of the cells
  if [ -z "$mesh" ]; then
    pamr-mesh --shape blunt-cone -o "$now" --force --quiet
  else
    cp "$mesh" "$now"
  fi
  n=$(count "$now")
  times=0 # by 8, so that the last refinement gives what is wanted
  while [ $((n * 8 ** (times + 1) * 78 / 10)) -le "$cells" ]; do times=$((times + 1)); done
  partly=$((cells * 10 / 78 / 8 ** times))
  if [ "$partly" -gt "$((n * 11 / 10))" ]; then refine_all --max-cells "$partly"; fi
  shell=$(reach "$now")
  for ((i = 0; i < times; ++i)); do refine_all; done
  mpirun -n "$ranks" pamr-mark "$now" -o "$out/marked.hdf" --force --quiet --centroid-shell "$shell"
}

now=$out/mesh.hdf
if [ -n "$cube" ]; then
  size="--cube $cube"
  pamr-mesh --shape kuhn-cube --n "$cube" -o "$now" --force --quiet
  pamr-mark "$now" -o "$out/marked.hdf" --force --quiet --all
else
  size="--cells $cells"
  mark_part_of_cone
fi
rm "$now"

echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg)." \
  "Command: bench/large.sh $size --ranks $ranks"
mpirun -n "$ranks" pamr-refine "$out/marked.hdf" -o "$now" --force --json "$out/large.json" &
job=$!
while kill -0 $job 2>/dev/null; do
  if [ "$(awk '/MemAvailable/ {print int($2 / 1024)}' /proc/meminfo)" -lt "$min_free" ]; then
    kill $job
    echo "large.sh: less than $min_free MB of memory were left" >&2
  fi
  sleep 0.5
done
wait $job
"$python" "$folder/large/check_in_slabs.py" "$now" "$out/large.json"
