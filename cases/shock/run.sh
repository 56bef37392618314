#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Normal shocks in argon and nitrogen, averaged about the mid-density point: jumps and thickness.
#
#   cases/shock/run.sh [--ranks N] [--all | --full] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --all           all four shocks with one seed; without it argon at Mach 8 (omega 0.81)
#   --full          all four with three seeds
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A flags=([--all]=all [--full]=full)
all=no full=no
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"
python=/usr/bin/python3  # the one that sees Debian's h5py
[ -x "$python" ] || python=python3

cases="case" seeds=1
[ $full = yes ] && all=yes seeds=3
[ $all = yes ] && cases="case argon-m8-omega-0.70 argon-m4.2 nitrogen-m20"
every=300
"$python" "$root/cases/box_mesh.py" "$out/box.msh" 205 2 2 -0.56 0.26
pamr-convert "$out/box.msh" "$out/box.hdf" --force --quiet

# A window of the averages is what a run stopped by --steps has added since the previous one, from which it continues.
status=0
number_of_run=0  # no two runs have the same random numbers
for name in $cases; do
  number() { sed -n "s/^$1 = \([0-9]*\).*/\1/p" "$case_folder/$name.toml"; }
  transient=$(number transient) windows=$(($(number sampling) / every))
  for ((seed = 1; seed <= seeds; ++seed)); do
    number_of_run=$((number_of_run + 1))
    sed -e "s|\.\./species.toml|$case_folder/../species.toml|" -e "s/^seed = .*/seed = $number_of_run/" \
      "$case_folder/$name.toml" >"$out/$name.toml"
    restart=()
    for ((window = 1; window <= windows; ++window)); do
      on_ranks pamr-dsmc "$out/$name.toml" --mesh "$out/box.hdf" -o "$out/$name-$seed-$window.hdf" --force --quiet \
        --steps $((transient + window * every)) --checkpoint "$out/$name-$seed.checkpoint" "${restart[@]}"
      restart=(--restart "$out/$name-$seed.checkpoint")
    done
  done
  "$python" "$case_folder/profile.py" "$case_folder/$name.toml" "$out" $seeds $every $windows || status=1
done
exit $status
