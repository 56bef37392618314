# SPDX-License-Identifier: GPL-3.0-or-later
"""netgen by its wheel `netgen-mesher`: `Refine`, uniform, or bisection of marked cells, which cuts a marked cell three
times.

Both end with `UpdateTopology`, by which its users get the faces of the cells. netgen_peer.cpp has the release of
Debian.
"""

from importlib.metadata import version

import netgen.meshing
import numpy as np

import workload
from assess import FACES


def boundary_of(cells):
    """Faces of one cell, seen from outside."""
    faces = np.concatenate([cells[:, face] for face in FACES])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


class Netgen:
    """The mesh is refined in place."""

    name = "netgen " + version("netgen-mesher")
    relate = None

    def __init__(self):
        self.is_uniform = True

    def start(self, cells, nodes):
        mesh = netgen.meshing.Mesh(3)
        mesh.Add(netgen.meshing.FaceDescriptor(surfnr=1, domin=1, bc=1))
        mesh.AddPoints(np.ascontiguousarray(nodes))
        mesh.AddElements(dim=2, index=1, data=boundary_of(cells).astype(np.int32), base=0)
        # netgen's cells are oriented the other way
        mesh.AddElements(dim=3, index=1, data=np.ascontiguousarray(cells[:, [0, 2, 1, 3]], dtype=np.int32), base=0)
        return mesh

    def mark(self, mesh, flags):
        self.is_uniform = False
        mesh.Elements3D().NumPy()["refine"] = flags > 0

    def refine(self, mesh):
        mesh.Refine(adaptive=not self.is_uniform)
        return mesh

    def count(self, mesh):
        return mesh.ne

    def corners(self, mesh):
        return np.asarray(mesh.Coordinates())[mesh.Elements3D().NumPy()["nodes"][:, :4] - 1]


workload.main(Netgen())
