# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh of a STEP file by Gmsh: cad_peer.py FILE SIZE. Prints a line of JSON: cells; cpu: s of reading the file and meshing;
worst and mean: the smallest mean ratio, and the mean of all."""

import json
import sys
import time

import gmsh
import numpy as np

import assess

TETRAHEDRON = 4


def main(file, size):
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMax", float(size))
    begin = time.process_time()
    gmsh.open(file)
    gmsh.model.mesh.generate(3)
    cpu = time.process_time() - begin
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    cells = gmsh.model.mesh.getElementsByType(TETRAHEDRON)[1].astype(np.int64).reshape(-1, 4)
    ratios = assess.mean_ratios(coordinates.reshape(-1, 3)[number[cells]])
    values = {"cells": len(cells), "cpu": cpu, "worst": float(ratios.min()), "mean": float(ratios.mean())}
    print(json.dumps({"peer": "Gmsh " + gmsh.option.getString("General.Version"), **values}))


main(*sys.argv[1:])
