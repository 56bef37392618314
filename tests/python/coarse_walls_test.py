# SPDX-License-Identifier: GPL-3.0-or-later
"""A wall much coarser than its curvature: through files, with a process for each call, and in memory; and all the way back."""
import pathlib
import subprocess

import h5py
import numpy as np

import pamr
from collective import COMM, in_folder, run_tests

REFINE = pathlib.Path(pamr.__file__).resolve().parents[2] / "bin" / "pamr-refine"
OF_MAP = ("level0_key", "level0_cell", "PAMR/level0")


def ball():
    """Eight cells around the center: edges of 1.4 radii."""
    points = np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    cells = np.array([[0, x, y, z] for x in (1, 2) for y in (3, 4) for z in (5, 6)])
    mine = slice(None) if COMM.rank == 0 else slice(0, 0)
    mesh = pamr.Mesh.from_arrays(COMM, points[mine], cells[mine], (cells[mine, 1:], np.full(8, 7)[mine]), {7: "wall"}, repair=True)
    mesh.associate({"wall": pamr.Sphere(center=(0, 0, 0), radius=1)})
    return mesh


def marks(mesh):
    """Cells about a point of the wall: all others are closed."""
    return np.linalg.norm(mesh.points[mesh.cells].mean(axis=1) - [0.5, 0.6, 0.4], axis=1) < 0.5


def through_files(mesh, flags, name):
    """Marks go into a file, which a process of its own refines; rank 0 starts it alone."""
    mesh.cell_fields["refine"] = np.asarray(flags, np.int8)
    mesh.write("marked.hdf")
    if COMM.rank == 0:
        subprocess.run([REFINE, "marked.hdf", "-o", name, "--force", "--quiet"], check=True)
    COMM.barrier()
    return pamr.Mesh.read(COMM, name)


def datasets(name):
    """All of a file but what tells how it was made."""
    found = {}
    with h5py.File(name) as file:
        file.visititems(lambda path, item: found.update({path: item[()]}) if isinstance(item, h5py.Dataset) else None)
    return found


def expect_same(a, b, left_out=()):
    a, b = ({k: v for k, v in datasets(name).items() if not k.endswith(left_out)} for name in (a, b))
    assert a.keys() == b.keys(), a.keys() ^ b.keys()
    assert all(a[key].dtype == b[key].dtype and np.array_equal(a[key], b[key]) for key in a), [k for k in a if not np.array_equal(a[k], b[k])]


@in_folder
def test_files_and_memory_give_the_same_bits_and_coarsening_gives_level_0_back():
    in_memory = ball()
    in_memory.write("level0.hdf")
    from_file = pamr.Mesh.read(COMM, "level0.hdf")
    for level in (1, 2, 3):
        result = pamr.refine(in_memory, marks(in_memory))
        in_memory = result.mesh
        assert (result.report["level0"]["coarse_edges"] > 0) == (level == 1), "the map is made once"
        from_file = through_files(from_file, marks(from_file), f"level{level}.hdf")
        in_memory.write("memory.hdf")
        expect_same(f"level{level}.hdf", "memory.hdf", ("provenance",))
    assert all(any(part in key for key in datasets("level3.hdf")) for part in OF_MAP)

    for turn in range(8):
        if from_file.n_cells == 8:
            break
        in_memory = pamr.adapt(in_memory, np.full(len(in_memory.cells), -1)).mesh
        from_file = through_files(from_file, np.full(len(from_file.cells), -1), f"back{turn}.hdf")
        in_memory.write("memory.hdf")
        expect_same(f"back{turn}.hdf", "memory.hdf", ("provenance",))
    assert not any(part in key for key in datasets("memory.hdf") for part in OF_MAP)
    expect_same("level0.hdf", "memory.hdf", ("provenance", "parent", "refine"))


run_tests(globals())
