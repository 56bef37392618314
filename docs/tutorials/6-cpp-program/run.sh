#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A C++ program on the library: run.sh [FOLDER]. PAMR_PREFIX is where PAMR is installed, if CMake does not find it by itself; in a
# checkout the build folder (PAMR_BUILD, default build/release) is installed into FOLDER/prefix first.
set -euo pipefail
. "$(dirname -- "${BASH_SOURCE[0]}")/../start.sh"

built=${PAMR_BUILD:-$project/build/release}
if [ -z "${PAMR_PREFIX:-}" ] && [ -e "$built/cmake_install.cmake" ]; then
  step cmake --install "$built" --prefix "$out/prefix" >install.log
  PAMR_PREFIX=$out/prefix
fi
step cmake -G Ninja -S "$here" -B build ${PAMR_PREFIX:+"-DCMAKE_PREFIX_PATH=$PAMR_PREFIX"} >configure.log
step cmake --build build
step mpirun -n 2 build/follow_ball "$out"
step pamr-quality step12.hdf --gate inverted_cells:max:0
picture steps.png step4.hdf step12.hdf --label "Step 4" --label "Step 12" --cut z=0.5 --whole-cells --camera 0.3,-0.6,1 --size 1500x760
