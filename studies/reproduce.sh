#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes every table and figure of the paper again, one case after another (docs/reports/paper.md says which is which). A step that
# has ended well is not repeated, so an interrupted run goes on where it was. Exit code 1 when a step failed.
#
#   studies/reproduce.sh [--quick] [--ranks N] [--out FOLDER] [--tools FOLDER] [STEP...]
#
#   --quick         lower levels and fewer particles: about a quarter of an hour; without it hours
#   --ranks N       MPI processes (default 2)
#   --out FOLDER    where results and logs go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
#   STEP            only these: shape cone heat-flux free-molecular sphere charges-b charges-a table5 pairs quality scaling
set -euo pipefail

declare -A flags=([--quick]=quick)
quick=no
arguments=()
check_options() {
  steps=(shape cone heat-flux free-molecular sphere charges-b charges-a table5 pairs quality scaling)
  local wanted
  for wanted in "${arguments[@]}"; do
    if [[ " ${steps[*]} " != *" $wanted "* ]]; then
      echo "reproduce.sh: unknown step $wanted: expected one of ${steps[*]}" >&2
      exit 2
    fi
  done
  if [ ${#arguments[@]} -gt 0 ]; then steps=("${arguments[@]}"); fi
  subfolder=$([ $quick = yes ] && echo quick || echo full)
}
. "$(dirname -- "${BASH_SOURCE[0]}")/../cases/start.sh"

build=$(dirname -- "$(cd -- "$tools" && pwd)")
cases=$root/cases
# What only the full or only the quick run has.
if [ $quick = yes ]; then cone=() sphere=(--levels 2) charges=(--levels 2 --max-cells 60000) quality=3 scaling=(--tiny)
else cone=(--full --levels 4) sphere=(--full) charges=() quality=6 scaling=(--counts); fi

# The command of a step; `own`: its options for ranks, tools and results.
command_of() { # STEP
  local own=(--ranks "$ranks" --tools "$tools" --out "$out/$1")
  case $1 in
    shape) command=("$cases/blunt-cone/geometry.sh" "${own[@]}") ;;
    cone) command=("$cases/blunt-cone/run.sh" "${cone[@]}" --resume "${own[@]}") ;;
    heat-flux) command=("$cases/blunt-cone/run.sh" --heat-flux --resume "${own[@]}") ;;
    free-molecular) command=("$cases/blunt-cone/free-molecular.sh" "${own[@]}") ;;
    sphere) command=("$cases/supersonic-sphere/run.sh" "${sphere[@]}" --resume "${own[@]}") ;;
    charges-b) command=("$cases/charged-spheres/run.sh" --reading b "${charges[@]}" "${own[@]}") ;;
    charges-a) command=("$cases/charged-spheres/run.sh" --reading a "${charges[@]}" "${own[@]}") ;;
    table5) command=("$case_folder/charged-spheres/table5.sh" "${own[@]}") ;;
    pairs) command=(/usr/bin/python3 -B "$case_folder/charged-spheres/pairs.py" --ranks "$ranks" --tools "$tools" --out "$out/$1") ;;
    quality) command=("$root/bench/quality_control.sh" "$build" "$quality") ;;
    scaling) command=("$root/bench/scaling.sh" "$build" --out "$out/$1" "${scaling[@]}") ;;
  esac
}

# Steps that take an hour and more are left out of the quick run, and those that need the benchmarks where these are not built.
left_out() { # STEP
  if [ $quick = yes ] && [[ $1 = heat-flux || $1 = table5 || $1 = pairs || $1 = charges-a ]]; then echo "takes too long for --quick"
  elif [ "$1" = quality ] && [ ! -x "$build/bench/bench_quality_control" ]; then echo "needs the benchmarks: scripts/setup.sh --tests"
  elif [ "$1" = scaling ] && [ ! -d "$build/bench" ]; then echo "needs the benchmarks: scripts/setup.sh --tests"; fi
}

status=0
for step in "${steps[@]}"; do
  reason=$(left_out "$step")
  if [ -e "$out/$step.done" ]; then
    echo "$step: done before, $out/$step.log"
  elif [ -n "$reason" ]; then
    echo "$step: left out: $reason"
  else
    command_of "$step"
    begin=$SECONDS
    echo "$step: ${command[*]}"
    if "${command[@]}" >"$out/$step.log" 2>&1; then
      touch "$out/$step.done"
      echo "$step: done in $((SECONDS - begin)) s, $out/$step.log"
    else
      echo "$step: FAILED after $((SECONDS - begin)) s, $out/$step.log ends with:"
      tail -n 5 "$out/$step.log"
      status=1
    fi
  fi
done
exit $status
