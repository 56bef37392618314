#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws C_D, C_L and C_m of the full run that expected.csv records over the number of cells with 95 % bounds, beside the runs of
studies.sh whose partners are any of the cell, the paper's levels and the experiment.

Usage: plot_partners.py STUDIES LEVELS -o FILE.svg|FILE.png    STUDIES: folder for runs of studies.sh
"""
import argparse
import pathlib
import sys

import study_tables  # needs h5py

CASES = pathlib.Path(__file__).resolve().parents[2] / "cases"
sys.path += [str(CASES), str(CASES / "blunt-cone")]
import plot_drag  # noqa: E402
import plots  # noqa: E402
from levels import STUDENT_9, long_run  # noqa: E402


def recorded_levels(n_levels):
    full = long_run()
    return [(int(full[i]["cells"][0]), {name: (full[i][name][0], STUDENT_9 * full[i][name][1]) for name in plot_drag.NAMES})
            for i in range(n_levels + 1)]


def any_partner_runs(folder):
    """The runs `*-any` of a folder of studies.sh; of two on one mesh the one with more particles."""
    runs = [study_tables.Found(folder, name.stem) for name in folder.glob("*-any.json")]
    by_cells = {run.cells: run.values for run in sorted(runs, key=lambda run: run.particles)}
    return sorted(by_cells.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("studies", type=pathlib.Path)
    parser.add_argument("levels", type=int)
    parser.add_argument("-o", required=True)
    o = parser.parse_args()
    plot_drag.draw([(recorded_levels(o.levels), "o-", plots.COLORS[0], "PAMR, 95 %"),
                    (any_partner_runs(o.studies), "^-", plots.COLORS[2], "PAMR, any partner")], o.o)


if __name__ == "__main__":
    main()
