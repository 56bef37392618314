#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT SHORT: the tables of a run compared with expected.csv; exit code 1 if a quantity is out of its bounds."""
import csv
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from bounds import all_within  # noqa: E402

out, short = pathlib.Path(sys.argv[1]), sys.argv[2] == "yes"


def table(name):
    with open(out / f"{name}.csv", encoding="ascii") as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def rate(rows, norm):
    """Of the error against the unknowns, by least squares over the last rows that are no longer coarse."""
    rows = [row for row in rows if row["unknowns"] > 500][-4:]
    x, y = ([math.log(row[key]) for row in rows] for key in ("unknowns", norm))
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return -sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)


def error_at(rows, unknowns, norm):
    """The error that a run has with so many unknowns, between two levels of it."""
    for a, b in zip(rows, rows[1:]):
        if a["unknowns"] <= unknowns <= b["unknowns"]:
            part = math.log(unknowns / a["unknowns"]) / math.log(b["unknowns"] / a["unknowns"])
            return a[norm] ** (1 - part) * b[norm] ** part
    return math.nan


def gain(adaptive, uniform):
    """How much larger the error of the gradient is with uniform refinement, for the most unknowns that both have."""
    unknowns = min(adaptive[-1]["unknowns"], uniform[-1]["unknowns"])
    return error_at(uniform, unknowns, "h1") / error_at(adaptive, unknowns, "h1")


edge, alone, uniform = table("edge"), table("edge-alone"), table("edge-uniform")
fichera, ball, flat = table("fichera"), table("ball"), table("ball-no-project")
measured = {
    "cells_of_independent_runs": max(abs(a["cells"] / b["cells"] - 1) for a, b in zip(edge, alone)),
    "recorded_marks_differ": len({(out / f"recorded-{n}.hdf").read_bytes() for n in (1, 2, 3)}) - 1,
    "ball_off_sphere": ball[-1]["off_wall"],
    "ball_no_project_off_sphere": flat[-1]["off_wall"],
    "min_mean_ratio": min(row["min_mean_ratio"] for rows in (edge, fichera, ball) for row in rows),
}
if not short:
    measured |= {
        "edge_gradient_rate": rate(edge, "h1"),
        "edge_l2_rate": rate(edge, "l2"),
        "edge_uniform_gradient_rate": rate(uniform[-3:], "h1"),
        "edge_uniform_l2_rate": rate(uniform[-3:], "l2"),
        "edge_gradient_uniform_over_adaptive": gain(edge, uniform),
        "fichera_gradient_rate": rate(fichera, "h1"),
        "fichera_gradient_uniform_over_adaptive": gain(fichera, table("fichera-uniform")),
        "ball_l2_rate": rate(ball, "l2"),
        "ball_gradient_rate": rate(ball, "h1"),
        "ball_no_project_l2_rate": rate(flat[-3:], "l2"),
        "ball_no_project_l2_over_projected": flat[-1]["l2"] / ball[-1]["l2"],
    }
sys.exit(0 if all_within(measured, pathlib.Path(__file__).parent / "expected.csv") else 1)
