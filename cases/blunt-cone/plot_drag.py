#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws C_D, C_L and C_m over the number of cells with 95 % bounds, beside the paper's levels and the experiment.

Usage: plot_drag.py FOLDER|recorded LEVELS -o FILE.svg|FILE.png [--studies FOLDER]

Reads flow<i>.json and quality<i>.json in FOLDER, or takes the levels of the full run that expected.csv records.
--studies adds the runs of studies.sh there whose partners are any of the cell.
"""
import argparse
import pathlib
import sys

from levels import EXPERIMENT, PAPER, Level, expected_rows

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import plots

NAMES = ("C_D", "C_L", "C_m")
STUDENT_9 = 2.262  # 97.5 % with ten groups, which the recorded levels have but for level 0 (20: 2.093)


# The next three give coefficients with their bounds, by the number of cells: [(cells, {name: (value, bound)})].
def levels_of(folder, n_levels):
    levels = [Level(folder, i) for i in range(n_levels + 1)]
    return [(level.cells, {name: (level.value(name)[0], level.bound(name)) for name in NAMES}) for level in levels]


def recorded_levels(n_levels):
    full = {(int(row["level"]), row["quantity"]): row for row in expected_rows() if row["run"] == "full"}
    return [(int(full[i, "cells"]["value"]),
             {name: (float(full[i, name]["value"]), STUDENT_9 * float(full[i, name]["stderr"])) for name in NAMES})
            for i in range(n_levels + 1)]


def any_partner_runs(folder):
    """The runs `*-any` of a folder of studies.sh; of two on one mesh the one with more particles."""
    import study_tables  # needs h5py

    runs = [study_tables.Found(folder, name.stem) for name in folder.glob("*-any.json")]
    by_cells = {run.cells: run.values for run in sorted(runs, key=lambda run: run.particles)}
    return sorted(by_cells.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("levels", type=int)
    parser.add_argument("-o", required=True)
    parser.add_argument("--studies", type=pathlib.Path)
    o = parser.parse_args()
    levels = recorded_levels(o.levels) if o.folder == "recorded" else levels_of(o.folder, o.levels)
    series = [(levels, "o-", plots.COLORS[0], "PAMR, 95 %")]
    any_partner = any_partner_runs(o.studies) if o.studies else []
    if any_partner:
        series.append((any_partner, "^-", plots.COLORS[2], "PAMR, any partner"))
    figure = plots.matplotlib.figure.Figure(figsize=(9.6, 3.4), layout="constrained")
    for i, name in enumerate(NAMES):
        axes = figure.add_subplot(1, 3, i + 1)
        for points, mark, color, label in series:
            values, bounds = zip(*(found[name] for _, found in points))
            axes.errorbar([cells for cells, _ in points], values, yerr=bounds, fmt=mark, color=color, label=label)
        axes.plot([row[0] for row in PAPER], [row[2 + i] for row in PAPER], "s--", color=plots.COLORS[1], label="the paper")
        axes.axhline(EXPERIMENT[i], color=plots.INK, lw=0.9, ls=":", label="experiment")
        axes.set_xscale("log")
        axes.set_xlabel("cells")
        axes.set_title(f"${name[0]}_{name[2]}$")
    figure.axes[2].legend(loc="center")  # between the two moments
    plots.save(figure, o.o)


if __name__ == "__main__":
    main()
