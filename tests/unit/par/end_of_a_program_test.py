#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a program with `par::Runtime` ends where an exception is not caught, or leaves it on one rank alone.

Usage: end_of_a_program_test.py PROGRAM MPIEXEC...
"""
import concurrent.futures
import pathlib
import subprocess
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import launcher  # noqa: E402

PROGRAM, MPIEXEC = sys.argv[1], sys.argv[2:]


def run(ranks, how):
    start = [] if ranks == 1 else MPIEXEC + [str(ranks)]
    done = subprocess.run(start + [PROGRAM, how], capture_output=True, text=True, timeout=120)
    return done.returncode, launcher.without_chatter(done.stderr).splitlines()


def check(ranks, how, code, *lines):
    """Each of these lines once, and no others, no stack least of all."""
    found = run(ranks, how)
    assert found == (code, list(lines)), f"{how} on {ranks} ranks: expected {(code, list(lines))}, found {found}"


def check_starts(ranks, how, code, *starts):
    """The same of what lines begin with, in any order."""
    found, lines = run(ranks, how)
    assert found == code and len(lines) == len(starts) and all(any(line.startswith(start) for line in lines) for start in starts), \
        f"{how} on {ranks} ranks: expected {code}, {starts}, found {found}, {lines}"


def said(text):
    return f"program: error: {text}"


checks = [(check, n, *what) for n in (1, 3) for what in
          (("well", 0), ("error", 2, said("file 'cube.hdf': expected a file, found none")),
           ("other-error", 3, said("uncaught exception: slot 12 of 4")))]
checks += [(check, 1, "caught-error", 5, "the program says: file 'cube.hdf': expected a file, found none"),
           (check, 3, "error-on-one", 2, said("cell 7: expected a cell (on rank 2)")),
           (check, 3, "memory-on-one", 3, said("out of memory (on rank 2)")),
           (check_starts, 3, "caught-error-on-one", 2, said("rank 2 is left by an exception"), "the program says: cell 7: expected a cell")]
with concurrent.futures.ThreadPoolExecutor(4) as pool:  # they wait, most of their time
    list(pool.map(lambda call: call[0](*call[1:]), checks))
# All ranks leave by one error and catch it further out: MPI ends as ever. mpirun ends those that have not printed by then.
code, lines = run(3, "caught-error")
assert code == 5 and set(lines) == {"the program says: file 'cube.hdf': expected a file, found none"}, (code, lines)
