# SPDX-License-Identifier: GPL-3.0-or-later
"""MFEM by PyMFEM: conforming bisection of marked tetrahedra.

A marked tetrahedron is bisected three times, which halves all of its edges, in the one call (`GeneralRefinement`); all
of them are refined by `UniformRefinement`, into eight. Edges, faces and the cells on both sides of each face are part
of the call. mfem_nonconforming_peer.py has the other way.
"""

import mfem
import mfem.ser
import numpy as np

import workload


class Mfem:
    """The mesh is refined in place."""

    name = f"MFEM {mfem.__version__}"
    relate = None

    def __init__(self):
        self.marked = None

    def start(self, cells, nodes):
        mesh = mfem.ser.Mesh(3, len(nodes), len(cells))
        for node in nodes.tolist():
            mesh.AddVertex(*node)
        for cell in cells.tolist():
            mesh.AddTet(*cell)
        mesh.FinalizeTetMesh(1, 1, True)  # with edges, marked for bisection of the longest, oriented
        return mesh

    def mark(self, _, flags):
        self.marked = mfem.ser.intArray(np.flatnonzero(flags > 0).tolist())

    def refine(self, mesh):
        if self.marked is None:
            mesh.UniformRefinement()
        else:
            mesh.GeneralRefinement(self.marked, 0)
        return mesh

    def count(self, mesh):
        return mesh.GetNE()

    def corners(self, mesh):
        coordinates, cell_nodes, attributes = mfem.ser.Vector(), mfem.ser.intArray(), mfem.ser.intArray()
        mesh.GetVertices(coordinates)
        mesh.GetElementData(mfem.ser.Geometry.TETRAHEDRON, cell_nodes, attributes)
        nodes = coordinates.GetDataArray().reshape(3, -1).T
        return nodes[cell_nodes.GetDataArray().reshape(-1, 4)]


if __name__ == "__main__":
    workload.main(Mfem())
