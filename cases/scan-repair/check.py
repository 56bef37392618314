#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS: each level compared with the ring that was scanned and with expected.csv; exit code 1 if a level misses a
bound."""
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

import make_scan

out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
bounds = bounds_of(FOLDER / "expected.csv")
failed = False


def compare(where, measured):
    global failed
    for text in misses(where, measured, bounds):
        failed = True
        print("  " + text)


repair, decimate = (json.loads((out / f"{name}.json").read_text()) for name in ("repair", "decimate"))
print("repair: " + "; ".join(repair["steps"]))
compare("repair", {"faults_left": len(repair["left"]["faults"])})
compare("decimation", {"distance": max(decimate["distance"][side]["at_most"] for side in ("from_old", "to_old"))})
errors = []
for level in range(levels + 1):
    name = out / f"level{level}.hdf"
    report = json.loads(subprocess.run(["pamr-quality", name, "--json", "-", "--quiet"], check=True, capture_output=True).stdout)
    patch = report["patches"]["body"]
    with h5py.File(name) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        cell, slot = np.nonzero(file["PAMR/cell_to_cell"][:] < 0)
    off = make_scan.distance_from_ring(points[np.unique(cells[cell[:, None], FACE_TO_CORNER[slot]])])
    volume, area = report["volume"] / make_scan.VOLUME - 1, patch["area"] / make_scan.AREA - 1
    errors.append((abs(volume), abs(area)))
    print(f"level {level}: {report['cells']} cells, smallest mean ratio {report['mean_ratio']['min']:.3f}, wall nodes off the "
          f"ring: mean {np.abs(off).mean():.2e}, largest {np.abs(off).max():.2e}; volume {volume:+.2e}, area {area:+.2e}, "
          f"middles of triangles off the surface: mean {patch['triangles']['mean_distance']:.2e}")
    compare(f"level {level}", {"inverted_cells": report["inverted_cells"], "min_mean_ratio": report["mean_ratio"]["min"],
                               "off_surface_nodes": patch["off_surface_nodes"],
                               "nodes_left_off_surface": report["ledger"]["nodes"], "mean_distance_from_ring": np.abs(off).mean(),
                               "largest_distance_from_ring": np.abs(off).max()})
compare("last level", {"volume_error": errors[-1][0], "area_error": errors[-1][1]})
sys.exit(1 if failed else 0)
