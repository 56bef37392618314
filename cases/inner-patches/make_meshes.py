#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""make_meshes.py OUT: ball.msh, a ball of radius 0.5 m in a box of 2 m, two regions with the surface between them as a group; sheet.msh,
a box of 2 m with a rectangle of 1 x 0.8 m inside, in one region; assembly.step, three solids: a box of 2 mm, a ball of radius 0.5 mm
inside, and a can of radius 0.4 mm that stands on the box. Numbers of groups are not those that Gmsh would give."""
import pathlib
import sys

import gmsh

out = pathlib.Path(sys.argv[1])
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ, model = gmsh.model.occ, gmsh.model


def group(dimension, entities, number, name):
    model.addPhysicalGroup(dimension, entities, number)
    model.setPhysicalName(dimension, number, name)


def size(edge):
    gmsh.option.setNumber("Mesh.MeshSizeMin", edge)
    gmsh.option.setNumber("Mesh.MeshSizeMax", edge)


model.add("ball")
box, ball = occ.addBox(-1, -1, -1, 2, 2, 2), occ.addSphere(0, 0, 0, 0.5)
occ.fragment([(3, box)], [(3, ball)])
occ.synchronize()
volumes = {abs(occ.getMass(3, tag) - 0.5236) < 0.01: tag for _, tag in model.getEntities(3)}
interface = [tag for _, tag in model.getBoundary([(3, volumes[True])], oriented=False)]
sides = [tag for _, tag in model.getEntities(2) if tag not in interface]
group(3, [volumes[True]], 21, "ball")
group(3, [volumes[False]], 23, "rest")
group(2, interface, 17, "interface")
group(2, sides, 11, "sides")
size(0.25)
model.mesh.generate(3)
gmsh.write(str(out / "ball.msh"))

model.add("sheet")
box, sheet = occ.addBox(-1, -1, -1, 2, 2, 2), occ.addRectangle(-0.5, -0.4, 0, 1, 0.8)
_, parts = occ.fragment([(3, box)], [(2, sheet)])
occ.synchronize()
inside = [tag for dim, tag in parts[1] if dim == 2]
sides = [tag for _, tag in model.getEntities(2) if tag not in inside]
lid = [tag for tag in sides if abs(occ.getCenterOfMass(2, tag)[2] - 1) < 1e-9]
group(3, [tag for _, tag in model.getEntities(3)], 5, "gas")
group(2, inside, 7, "sheet")
group(2, lid, 12, "lid")
group(2, [tag for tag in sides if tag not in lid], 3, "sides")
size(0.25)
model.mesh.generate(3)
gmsh.write(str(out / "sheet.msh"))

model.add("assembly")
occ.addBox(-1, -1, -1, 2, 2, 2)
occ.addSphere(0, 0, 0, 0.5)
occ.addCylinder(0, 0, 1, 0, 0, 0.8, 0.4)
occ.synchronize()
gmsh.write(str(out / "assembly.step"))
gmsh.finalize()
