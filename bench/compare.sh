#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets PAMR's refinement beside that of the codes that Debian packages: the same workloads (docs/reports/performance.md), one
# process each, on this machine in this run. Prints one Markdown table with ratios, and what the table needs to be read.
#
#   bench/compare.sh [options] [BUILD]     BUILD: folder with the benchmarks (default build/release)
#
#   --small          sizes for a quick look: W1 and W2 on K(20), two levels of W3
#   --levels N       levels of W3 (default 5)
#   --budget S       CPU seconds for each peer and workload, after which it gets no further run (default 30, at most 5
#                    runs); the first run always ends
#   --peers "A B"    some of: netgen dolfinx ug dmplex gmsh (default all)
#   --install        first install the peers' packages with apt
#
# Peers that are not installed are named in the table. Environment: PAMR_PEER_PYTHON (default /usr/bin/python3, Debian's
# own, which sees the packages), PAMR_PEER_CXX (default mpicxx).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
here=$root/bench/compare
. "$here/build_peers.sh"

declare -A workloads=([netgen]="W1 W2 W3" [dolfinx]="W1 W2 W3" [ug]="W2 W3" [dmplex]="W1" [gmsh]="W1")

n_uniform=55 n_shell=56 n_levels=14 levels=5 budget=30 repeats=5 peers="netgen dolfinx ug dmplex gmsh" install=no build=
arguments="$*"
while [ $# -gt 0 ]; do
  case $1 in
    --small) n_uniform=20 n_shell=20 levels=2 ;;
    --levels) levels=${2:?}; shift ;;
    --budget) budget=${2:?}; shift ;;
    --peers) peers=${2?}; shift ;;
    --install) install=yes ;;
    -h | --help) sed -n '3,17s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "compare.sh: unknown option $1 (see compare.sh --help)" >&2; exit 2 ;;
    *) build=$1 ;;
  esac
  shift
done
build=${build:-$root/build/release}
for peer in $peers; do
  [ -n "${packages[$peer]:-}" ] || { echo "compare.sh: expected peers among ${!packages[*]}, found $peer" >&2; exit 2; }
done
if ! [[ $levels =~ ^[1-5]$ ]]; then
  echo "compare.sh: expected 1 to 5 levels, found $levels" >&2
  exit 2
fi
bench=$build/bench/bench_refine quality=$build/bench/bench_quality_control
for program in "$bench" "$quality"; do
  [ -x "$program" ] || { echo "compare.sh: no $program: build with -DPAMR_BENCH=ON first" >&2; exit 2; }
done

results=$(mktemp -d)
trap 'rm -rf -- "$results"' EXIT

install_peers() {
  local wanted=() peer as_root=()
  for peer in $peers; do read -ra wanted <<<"${wanted[*]} ${packages[$peer]}"; done
  [ "$(id -u)" = 0 ] || as_root=(sudo)
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends "${wanted[@]}" >&2
}

size_of() {
  case $1 in
    W1) echo "$n_uniform 1" ;;
    W2) echo "$n_shell 1" ;;
    W3) echo "$n_levels $levels" ;;
  esac
}

# Lines of JSON to <peer>.json; why there are none, to <peer>.note.
run_peer() {
  local peer=$1 program=("$python" "$here/$1_peer.py") workload size
  if ! is_installed "$peer"; then
    echo "not installed (${packages[$peer]})" >"$results/$peer.note"
    return
  fi
  if [ -e "$here/${peer}_peer.cpp" ]; then
    program=("$results/${peer}_peer")
    if ! "build_$peer"; then
      echo "could not be built" >"$results/$peer.note"
      return
    fi
  fi
  for workload in ${workloads[$peer]}; do
    echo "compare.sh: $peer, $workload" >&2
    read -ra size <<<"$(size_of "$workload")"
    "${program[@]}" "$workload" "${size[@]}" "$repeats" "$budget" >>"$results/$peer.json" ||
      echo "$workload ended with code $?" >>"$results/$peer.note"
  done
}

run_ours() {
  local name level count=0
  for name in "W1/$n_uniform" "W2/n:$n_shell/policy:3" $(for level in $(seq "$levels"); do
    echo "W3/n:$n_levels/level:$level"
  done); do
    echo "compare.sh: PAMR, $name" >&2
    "$bench" "--benchmark_filter=^$name/" --benchmark_format=json 2>/dev/null >"$results/pamr.$count.json"
    count=$((count + 1))
  done
  "$quality" "kuhn:$n_levels" sphere:0.5,0.5,0.5,0.35 "$levels" >"$results/pamr.quality"
}

[ $install = no ] || install_peers
run_ours
for peer in $peers; do run_peer "$peer"; done

commit=$(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)
machine="$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc --all) cores"
load=$(cut -d' ' -f1 /proc/loadavg)
echo "$(date +%F), commit $commit, $machine, load $load. Command: \`bench/compare.sh${arguments:+ $arguments}\`."
echo
read -ra peer_list <<<"$peers"
python3 -B "$here/table.py" "$results" "${peer_list[@]}"
