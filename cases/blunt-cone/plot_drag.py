#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws C_D, C_L and C_m over the number of cells with 95 % bounds, beside the paper's levels and the experiment.

Usage: plot_drag.py FOLDER|recorded LEVELS -o FILE.svg|FILE.png [--studies FOLDER]

Reads flow<i>.json and quality<i>.json in FOLDER, or takes the levels of the full run that expected.csv records.
--studies adds the runs of studies.sh there whose partners are any of the cell.
"""
import argparse
import csv
import pathlib
import sys

from levels import EXPERIMENT, PAPER, Level

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import plots

STUDENT_9 = 2.262  # 97.5 % with ten groups


class Recorded:
    """A level of the full run as expected.csv has it: what `Level` has of a run."""

    def __init__(self, level):
        with open(pathlib.Path(__file__).parent / "expected.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.rows = {row["quantity"]: row for row in rows if row["run"] == "full" and int(row["level"]) == level}
        self.cells = int(self.rows["cells"]["value"])

    def value(self, name):
        return float(self.rows[name]["value"]), float(self.rows[name]["stderr"])

    def bound(self, name):
        return STUDENT_9 * float(self.rows[name]["stderr"])


def any_partner_runs(folder):
    """The runs `*-any` of a folder of studies.sh, by their number of cells; of two on one mesh the one with more particles."""
    import study_tables  # needs h5py

    best = {}
    for name in sorted(folder.glob("*-any.json")):
        run = study_tables.Found(folder, name.stem)
        if run.cells not in best or run.particles > best[run.cells].particles:
            best[run.cells] = run
    return [best[cells] for cells in sorted(best)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("levels", type=int)
    parser.add_argument("-o", required=True)
    parser.add_argument("--studies", type=pathlib.Path)
    o = parser.parse_args()
    levels = [Recorded(i) if o.folder == "recorded" else Level(o.folder, i) for i in range(o.levels + 1)]
    any_partner = any_partner_runs(o.studies) if o.studies else []
    figure = plots.matplotlib.figure.Figure(figsize=(9.6, 3.4), layout="constrained")
    for i, name in enumerate(("C_D", "C_L", "C_m")):
        axes = figure.add_subplot(1, 3, i + 1)
        axes.errorbar([level.cells for level in levels], [level.value(name)[0] for level in levels],
                      yerr=[level.bound(name) for level in levels], fmt="o-", color=plots.COLORS[0], label="PAMR, 95 %")
        if any_partner:
            axes.errorbar([run.cells for run in any_partner], [run.values[name][0] for run in any_partner],
                          yerr=[run.values[name][1] for run in any_partner], fmt="^-", color=plots.COLORS[2],
                          label="PAMR, any partner")
        axes.plot([row[0] for row in PAPER], [row[2 + i] for row in PAPER], "s--", color=plots.COLORS[1], label="the paper")
        axes.axhline(EXPERIMENT[i], color=plots.INK, lw=0.9, ls=":", label="experiment")
        axes.set_xscale("log")
        axes.set_xlabel("cells")
        axes.set_title(f"${name[0]}_{name[2]}$")
    figure.axes[2].legend(loc="center")  # between the two moments
    plots.save(figure, o.o)


if __name__ == "__main__":
    main()
