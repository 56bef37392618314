# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh of dolfinx refined, and given back to it."""
import dolfinx
import numpy as np
from dolfinx import fem
from mpi4py import MPI

import pamr
from pamr import dolfinx_versions as versions
from collective import COMM, run_tests


def tagged_cube(n):
    """dolfinx's unit cube with 1 for x = 0, 2 for x = 1, and cells with 5 where x <= 1/2."""
    mesh = dolfinx.mesh.create_unit_cube(COMM, n, n, n)
    facets, values = [], []
    for tag, x in ((1, 0), (2, 1)):
        found = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda p, x=x: np.isclose(p[0], x))
        facets.append(found)
        values.append(np.full(len(found), tag, np.int32))
    facets, values = np.concatenate(facets), np.concatenate(values)
    order = np.argsort(facets)
    facet_tags = dolfinx.mesh.meshtags(mesh, 2, facets[order], values[order])
    cells = dolfinx.mesh.locate_entities(mesh, 3, lambda p: p[0] <= 0.5)
    return mesh, facet_tags, dolfinx.mesh.meshtags(mesh, 3, cells, np.full(len(cells), 5, np.int32))


def test_a_mesh_goes_from_dolfinx_and_back_with_tags_and_maps():
    theirs, facet_tags, cell_tags = tagged_cube(3)
    ours = pamr.from_dolfinx(theirs, facet_tags, {1: "in", 2: "out"}, cell_tags)

    n = theirs.topology.index_map(3).size_local
    assert ours.n_cells == 162 and len(ours.cells) == n and ours.patches == ["in", "out", "boundary"]
    assert abs(COMM.allreduce(ours.volumes().sum()) - 1) < 1e-12
    x = theirs.geometry.x[versions.dofmap(theirs.geometry)[:n]].mean(axis=1)
    assert np.allclose(ours.points[ours.cells].mean(axis=1), x)
    region = ours.cell_fields["region"]
    assert set(region.tolist()) <= {0, 5} and np.array_equal(region == 5, x[:, 0] < 1 / 3)

    fine = pamr.refine(ours, ours.points[ours.cells].mean(axis=1)[:, 0] < 0.5).mesh
    back = pamr.to_dolfinx(fine)
    mesh = back.mesh
    assert mesh.topology.index_map(3).size_global == fine.n_cells
    assert mesh.topology.index_map(0).size_global == mesh.geometry.index_map().size_global == fine.n_nodes  # ranks share nodes
    own = mesh.topology.index_map(3).size_local
    dofs = versions.dofmap(mesh.geometry)[:own]
    assert np.allclose(mesh.geometry.x[dofs].mean(axis=1), fine.points[fine.cells[back.cell_rows]].mean(axis=1))
    place = dict(zip(fine.node_numbers.tolist(), fine.points.tolist()))
    for x, number in zip(mesh.geometry.x, back.node_numbers):
        assert number not in place or np.allclose(x, place[number])
    import ufl
    measure = ufl.Measure("ds", mesh, subdomain_data=back.facet_tags)
    one = fem.Constant(mesh, 1.0)
    assert back.names == {1: "in", 2: "out"}  # the tags that were given
    for tag, area in ((1, 1), (2, 1), (0, 0)):
        found = COMM.allreduce(fem.assemble_scalar(fem.form(one * measure(tag))), MPI.SUM)
        assert abs(found - area) < 1e-12
    own_cells = back.cell_tags.indices
    assert set(back.cell_tags.values.tolist()) <= {5}
    assert np.array_equal(np.sort(own_cells), np.flatnonzero(fine.cell_fields["region"][back.cell_rows] == 5))
    # Faces between cells, those on the border of ranks too.
    faces = ufl.Measure("dS", mesh)
    found = COMM.allreduce(fem.assemble_scalar(fem.form(one("+") * faces)), MPI.SUM)
    corners = fine.points[fine.cells]
    edges = [corners[:, j] - corners[:, i] for i, j in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3))]
    areas = sum(np.linalg.norm(np.cross(edges[i], edges[j]), axis=1).sum() / 2 for i, j in ((0, 1), (0, 2), (1, 2), (3, 4)))
    assert abs(found - (COMM.allreduce(areas, MPI.SUM) - 6) / 2) < 1e-10


def test_a_tagged_plane_inside_is_integrated_over_at_every_level():
    """Facets at x = 1/3 have tag 7, those at x = 1 tag 12: dS and ds of a linear function, exact on every level."""
    import ufl
    theirs = dolfinx.mesh.create_unit_cube(COMM, 3, 3, 3)
    inside = dolfinx.mesh.locate_entities(theirs, 2, lambda p: np.isclose(p[0], 1 / 3))
    outside = dolfinx.mesh.locate_entities_boundary(theirs, 2, lambda p: np.isclose(p[0], 1))
    facets = np.concatenate([inside, outside])
    values = np.concatenate([np.full(len(inside), 7, np.int32), np.full(len(outside), 12, np.int32)])
    order = np.argsort(facets)
    ours = pamr.from_dolfinx(theirs, dolfinx.mesh.meshtags(theirs, 2, facets[order], values[order]), {7: "sheet"})
    assert ours.patches == ["sheet", "patch_12", "boundary"] and ours.patch_numbers == [7, 12, -1]
    for level in range(3):
        back = pamr.to_dolfinx(ours)
        x = ufl.SpatialCoordinate(back.mesh)
        on, at = (ufl.Measure(kind, back.mesh, subdomain_data=back.facet_tags) for kind in ("dS", "ds"))
        for form, exact in ((x[1]("+") * on(7), 0.5), ((1 + x[2]) * at(12), 1.5)):
            assert abs(COMM.allreduce(fem.assemble_scalar(fem.form(form)), MPI.SUM) - exact) < 1e-12, level
        ours = pamr.refine(ours, ours.points[ours.cells].mean(axis=1)[:, 1] < 0.5).mesh


def test_functions_go_to_the_fields_of_a_mesh_and_back():
    """Linear functions and values of cells, scalar and of vectors, on the mesh that came from dolfinx and on the refined one."""
    theirs = dolfinx.mesh.create_unit_cube(COMM, 3, 3, 3)
    ours = pamr.from_dolfinx(theirs)
    fine = pamr.refine(ours, ours.points[ours.cells].mean(axis=1)[:, 0] < 0.5).mesh
    back = pamr.to_dolfinx(fine)
    for given, mesh, of in ((ours, theirs, ours), (back, back.mesh, fine)):
        x, middle = of.points, of.points[of.cells].mean(axis=1)
        for size, scalar in ((None, True), (3, False), (2, False)):
            def linear(p):
                return 1 + p[0] - 2 * p[1] if scalar else np.stack([p[2], p[0] + 3 * p[1], p[1]][:size])
            for on, element, place in (("nodes", ("Lagrange", 1), x), ("cells", ("DG", 0), middle)):
                u = fem.Function(versions.function_space(mesh, element, size))
                u.interpolate(linear)
                u.x.scatter_forward()
                values = pamr.dolfinx_values(given, u)
                assert np.allclose(values, linear(place.T).T, atol=1e-14), (on, size)
                again = pamr.dolfinx_function(given, mesh, values, on)
                assert np.allclose(again.x.array, u.x.array, atol=1e-14), (on, size)  # those of ghosts, too


def test_other_elements_and_arrays_are_refused():
    theirs = dolfinx.mesh.create_unit_cube(COMM, 2, 2, 2)
    ours = pamr.from_dolfinx(theirs)
    for element in (("Lagrange", 2), ("DG", 1)):
        u = fem.Function(versions.function_space(theirs, element))
        assert "expected Lagrange elements of first order" in error_of(lambda: pamr.dolfinx_values(ours, u))
    wrong = np.zeros(len(ours.cells) + (COMM.rank == COMM.size - 1))  # on one rank only
    assert "found an array of shape" in error_of(lambda: pamr.dolfinx_function(ours, theirs, wrong, "cells"))
    assert 'found "edges"' in error_of(lambda: pamr.dolfinx_function(ours, theirs, wrong, "edges"))


def error_of(call):
    try:
        call()
    except pamr.Error as error:
        return str(error)
    return "no error"


run_tests(globals())
