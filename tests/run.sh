#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up, builds and runs every test on every rank count (more ranks than cores are fine). Arguments go to ctest:
#
#   tests/run.sh               all tests
#   tests/run.sh -L unit       those with this label
#   tests/run.sh -R close      those with this name
#
# Environment: PAMR_BUILD (build folder, default build/release).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${PAMR_BUILD:-$root/build/release}

"$root/scripts/setup.sh" --tests
# A test that needs k ranks counts as k of the cores.
ctest --test-dir "$build" --parallel "$(nproc)" --output-on-failure --no-label-summary --no-tests=error "$@"
