#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for balance.sh that the tools do not make.

    make_meshes.py shuffle MESH.hdf OUT.hdf    the cells and nodes of a level-0 mesh renumbered at random
    make_meshes.py BODY OUT.msh                a body meshed by Gmsh (python3-gmsh): torus, holes, plate
"""
import shutil
import sys


def shuffle(source, target):
    import h5py
    import numpy as np

    random = np.random.default_rng(1)
    shutil.copy(source, target)
    with h5py.File(target, "r+") as file:
        vtk, ours = file["VTKHDF"], file["PAMR"]
        cells = random.permutation(len(ours["lineage"]))
        nodes = random.permutation(len(vtk["Points"]))
        new_cell, new_node = np.argsort(cells), np.argsort(nodes)
        neighbors = ours["cell_to_cell"][:][cells]
        ours["cell_to_cell"][:] = np.where(neighbors >= 0, new_cell[neighbors], neighbors)
        ours["lineage"][:] = ours["lineage"][:][cells]
        vtk["Points"][:] = vtk["Points"][:][nodes]
        vtk["Connectivity"][:] = new_node[vtk["Connectivity"][:].reshape(-1, 4)[cells]].ravel()
        for data, order in (("CellData", cells), ("PointData", nodes)):
            for field in vtk.get(data, {}).values():
                field[:] = field[:][order]
        for name in list(ours["checksums"].attrs):
            del ours["checksums"].attrs[name]


def torus(occ):
    occ.addTorus(0, 0, 0, 1, 0.3)
    return 0.08


def holes(occ):
    """A block with two holes."""
    box = occ.addBox(0, 0, 0, 2, 1, 1)
    occ.cut([(3, box)], [(3, occ.addCylinder(x, 0.5, -1, 0, 0, 3, 0.2)) for x in (0.5, 1.5)])
    return 0.06


def plate(occ):
    """A thin plate with a hole, two or three cells thick."""
    box = occ.addBox(0, 0, 0, 4, 4, 0.15)
    occ.cut([(3, box)], [(3, occ.addCylinder(2, 2, -1, 0, 0, 3, 0.7))])
    return 0.09


def mesh_by_gmsh(body, target):
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    size = {"torus": torus, "holes": holes, "plate": plate}[body](gmsh.model.occ)
    gmsh.model.occ.synchronize()
    for dimension in (3, 2):
        gmsh.model.addPhysicalGroup(dimension, [tag for _, tag in gmsh.model.getEntities(dimension)])
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(3)
    gmsh.write(target)
    gmsh.finalize()


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "shuffle":
        shuffle(*sys.argv[2:])
    elif len(sys.argv) == 3 and sys.argv[1] in ("torus", "holes", "plate"):
        mesh_by_gmsh(*sys.argv[1:])
    else:
        sys.exit(__doc__)
