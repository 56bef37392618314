#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# mpirun of Open MPI 5 without its own words about a job that ended with an error, which version 4 leaves out if a variable says so.
#
#   quiet_mpirun.sh MPIRUN ARGUMENT...
exec "$@" 2> >(
  trap '' HUP INT TERM USR1 # it ends when mpirun does
  exec sed -u 's/\x00//g; /^-\{74\}$/ { :more; N; /\n-\{74\}$/ !b more; /prterun\|MPI_ABORT/ d }' >&2
)
