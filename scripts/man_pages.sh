#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Man pages and completions for bash of the tools in a folder, made of what they say themselves; those that are newer than their tool
# stay. `cmake --install` runs it.
#
#   scripts/man_pages.sh BIN OUT    OUT/man/NAME.1 (needs help2man) and OUT/completions/NAME for each tool in BIN
set -euo pipefail

bin=${1:?expected the folder of the tools}
out=${2:?expected a folder for what is made}
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
. "$root/scripts/mpi_environment.sh"
mkdir -p "$out/man" "$out/completions"

has_help2man=yes
command -v help2man >/dev/null || { has_help2man=no && echo "man pages are left out (Debian: help2man)" >&2; }
for tool in "$bin"/pamr-*; do
  name=${tool##*/}
  [ "$out/completions/$name" -nt "$tool" ] || "$root/scripts/completions.py" "$out/completions" "$tool"
  [ $has_help2man = yes ] && [ ! "$out/man/$name.1" -nt "$tool" ] || continue
  purpose=$(sed -n "s/^# $name: //p" "$root/docs/tools/$name.md")
  help2man --no-info --no-discard-stderr --name "${purpose:?docs/tools/$name.md must begin with '# $name: ...'}" --section 1 \
    --source PAMR --manual "PAMR's tools" --output "$out/man/$name.1" "$tool"
done
