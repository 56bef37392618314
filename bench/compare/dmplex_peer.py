# SPDX-License-Identifier: GPL-3.0-or-later
"""PETSc DMPlex: `DMRefine` with the regular transform, uniform only: the adaptive one, `refine_sbr`, takes
triangles."""

import numpy as np
import petsc4py
from petsc4py import PETSc

import workload

petsc4py.init([])


class DMPlex:
    """A mesh is refined into a new one, edges, faces and the cells on both sides of each face included."""

    name = "PETSc DMPlex " + ".".join(map(str, PETSc.Sys.getVersion()))
    relate = None

    def start(self, cells, nodes):
        mesh = PETSc.DMPlex().createFromCellList(3, cells.astype(PETSc.IntType), nodes, comm=PETSc.COMM_SELF)
        mesh.setRefinementUniform(True)
        return mesh

    def refine(self, mesh):
        return mesh.refine()

    def count(self, mesh):
        first, end = mesh.getHeightStratum(0)
        return end - first

    def corners(self, mesh):
        first_node, end_node = mesh.getDepthStratum(0)
        nodes = mesh.getCoordinatesLocal().array.reshape(-1, 3)
        cells = np.empty((self.count(mesh), 4), dtype=np.int64)
        for cell in range(len(cells)):
            closure = mesh.getTransitiveClosure(cell)[0]
            cells[cell] = closure[(first_node <= closure) & (closure < end_node)]
        return nodes[cells - first_node]


workload.main(DMPlex())
