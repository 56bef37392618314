#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws C_D, C_L and C_m over the number of cells with 95 % bounds, beside the paper's levels and the experiment.

Usage: plot_drag.py FOLDER LEVELS -o FILE.svg|FILE.png    reads flow<i>.json and quality<i>.json in FOLDER
"""
import argparse
import pathlib
import sys

from levels import EXPERIMENT, PAPER, Level

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import plots


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("levels", type=int)
    parser.add_argument("-o", required=True)
    o = parser.parse_args()
    levels = [Level(o.folder, i) for i in range(o.levels + 1)]
    figure = plots.matplotlib.figure.Figure(figsize=(9.6, 3.4), layout="constrained")
    for i, name in enumerate(("C_D", "C_L", "C_m")):
        axes = figure.add_subplot(1, 3, i + 1)
        axes.errorbar([level.cells for level in levels], [level.value(name)[0] for level in levels],
                      yerr=[level.bound(name) for level in levels], fmt="o-", color=plots.COLORS[0], label="PAMR, 95 %")
        axes.plot([row[0] for row in PAPER], [row[2 + i] for row in PAPER], "s--", color=plots.COLORS[1], label="the paper")
        axes.axhline(EXPERIMENT[i], color=plots.INK, lw=0.9, ls=":", label="experiment")
        axes.set_xscale("log")
        axes.set_xlabel("cells")
        axes.set_title(f"${name[0]}_{name[2]}$")
        if i == 0:
            axes.legend()
    plots.save(figure, o.o)


if __name__ == "__main__":
    main()
