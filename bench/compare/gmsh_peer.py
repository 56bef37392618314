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

    def start(self, n):
        cells, nodes = workload.kuhn_cube(n)
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


workload.main(Gmsh())
