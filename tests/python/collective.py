# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the Python package share: a shared folder, and an end of the whole job when one rank fails alone."""
import os
import pathlib
import shutil
import sys
import tempfile
import traceback

import numpy as np
from mpi4py import MPI

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))  # whole_meshio

COMM = MPI.COMM_WORLD

# The unit cube as six tetrahedra, and its face z = 0.
POINTS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
CELLS = np.array([[0, 1, 3, 7], [0, 5, 1, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 6, 4, 7]])
FLOOR = np.array([[0, 1, 3], [0, 3, 2]])


def in_folder(test):
    """The test in a folder of its own that all ranks share."""
    def wrapped():
        name = COMM.bcast(tempfile.mkdtemp(prefix="pamr python ") if COMM.rank == 0 else None)
        os.chdir(name)
        test()
        COMM.barrier()
        os.chdir("/")
        if COMM.rank == 0:
            shutil.rmtree(name)
    wrapped.__name__ = test.__name__
    return wrapped


def error_of(call):
    """The message of the pamr.Error that a call raises, which has to be the same on every rank."""
    import pamr
    try:
        call()
        message = "no error"
    except pamr.Error as error:
        message = str(error)
    everywhere = COMM.allgather(message)
    assert len(set(everywhere)) == 1, everywhere
    return message


def run_tests(names):
    for name, test in list(names.items()):
        if not name.startswith("test_"):
            continue
        try:
            test()
        except BaseException:  # the others would wait for ever
            print(f"FAILED {name} on rank {COMM.rank}", file=sys.stderr)
            traceback.print_exc()
            sys.stderr.flush()
            COMM.Abort(1)
        if COMM.rank == 0:
            print("ok    ", name, flush=True)
