# SPDX-License-Identifier: GPL-3.0-or-later
"""What the reference values by dolfinx and Gmsh share (Debian packages python3-dolfinx-real and python3-gmsh; dolfinx 0.5)."""
import gmsh
from dolfinx import fem
from dolfinx.io import gmshio
from mpi4py import MPI
from petsc4py import PETSc


def make_curved_mesh():
    """Curved cells of the current model of Gmsh, whose sizes come from its field alone, and its tagged faces; ends Gmsh."""
    for name in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber("Mesh.MeshSize" + name, 0)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.model.mesh.optimize("HighOrder")
    mesh, _, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0)
    gmsh.finalize()
    return mesh, facets


def solve(form, right, conditions, space):
    matrix = fem.petsc.assemble_matrix(fem.form(form), conditions)
    matrix.assemble()
    vector = fem.petsc.assemble_vector(fem.form(right))
    fem.petsc.apply_lifting(vector, [fem.form(form)], [conditions])
    fem.petsc.set_bc(vector, conditions)
    solver = PETSc.KSP().create(MPI.COMM_SELF)
    solver.setOperators(matrix)
    solver.setType("cg")
    solver.getPC().setType("icc")
    solver.setTolerances(rtol=1e-11, max_it=5000)
    result = fem.Function(space)
    solver.solve(vector, result.vector)
    return result
