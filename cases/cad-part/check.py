#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS: each level compared with OpenCASCADE's own area and volume, and the wall nodes of the last one with the
nearest points that Gmsh finds, and by OpenFOAM's checkMesh where it is installed; exit code 1 if a bound of expected.csv is missed."""
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

import gmsh
import h5py
import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path += [str(FOLDER.parents[1] / "tools/picture"), str(FOLDER.parent)]
from bounds import bounds_of, misses  # noqa: E402
from tet import FACE_TO_CORNER  # noqa: E402

ANGLES = re.compile(r"non-orthogonality|skew|aspect ratio|wedge|two or more|underdetermined|Failed \d+ mesh check", re.I)
MAX_NODES = 3000  # of each patch, to be measured by Gmsh
out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
bounds = bounds_of(FOLDER / "expected.csv")
failed = False


def compare(where, measured):
    global failed
    for text in misses(where, measured, bounds):
        failed = True
        print("  " + text)


def wall_nodes(name):
    """The nodes of each patch."""
    with h5py.File(name) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        next_to = file["PAMR/cell_to_cell"][:]
        names = [n.decode() for n in file["PAMR/patches/names"][:]]
    for patch, patch_name in enumerate(names):
        cell, slot = np.nonzero(next_to == -1 - patch)
        yield patch_name, points[np.unique(cells[cell[:, None], FACE_TO_CORNER[slot]])]


def off_faces(nodes, faces):
    """Distance of each node from the nearest of these faces, as Gmsh finds it."""
    best = np.full(len(nodes), np.inf)
    for face in faces:
        nearest = np.array(gmsh.model.getClosestPoint(2, face, nodes.ravel())[0]).reshape(-1, 3)
        best = np.minimum(best, np.linalg.norm(nodes - nearest, axis=1))
    return best


def check_mesh(folder):
    """Complaints of OpenFOAM's checkMesh about topology and signs; nothing where it is not installed."""
    (folder / "system").mkdir(exist_ok=True)
    for name, body in {"controlDict": "application none; startFrom startTime; startTime 0; endTime 0; deltaT 1; writeControl timeStep; writeInterval 1;",
                       "fvSchemes": "gradSchemes {} divSchemes {} laplacianSchemes {}", "fvSolution": ""}.items():
        (folder / "system" / name).write_text(f"FoamFile {{ version 2.0; format ascii; class dictionary; object {name}; }}\n{body}\n")
    environment = dict(os.environ)
    if os.path.isdir("/usr/share/openfoam/etc"):  # where Debian has it
        environment.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")
    said = subprocess.run(["checkMesh", "-case", folder, "-allTopology"], capture_output=True, text=True, env=environment).stdout
    (folder / "log.checkMesh").write_text(said)
    faults = [line for line in said.splitlines() if "***" in line and not ANGLES.search(line)]
    for line in faults:
        print("  checkMesh: " + line.strip())
    return len(faults) if "End" in said else 1


cad = json.loads((out / "convert.json").read_text())["cad"]
area = {name: sum(cad["area_of_faces"][face - 1] for face in patch["faces"]) for name, patch in cad["patches"].items()}
tolerance = max(1e-9 * cad["size"], cad["largest_edge_tolerance"])
compare("patches", {"faces_off_shape": sum(p["off"] for p in cad["patches"].values())})
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.importShapes(str(out / "part.step"))
gmsh.model.occ.synchronize()
for mesh, title in (("level", "Gmsh's mesh"), ("own", "pamr-mesh's mesh")):
    print(title)
    errors = []
    for level in range(levels + 1):
        report = json.loads(subprocess.run(["pamr-quality", out / f"{mesh}{level}.hdf", "--json", "-", "--quiet"], check=True,
                                           capture_output=True).stdout)
        error = {"volume": report["volume"] / cad["volume"] - 1}
        for name in sorted(area):
            error[f"area of {name}"] = report["patches"][name]["area"] / area[name] - 1
        errors.append(error)
        print(f"level {level}: {report['cells']} cells, smallest mean ratio {report['mean_ratio']['min']:.3f}, errors of "
              + ", ".join(f"{name} {value:+.2e}" for name, value in error.items()))
        compare(f"level {level}", {"inverted_cells": report["inverted_cells"], "nodes_left_off_surface": report["ledger"]["nodes"],
                                   "off_surface_nodes": sum(p["off_surface_nodes"] for p in report["patches"].values())})
    if levels > 0:
        orders = {name: math.log2(abs(errors[-2][name] / errors[-1][name])) for name in errors[-1]}
        print("orders of convergence: " + ", ".join(f"{name} {order:.2f}" for name, order in orders.items()))
        for name, order in orders.items():
            compare(name, {"order": order})
    worst = 0
    for name, nodes in wall_nodes(out / f"{mesh}{levels}.hdf"):
        chosen = nodes[:: max(1, len(nodes) // MAX_NODES)]
        worst = max(worst, off_faces(chosen, cad["patches"][name]["faces"]).max())
    print(f"wall nodes of level {levels} by Gmsh's nearest points: at most {worst:.2e} off; tolerance {tolerance:.2e}: the larger one "
          f"of 1e-9 of the size ({1e-9 * cad['size']:.2e}) and the largest tolerance of an edge ({cad['largest_edge_tolerance']:.2e})")
    compare("Gmsh", {"distance_over_tolerance": worst / tolerance})
    if shutil.which("checkMesh"):
        compare("OpenFOAM", {"complaints_of_checkMesh": check_mesh(out / f"{mesh}_foam")})
gmsh.finalize()
sys.exit(1 if failed else 0)
