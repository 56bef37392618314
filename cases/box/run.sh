#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A closed box of gas: the collision rate of argon and the rotational relaxation of nitrogen, compared with kinetic theory.
#
#   cases/box/run.sh [--ranks N] [--full] [--out FOLDER] [--tools FOLDER]
#
#   --ranks N       MPI processes (default 2)
#   --full          the numbers of README.md; without it a shorter run with larger standard errors
#   --out FOLDER    where meshes and results go (default out/ beside this script)
#   --tools FOLDER  takes the tools from there and sets nothing up
set -euo pipefail

declare -A flags=([--full]=full)
full=no
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

cubes=12
[ $full = yes ] && cubes=24
pamr-mesh --shape kuhn-cube --n $cubes -o "$out/box.hdf" --force
for name in collision-rate case; do
  sed "s|\.\./species.toml|$case_folder/../species.toml|" "$case_folder/$name.toml" >"$out/$name.toml"
  on_ranks pamr-dsmc "$out/$name.toml" --mesh "$out/box.hdf" -o "$out/$name.hdf" --force --history "$out/$name.csv"
done
python3 "$case_folder/check.py" "$out"
