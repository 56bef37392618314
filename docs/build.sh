#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the manual: the Markdown pages of this project as a site, with a search that needs no network, and the interfaces of
# C++ and Python from their comments. A link that leads nowhere and a page that no other lists are errors.
#
#   docs/build.sh [FOLDER]    FOLDER/index.html (default build/manual)
#
# Needs doxygen, furo, python3-breathe, python3-myst-parser and python3-sphinx (scripts/setup.sh --manual --packages-only).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
out=${1:-$root/build/manual}
mkdir -p "$out"
out=$(cd -- "$out" && pwd)
work=$(mktemp -d -t pamr-manual.XXXXXX)
trap 'rm -rf "$work"' EXIT

# Doxygen reads the headers that docs/api/cpp.md names; Breathe shows what they declare, namespace by namespace.
(
  cd -- "$root"
  headers=()
  for header in $(grep -o '`pamr/[^`]*\.hpp`' docs/api/cpp.md | tr -d '`'); do
    for folder in lib geometry; do
      if [ -e "$folder/$header" ]; then headers+=("$folder/$header") && continue 2; fi
    done
    echo "build.sh: docs/api/cpp.md names $header, which is not there" >&2
    exit 1
  done
  sed -e "s|@OUT@|$work/doxygen|" -e "s|@HEADERS@|${headers[*]}|" docs/site/Doxyfile >"$work/Doxyfile"
  mkdir "$work/doxygen"
  doxygen -q "$work/Doxyfile" 2>"$work/doxygen.log" || { cat "$work/doxygen.log" >&2; exit 1; }
)
export PAMR_DOXYGEN=$work/doxygen/xml PYTHONPATH=$root/lib/python PYTHONDONTWRITEBYTECODE=1
/usr/bin/python3 -m sphinx -q -W --keep-going -j auto -b html -c "$root/docs/site" -d "$work/doctrees" "$root" "$work/html"
rm -rf "${out:?}"/*
cp -r "$work/html/." "$out"
rm -rf "$out/.doctrees" "$out/.buildinfo"
printf '<!DOCTYPE html><meta charset="utf-8"><title>PAMR</title><meta http-equiv="refresh" content="0; url=%s"><a href="%s">PAMR</a>\n' \
  docs/index.html docs/index.html >"$out/index.html"
echo "$out/index.html"
