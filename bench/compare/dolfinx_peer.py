# SPDX-License-Identifier: GPL-3.0-or-later
"""dolfinx: `mesh.refine`, Plaza and Carey's bisection of longest edges, of the marked edges or of all."""
import dolfinx
import numpy as np
import ufl
from dolfinx import mesh as dolfinx_mesh
from mpi4py import MPI

import workload


class Dolfinx:
    """A mesh is refined into a new one. `refine` needs the edges of the old one, which are made before it is timed."""

    name = f"dolfinx {dolfinx.__version__}"

    def __init__(self):
        self.marked_edges = None

    def start(self, n):
        mesh = dolfinx_mesh.create_box(MPI.COMM_SELF, [np.zeros(3), np.ones(3)], [n] * 3,
                                       dolfinx_mesh.CellType.tetrahedron)
        assert workload.is_kuhn_cube(self.corners(mesh), n), f"expected dolfinx to make the Kuhn cube K({n})"
        mesh.topology.create_entities(1)
        return mesh

    def load(self, cells, nodes):
        element = ufl.VectorElement("Lagrange", ufl.tetrahedron, 1)
        mesh = dolfinx_mesh.create_mesh(MPI.COMM_SELF, cells, nodes, ufl.Mesh(element))
        mesh.topology.create_entities(1)
        return mesh

    def mark(self, mesh, flags):
        mesh.topology.create_entities(1)
        mesh.topology.create_connectivity(3, 1)
        self.marked_edges = dolfinx_mesh.compute_incident_entities(mesh, np.flatnonzero(flags).astype(np.int32), 3, 1)

    def refine(self, mesh):
        return dolfinx_mesh.refine(mesh, self.marked_edges, redistribute=False)

    def relate(self, mesh):
        mesh.topology.create_entities(2)
        mesh.topology.create_connectivity(2, 3)
        mesh.topology.create_connectivity(3, 2)

    def count(self, mesh):
        return mesh.topology.index_map(3).size_local

    def corners(self, mesh):
        return mesh.geometry.x[mesh.geometry.dofmap.array.reshape(-1, 4)]


workload.main(Dolfinx())
