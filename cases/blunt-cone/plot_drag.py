#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws C_D, C_L and C_m over the number of cells with 95 % bounds, beside the paper's levels and the experiment.

Usage: plot_drag.py FOLDER LEVELS -o FILE.svg|FILE.png    reads flow<i>.json and quality<i>.json in FOLDER.
"""
import argparse
import pathlib
import sys

from levels import EXPERIMENT, PAPER, Level

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import plots

NAMES = ("C_D", "C_L", "C_m")


def levels_of(folder, n_levels):
    """The coefficients with their bounds, by the number of cells: [(cells, {name: (value, bound)})]."""
    levels = [Level(folder, i) for i in range(n_levels + 1)]
    return [(level.cells, {name: (level.value(name)[0], level.bound(name)) for name in NAMES}) for level in levels]


def draw(series, name):
    """Each of the series: levels as levels_of gives them, mark, color, label."""
    figure = plots.matplotlib.figure.Figure(figsize=(9.6, 3.4), layout="constrained")
    for i, quantity in enumerate(NAMES):
        axes = figure.add_subplot(1, 3, i + 1)
        for points, mark, color, label in series:
            values, bounds = zip(*(found[quantity] for _, found in points))
            axes.errorbar([cells for cells, _ in points], values, yerr=bounds, fmt=mark, color=color, label=label)
        axes.plot([row[0] for row in PAPER], [row[2 + i] for row in PAPER], "s--", color=plots.COLORS[1], label="the paper")
        axes.axhline(EXPERIMENT[i], color=plots.INK, lw=0.9, ls=":", label="experiment")
        axes.set_xscale("log")
        axes.set_xlabel("cells")
        axes.set_title(f"${quantity[0]}_{quantity[2]}$")
    figure.axes[2].legend(loc="center")  # between the two moments
    plots.save(figure, name)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("levels", type=int)
    parser.add_argument("-o", required=True)
    o = parser.parse_args()
    draw([(levels_of(o.folder, o.levels), "o-", plots.COLORS[0], "PAMR, 95 %")], o.o)


if __name__ == "__main__":
    main()
