#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The loop of mesh, flow, mark and refine about the 70-degree blunt cone at Mach 20 and 10 degrees: solves on level 0,
# marks the cells larger than the local mean free path, refines them, carries the flow to the new mesh, solves again.
# Prints one table of the levels. Installs and builds what is missing first.
#
#   cases/blunt-cone/run.sh [--ranks N] [--levels N] [--full | --last | --smoke | --heat-flux] [--resume] [--picture]
#                           [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --levels N      refinements, at most 4 (default 1; with --full and --last 2; the third makes 1.1 million cells, the fourth
#                   up to 2.8 million: hours)
#   --full          the particles and steps of docs/reports/blunt-cone.md
#   --last          the last level as with --full; those before have only what their marks need, and are not checked
#   --smoke         few particles and steps: shows in seconds that the loop works; its flow means nothing
#   --heat-flux     Set 1 of the wind tunnel at no incidence instead, and its heat flux at the thermocouples
#   --resume        keeps what an interrupted run has finished, and continues from its last checkpoint
#   --picture       installs what pictures need; where it is there, pictures are made and named in any case
#   --out FOLDER    where meshes and reports go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A values=([--levels]=levels)
declare -A flags=([--full]=full [--last]=last [--smoke]=smoke [--heat-flux]=heat_flux [--resume]=resume [--picture]=picture)
uses="pamr-mesh pamr-mark pamr-refine pamr-quality pamr-dsmc"
levels= full=no last=no smoke=no heat_flux=no resume=no picture=no
check_options() {
  size=small
  if [ $full = yes ]; then size=full; fi
  if [ $last = yes ]; then size=last; fi
  if [ $smoke = yes ]; then size=smoke; fi
  if [ $heat_flux = yes ]; then size=heat-flux; fi
  case $size in
    full | last) levels=${levels:-2} ;;
    *) levels=${levels:-1} ;;
  esac
  local most=4
  if [ $size = heat-flux ]; then most=1; fi
  if ! [[ $levels =~ ^[0-9]$ ]] || [ "$levels" -gt $most ]; then
    echo "run.sh: --levels: expected 0 to $most, found $levels" >&2
    exit 2
  fi
}
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

# By level: molecules a particle where the time step is the longest, averaged steps (of --full ten passages of the free
# stream), and at most so many cells.
cells=(0 60000 165000 1200000 2800000)
mesh=() time=() transient= # what differs from the case
case_file=$case_folder/case.toml
limit=1.1718e21  # 1.05 times the free stream's density
case $size in
  heat-flux)
    weight=(3.5e11 3.5e11) sampling=(800 10800) cells=(0 100000)
    case_file=$case_folder/heat-flux.toml
    limit=3.9008e20
    ;;
  full | last) weight=(4.0e11 8.2e11 6.2e11 4.0e11 2.4e11) sampling=(3300 1650 2150 4400 4200) ;;
  small) # a narrower and shorter domain, small cells at all of the fore-body and larger ones elsewhere, longer steps, partners from
    # sub-cells: enough particles a cell in all, and averages of ten passages, with 700,000 particles
    weight=(1.4e12 1.75e12 1.75e12 1.75e12 1.75e12) sampling=(300 500 1000 2000 2000) cells=(0 45000 165000 1200000 2800000)
    mesh=(-e "s/^\[mesh.sizes\]/[mesh.geometry]\nouter_radius = 45e-3\noutflow = 30e-3\n\n&/" -e "s/^far = .*/far = 15e-3/"
      -e "s/^forebody = .*e-3$/forebody = 0.8e-3/" -e "s/^shoulder = .*/shoulder = 0.9e-3/"
      -e "s/^base = .*/base = 6e-3/" -e "s/^sting = .*/sting = 3.8e-3/" -e "s/^growth = .*/growth = 0.8/")
    time=(-e "s/^step = .*/step = 2.5e-6/" -e "s/^cell_fraction = .*/cell_fraction = 0.5/"
      -e '$a\\n[collisions]\npartner = "subcell"')
    ;;
  smoke) weight=(3.0e13 4.0e13 4.0e13 4.0e13 4.0e13) sampling=(40 40 40 40 40) transient="transient = 40" ;;
esac
if [ $size = last ]; then
  for_marks=(2.0e12 3.0e12 6.2e11 4.0e11) steps_for_marks=(500 500 800 600)
  weight=("${for_marks[@]:0:levels}" "${weight[@]:levels}")
  sampling=("${steps_for_marks[@]:0:levels}" "${sampling[@]:levels}")
fi
[ $resume = yes ] || rm -f "$out"/*.hdf "$out"/*.json "$out"/*.checkpoint "$out"/*.csv

# Runs a tool on all ranks unless its report is there; reports go to out/<report>.json, summary lines to the terminal.
on_ranks() { # REPORT TOOL ARGUMENT...
  local report=$out/$1.json tool=$2
  shift 2
  if [ -e "$report" ]; then return; fi
  printf '%-12s ' "$tool"
  mpirun -n "$ranks" "$tool" "$@" --force --json "$report.part"
  mv "$report.part" "$report"
}

# The case with the numbers of a level.
case_of() { # LEVEL
  sed -e "s|\"\.\./species.toml\"|\"$root/cases/species.toml\"|" -e "s/^weight = .*/weight = ${weight[$1]}/" \
    -e "s/^sampling = .*/sampling = ${sampling[$1]}\n$transient/" "${mesh[@]}" "${time[@]}" "$case_file" >"$out/case$1.toml"
}

solve() { # LEVEL
  local begin=() lines=()
  if [ -e "$out/flow$1.checkpoint" ]; then begin=(--restart "$out/flow$1.checkpoint")
  elif [ "$1" -gt 0 ]; then begin=(--carry "$out/flow$(($1 - 1)).checkpoint"); fi
  case_of "$1"
  if grep -Eq '^\[\[(station|line|plane)\]\]' "$out/case$1.toml"; then lines=(--lines "$out/lines$1.csv"); fi
  on_ranks "flow$1" pamr-dsmc "$out/case$1.toml" --mesh "$out/level$1.hdf" -o "$out/flow$1.hdf" "${begin[@]}" \
    --checkpoint "$out/flow$1.checkpoint" --every 300 --surface "$out/wall$1.vtu" "${lines[@]}" \
    --history "$out/history$1.csv"
}

# Larger than the local mean free path, where the gas is denser than 1.05 times the free stream's beyond three standard
# errors; the coarsest against it first, up to the level's number of cells.
refine() { # LEVEL
  local coarse=$(($1 - 1))
  on_ranks "mark$coarse" pamr-mark "$out/flow$coarse.hdf" -o "$out/marked$coarse.hdf" --size-over lambda --ratio 1 \
    --only-where "n:above:$limit" --error n_stderr:3 --max-cells "${cells[$1]}"
  on_ranks "refine$1" pamr-refine "$out/marked$coarse.hdf" -o "$out/level$1.hdf"
}

# No inverted cell, and every boundary node on its surface.
gates=(--gate inverted_cells:max:0)
for patch in forebody base sting inflow outflow symmetry; do
  gates+=(--gate "patches.$patch.off_surface_nodes:max:0")
done
quality() { # LEVEL
  if [ -e "$out/quality$1.json" ]; then return; fi
  printf '%-12s ' pamr-quality
  mpirun -n "$ranks" pamr-quality "$out/level$1.hdf" "${gates[@]}" --json "$out/quality$1.json"
}

sed "${mesh[@]}" -e '' "$case_folder/case.toml" >"$out/mesh.toml"
on_ranks mesh pamr-mesh "$out/mesh.toml" -o "$out/level0.hdf"
quality 0
solve 0
for ((level = 1; level <= levels; ++level)); do
  refine "$level"
  quality "$level"
  solve "$level"
done

echo
status=0
if [ $size = heat-flux ]; then
  python3 -B "$case_folder/heat_flux.py" "$out" "$levels" || status=$?
else
  python3 -B "$case_folder/levels.py" "$out" "$levels" $size || status=$?
fi
echo
last=$out/flow$levels.hdf
draw levels.png pamr-picture "$out/level0.hdf" "$out/level$levels.hdf" --patch forebody --patch base --patch sting \
  --patch symmetry --camera -0.16,0.29,-0.1 --up -z --focus 0.0085,0.006,0.0005 --zoom 1.8
if [ $size != smoke ]; then
  plane=(--cut y=0 --smooth 0)
  free=$(sed -n 's/^density = \([0-9.e+]*\).*/\1/p' "$case_file" | head -n 1)
  cold=$(sed -n 's/^temperature = \([0-9.e+]*\).*/\1/p' "$case_file" | head -n 1)
  draw density.png pamr-picture "$last" "${plane[@]}" --field n --scale "$(awk "BEGIN { print 1 / $free }")" \
    --title "n / n_inf" --log --range 0.05,20 --isolines 0.1,0.5,1.05,2,4,8,16 --streamlines u
  draw temperature.png pamr-picture "$last" "${plane[@]}" --field T --scale "$(awk "BEGIN { print 1 / $cold }")" \
    --title "T / T_inf" --range 0,80 --isolines 5,20,40,60 --map inferno
  draw mach.png pamr-picture "$last" "${plane[@]}" --field Ma --title "Ma" --range 0,20 --isolines 1,2,5,10
  walls=()
  for ((level = 0; level <= levels; ++level)); do walls+=("level $level=$out/wall$level.vtu"); done
  measured=()
  if [ $heat_flux = yes ]; then measured=(--measured "$case_folder/heat-flux.csv"); fi
  draw heat.png /usr/bin/python3 -B "$case_folder/plot_heat.py" "${measured[@]}" "${walls[@]}"
  if [ $heat_flux = no ]; then draw drag.png /usr/bin/python3 -B "$case_folder/plot_drag.py" "$out" "$levels"; fi
fi
if ! can_draw; then echo "No pictures: --picture installs what they need."; fi
echo "To open in ParaView: $out/flow0.hdf ... flow$levels.hdf and $out/wall0.vtu ..."
exit $status
