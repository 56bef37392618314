# SPDX-License-Identifier: GPL-3.0-or-later
"""dolfinx: `mesh.refine`, Plaza and Carey's bisection of longest edges, of the marked edges or of all.

Written for 0.9 and later.
"""

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import mesh as dolfinx_mesh
from mpi4py import MPI

import workload


def linear_tetrahedron():
    return ufl.Mesh(basix.ufl.element("Lagrange", "tetrahedron", 1, shape=(3,)))


class Dolfinx:
    """A mesh is refined into a new one. `refine` needs the edges of the old one, which are made before it is timed."""

    name = f"dolfinx {dolfinx.__version__}"

    def __init__(self):
        self.marked_edges = None

    def start(self, cells, nodes):
        mesh = dolfinx_mesh.create_mesh(MPI.COMM_SELF, cells, linear_tetrahedron(), nodes)
        mesh.topology.create_entities(1)
        return mesh

    def mark(self, mesh, flags):
        mesh.topology.create_entities(1)
        mesh.topology.create_connectivity(3, 1)
        self.marked_edges = dolfinx_mesh.compute_incident_entities(
            mesh.topology, np.flatnonzero(flags > 0).astype(np.int32), 3, 1
        )

    def refine(self, mesh):
        return dolfinx_mesh.refine(mesh, self.marked_edges)[0]

    def relate(self, mesh):
        mesh.topology.create_entities(2)
        mesh.topology.create_connectivity(2, 3)
        mesh.topology.create_connectivity(3, 2)

    def count(self, mesh):
        return mesh.topology.index_map(3).size_local

    def corners(self, mesh):
        return mesh.geometry.x[np.asarray(mesh.geometry.dofmap).reshape(-1, 4)]


workload.main(Dolfinx())
