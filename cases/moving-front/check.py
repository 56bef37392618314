#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT: the histories in OUT and OUT/uniform against expected.csv; exit code 1 if a bound is missed."""
import csv
import pathlib
import sys

folder = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(folder.parent))
from bounds import all_within

INSIDE = 0.4  # until then the pulse touches no wall


def history(out):
    with open(out / "history.csv", encoding="ascii") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def error_when_leaving(rows):
    """When the pulse meets the wall, between the two rows around that."""
    before = [row for row in rows if row["time"] <= INSIDE][-1]
    after = [row for row in rows if row["time"] > INSIDE][0]
    part = (INSIDE - before["time"]) / (after["time"] - before["time"])
    return (1 - part) * before["error"] + part * after["error"]


out = pathlib.Path(sys.argv[1])
rows, uniform = history(out), history(out / "uniform")
cells = [row["cells"] for row in rows if row["time"] <= INSIDE]
measured = {
    "cells_spread": (max(cells) - min(cells)) / (sum(cells) / len(cells)),
    "cells_over_uniform": max(cells) / uniform[0]["cells"],
    "error_over_uniform": error_when_leaving(rows) / error_when_leaving(uniform),
    "mass_defect": max(abs(row["mass_defect"]) for row in rows),
    "smallest_mean_ratio": min(row["smallest_mean_ratio"] for row in rows),
    "largest_value": max(row["largest"] for row in rows),
    "last_mesh_is_level_0": float("the last mesh is level 0" in (out / "run.txt").read_text()),
}
sys.exit(0 if all_within(measured, folder / "expected.csv") else 1)
