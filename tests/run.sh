#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up, builds and runs every test on every rank count (more ranks than cores are fine). Arguments go to ctest:
#
#   tests/run.sh               all tests (random cases: the quick level, 50 of each property)
#   tests/run.sh full          also the full level: 1,000 random cases of each property, on up to 16 ranks
#   tests/run.sh -L unit       those with this label
#   tests/run.sh -R close      those with this name
#   tests/run.sh full -L full_level   the full level alone
#
# Environment: PAMR_BUILD (build folder, default build/release).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${PAMR_BUILD:-$root/build/release}

level=()
case ${1:-} in
  quick) shift ;;
  full) level=(-C full) && shift ;;
esac

"$root/scripts/setup.sh" --tests
# A test that needs k ranks counts as k of the cores. One more than there are, since starting a job is mostly waiting.
ctest --test-dir "$build" --parallel $(($(nproc) + 1)) --output-on-failure --no-label-summary --no-tests=error "${level[@]}" "$@"
