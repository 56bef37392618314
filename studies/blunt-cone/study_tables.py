# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the studies of the blunt cone, in markdown; all +- are bounds of 95 %."""
import csv
import json
import math
import re
import statistics

import h5py
import numpy as np

COEFFICIENTS = ("C_D", "C_L", "C_m", "C_H")
DENSITY = 1.116e21
NOSE = 4e-3  # radius of the cap over which the heat of the nose is a mean, m
CONE = (4.3e-3, 24e-3)  # the cone lies between these distances from the axis
CONE_END = 7.99e-3  # and before this x
STUDENT_7, CHI2_7 = 2.365, (1.690, 16.013)  # 7 degrees of freedom: 97.5 %; 2.5 and 97.5 %


class Found:
    """What a run gave."""

    def __init__(self, folder, name):
        with open(folder / f"{name}.json", encoding="utf-8") as file:
            self.report = json.load(file)
        self.name, self.particles = name, self.report["particles"]
        wall = name.replace("flow", "wall") if name.startswith("flow") else name
        self.values = {c: (self.report[c]["value"], self.report[c]["ci95"]) for c in COEFFICIENTS}
        student = self.report["averages"]["student_95"]
        self.values["nose"] = heat(folder / f"{wall}.vtu", 0, NOSE, student)
        self.cone = heat(folder / f"{wall}.vtu", *CONE, student)
        self.flow = folder / f"{name}.hdf"
        self.cells = int(h5py.File(self.flow, "r")["VTKHDF/NumberOfCells"][0])

    def text(self):
        digits = {"nose": 1}
        return " | ".join(f"{v:.{digits.get(c, 4)}f} +- {e:.{digits.get(c, 4)}f}" for c, (v, e) in self.values.items())


def heat(name, low, high, student):
    """Mean heat flux of the fore-body between two distances from the axis, kW/m2, and its bound; faces count as independent."""
    text = name.read_text(encoding="utf-8")

    def array(title):
        return np.array(re.search(f'Name="{title}"[^>]*>([^<]*)<', text).group(1).split(), float)

    middle = array("Points").reshape(-1, 3)[array("connectivity").astype(int).reshape(-1, 3)].mean(axis=1)
    radius = np.hypot(middle[:, 1], middle[:, 2])
    near = (radius >= low) & (radius < high) & (middle[:, 0] < CONE_END)
    area, q, error = (array(title)[near] for title in ("area", "q", "q_stderr"))
    return ((area * q).sum() / area.sum() / 1e3, student * math.sqrt(((area * error) ** 2).sum()) / area.sum() / 1e3)


def table(head, rows):
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(map(str, row)) + " |")
    print()


def signed(value, error, digits):
    return f"{value:+.{digits}f} +- {error:.{digits}f}"


def change(after, before, factor=1.0):
    """Differences of the values of two runs, times a factor, with bounds."""
    return " | ".join(signed(factor * (after.values[c][0] - before.values[c][0]),
                             abs(factor) * math.hypot(after.values[c][1], before.values[c][1]), 1 if c == "nose" else 4)
                      for c in after.values)


def seeds(found):
    """The spread of the seeds beside the errors that they state."""
    runs = [found[name] for name in sorted(found) if "-seed" in name]
    if len(runs) < 3:
        return
    n = len(runs)
    print(f"{n} seeds of {runs[0].particles} particles\n")
    rows = []
    for c in COEFFICIENTS:
        values = [run.values[c][0] for run in runs]
        spread = statistics.stdev(values)
        stated = math.sqrt(statistics.mean(run.report[c]["stderr"] ** 2 for run in runs))
        mean = statistics.mean(values)
        inside = sum(abs(value - mean) <= run.values[c][1] for value, run in zip(values, runs))
        rows.append((c, f"{mean:.4f} +- {STUDENT_7 * spread / math.sqrt(n):.4f}", f"{spread:.5f}", f"{stated:.5f}",
                     f"{spread / stated:.2f}", f"{inside} of {n}"))
    low, high = (math.sqrt(v / 7) for v in CHI2_7)
    table(("", "mean", "spread of the seeds", "stated standard error", f"ratio (95 % of chance: {low:.2f} to {high:.2f})",
           "within the bound of the mean"), rows)


def memory(folder, levels):
    """Whether the averaged blocks of a level remember each other: correlation of neighbors, and standard errors from single
    blocks, pairs and fives, which would grow if they did."""
    rows = []
    for level in levels:
        with open(folder / f"history{level}.csv", encoding="utf-8") as file:
            blocks = [row for row in csv.DictReader(file) if row["averaged"] == "1"]
        for c in COEFFICIENTS:
            values = np.array([float(row[c]) for row in blocks])
            if len(values) < 10:
                continue
            off = values - values.mean()
            errors = []
            for size in (1, 2, 5):
                groups = values[: len(values) // size * size].reshape(-1, size).mean(axis=1)
                errors.append(f"{groups.std(ddof=1) / math.sqrt(len(groups)):.5f}")
            rows.append((level, c, len(values), f"{(off[1:] * off[:-1]).sum() / (off**2).sum():+.2f}", *errors))
    table(("level", "", "blocks", "correlation of neighbors", "standard error from blocks", "pairs", "fives"), rows)


def sizes(folder, levels):
    """Cell sizes over the local mean free path, separations and collision probabilities of the recorded levels."""
    rows = []
    for level in levels:
        cell = h5py.File(folder / f"flow{level}.hdf", "r")
        data = cell["VTKHDF/CellData"]
        ratio = 1 / data["Kn_cell"][:]
        dense = (data["n"][:] > 1.05 * DENSITY) & (ratio > 1e-20)
        wall = (cell["PAMR/cell_to_cell"][:] == -1).any(axis=1) & (ratio > 1e-20)  # patch 0, the fore-body
        for where, which in (("denser than 1.05 n_inf", dense), ("at the fore-body", wall)):
            if not which.any():
                continue
            r = ratio[which]
            rows.append((level, where, int(which.sum()), *(f"{np.quantile(r, p):.2f}" for p in (0.5, 0.9, 0.99, 1)),
                         f"{np.median(data['particles'][:][which]):.1f}",
                         f"{np.median(data['separation_over_lambda'][:][which]):.2f}",
                         " ".join(f"{np.quantile(data['collision_probability'][:][which], p):.2f}" for p in (0.5, 0.9))))
    table(("level", "cells", "number", "size / lambda: half below", "90 %", "99 %", "largest", "particles a cell, median",
           "separation / lambda, median", "collisions of a particle a step, median, 90 %"), rows)


def cone_heat(found):
    """Heat of the conical part of the fore-body beside what the gas at it sees: means over collisions in the cells there."""
    rows = []
    for name, f in found.items():
        cell = h5py.File(f.flow, "r")
        data = {key: value[:] for key, value in cell["VTKHDF/CellData"].items() if value.ndim == 1}
        points = cell["VTKHDF/Points"][:][cell["VTKHDF/Connectivity"][:].reshape(-1, 4)]
        edges = points[:, 1:] - points[:, :1]
        collisions = data["n"] / data["tau_c"] * np.abs(np.linalg.det(edges))
        radius = np.hypot(*points.mean(axis=1)[:, 1:].T)
        there = (cell["PAMR/cell_to_cell"][:] == -1).any(axis=1) & (radius > CONE[0]) & (radius < CONE[1])
        there &= data["tau_c"] < 1e29

        def mean(key, there=there, data=data, collisions=collisions):
            return np.average(data[key][there], weights=collisions[there])

        size = np.average(1 / data["Kn_cell"][there], weights=collisions[there])
        rows.append((name, f.cells, f.particles, f"{mean('separation_over_lambda'):.2f}", f"{size:.2f}",
                     f"{mean('collision_probability'):.2f}", f"{f.cone[0]:.3f} +- {f.cone[1]:.3f}"))
    table(("run", "cells", "particles", "separation / lambda", "size / lambda", "collisions of a particle a step",
           "heat of the cone, kW/m2"), rows)


def recorded(folder):
    """The levels of a run of run.sh."""
    levels = [i for i in range(5) if all((folder / file).exists() for file in (f"flow{i}.json", f"wall{i}.vtu"))]
    return {f"level {level}": Found(folder, f"flow{level}") for level in levels}


def print_all(runs, folders):
    found = {run.name: Found(folders.out, run.name) for run in runs if (folders.out / f"{run.name}.json").exists()}
    found |= recorded(folders.full)
    head = ("C_D", "C_L", "C_m", "C_H", "nose, kW/m2")
    table(("run", "cells", "particles", "averaged steps", *head),
          [(name, f.cells, f.particles, f.report["steps"] - f.report["averages_from_step"], f.text())
           for name, f in found.items()])
    seeds(found)
    rows = [(what, change(found[after], found[before], factor)) for what, after, before, factor in CHANGES
            if after in found and before in found]
    table(("change", *head), rows)
    cone_heat(found)
    memory(folders.full, [level for level in range(5) if f"level {level}" in found])
    sizes(folders.full, [level for level in range(5) if f"level {level}" in found])


# what, after, before, factor
CHANGES = (
    ("level 0: twice the particles (0.25 to 0.5 million)", "l0-500k", "l0-250k", 1),
    ("level 0: 5 times the particles (0.5 to 2.5 million)", "level 0", "l0-500k", 1),
    ("level 0: half the step", "l0-250k-half-step", "l0-250k", 1),
    ("level 0: twice the step", "l0-250k-double-step", "l0-250k", 1),
    ("level 0: cells half as large, same steps and weights", "l0-halved-500k", "l0-500k", 1),
    ("level 0: any partner", "l0-250k-any", "l0-250k", 1),
    ("level 1: any partner", "l1-380k-any", "l1-380k", 1),
    ("level 2: any partner", "l2-950k-any", "l2-950k", 1),
    ("level 1: any partner, the paper's particles", "l1-560k-any", "level 1", 1),
    ("level 2: any partner, the paper's particles", "l2-5880k-any", "level 2", 1),
    ("level 3: any partner, the paper's particles", "l3-11100k-any", "level 3", 1),
    ("level 1: twice the particles (0.38 to 0.76 million)", "l1-760k", "l1-380k", 1),
    ("level 1: 5 times the particles (0.38 to 1.95 million)", "level 1", "l1-380k", 1),
    ("level 2: 4 times the particles (0.95 to 3.8 million)", "level 2", "l2-950k", 1),
    ("level 0: outer radius 90 mm", "wide", "l0-250k", 1),
)
