# SPDX-License-Identifier: GPL-3.0-or-later
"""A coupled run is saved and goes on on another number of ranks: mesh, fields, data of any length in each cell."""
import pathlib

import numpy as np
from mpi4py import MPI

import pamr
from collective import COMM, error_of, in_folder, run_tests


def on_first(n, call):
    """Calls with a communicator of the first n ranks, on these."""
    few = COMM.Split(0 if COMM.rank < n else MPI.UNDEFINED)
    if few != MPI.COMM_NULL:
        call(few)
        few.Free()
    COMM.barrier()


def marks(mesh, turn):
    return np.linalg.norm(mesh.points[mesh.cells].mean(axis=1) - 0.2 * turn, axis=1) < 0.5


def turn_of(mesh, particles, table, turn):
    """One turn of a coupled run: a field, particles, a table; everything goes through a refinement."""
    mesh.cell_fields["u"] = np.sqrt(mesh.cell_numbers + 1.0)
    particles = [np.append(own, number) for own, number in zip(particles, mesh.cell_numbers)]
    result = pamr.refine(mesh, marks(mesh, turn))
    return result.mesh, result.from_parents(particles), result.from_parents(table)


def save(comm):
    mesh = pamr.Mesh.kuhn_cube(comm, 3)
    particles = [np.arange(number % 4) for number in mesh.cell_numbers]
    table = np.stack([mesh.cell_numbers, 2 * mesh.cell_numbers, -mesh.cell_numbers], axis=1).astype(np.float32)
    mesh, particles, table = turn_of(mesh, particles, table, 0)
    mesh.write("saved.hdf")
    mesh.write_rows("saved.particles", particles)
    mesh.write_rows("saved.table", table)


def go_on(comm, name):
    mesh = pamr.balance(pamr.Mesh.read(comm, "saved.hdf"))
    particles, table = mesh.read_rows("saved.particles"), mesh.read_rows("saved.table")
    assert "u" in mesh.cell_fields and table.dtype == np.float32 and table.shape == (len(mesh.cells), 3)
    for own, row, parent in zip(particles, table, mesh.cell_fields["parent"]):
        assert own.tolist() == [*range(parent % 4), parent] and row.tolist() == [parent, 2 * parent, -parent]
    mesh, particles, table = turn_of(mesh, particles, table, 1)
    mesh.write(f"{name}.hdf")
    mesh.write_rows(f"{name}.particles", particles)
    mesh.write_rows(f"{name}.table", table)


@in_folder
def test_a_run_goes_on_on_another_number_of_ranks():
    files = {}
    for before, after in ((1, 1), (3, 2), (2, 5)):
        if max(before, after) > COMM.size:
            continue
        on_first(before, save)
        on_first(after, lambda comm: go_on(comm, "next"))
        for name in ("next.hdf", "next.particles", "next.table"):
            found = pathlib.Path(name).read_bytes()
            assert len(found) > 5000 and files.setdefault(name, found) == found, (before, after, name)
        COMM.barrier()


@in_folder
def test_wrong_rows_are_one_error():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    n = len(mesh.cells)
    mesh.write_rows("good", np.arange(n))
    assert "expected a row for each of" in error_of(lambda: mesh.write_rows("x", np.zeros(n + (COMM.rank == 0))))
    assert "found a single value for cell 1" in error_of(lambda: mesh.write_rows("x", [np.zeros(2)] + [1.0] * (n - 1)))
    assert "Python objects" in error_of(lambda: mesh.write_rows("x", np.array([None] * n)))
    assert "a type with fields" in error_of(lambda: mesh.write_rows("x", np.zeros(n, [("a", "i4")])))
    assert "expected data of 162 cells" in error_of(lambda: pamr.Mesh.kuhn_cube(COMM, 3).read_rows("good"))
    assert "expected items of 4 bytes, found 8" in error_of(lambda: mesh.read_rows("good", np.int32))
    assert [r.tolist() for r in mesh.read_rows("good", np.int64)] == [[k] for k in range(n)]
    assert "expected a file that can be read" in error_of(lambda: mesh.read_rows("none"))


run_tests(globals())
