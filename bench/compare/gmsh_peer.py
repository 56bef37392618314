# SPDX-License-Identifier: GPL-3.0-or-later
"""Gmsh: `gmsh.model.mesh.refine`, the uniform split that `gmsh -refine` applies, without reading and writing files."""

import gmsh
import numpy as np

import workload

TETRAHEDRON = 4
gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 1)


class Gmsh:
    """The mesh of the one model of the process is refined in place."""

    name = "Gmsh " + gmsh.option.getString("General.Version")
    relate = None

    def start(self, cells, nodes):
        gmsh.clear()
        volume = gmsh.model.addDiscreteEntity(3)
        gmsh.model.mesh.addNodes(3, volume, np.arange(1, len(nodes) + 1), nodes.ravel())
        gmsh.model.mesh.addElementsByType(volume, TETRAHEDRON, np.arange(1, len(cells) + 1), cells.ravel() + 1)
        return volume

    def refine(self, volume):
        gmsh.model.mesh.refine()
        return volume

    def count(self, volume):
        return len(gmsh.model.mesh.getElementsByType(TETRAHEDRON, volume)[0])

    def corners(self, volume):
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        number[tags.astype(np.int64)] = np.arange(len(tags))
        cells = gmsh.model.mesh.getElementsByType(TETRAHEDRON, volume)[1].astype(np.int64).reshape(-1, 4)
        return coordinates.reshape(-1, 3)[number[cells]]


workload.main(Gmsh())
