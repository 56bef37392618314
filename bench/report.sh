#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes every table of the performance reports from nothing: ours and the other codes of today on the same work, in
# turn, with what the machine can do (`limit`) and its load beside each row; scaling; the costs of single steps. A table is
# a file, written when it is complete: a run that was interrupted goes on behind the last one that is of this commit.
#
#   bench/report.sh [BUILD] [options]    BUILD: folder with the benchmarks (default build/release)
#
#   --quick             smaller meshes: a quarter of an hour on two quiet cores (the whole: an hour and a half)
#   --tiny              tiny ones, which show that all this works
#   --table NAME        this table; may be repeated (default all)
#   --list              names the tables, and the pages that hold them
#   --again             also makes the tables that are there already
#   --into-docs         puts them into the pages, between <!-- table NAME --> and <!-- end of table NAME -->
#   --docs FOLDER       of the pages (default docs/reports)
#   --peers "A B"       only these other codes (report/peers.toml has all, with their releases); "" for none
#   --out FOLDER        where tables and meshes go (default BUILD/bench/report)
#   --peer-folder FOLDER  where the other codes are kept (default BUILD/bench/peers): each is made there when it is
#                       first needed, by pip in an environment of its own, from packages of Debian that are unpacked, not
#                       installed, or by git; takes a few minutes once. One that cannot be had is named below the table, with the
#                       last error.
#
# Exit code 1 when a table could not be made, 2 for a wrong command line. Needs Python 3.11 with numpy and h5py
# (PAMR_PYTHON). Environment: PAMR_PEER_PYTHON (default /usr/bin/python3, which sees Debian's packages), PAMR_PEER_CXX
# (default mpicxx).
set -euo pipefail
folder=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
case " $* " in *" --help "* | *" -h "*) sed -n '3,28s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;; esac
. "$folder/../scripts/mpi_environment.sh"
python=${PAMR_PYTHON:-python3}
"$python" -c 'import h5py, numpy' 2>/dev/null || python=/usr/bin/python3
exec "$python" -B "$folder/report/report.py" "$@"
