# SPDX-License-Identifier: GPL-3.0-or-later
"""A shared Scotch of another integer size in the same process: PETSc and dolfinx load one, pamr has its own inside.

Usage: other_scotch_test.py pamr-first|pamr-last    Both divide a mesh among the ranks, whichever was loaded first.
"""
import importlib
import sys

import numpy as np

from collective import COMM, run_tests

OTHERS = ("petsc4py.PETSc", "dolfinx")


def load(order):
    """The modules of others that are installed."""
    if order == "pamr-first":
        importlib.import_module("pamr")
    found = {}
    for name in OTHERS:
        try:
            found[name] = importlib.import_module(name)
        except ImportError:
            pass
    return found


FOUND = load(sys.argv[1])
import pamr  # noqa: E402  after the others, unless it is there already


def shared_scotches():
    with open("/proc/self/maps", encoding="ascii", errors="replace") as file:
        return {line.split("/")[-1].strip() for line in file if "scotch" in line.rsplit("/", 1)[-1]}


def test_pamr_divides_a_refined_corner():
    mesh = pamr.Mesh.kuhn_cube(COMM, 6)
    mesh = pamr.refine(mesh, np.linalg.norm(mesh.points[mesh.cells].mean(axis=1), axis=1) < 0.5).mesh
    mesh = pamr.balance(mesh, method="scotch")
    own = COMM.allgather(len(mesh.cells))
    assert sum(own) == mesh.n_cells and max(own) < 1.1 * mesh.n_cells / COMM.size, own
    assert abs(COMM.allreduce(mesh.volumes().sum()) - 1) < 1e-12


def test_the_other_scotch_divides_as_it_did():
    assert FOUND, "this test is for machines with petsc4py or dolfinx"
    assert any("scotch" in name for name in shared_scotches()), "no shared Scotch was loaded: the test shows nothing"
    if "petsc4py.PETSc" in FOUND:
        parts_of_a_chain(FOUND["petsc4py.PETSc"])
    if "dolfinx" in FOUND:
        from dolfinx import graph, mesh
        cube = mesh.create_unit_cube(COMM, 6, 6, 6, partitioner=mesh.create_cell_partitioner(graph.partitioner_scotch()))
        sizes = COMM.allgather(cube.topology.index_map(3).size_local)
        assert sum(sizes) == 6 ** 4 and max(sizes) < 1.2 * 6 ** 4 / COMM.size, sizes


def parts_of_a_chain(petsc):
    """PETSc asks its Scotch to cut a chain of nodes into equal parts."""
    n = 30 * COMM.size
    matrix = petsc.Mat().createAIJ((n, n), comm=COMM)
    matrix.setUp()
    for row in range(*matrix.getOwnershipRange()):
        for column in {max(row - 1, 0), min(row + 1, n - 1)} - {row}:
            matrix.setValue(row, column, 1.0)
    matrix.assemble()
    cut = petsc.MatPartitioning().create(COMM)
    cut.setAdjacency(matrix.convert("mpiadj"))
    cut.setType("ptscotch")
    parts = petsc.IS().create(COMM)
    cut.apply(parts)
    counts = COMM.allreduce(np.bincount(parts.getIndices(), minlength=COMM.size))
    assert counts.sum() == n and counts.max() <= 1.2 * 30, counts


run_tests(globals())
