#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Supersonic argon past a sphere: the loop of flow, mark and refine with each of the four quality controls, and the same
# refinements once more on one recorded sequence of marks. Tables and pictures. Installs and builds what is missing first.
#
#   cases/supersonic-sphere/run.sh [--ranks N] [--levels N] [--full | --smoke] [--mach-8] [--resume] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels N      refinements, 1 to 4 (default 3; 2 with --smoke)
#   --full          four times the particles and ten passages of the free stream on every level
#   --smoke         few particles and steps: shows in a minute that the loop works; its flow means nothing
#   --mach-8        Mach 8 at a Knudsen number of 0.03 instead (default 2 levels; three make a million cells)
#   --resume        keeps what an interrupted run has finished
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A values=([--levels]=levels)
declare -A flags=([--full]=full [--smoke]=smoke [--mach-8]=mach_8 [--resume]=resume)
levels= full=no smoke=no mach_8=no resume=no
picture=yes  # h5py, which the recorded marks need too
check_options() {
  if [ $mach_8 = yes ]; then subfolder=mach-8; fi
  levels=${levels:-$([ $smoke = yes ] || [ $mach_8 = yes ] && echo 2 || echo 3)}
  if ! [[ $levels =~ ^[1-4]$ ]]; then
    echo "run.sh: --levels: expected 1 to 4, found $levels" >&2
    exit 2
  fi
}
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
python=/usr/bin/python3  # the one that sees Debian's h5py

# By level: molecules a particle where the time step is the longest, and averaged steps.
weight=(3.5e15 5e15 7e15 7e15 7e15) sampling=(1500 1500 1500 1500 1500) transient=
density=6.438e18 speed=1355.25
if [ $full = yes ]; then weight=(0.9e15 1.2e15 1.2e15 1.2e15 1.2e15) sampling=(3200 3200 4600 6400 6400); fi
if [ $smoke = yes ]; then weight=(2e16 4e16 8e16 8e16 8e16) sampling=(40 40 40 40 40) transient="transient = 40"; fi
if [ $mach_8 = yes ]; then
  density=2.2211e19 speed=2581.43
  for level in "${!weight[@]}"; do weight[level]=$(awk "BEGIN { print ${weight[level]} * 3 }"); done
fi
limit=$(awk "BEGIN { print 1.05 * $density }")
controls=(none isotropic short-edge removable)
[ $resume = yes ] || rm -rf "$out"/level0* "$out"/flow0* "$out"/own "$out"/recorded "$out"/*.csv "$out"/*.png
mkdir -p "$out/own" "$out/recorded"

# Runs a tool on all ranks unless its report is there.
on_ranks() { # REPORT TOOL ARGUMENT...
  local report=$1.json tool=$2
  shift 2
  if [ -e "$report" ]; then return; fi
  printf '%-12s ' "$tool"
  mpirun -n "$ranks" "$tool" "$@" --force --json "$report.part"
  mv "$report.part" "$report"
}

solve() { # LEVEL MESH FLOW [CHECKPOINT]
  local begin=() case_file=$out/case$1.toml
  if [ $# -gt 3 ]; then begin=(--carry "$4"); fi
  sed -e "s|\"\.\./species.toml\"|\"$root/cases/species.toml\"|" -e "s/^weight = [^ ]*/weight = ${weight[$1]}/" \
    -e "s/^density = [^ ]*/density = $density/" -e "s/^velocity = .*/velocity = [$speed, 0.0, 0.0]/" \
    -e "s/^sampling = .*/sampling = ${sampling[$1]}\n$transient/" "$case_folder/case.toml" >"$case_file"
  on_ranks "$3" pamr-dsmc "$case_file" --mesh "$2" -o "$3.hdf" "${begin[@]}" --checkpoint "$3.checkpoint" \
    --surface "$3-wall.vtu" --lines "$3-lines.csv" --history "$3-history.csv"
}

# Cells with an edge longer than the local mean free path, where the gas is denser than 1.05 times the free stream's beyond
# three standard errors.
refine() { # FIELDS QUALITY-CONTROL RESULT
  on_ranks "$3-mark" pamr-mark "$1" -o "$3-marked.hdf" --size-over lambda --size longest-edge --ratio 1 \
    --only-where "n:above:$limit" --error n_stderr:3 --quality-control "$2"
  on_ranks "$3-refine" pamr-refine "$3-marked.hdf" -o "$3.hdf" --quality-control "$2"
  on_ranks "$3-quality" pamr-quality "$3.hdf" --gate inverted_cells:max:0 --gate patches.sphere.off_surface_nodes:max:0
  rm -f "$3-marked.hdf"
}

# Level 0 has no closure cells, so most controls make the same level 1 and would compute the same flow again.
fingerprint() { sed -n 's/.*"fingerprint": *"\([0-9a-f]*\)".*/\1/p' "$1-quality.json"; }
copy_flow() { # FROM TO
  local file
  for file in "$out/own/$1"-flow*; do
    ln -f "$file" "$out/own/$2-flow${file#"$out/own/$1-flow"}"
  done
}

on_ranks "$out/level0" pamr-mesh "$case_folder/case.toml" -o "$out/level0.hdf"
if [ ! -e "$out/flow0.json" ]; then "$python" -B "$case_folder/record.py" number "$out/level0.hdf"; fi
on_ranks "$out/level0-quality" pamr-quality "$out/level0.hdf"
solve 0 "$out/level0.hdf" "$out/flow0"

echo "Each quality control with its own flow:"
for control in removable none isotropic short-edge; do
  flow=$out/flow0
  for ((level = 1; level <= levels; ++level)); do
    here=$out/own/$control$level
    refine "$flow.hdf" $control "$here"
    if [ $level = 1 ] && [[ $control = isotropic || $control = short-edge ]] &&
      [ "$(fingerprint "$here")" = "$(fingerprint "$out/own/none1")" ]; then copy_flow none1 ${control}1; fi
    solve "$level" "$here.hdf" "$here-flow" "$flow.checkpoint"
    flow=$here-flow
  done
done

echo "Each with the flows that removable was marked by:"
for control in "${controls[@]}"; do
  mesh=$out/level0.hdf flow=$out/flow0.hdf
  for ((level = 1; level <= levels; ++level)); do
    here=$out/recorded/$control$level
    if [ ! -e "$here-quality.json" ]; then
      "$python" -B "$case_folder/record.py" sample "$flow" "$mesh" "$here-fields.hdf"
      refine "$here-fields.hdf" "$control" "$here"
      rm "$here-fields.hdf"
    fi
    mesh=$here.hdf flow=$out/own/removable$level-flow.hdf
  done
done

echo
status=0
size=mach-4.2
if [ $mach_8 = yes ]; then size=mach-8; fi
if [ $full = yes ]; then size=$([ $mach_8 = yes ] && echo mach-8-full || echo full); fi
if [ $smoke = yes ]; then size=smoke; fi
"$python" -B "$case_folder/check.py" "$out" "$levels" "$size" || status=$?
view=(--patch sphere --patch symmetry_1 --camera -0.5,0.35,1 --up y --focus -0.6,0.45,0.1 --zoom 4)
last=()
for control in "${controls[@]}"; do last+=("$out/recorded/$control$levels.hdf"); done
draw meshes.png pamr-picture "${last[@]}" "${view[@]}" --label none --label isotropic --label short-edge --label removable
draw worst.png pamr-picture "${last[@]}" --cells 'mean_ratio<0.25' --patch sphere --camera -0.5,0.35,1 --up y --field mean_ratio --no-edges \
  --range 0,0.7 --map magma --label none --label isotropic --label short-edge --label removable
draw density.png pamr-picture "$out/own/removable$levels-flow.hdf" --patch symmetry_1 --camera z --up y --field n \
  --scale "$(awk "BEGIN { print 1 / $density }")" --title "n / n_inf" --log --range 0.2,10 --smooth 0 --isolines 1.05,1.5,2,3,4
exit $status
