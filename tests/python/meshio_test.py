# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from meshio: patches by tags, names, fields, points of no cell."""
import numpy as np

import pamr
from collective import CELLS, COMM, FLOOR, POINTS, error_of, in_folder, run_tests


def tagged():
    import meshio
    points = np.insert(POINTS, 3, (9, 9, 9), axis=0)  # belongs to no tetrahedron
    new = np.array([0, 1, 2, 4, 5, 6, 7, 8])
    return meshio.Mesh(points, [("triangle", new[FLOOR]), ("tetra", new[CELLS]), ("line", [[0, 1]])],
                       point_data={"T": np.arange(9.0)},
                       cell_data={"gmsh:physical": [[4, 4], [7] * 6, [1]], "mark": [[0, 0], np.arange(6), [0]]},
                       field_data={"floor": np.array([4, 2]), "gas": np.array([7, 3])})


def test_a_mesh_on_rank_zero_is_spread_over_all():
    mesh = pamr.from_meshio(COMM, tagged() if COMM.rank == 0 else None)
    assert mesh.n_cells == 6 and mesh.n_nodes == 8 and mesh.patches == ["floor", "boundary"]
    faces = mesh.boundary_faces()
    assert COMM.allreduce(int((faces.patches == 0).sum())) == 2
    assert (mesh.points[faces.nodes[faces.patches == 0]][:, :, 2] == 0).all()
    expected = np.array([0, 1, 2, 4, 5, 6, 7, 8.0])
    by_place = {tuple(p): t for p, t in zip(POINTS, expected)}
    assert all(by_place[tuple(p)] == t for p, t in zip(mesh.points, mesh.node_fields["T"]))
    assert sorted(np.concatenate(COMM.allgather(mesh.cell_fields["mark"]))) == list(range(6))
    assert COMM.allreduce(len(mesh.cells), max) == -(-6 // COMM.size)


def test_what_is_no_tetrahedral_mesh_is_refused_everywhere():
    import meshio
    flat = meshio.Mesh(POINTS, [("triangle", FLOOR)])
    assert "expected tetrahedra, found triangle" in error_of(
        lambda: pamr.from_meshio(COMM, flat if COMM.rank == 0 else None))
    if COMM.size > 1:
        assert "on rank 0 alone" in error_of(lambda: pamr.from_meshio(COMM, tagged()))


@in_folder
def test_the_level_that_files_show_is_no_field():
    import meshio
    pamr.from_meshio(COMM, tagged() if COMM.rank == 0 else None).write("mesh.vtu")
    mesh = pamr.from_meshio(COMM, meshio.read("mesh.vtu") if COMM.rank == 0 else None, tags="patch")
    assert set(mesh.cell_fields) == {"mark", "mean_ratio", "patch"} and mesh.patches == ["patch_0", "patch_1"]
    mesh.write("mesh.hdf")
    assert set(pamr.Mesh.read(COMM, "mesh.hdf").cell_fields) == set(mesh.cell_fields)
    mesh.cell_fields["level"] = np.zeros(len(mesh.cells), np.uint8)
    assert "'level': expected another name or type than uint8" in error_of(lambda: mesh.write("other.hdf"))


run_tests(globals())
