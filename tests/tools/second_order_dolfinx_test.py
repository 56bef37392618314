# SPDX-License-Identifier: GPL-3.0-or-later
"""dolfinx reads what pamr-convert --order 2 writes for Gmsh: volume, areas by patch, the sign of every Jacobian."""
import numpy as np

from tool_run import run, run_tests


def values_in_cells(expression, mesh):
    """dolfinx 0.5 knows the mesh, 0.9 has to be told."""
    cells = np.arange(mesh.topology.index_map(3).size_local, dtype=np.int32)
    try:
        return expression.eval(mesh, cells)
    except TypeError:
        return expression.eval(cells)


def test_dolfinx_integrates_over_the_curved_cells():
    import gmsh
    import ufl
    from dolfinx import fem
    from dolfinx.io import gmshio
    from mpi4py import MPI

    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", "box.hdf", "--quiet")
    run("pamr-convert", "box.hdf", "box.msh", "--order", 2, "--quiet")
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open("box.msh")
    mesh, _, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_WORLD, 0, gdim=3)
    assert np.asarray(getattr(mesh.geometry.dofmap, "array", mesh.geometry.dofmap)).size == 10 * mesh.topology.index_map(3).size_local
    one = fem.Constant(mesh, 1.0)
    dx = ufl.Measure("dx", mesh, metadata={"quadrature_degree": 3})
    ds = ufl.Measure("ds", mesh, subdomain_data=facets, metadata={"quadrature_degree": 6})
    volume, box, sphere = (fem.assemble_scalar(fem.form(one * m)) for m in (dx, ds(1), ds(2)))
    assert np.isclose(volume, 64 - 4 * np.pi / 3, rtol=1e-4)
    assert np.isclose(box, 96, rtol=1e-13) and np.isclose(sphere, 4 * np.pi, rtol=1e-3)
    assert abs(sphere - 4 * np.pi) > 1e-6  # it is the mesh that is seen, not the sphere
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (.5, .5, 0), (.5, 0, .5), (0, .5, .5), (.25, .25, .25)], float)
    at_points = fem.Expression(ufl.JacobianDeterminant(mesh), points)
    signs = np.sign(values_in_cells(at_points, mesh))
    assert np.all(np.abs(signs.sum(axis=1)) == len(points)), "a cell that changes its sign"
    gmsh.finalize()


run_tests(globals())
