# SPDX-License-Identifier: GPL-3.0-or-later
"""A box of side 4 with a round hole of radius 1 in the middle by Gmsh: hole_mesh.py SIZE OUT.msh (format 2.2, text)."""

import sys

import gmsh

HALF_SIDE = 2


def main(size, target):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    box = gmsh.model.occ.addBox(*[-HALF_SIDE] * 3, *[2 * HALF_SIDE] * 3)
    ball = gmsh.model.occ.addSphere(0, 0, 0, 1)
    gmsh.model.occ.cut([(3, box)], [(3, ball)])
    gmsh.model.occ.synchronize()
    wall, outer = [], []
    for dimension, tag in gmsh.model.getEntities(2):
        (wall if gmsh.model.getType(dimension, tag) == "Sphere" else outer).append(tag)
    for name, tags in (("wall", wall), ("outer", outer)):
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="gas")
    gmsh.option.setNumber("Mesh.MeshSizeMax", float(size))
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    gmsh.model.mesh.generate(3)
    gmsh.write(target)


main(*sys.argv[1:])
