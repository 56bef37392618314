#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""measure.py OUT FIRST NAME...: the shock of the runs OUT/NAME-SEED/, as many seeds as there are folders, from step FIRST on.

In every window a step n1 + (n2 - n1) / (1 + exp(4 (x - X) / d)) is fitted to the density of the cells beyond the layer at the wall: X is
the place of the shock, d its thickness by the largest slope. The speed is that of a straight line through the X of all windows from
step FIRST on; n2 and d are means over these windows. The temperature behind is that of all molecules between the layer and the shock,
the pressure that on the wall (--history), over the same windows. Errors are those of the means of the seeds; +-: bounds of 95 %.

Prints each number beside the closed form; writes OUT/NAME.csv (time, X of each seed). Exit code 1 if one of a row of expected.csv is
missed: off by more than four standard errors, or its standard error larger than the row allows."""
import csv
import math
import pathlib
import sys
import tomllib

import h5py
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from bounds import student_95  # noqa: E402

BOLTZMANN, MASS = 1.380649e-23, 6.63e-26
WALL_LAYER = 0.15  # m: what the start has left at the wall
AHEAD = 0.12  # m: half of what belongs to the shock

folder = pathlib.Path(__file__).resolve().parent
out, first = pathlib.Path(sys.argv[1]), int(sys.argv[2])


def cells_of(file):
    with h5py.File(file) as f:
        points, corners = f["VTKHDF/Points"][:], f["VTKHDF/Connectivity"][:].reshape(-1, 4)
        data = {key: f[f"VTKHDF/CellData/{key}"][:] for key in ("n", "u", "T_tr", "particles")}
    p = points[corners]
    data["volume"] = np.abs(np.einsum("ij,ij->i", p[:, 1] - p[:, 0], np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 0]))) / 6
    data["x"] = p.mean(axis=1)[:, 0]
    return data


def fitted(x, n, weight, place, height, width):
    """Place, height and thickness of the step from 1 through n(x), by Gauss and Newton."""
    for _ in range(40):
        e = np.exp(np.clip(4 * (x - place) / width, -60, 60))
        f = 1 / (1 + e)
        slope = f * (1 - f)
        jacobian = np.stack([height * slope * 4 / width, f, height * slope * 4 * (x - place) / width**2], axis=1)
        change = np.linalg.lstsq(jacobian * weight[:, None], (n - 1 - height * f) * weight, rcond=None)[0]
        place, height, width = place + np.clip(change[0], -0.05, 0.05), height + change[1], abs(width + np.clip(change[2], -0.02, 0.02))
        if abs(change[0]) < 1e-7:
            break
    return place, height, width


def temperature_behind(windows, case):
    """Of all molecules behind the shock, about their mean velocity."""
    count = energy = 0
    momentum = np.zeros(3)
    for data, place in windows:
        here = (data["x"] > WALL_LAYER) & (data["x"] < place - AHEAD) & (data["particles"] > 0)
        n, u, t = data["particles"][here], data["u"][here], data["T_tr"][here]
        samples = n * case["run"]["window"]
        thermal = 3 * BOLTZMANN / MASS * t * np.maximum(samples - 1, 0) / samples
        count += n.sum()
        momentum += (n[:, None] * u).sum(axis=0)
        energy += (n * (thermal + (u**2).sum(axis=1))).sum()
    return (energy / count - ((momentum / count)**2).sum()) * MASS / (3 * BOLTZMANN)


def run_of(path, case, n1):
    dt, window = case["time"]["step"], case["run"]["window"]
    files = sorted(path.glob("window-*.hdf"))
    rows, kept, cells = [], [], []
    place, height, width = 0.0, 2.0, 0.08
    for file in files:
        data = cells_of(file)
        cells.append(len(data["x"]))
        step = int(file.stem.split("-")[-1])
        if step < first:
            continue
        if not rows:  # begin where the molecules are that came in
            place = (data["n"] - n1) @ data["volume"] / (2 * n1) / case["reference"]["area"]
        beyond = data["x"] > WALL_LAYER
        place, height, width = fitted(data["x"][beyond], data["n"][beyond] / n1, np.sqrt(data["volume"][beyond]), place, height, width)
        rows.append(((step - 0.5 * window) * dt, place, 1 + height, width))
        kept.append((data, place))
    time, where, behind, width = np.array(rows).T
    with open(path / "history.csv") as f:
        drag = [float(r["C_D"]) for r in csv.DictReader(f) if int(r["step"]) > first]
    rho, speed = n1 * MASS, np.linalg.norm(case["stream"]["free"]["velocity"])
    return {"speed": np.polyfit(time, where, 1)[0], "n2/n1": behind.mean(), "T2/T1": temperature_behind(kept, case) / case["stream"]["free"]["temperature"],
            "p2/p1": np.mean(drag) * 0.5 * rho * speed**2 / (n1 * BOLTZMANN * case["stream"]["free"]["temperature"]),
            "thickness": width.mean(), "cells": np.mean(cells)}, time, where


with open(folder / "expected.csv") as file:
    expected = {(r["run"], r["quantity"]): r for r in csv.DictReader(file)}
failed = False
for name in sys.argv[3:]:
    paths = sorted(path for path in out.glob(f"{name}-[0-9]*") if path.is_dir())
    case = tomllib.loads((paths[0] / "case.toml").read_text())
    n1 = case["stream"]["free"]["density"]
    results, places = [], []
    for path in paths:
        result, time, where = run_of(path, case, n1)
        results.append(result)
        places.append(where)
    print(f"{name}: {len(paths)} runs, {results[0]['cells']:.0f} cells on average")
    for quantity in ("speed", "n2/n1", "T2/T1", "p2/p1", "thickness"):
        values = np.array([r[quantity] for r in results])
        error = values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else math.nan
        line = f"  {quantity:10} {values.mean():9.4f} +- {student_95(len(values)) * error:.4f}"
        if row := expected.get((name, quantity)):
            value, most = float(row["value"]), float(row["largest_error"])
            good = error <= most * value and abs(values.mean() - value) <= 4 * error + float(row["allowed"]) * value
            failed = failed or not good
            line += f"  expected {value:9.4f}  {100 * (values.mean() / value - 1):+.2f} %  {'ok' if good else 'NOT AS EXPECTED'}"
        print(line)
    with open(out / f"{name}.csv", "w") as file:
        file.write("time" + "".join(f",X{i + 1}" for i in range(len(places))) + "\n")
        file.writelines(",".join(f"{v:.6g}" for v in row) + "\n" for row in zip(time, *places))
sys.exit(1 if failed else 0)
