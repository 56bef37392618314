# SPDX-License-Identifier: GPL-3.0-or-later
"""A wall much coarser than its curvature: through files, with a process for each call, and in memory; and all the way back."""
import itertools
import pathlib
import subprocess
import warnings

import h5py
import numpy as np

import pamr
from collective import COMM, in_folder, run_tests

REFINE = pathlib.Path(pamr.__file__).resolve().parents[2] / "bin" / "pamr-refine"
OF_MAP = ("level0_key", "level0_cell", "PAMR/level0")
SADDLE = '[[surface]]\nname = "wall"\nkind = "quadric"\ncoefficients = [-0.5, 0.5, 0, 0, 0, 0, 0, 0, 1, -1]\n'


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


def test_associating_says_how_coarse_walls_are():
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        ball()

    says = ["12 edges in curved walls are longer than 0.2 of the radius of curvature, the longest 1.41 of it near (-0.5, -0.5, 0)"]
    remarks = [str(w.message).split(":")[0] for w in told]
    assert [r for r in remarks if "curved walls" in r] == (says if COMM.rank == 0 else []), remarks


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


def test_linear_functions_on_nodes_stay_to_second_order():
    """New nodes lie off the middles of their edges, by a quarter of that at each level; their values are means of the ends."""
    mesh, errors = ball(), []
    for level in range(4):
        mesh.node_fields["u"] = mesh.points @ [1.0, 2.0, -0.5]
        mesh = pamr.refine(mesh, np.ones(len(mesh.cells), bool)).mesh
        off = np.abs(mesh.node_fields["u"] - mesh.points @ [1.0, 2.0, -0.5])
        errors.append(COMM.allreduce(off.sum()) / COMM.allreduce(np.count_nonzero(off > 1e-15)))
    assert errors[0] > 0.1 and errors[-2] / errors[-1] > 3.5, errors


def saddle(n=3, layers=2):
    """A block under z = 1 + (x^2 - y^2) / 2 of two regions, one above the other, periodic along x: edges of 0.7 radii."""
    axes = [np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), np.linspace(0, 1, layers + 1)]
    x, y, z = (a.ravel() for a in np.meshgrid(*axes, indexing="ij"))
    points = np.column_stack([x, y, z * (1 + (x * x - y * y) / 2)])
    number = np.arange(len(points)).reshape(n + 1, n + 1, layers + 1)
    cells = []
    for at in np.ndindex(n, n, layers):
        for axes in itertools.permutations(range(3)):
            corner = [np.array(at)]
            for axis in axes:
                corner.append(corner[-1] + np.eye(3, dtype=int)[axis])
            cells.append([number[tuple(c)] for c in corner])
    cells = np.array(cells)
    volume = np.linalg.det(points[cells[:, 1:]] - points[cells[:, :1]])
    cells[volume < 0] = cells[volume < 0][:, [0, 1, 3, 2]]
    of_cells = cells[:, list(itertools.combinations(range(4), 3))].reshape(-1, 3)
    faces, counts = np.unique(np.sort(of_cells, axis=1), axis=0, return_counts=True)
    faces = faces[counts == 1]
    at = {7: z[faces] == 1, 1: x[faces] == -1, 2: x[faces] == 1}
    tags = np.select([side.all(axis=1) for side in at.values()], list(at), 3)  # 3: three flat sides in one patch
    mine = slice(None) if COMM.rank == 0 else slice(0, 0)
    mesh = pamr.Mesh.from_arrays(COMM, points[mine], cells[mine], (faces[mine], tags[mine]),
                                 {7: "wall", 1: ("left", "periodic"), 2: ("right", "periodic"), 3: "sides"},
                                 cell_fields={"region": (z[cells].mean(axis=1) > 0.5).astype(int)[mine]})
    mesh.associate({"wall": pamr.Toml(SADDLE, "wall")})
    return mesh


def smallest_mean_ratio(mesh):
    return pamr.quality(mesh)["mean_ratio"]["min"]


def volume_below(mesh):
    return COMM.allreduce(mesh.volumes()[mesh.cell_fields["region"] == 0].sum())


def nodes_of_side(mesh, name):
    faces = mesh.boundary_faces()
    mine = mesh.points[np.unique(faces.nodes[faces.patches == mesh.patches.index(name)])]
    return np.unique(np.concatenate(COMM.allgather(mine))[:, 1:].round(12), axis=0)


def test_a_saddle_keeps_shapes_periodic_sides_and_the_face_between_regions():
    mesh = first = saddle()
    below = volume_below(mesh)
    for level in (1, 2):
        mesh = pamr.refine(mesh, np.ones(len(mesh.cells), bool)).mesh
        assert smallest_mean_ratio(mesh) > 0.8 * 0.29
        left, right = nodes_of_side(mesh, "left"), nodes_of_side(mesh, "right")
        assert left.shape == right.shape and np.allclose(left, right, rtol=0, atol=2e-12)
    assert abs(volume_below(mesh) / below - 1) < 1e-12

    for seed in range(2):
        mesh = first
        for level in (1, 2, 3):
            chosen = np.random.default_rng(seed).random(mesh.n_cells) < 0.2
            result = pamr.refine(mesh, chosen[mesh.cell_numbers])
            mesh = result.mesh
            assert smallest_mean_ratio(mesh) > 0.8 * 0.29
            assert result.report["off_surface_nodes"] == 0 == result.report["families_kept"]


run_tests(globals())
