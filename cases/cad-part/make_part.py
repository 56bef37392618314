#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a CAD part with OpenCASCADE through Gmsh and meshes it: a plate with a wavy side (a spline face), a boss with a fillet
(cylinder, torus), a through hole and a spike (a cone with its apex). Lengths in millimeters.

    make_part.py FOLDER    writes part.step and part.msh
"""
import math
import os
import re
import sys

import gmsh


def spline_wire(z, amplitude):
    """A closed wire at height z: a wave near x = 40, closed beyond the plate."""
    occ = gmsh.model.occ
    wave = [occ.addPoint(40 + amplitude * math.sin(math.pi * y / 15) - 4, y, z) for y in range(-1, 32, 4)]
    wave.append(occ.addPoint(40 + amplitude * math.sin(math.pi * 31 / 15) - 4, 31, z))
    far = [occ.addPoint(50, 31, z), occ.addPoint(50, -1, z)]
    curves = [occ.addBSpline(wave), occ.addLine(wave[-1], far[0]), occ.addLine(far[0], far[1]),
              occ.addLine(far[1], wave[0])]
    return occ.addCurveLoop(curves)


def make_part():
    occ = gmsh.model.occ
    plate = occ.addBox(0, 0, 0, 40, 30, 10)
    wave = occ.addThruSections([spline_wire(-1, 1.0), spline_wire(11, 3.0)], makeSolid=True, makeRuled=True)
    part, _ = occ.cut([(3, plate)], wave)
    boss = occ.addCylinder(12, 15, 10, 0, 0, 12, 6)
    spike = occ.addCone(27, 15, 10, 0, 0, 9, 4, 0)
    part, _ = occ.fuse(part, [(3, boss), (3, spike)])
    part, _ = occ.cut(part, [(3, occ.addCylinder(6, 5, -1, 0, 0, 12, 2.5))])
    occ.synchronize()
    ring = [tag for dim, tag in gmsh.model.getEntities(1)
            if all(abs(a - b) < 1e-5 for a, b in zip(gmsh.model.getBoundingBox(1, tag), (6, 9, 10, 18, 21, 10)))]
    if len(ring) != 1:
        sys.exit(f"expected one circle at the foot of the boss, found {len(ring)}")
    occ.fillet([tag for _, tag in part], ring, [2.0])
    occ.synchronize()


def name_faces():
    """Patches of the mesh: some of one face, some of several."""
    boss, wave, spike, others = [], [], [], []
    for _, tag in gmsh.model.getEntities(2):
        kind = gmsh.model.getType(2, tag)
        low, high = gmsh.model.getBoundingBox(2, tag)[:3], gmsh.model.getBoundingBox(2, tag)[3:]
        if kind == "Cone":
            spike.append(tag)
        elif kind == "Torus" or low[2] > 11:
            boss.append(tag)
        elif kind not in ("Plane", "Cylinder", "Cone", "Torus"):
            wave.append(tag)
        else:
            others.append(tag)
    for name, tags in (("boss", boss), ("wave", wave), ("spike", spike), ("plate", others)):
        gmsh.model.addPhysicalGroup(2, tags)
        gmsh.model.setPhysicalName(2, gmsh.model.getPhysicalGroups(2)[-1][1], name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)])


def main(folder):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    make_part()
    step = os.path.join(folder, "part.step")
    gmsh.write(step)
    with open(step, encoding="ascii") as file:
        text = file.read()
    with open(step, "w", encoding="ascii") as file:  # the same bytes at any time
        file.write(re.sub(r"'\d{4}-\d\d-\d\dT[\d:]+'", "'2026-01-01T00:00:00'", text))
    gmsh.clear()
    gmsh.model.occ.importShapes(step)  # the mesh is that of the file, as anyone would make it
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMin", 1.0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 4.0)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 18)
    gmsh.model.mesh.generate(3)
    name_faces()
    gmsh.write(os.path.join(folder, "part.msh"))
    gmsh.finalize()


if __name__ == "__main__":
    main(sys.argv[1])
