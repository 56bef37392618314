#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws density, temperature and speed along the stagnation line on level 0 and the last one, and prints a table of the last.

Usage: plot_stagnation.py OUT LEVELS -o FILE.svg|FILE.png

OUT is the folder of run.sh; all is over the values of the free stream. Dashes: behind a normal shock of a gas without viscosity.
"""
import argparse
import csv
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import plots

MASS, BOLTZMANN = 66.3e-27, 1.380649e-23  # argon
NEAR = 0.0101  # radii; the table has means over two of them, or a cell


def stream(out):
    found = {}
    for line in (out / "case0.toml").read_text(encoding="utf-8").splitlines():
        name, _, value = line.partition(" = ")
        if name in ("density", "temperature", "velocity") and name not in found:
            found[name] = float(value.split("#")[0].strip("[ ]").split(",")[0])
    return found["density"], found["temperature"], found["velocity"]


def profile(file):
    """Distance from the sphere and values over those of the free stream."""
    columns = {}
    with open(file, encoding="utf-8") as lines:
        for row in csv.DictReader(lines):
            if row["name"] == "stagnation":
                columns.setdefault(row["quantity"], []).append((float(row["x"]), float(row["value"])))
    return columns


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("levels", type=int)
    parser.add_argument("-o", required=True)
    options = parser.parse_args()
    density, temperature, speed = stream(options.out)
    square = speed**2 / (5 / 3 * BOLTZMANN * temperature / MASS)  # of the Mach number
    compression = 4 * square / (square + 3)
    quantities = {"n": ("density", density, compression), "u_x": ("speed", speed, 1 / compression),
                  "T": ("temperature", temperature, (5 * square - 1) * (square + 3) / (16 * square))}
    first, last = (profile(options.out / f"{name}-lines.csv") for name in ("flow0", f"own/removable{options.levels}-flow"))
    figure, axes = plots.new_plot("radii before the sphere", f"over the free stream's, Mach {math.sqrt(square):.3g}")
    for (name, (title, free, behind)), color in zip(quantities.items(), plots.COLORS):
        for line, style, label in ((first, ":", None), (last, "-", title)):
            axes.plot([-x - 1 for x, _ in line[name]], [value / free for _, value in line[name]], style, color=color, label=label)
        axes.axhline(behind, color=color, linestyle="--", linewidth=0.8)
    axes.set(xlim=(1.2, 0), ylim=(0.01, 50), yscale="log")
    axes.legend()
    plots.save(figure, options.o)
    print("| radii before the sphere | density | speed | temperature |\n|---|---|---|---|")
    for distance in (0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6, 1.0):
        near = [[value / free for x, value in last[name] if abs(-x - 1 - distance) <= NEAR] for name, (_, free, _) in quantities.items()]
        print(f"| {distance:g} | " + " | ".join(f"{sum(values) / len(values):.3g}" for values in near) + " |")


if __name__ == "__main__":
    main()
