#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Faces between ranks, neighbors, imbalance and seconds of every way of balancing, on the gas about the blunt cone, a
# cube with random numbers, a body meshed by Gmsh and the cube of W2. Docs: docs/reports/balance.md.
#
#   bench/balance.sh [BUILD] [--ranks "4 8 16"] [--constant | --assess] [--out FOLDER]
#
#   BUILD       build folder (default build/release)
#   --ranks     numbers of processes (default "4 8 16 32 64"); they share the cores there are
#   --constant  instead: what Scotch's 2 to 64 parts of five meshes have of the faces that compact parts are said to
#               have (`faces_between_compact_parts`, whose constant is their mean), on one process
#   --assess     the same for three meshes that the constant was not found from
#   --out       where meshes go (default BUILD/bench/balance-out); they stay there for the next time
#
# Exit code 1 where Scotch's parts of such a mesh have more faces than the rule allows.
#
# Needs Python with h5py and numpy (PAMR_PYTHON, else python3) and, for the bodies meshed by it, Gmsh's Python module;
# without that these are left out.
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$folder/.." && pwd)
build=$root/build/release
ranks="4 8 16 32 64"
mode=ranks
out=
while [ $# -gt 0 ]; do
  case $1 in
    --ranks) ranks=${2:?balance.sh: --ranks needs numbers}; shift 2 ;;
    --constant) mode=constant; shift ;;
    --assess) mode=assess; shift ;;
    --out) out=${2:?balance.sh: --out needs a folder}; shift 2 ;;
    -h | --help) sed -n '3,20s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "balance.sh: unknown option $1 (see balance.sh --help)" >&2; exit 2 ;;
    *) build=$1; shift ;;
  esac
done
out=${out:-$build/bench/balance-out}
python=${PAMR_PYTHON:-python3}
bench=$build/bench/bench_balance
PATH=$build/bin:$PATH
. "$root/scripts/mpi_environment.sh"
mkdir -p "$out"

# Make one mesh, unless it is there already; nothing if it cannot be made.
make_mesh() { # NAME
  local mesh=$out/$1.hdf
  [ -s "$mesh" ] && return
  case $1 in
    cone)
      pamr-mesh --shape blunt-cone -o "$out/level0.hdf" --force --quiet
      pamr-mark "$out/level0.hdf" -o "$mesh" --force --quiet --patch forebody --centroid-shell 0.002,0,0,0,0.010 \
        --centroid-shell 0.066,0,0,0.070,0.0100
      ;;
    random)
      pamr-mesh --shape kuhn-cube --n 17 -o "$out/level0.hdf" --force --quiet
      pamr-mark "$out/level0.hdf" -o "$out/marked.hdf" --force --quiet --crossing-sphere 0,0,0,0.6
      "$python" "$folder/balance/make_meshes.py" shuffle "$out/marked.hdf" "$mesh"
      ;;
    cube) pamr-mesh --shape kuhn-cube --n 20 -o "$mesh" --force --quiet ;;
    supersonic)
      pamr-mesh --shape supersonic-sphere --size 0.003 -o "$out/level0.hdf" --force --quiet
      pamr-mark "$out/level0.hdf" -o "$out/marked.hdf" --force --quiet --all
      pamr-refine "$out/marked.hdf" -o "$out/level1.hdf" --force --quiet
      pamr-mark "$out/level1.hdf" -o "$mesh" --force --quiet --centroid-shell 0,0,0,0,0.02
      ;;
    sphere) pamr-mesh --shape sphere-in-box --size 0.16 -o "$mesh" --force --quiet ;;
    *)
      "$python" -c 'import gmsh' 2>/dev/null || return 0
      "$python" "$folder/balance/make_meshes.py" "$1" "$out/$1.msh"
      pamr-convert "$out/$1.msh" "$mesh" --force --quiet
      ;;
  esac
}

case $mode in
  ranks) meshes="cone random holes 44" ;;
  constant) meshes="cube torus cone sphere 24" ;;
  assess) meshes="holes plate supersonic" ;;
esac
rows=$out/$mode.md
: >"$rows"
echo "$(date +%F), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
  "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores, load $(cut -d' ' -f1 /proc/loadavg)."
for name in $meshes; do
  mesh=$name
  case $name in
    *[!0-9]*)
      make_mesh "$name"
      mesh=$out/$name.hdf
      if [ ! -s "$mesh" ]; then
        echo "balance.sh: $name is left out: $python has no gmsh" >&2
        continue
      fi
      ;;
  esac
  if [ $mode = ranks ]; then
    for p in $ranks; do mpirun -n "$p" "$bench" "$mesh" >>"$rows"; done
  else
    "$bench" "$mesh" 2 3 4 5 6 7 8 12 16 24 32 48 64 >>"$rows"
  fi
done
awk '/^\| mesh/ || /^\|---/ { if (n++ > 1) next } 1' "$rows"
if [ $mode != ranks ]; then
  echo
  "$python" "$folder/balance/compare_with_compact.py" <"$rows"
fi
