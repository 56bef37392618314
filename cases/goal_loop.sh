#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The coupled loop of the Poisson-Boltzmann cases, by the stage tools: solve, mark, refine with new nodes on the spheres,
# and start the next solution from the potential that refinement transferred. Stops when nothing is marked.
#
#   goal_loop.sh CASE.toml LEVEL0.hdf FOLDER RANKS LEVELS MAX_CELLS CRITERION...
#
# LEVELS refinements at most; CRITERION are options of pamr-mark, of which --shape-floor is for pamr-refine too; refined
# meshes stay within MAX_CELLS, which may be several numbers with commas between, one for each refinement (the last
# serves all further ones). Leaves FOLDER/level<i>.hdf (the mesh with its solution) and the reports solve<i>.json,
# mark<i>.json, refine<i>.json. `pamr-pb --levels` does the same in one command, with marks of its own.
set -euo pipefail

case_file=$1 mesh=$2 out=$3 ranks=$4 levels=$5
IFS=, read -ra max_cells <<<"$6"
shift 6
floor=()
for ((i = 1; i < $#; ++i)); do
  if [ "${!i}" = --shape-floor ]; then floor=(--shape-floor "${@:i+1:1}"); fi
done
mkdir -p "$out"
. "$(dirname -- "${BASH_SOURCE[0]}")/../scripts/mpi_environment.sh"
export OMPI_MCA_orte_execute_quiet=1 # as in start.sh

on_ranks() { # REPORT TOOL ARGUMENT...
  local report=$out/$1.json
  shift
  mpirun -n "$ranks" "$@" --json "$report" --quiet
}

start=()
rm -f "$out"/solve*.json # of a longer run before
for ((level = 0; ; ++level)); do
  on_ranks "solve$level" pamr-pb "$case_file" --mesh "$mesh" -o "$out/level$level.hdf" --force "${start[@]}"
  if ((level > 0)); then rm -f "$mesh"; fi
  if ((level == levels)); then break; fi
  on_ranks "mark$level" pamr-mark "$out/level$level.hdf" -o "$out/marked.hdf" --force "$@" \
    --max-cells "${max_cells[level]:-${max_cells[-1]}}"
  if grep -q '"marked": *0,' "$out/mark$level.json" || grep -q '"marked":0,' "$out/mark$level.json"; then break; fi
  mesh=$out/refined.hdf
  on_ranks "refine$((level + 1))" pamr-refine "$out/marked.hdf" -o "$mesh" --force "${floor[@]}"
  start=(--start potential)
done
rm -f "$out/marked.hdf"
