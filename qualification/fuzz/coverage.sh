#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# How much of a reader damaged files reach, and what a search guided by coverage (AFL++) reaches beyond them and finds.
# Prints a line of a table a reader: edges of the control flow in what reads that are reached by its good files, by
# damaged files as qualification/fuzz/fuzz.sh makes them, and by those that AFL++ found, of how many; files that AFL++ read and
# paths that it found; files on which the reader died or found no end, and those of them on which it does so as the tools
# read them, by a child first. Installs afl++ and clang where they are missing.
#
#   qualification/fuzz/coverage.sh [--files N] [--minutes M] [FORMAT...]
#
#   --files N      damaged files (default 2000)
#   --minutes M    AFL++ searches so long for each reader (default 10)
#   FORMAT         native, gmsh, medit, mfem, su2, ugrid, vtu, legacy_vtk, foam, cgns (default native and gmsh, which parse most)
#
# Environment: PAMR_AFL_BUILD (default build/afl; found/FORMAT/default in it has what AFL++ found).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
build=${PAMR_AFL_BUILD:-$root/build/afl}
files=2000 minutes=10
while [ $# -gt 0 ]; do
  case $1 in
    --files) files=$2 && shift 2 ;;
    --minutes) minutes=$2 && shift 2 ;;
    -*) echo "coverage.sh: unknown option $1 (see its head)" >&2 && exit 2 ;;
    *) break ;;
  esac
done
formats=("$@")
if [ $# = 0 ]; then formats=(native gmsh); fi
if ! command -v afl-clang-fast++ >/dev/null; then
  apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends afl++ clang llvm
fi
. "$root/scripts/mpi_environment.sh"
export AFL_SKIP_CPUFREQ=1 AFL_NO_AFFINITY=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_NO_UI=1 AFL_QUIET=1
export AFL_MAP_SIZE=65536

# What reads is instrumented, and nothing else: the search then goes for the readers, and edges are theirs.
mkdir -p "$build"
{
  for folder in cgns foam gmsh medit mfem su2 ugrid vtk native; do echo "src: *lib/pamr/io/$folder/read_*"; done
  for name in gmsh/gmsh_parts medit/gmf ugrid/mapbc ugrid/ugrid_layout vtk/vtk_xml elements/ text \
    native/{catalog,hdf5.,inspect,layout,lineage_word,native_file,patch_surfaces,preflight,row_,slab_reader}; do
    echo "src: *lib/pamr/io/$name*"
  done
} >"$build/instrumented"
export AFL_LLVM_ALLOWLIST=$build/instrumented
{
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER=afl-clang-fast \
    -DCMAKE_CXX_COMPILER=afl-clang-fast++ -DPAMR_BATCHES=OFF -DPAMR_BENCH=OFF &&
    cmake --build "$build" --target "${formats[@]/#/fuzz_}"
} >"$build/log" 2>&1 || { tail -n 20 "$build/log" >&2 && exit 1; }

# Files of this size belong into memory.
if [ -w /dev/shm ]; then export TMPDIR=/dev/shm; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
commit=$(git -C "$root" rev-parse --short HEAD)

# "reached of existing" edges by all files of a folder.
edges() { # PROGRAM FOLDER EXTENSION
  (cd "$work" && env -u AFL_QUIET afl-showmap -C -m none -t 10000 -i "$2" -o "$build/map" -- "$1" --file @@ "$3") </dev/null 2>&1 |
    sed -n 's/.*coverage of \([0-9]*\) edges were achieved out of \([0-9]*\) existing.*/\1 of \2/p'
}

status=0
found=$build/found
mkdir -p "$found"
echo "| reader | good files | damaged files | and AFL++'s | AFL++ read | new paths | within HDF5 | deaths | minutes | commit | date |"
echo "|---|---|---|---|---|---|---|---|---|---|---|"
for format in "${formats[@]}"; do
  program=$(find "$build" -type f -name "fuzz_$format" -perm -u+x | head -n 1)
  mkdir "$work/good" "$work/damaged"
  "$program" --seeds "$work/good" >/dev/null
  "$program" --all "$files" "$work/damaged" >/dev/null
  extension=$(find "$work/good" -type f | head -n 1)
  extension=${extension##*.}
  rm -rf "${found:?}/$format"
  afl-fuzz -m none -t 10000 -V $((60 * minutes)) -i "$work/good" -o "$found/$format" -- \
    "$program" --file @@ "$extension" </dev/null >"$build/afl-fuzz-$format.log" 2>&1 ||
    { tail -n 20 "$build/afl-fuzz-$format.log" >&2 && exit 1; }
  value() { sed -n "s/^$1 *: *//p" "$found/$format/default/fuzzer_stats"; }
  deaths=0 # that remain when files are read as the tools read them, by a child first
  for file in "$found/$format"/default/{crashes,hangs}/id*; do
    if [ ! -e "$file" ]; then continue; fi
    cp "$file" "$work/file"
    if ! timeout 60 "$program" --file-as-tool "$work/file" "$extension" >/dev/null 2>&1; then
      echo "coverage.sh: $format must not end so on $file" >&2
      deaths=$((deaths + 1)) status=1
    fi
  done
  good=$(edges "$program" "$work/good" "$extension")
  cp "$work"/good/* "$work/damaged"
  damaged=$(edges "$program" "$work/damaged" "$extension")
  cp "$found/$format"/default/queue/id* "$work/damaged"
  all=$(edges "$program" "$work/damaged" "$extension")
  echo "| $format | $good | $damaged | $all | $(value execs_done) | $(value corpus_found) |" \
    "$(($(value saved_crashes) + $(value saved_hangs))) | $deaths | $minutes | $commit | $(date -u +%F) |"
  rm -rf "$work/good" "$work/damaged"
done
exit $status
