#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS: each level compared with OpenCASCADE's own area and volume, and the wall nodes of the last one with the
nearest points that Gmsh finds; exit code 1 if a bound of expected.csv is missed."""
import csv
import json
import math
import pathlib
import subprocess
import sys

import gmsh
import h5py
import numpy as np

MAX_NODES = 3000  # of each patch, to be measured by Gmsh
FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
bounds = {r["quantity"]: r for r in csv.DictReader(open(pathlib.Path(__file__).parent / "expected.csv"))}
failed = False


def compare(where, measured):
    global failed
    for quantity, value in measured.items():
        row = bounds[quantity]
        if (row["at_most"] and not value <= float(row["at_most"])) or (row["at_least"] and not value >= float(row["at_least"])):
            failed = True
            print(f"  NOT AS EXPECTED: {where}: {quantity} {value:.4g} ({row['source']})")


def wall_nodes(name):
    """The nodes of each patch."""
    with h5py.File(name) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        next_to = file["PAMR/cell_to_cell"][:]
        names = [n.decode() for n in file["PAMR/patches/names"][:]]
    for patch, patch_name in enumerate(names):
        cell, slot = np.nonzero(next_to == -1 - patch)
        yield patch_name, points[np.unique(cells[cell[:, None], FACES[slot]])]


def off_faces(nodes, faces):
    """Distance of each node from the nearest of these faces, as Gmsh finds it."""
    best = np.full(len(nodes), np.inf)
    for face in faces:
        nearest = np.array(gmsh.model.getClosestPoint(2, face, nodes.ravel())[0]).reshape(-1, 3)
        best = np.minimum(best, np.linalg.norm(nodes - nearest, axis=1))
    return best


cad = json.loads((out / "convert.json").read_text())["cad"]
area = {name: sum(cad["area_of_faces"][face - 1] for face in patch["faces"]) for name, patch in cad["patches"].items()}
tolerance = max(1e-9 * cad["size"], cad["largest_edge_tolerance"])
errors = []
for level in range(levels + 1):
    report = json.loads(subprocess.run(["pamr-quality", out / f"level{level}.hdf", "--json", "-", "--quiet"], check=True,
                                       capture_output=True).stdout)
    error = {"volume": report["volume"] / cad["volume"] - 1}
    for name in sorted(area):
        error[f"area of {name}"] = report["patches"][name]["area"] / area[name] - 1
    errors.append(error)
    print(f"level {level}: {report['cells']} cells, smallest mean ratio {report['mean_ratio']['min']:.3f}, errors of "
          + ", ".join(f"{name} {value:+.2e}" for name, value in error.items()))
    compare(f"level {level}", {"inverted_cells": report["inverted_cells"], "nodes_left_off_surface": report["ledger"]["nodes"],
                               "off_surface_nodes": sum(p["off_surface_nodes"] for p in report["patches"].values())})
compare("patches", {"faces_off_shape": sum(p["off"] for p in cad["patches"].values())})
if levels > 0:
    orders = {name: math.log2(abs(errors[-2][name] / errors[-1][name])) for name in errors[-1]}
    print("orders of convergence: " + ", ".join(f"{name} {order:.2f}" for name, order in orders.items()))
    for name, order in orders.items():
        compare(name, {"order": order})
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.importShapes(str(out / "part.step"))
gmsh.model.occ.synchronize()
worst = 0
for name, nodes in wall_nodes(out / f"level{levels}.hdf"):
    chosen = nodes[:: max(1, len(nodes) // MAX_NODES)]
    worst = max(worst, off_faces(chosen, cad["patches"][name]["faces"]).max())
gmsh.finalize()
print(f"wall nodes of level {levels} by Gmsh's nearest points: at most {worst:.2e} off; tolerance {tolerance:.2e}: the larger one of "
      f"1e-9 of the size ({1e-9 * cad['size']:.2e}) and the largest tolerance of an edge ({cad['largest_edge_tolerance']:.2e})")
compare("Gmsh", {"distance_over_tolerance": worst / tolerance})
sys.exit(1 if failed else 0)
