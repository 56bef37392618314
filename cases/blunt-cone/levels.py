#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints one table of the levels of the flow about the blunt cone from their reports, compared with the paper's, and checks it.

Usage: levels.py FOLDER LEVELS smoke|small|full|last    reads flow<i>.json and quality<i>.json in FOLDER.
Exit code 1 when a particle was lost, (small, full) a number is not as in expected.csv or the drag changes from one level
to the next by more than half a percent and its bounds, or (full) a flow is not steady, or there are too few particles or
too large bounds. "last" asks of the last level alone what "full" asks of each.
"""
import csv
import json
import math
import os
import sys

# The paper's Tables 3 and 4: cells, particles, C_D, C_L, C_m; and the experiment that it compares with.
PAPER = [(15190, 0.27e6, 1.667, -0.141, -0.057), (43624, 0.56e6, 1.621, -0.154, -0.058),
         (229040, 5.88e6, 1.582, -0.166, -0.056), (1070194, 11.1e6, 1.552, -0.174, -0.057),
         (2700319, 18.1e6, 1.543, -0.182, -0.055)]
EXPERIMENT = (1.476, -0.18, -0.054)
COEFFICIENTS = ("C_D", "C_L", "C_m", "C_H")
FOUR_ERRORS = 4 / 2.262  # four standard errors in bounds of 95 % of ten groups, which most levels have


def read(folder, name):
    with open(os.path.join(folder, name + ".json"), encoding="utf-8") as file:
        return json.load(file)


class Level:
    def __init__(self, folder, level):
        self.flow = read(folder, f"flow{level}")
        self.cells = read(folder, f"quality{level}")["cells"]
        self.few = self.flow["quality"]["dense_gas_below_5_particles"]

    def value(self, name):
        """A number of the reports and its bound: half the width of the interval of 95 %."""
        if name == "cells":
            return self.cells, 0.0
        found = self.flow[name]
        return (found["value"], found["ci95"]) if isinstance(found, dict) else (found, 0.0)

    def bound(self, name):
        return self.value(name)[1]

    def row(self, level):
        flow = self.flow
        return (f"{'level ' + str(level):10} {self.cells:8d} {flow['particles']:10d} {flow['particles'] / self.cells:6.1f} "
                f"{100 * (1 - self.few):6.0f} % {flow['steps'] - flow['averages_from_step']:6d}"
                + coefficients([self.value(c) for c in COEFFICIENTS]))


def coefficients(values):
    """The last columns of a row: values with their bounds, or alone."""
    return "".join(f"  {v:8.4f} +- {e:.4f}" if e else f"  {v:8.3f}          " for v, e in values).rstrip()


def blocks(level, found):
    """Where the bounds of a level come from, in words."""
    a = found.flow["averages"]
    text = f"level {level}: +- from {a['groups']} groups of {a['group_steps']} steps; the free stream passes in {a['passage_steps']}"
    return text if a["independent"] else text + ": shorter groups depend on each other, and bounds are too narrow"


def is_full(levels, level, size):
    return size == "full" or (size == "last" and level + 1 == len(levels))


def expected_rows():
    """What expected.csv records: run, level, quantity, value, ci95, mesh."""
    name = os.path.join(os.path.dirname(os.path.abspath(__file__)), "expected.csv")
    with open(name, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def unexpected(levels, size):
    """Differences from expected.csv: four standard errors of both, and a share for what another mesh would change."""
    for row in expected_rows():
        level = int(row["level"])
        if level >= len(levels) or row["run"] != ("full" if is_full(levels, level, size) else size):
            continue
        found, bound = levels[level].value(row["quantity"])
        expected = float(row["value"])
        allowed = FOUR_ERRORS * math.hypot(bound, float(row["ci95"])) + float(row["mesh"])
        if not bound <= 3 * float(row["ci95"]):  # a wide bar would let any value pass; ten groups give it within a third or so
            yield f"level {level}: expected a bound of 95 % of {row['quantity']} of {row['ci95']}, at most three times that, found {bound:.2g}"
        if not abs(found - expected) <= allowed:
            yield (f"level {level}: expected {row['quantity']} = {row['value']} within {allowed:.3g}, "
                   f"found {found:g}")


def long_run():
    """The levels of the full run that expected.csv records: cells, coefficients, each with its bound of 95 %."""
    levels = {}
    for row in expected_rows():
        if row["run"] == "full":
            levels.setdefault(int(row["level"]), {})[row["quantity"]] = (float(row["value"]), float(row["ci95"]))
    return levels


def beyond_bounds(levels, long):
    """The coefficients that differ from the long run's by more than both bounds, in words."""
    for i, level in enumerate(levels):
        for c in COEFFICIENTS if i in long else ():
            off = level.value(c)[0] - long[i][c][0]
            if abs(off) > math.hypot(level.bound(c), long[i][c][1]):
                yield f"{c} of level {i} ({off:+.4f})"


def drifts(i, level):
    """What changes while it is averaged by more than chance and half a percent, as pamr-dsmc says."""
    for name, change in level.flow["averages"].get("change", {}).items():
        if change["drifts"]:
            yield (f"level {i}: expected averages of a steady flow, found {name} that changes by {change['value']:.4g} "
                   f"+- {change['ci95']:.2g}")


def requirements(levels, size):
    for i, (coarse, fine) in enumerate(zip(levels, levels[1:])):
        before, after = coarse.value("C_D")[0], fine.value("C_D")[0]
        allowed = 0.005 * before + math.hypot(coarse.bound("C_D"), fine.bound("C_D"))
        if size not in ("smoke", "last") and abs(after - before) > allowed:
            yield f"level {i + 1}: expected C_D within {allowed:.4f} of {before:.4f}, the level's before, found {after:.4f}"
    for i, level in enumerate(levels):
        if level.flow["lost_particles"] != 0:
            yield f"level {i}: {level.flow['lost_particles']} particles were lost"
        if not is_full(levels, i, size):
            continue
        if level.flow["averages"]["begun"] == "most_transient":
            yield f"level {i}: expected a steady flow, found: {level.flow['steady']}"
        yield from drifts(i, level)
        if level.flow["particles"] < 8 * level.cells or (i < 3 and level.few > 0.1):
            yield f"level {i}: expected 8 particles a cell and 5 in 90 % of the cells in gas denser than the free stream's"
        if not level.flow["averages"]["independent"]:
            yield f"level {i}: expected ten groups of steps as long as a passage, found: {blocks(i, level)}"
        if level.bound("C_D") > 0.005 * level.value("C_D")[0] or max(level.bound(c) for c in ("C_L", "C_m")) > 0.003:
            yield f"level {i}: expected 95 % bounds of at most 0.5 % (C_D) and 0.003 (C_L, C_m)"
    if size == "full" and len(levels) > 2 and levels[2].cells < 150000:
        yield f"level 2: expected at least 150,000 cells, found {levels[2].cells}"


def main():
    folder, n_levels, size = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    levels = [Level(folder, level) for level in range(n_levels + 1)]
    long = long_run()
    print("              cells  particles      a   with 5  steps" + "".join(f"{c:>13}       " for c in COEFFICIENTS).rstrip())
    print("                              cell  or more averaged")
    for i, level in enumerate(levels):
        print(level.row(i))
    if size == "small":
        for i in range(min(len(levels), len(long))):
            print(f"{'--full, ' + str(i):10} {long[i]['cells'][0]:8.0f}" + " " * 33
                  + coefficients([long[i][c] for c in COEFFICIENTS]))
    for i, (cells, particles, *found) in enumerate(PAPER[:len(levels)]):
        print(f"{'paper, ' + str(i):10} {cells:8d} {particles:10.0f} {particles / cells:6.1f}" + " " * 16
              + coefficients([(v, 0) for v in found]))
    print(f"{'experiment':53}" + coefficients([(v, 0) for v in EXPERIMENT]))
    print("C_D, C_L, C_m, C_H: drag, lift, pitching moment and heat; +-: bounds of 95 % for the chance of one run, not for what its cells,")
    print("number of particles and steps add")
    print("with 5 or more: share of the cells in gas denser than the free stream's that hold at least five particles")
    for i, level in enumerate(levels):
        print(blocks(i, level))
    if size == "small":
        off = list(beyond_bounds(levels, long))
        if off:
            print("outside of its bounds beside the long run (--full): " + ", ".join(off)
                  + ": what fewer particles, longer steps and other cells add")
    trouble = list(unexpected(levels, size)) + list(requirements(levels, size))
    for text in trouble:
        print("levels.py: error: " + text, file=sys.stderr)
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
