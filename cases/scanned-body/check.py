#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS: the wall of each level compared with the body without noise that the scan was made from; exit code 1 if a
level misses a bound of expected.csv."""
import json
import pathlib
import subprocess
import sys

import h5py
import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path += [str(FOLDER.parents[1] / "tools/picture"), str(FOLDER.parent)]
from bounds import bounds_of, misses  # noqa: E402
from tet import FACE_TO_CORNER  # noqa: E402

import make_body

out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
bounds = bounds_of(FOLDER / "expected.csv")


def off_body(points):
    """Distance from the body along the ray from its center."""
    radius = np.linalg.norm(points, axis=1)
    return np.abs(radius - make_body.body_radius(points / radius[:, None]))


def facets_of_scan():
    data = np.frombuffer(open(out / "scan.stl", "rb").read()[84:], dtype=np.dtype([("f", "<f4", 12), ("n", "<u2")]))
    return data["f"][:, 3:].reshape(-1, 3, 3).astype(float)


def wall(name):
    with h5py.File(name) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        names = [n.decode() for n in file["PAMR/patches/names"][:]]
        cell, slot = np.nonzero(file["PAMR/cell_to_cell"][:] < 0)
        patch = -1 - file["PAMR/cell_to_cell"][:][cell, slot]
    on_body = np.isin(patch, [i for i, n in enumerate(names) if n.startswith("body")])
    return points, cells[cell[:, None], FACE_TO_CORNER[slot]][on_body], patch[on_body]


def edges_of(points, faces, patch):
    """Edges with two faces: their ends, the angle between the faces in degrees, whether the patches differ."""
    edge = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    face = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edge[:, 1], edge[:, 0]))
    edge, face = edge[order][::2], face[order].reshape(-1, 2)
    p = points[faces]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    angle = np.degrees(np.arccos(np.clip((normal[face[:, 0]] * normal[face[:, 1]]).sum(axis=1), -1, 1)))
    return edge, angle, patch[face[:, 0]] != patch[face[:, 1]]


middles = facets_of_scan().mean(axis=1)
print(f"scan: {len(middles)} triangles, their middles off the body: mean {off_body(middles).mean():.2e}, "
      f"largest {off_body(middles).max():.2e}")
failed = False
for level in range(levels + 1):
    name = out / f"level{level}.hdf"
    report = json.loads(subprocess.run(["pamr-quality", name, "--json", "-", "--quiet"], check=True, capture_output=True).stdout)
    points, faces, patch = wall(name)
    nodes = np.unique(faces)
    plane = [np.abs(points[np.unique(faces[patch == p])] @ n - d).max() for n, d in make_body.PLANES
             for p in np.unique(patch) if np.abs(points[np.unique(faces[patch == p])] @ n - d).max() < 1e-3]
    edge, angle, parts = edges_of(points, faces, patch)
    sharp = (angle > 28) & ~parts
    groove = np.abs(points[edge[sharp].ravel()] @ np.array([0, -0.1, 1]))
    measured = {"inverted_cells": report["inverted_cells"],
                "off_surface_nodes": sum(p["off_surface_nodes"] for p in report["patches"].values()),
                "ledger_nodes": report["ledger"]["nodes"], "min_mean_ratio": report["mean_ratio"]["min"],
                "mean_off_body": off_body(points[nodes]).mean(),
                "worst_off_plane": max(plane), "worst_off_groove": groove.max()}
    print(f"level {level}: {report['cells']} cells, {len(nodes)} wall nodes, smallest mean ratio "
          f"{report['mean_ratio']['min']:.3f}, {int(sharp.sum())} edges on the groove; "
          + ", ".join(f"{k} {v:.2e}" if isinstance(v, float) else f"{k} {v}" for k, v in measured.items()))
    for text in misses(f"level {level}", measured, bounds):
        failed = True
        print("  " + text)
    if len(plane) != 2:
        failed = True
        print(f"  NOT AS EXPECTED: {len(plane)} plane patches, 2")
sys.exit(1 if failed else 0)
