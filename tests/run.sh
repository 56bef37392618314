#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sets up, builds and runs the tests (more ranks than cores are fine). Arguments go to ctest:
#
#   tests/run.sh               all tests (most on 1 and 3 ranks; random cases: the quick level, 50 of each property)
#   tests/run.sh full          also the full level: 1,000 random cases of each property, up to 16 ranks, unit tests on 2 and 4, all tests
#                              of the tools on all ranks, faults, up to 100,000 damaged files of each format, the cases and tutorials
#                              (docs/building.md)
#   tests/run.sh -L unit       those with this label
#   tests/run.sh -R close      those with this name
#   tests/run.sh full -L full_level   the full level alone
#   tests/run.sh full -F       goes on where an interrupted run ended (what failed before that is in its output only)
#
# Environment: PAMR_BUILD (build folder, default build/release); TMPDIR (where tests write; default: memory, if there are 8 GB of it to
# spare, else /tmp).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${PAMR_BUILD:-$root/build/release}

# Three serial tests for each core, or three jobs on two: starting and ending a job is mostly waiting (tests/CMakeLists.txt has the weights).
level=()
case ${1:-} in
  quick) shift ;;
  full) level=(-C full) && shift ;;
esac

"$root/scripts/setup.sh" --tests
# Tests write to a folder of their own, in memory if that can be: every output is flushed to the disk, and so is, by ext4, each damaged
# file that replaces another, so that the readers of these waited ten times as long as they computed. Open MPI keeps what it holds of its
# jobs there, too: version 5 starts none where a job that was killed and had the same process id has left its folder.
spare_kilobytes() { (df --output=avail -k /dev/shm | tail -1 && awk '/^MemAvailable:/ { print $2 }' /proc/meminfo) | sort -n | head -1; }
place=${TMPDIR:-/tmp}
if [ -z "${TMPDIR:-}" ] && [ -w /dev/shm ] && [ "$(spare_kilobytes)" -ge 8000000 ]; then place=/dev/shm; fi
TMPDIR=$(mktemp -d "$place/pamr-tests.XXXXXX")
export TMPDIR PRTE_MCA_prte_tmpdir_base=$TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
# Open MPI 4.1 removes the folder of a user's jobs when it is empty: a job that starts at that moment fails (orte/util/session_dir.c).
jobs=$TMPDIR/ompi.$(uname -n).$(id -u)
(umask 077 && mkdir -p "$jobs/tests")
ctest --test-dir "$build" --parallel $((3 * $(nproc))) --output-on-failure --no-label-summary --no-tests=error "${level[@]}" "$@"
