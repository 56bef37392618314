# SPDX-License-Identifier: GPL-3.0-or-later
"""PETSc DMPlex: `DMRefine` with the regular transform, uniform only: the adaptive one, `refine_sbr`, takes triangles."""
import petsc4py
from petsc4py import PETSc

import workload

petsc4py.init([])


class DMPlex:
    """A mesh is refined into a new one, edges, faces and the cells on both sides of each face included."""

    name = "PETSc DMPlex " + ".".join(map(str, PETSc.Sys.getVersion()))
    relate = None

    def start(self, n):
        cells, nodes = workload.kuhn_cube(n)
        mesh = PETSc.DMPlex().createFromCellList(3, cells.astype(PETSc.IntType), nodes, comm=PETSc.COMM_SELF)
        mesh.setRefinementUniform(True)
        return mesh

    def refine(self, mesh):
        return mesh.refine()

    def count(self, mesh):
        first, end = mesh.getHeightStratum(0)
        return end - first


workload.main(DMPlex())
