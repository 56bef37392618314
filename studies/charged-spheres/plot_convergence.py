#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the error of a quantity over the number of cells, both logarithmic, for several runs of cases/goal_loop.sh.

Usage: plot_convergence.py -o FILE.svg|FILE.png --exact VALUE --quantity PATH LABEL=FOLDER...

PATH is that of a number in the report of pamr-pb, for example forces.sphere.midplane.dimensionless.0. A thin line shows the
slope of second order, error ~ cells^(-2/3).
"""
import argparse
import json
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cases"))
import plots
from goal_levels import value_at


def read(folder, quantity, exact):
    points = []
    while os.path.exists(name := os.path.join(folder, f"solve{len(points)}.json")):
        with open(name, encoding="utf-8") as file:
            report = json.load(file)
        points.append((report["cells"], abs(value_at(report, quantity) / exact - 1)))
    return points


def draw(series):
    """The figure; `series`: label and points of each run."""
    figure, axes = plots.new_plot("cells", "relative error", (6.2, 4.4))
    for i, (label, points) in enumerate(series):
        axes.loglog(*zip(*points), plots.MARKS[i % len(plots.MARKS)] + "-", color=plots.COLORS[i % len(plots.COLORS)],
                    label=label)
    cells, error = max((points[0] for _, points in series), key=lambda point: point[1])
    far = max(n for _, points in series for n, _ in points)
    axes.loglog((cells, far), (0.7 * error, 0.7 * error * (far / cells) ** (-2 / 3)), "--", color="#999999", lw=0.9,
                label="second order")
    axes.legend()
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--exact", type=float, required=True)
    parser.add_argument("--quantity", required=True)
    parser.add_argument("runs", nargs="+", metavar="LABEL=FOLDER")
    o = parser.parse_args()
    series = []
    for run in o.runs:
        label, folder = run.split("=", 1)
        points = read(folder, o.quantity, o.exact)
        if not points:
            raise SystemExit(f"plot_convergence.py: expected solve0.json in {folder}, found none")
        series.append((label, points))
    plots.save(draw(series), o.output)


if __name__ == "__main__":
    main()
