#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the error of a quantity over the number of cells, both logarithmic, for several runs of loop.sh, as SVG.

Usage: plot_convergence.py -o FILE.svg --exact VALUE --quantity PATH LABEL=FOLDER...

PATH is that of a number in the report of pamr-pb, for example forces.sphere.midplane.dimensionless.0.
"""
import argparse
import json
import math
import os

from levels import value_at

COLORS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd")
WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 620, 440, 80, 55, 20, 20


def read(folder, quantity, exact):
    points = []
    while os.path.exists(name := os.path.join(folder, f"solve{len(points)}.json")):
        with open(name, encoding="utf-8") as file:
            report = json.load(file)
        points.append((report["cells"], abs(value_at(report, quantity) / exact - 1)))
    return points


def decades(values):
    return math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))


def draw(series):
    """The text of the picture; `series`: label and points of each run."""
    x_low, x_high = decades([x for _, points in series for x, _ in points])
    y_low, y_high = decades([y for _, points in series for _, y in points])

    def at(x, y):
        return (LEFT + (math.log10(x) - x_low) / (x_high - x_low) * (WIDTH - LEFT - RIGHT),
                HEIGHT - BOTTOM - (math.log10(y) - y_low) / (y_high - y_low) * (HEIGHT - BOTTOM - TOP))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
           'font-size="13">', f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for power in range(x_low, x_high + 1):
        x, y = at(10.0 ** power, 10.0 ** y_low)
        out.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{y:.1f}" stroke="#ccc"/>')
        out.append(f'<text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">1e{power}</text>')
    for power in range(y_low, y_high + 1):
        x, y = at(10.0 ** x_low, 10.0 ** power)
        out.append(f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#ccc"/>')
        out.append(f'<text x="{x - 6:.1f}" y="{y + 4:.1f}" text-anchor="end">1e{power}</text>')
    out.append(f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 12}" text-anchor="middle">cells</text>')
    out.append(f'<text x="20" y="{HEIGHT / 2}" text-anchor="middle" transform="rotate(-90 20 {HEIGHT / 2})">'
               'relative error</text>')
    for number, (label, points) in enumerate(series):
        color = COLORS[number % len(COLORS)]
        line = " ".join("{:.1f},{:.1f}".format(*at(*p)) for p in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"/>')
        out += ['<circle cx="{:.1f}" cy="{:.1f}" r="4" fill="{}"/>'.format(*at(*p), color) for p in points]
        out.append(f'<text x="{WIDTH - RIGHT - 8}" y="{TOP + 20 + 18 * number}" text-anchor="end" fill="{color}">'
                   f'{label}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"


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
    with open(o.output, "w", encoding="utf-8") as file:
        file.write(draw(series))


if __name__ == "__main__":
    main()
