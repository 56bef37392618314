#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Renders two levels of a case side by side:
#   render.sh COARSE.hdf FINE.hdf PICTURE.png             the blunt cone
#   render.sh --spheres COARSE.hdf FINE.hdf PICTURE.png   the charged spheres and their plate
# Needs python3-vtk9, python3-h5py, xvfb and xauth (scripts/setup.sh --picture); works without a screen.
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
script=render.py
if [ "${1:-}" = --spheres ]; then
  script=render_spheres.py
  shift
fi
exec xvfb-run --auto-servernum --server-args='-screen 0 1280x1024x24' /usr/bin/python3 "$folder/$script" "$@"
