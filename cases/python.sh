#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced after start.sh by a case that needs the Python package: python.sh MODULE PACKAGE... puts the package into the path
# and ends the script with one line where it or the module is missing.
for folder in "$tools/../python" "$tools"/../lib/python3*/dist-packages; do
  if [ -e "$folder/pamr/__init__.py" ]; then
    PYTHONPATH=$(cd -- "$folder" && pwd)${PYTHONPATH:+:$PYTHONPATH}
    export PYTHONPATH
    break
  fi
done
if ! /usr/bin/python3 -c "import pamr" 2>/dev/null; then
  echo "$name: expected PAMR's Python package beside $tools, found none (scripts/setup.sh --python builds it)" >&2
  exit 2
fi
if ! /usr/bin/python3 -c "import $1" 2>/dev/null; then
  echo "$name: this case needs the Python module $1 (Debian: apt install ${*:2})" >&2
  exit 2
fi
