#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the heat flux along the meridian in the symmetry plane, level by level, with bounds of 95 % (the paper's Fig. 14).

Usage: plot_heat.py -o FILE.svg|FILE.png [--measured heat-flux.csv] LABEL=WALL.vtu...

The walls are those that run.sh writes, out/wall<level>.vtu. S is the way along the wall from the nose tip: negative on the
side that the stream comes from (z < 0). The lines of --measured are s_over_rn and a column of kW/m2 for each source.
"""
import argparse
import csv
import math
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import plots

# The meridian, m: nose and cone touch at NOSE, cone and shoulder at CONE, then the arcs' centers and radii.
RADIUS, ANGLE = 12.5e-3, math.radians(70)
NOSE, CONE = (0.753842e-3, 4.275252e-3), (7.997677e-3, 24.177525e-3)
SHOULDER, FILLET = (9.172293e-3, 23.75e-3, 1.25e-3), (12.502293e-3, 8.33e-3, 2.08e-3)
END = 6.0  # S/Rn at which the drawing ends
N_BINS = 120
NORMAL_95 = 1.96  # from a standard error to a bound of 95 %; a mean over many faces is spread normally


def arc_length(x, r):
    """S of a point on the wall, m."""
    nose_end = RADIUS * (math.pi / 2 - ANGLE)
    cone_end = nose_end + math.hypot(CONE[0] - NOSE[0], CONE[1] - NOSE[1])
    shoulder_end = cone_end + SHOULDER[2] * (math.pi / 2 + ANGLE)
    base_end = shoulder_end + SHOULDER[1] - FILLET[1]
    if x <= NOSE[0]:
        return RADIUS * math.atan2(r, RADIUS - x)
    if x <= CONE[0]:
        return nose_end + math.hypot(x - NOSE[0], r - NOSE[1])
    if r > SHOULDER[1] or x < SHOULDER[0]:
        return cone_end + SHOULDER[2] * (math.pi / 2 + ANGLE - math.atan2(r - SHOULDER[1], x - SHOULDER[0]))
    if r > FILLET[1]:
        return shoulder_end + SHOULDER[1] - r
    if x < FILLET[0]:
        return base_end + FILLET[2] * math.atan2(FILLET[1] - r, FILLET[0] - x)
    return base_end + FILLET[2] * math.pi / 2 + x - FILLET[0]


def read(name):
    """Middle, area, heat flux and its standard error of every face."""
    with open(name, encoding="utf-8") as file:
        text = file.read()

    def array(title):
        body = re.search(f'Name="{title}"[^>]*>([^<]*)<', text).group(1).split()
        return [float(v) for v in body]

    points, corner, area = array("Points"), array("connectivity"), array("area")
    q, error = array("q"), array("q_stderr")
    for face, value in enumerate(q):
        at = [3 * int(corner[3 * face + k]) for k in range(3)]
        yield tuple(sum(points[a + d] for a in at) / 3 for d in range(3)), area[face], value, error[face]


def curve(name):
    """Means over bins of S of the faces nearer than 20 degrees to the symmetry plane, with their signs: S over the nose
    radius, heat flux and its bound of 95 %, kW/m2; faces count as independent."""
    sums = {}
    for (x, y, z), area, q, error in read(name):
        r = math.hypot(y, z)
        if y > math.sin(math.radians(20)) * r and r > 2e-3:
            continue
        s = math.copysign(arc_length(x, r) / RADIUS, z)
        if abs(s) > END:
            continue
        total = sums.setdefault(math.floor((s + END) / (2 * END) * N_BINS), [0.0, 0.0, 0.0, 0.0])
        for i, part in enumerate((area, area * q, area * s, (area * error) ** 2)):
            total[i] += part
    return [(t[2] / t[0], t[1] / t[0] / 1e3, NORMAL_95 * math.sqrt(t[3]) / t[0] / 1e3) for _, t in sorted(sums.items())]


def draw(curves, measured):
    figure, axes = plots.new_plot("$S / R_n$, negative: the side towards the stream", "heat flux, kW/m$^2$")
    for i, (label, points) in enumerate(curves):
        s, q, error = zip(*points)
        axes.errorbar(s, q, yerr=error, color=plots.COLORS[i % len(plots.COLORS)], lw=1.2, elinewidth=0.7, capsize=0,
                      label=label)
    for i, (source, values) in enumerate(measured.items()):
        s, q = zip(*values)
        axes.plot(s, q, plots.MARKS[i % len(plots.MARKS)], color=plots.INK, mfc="white" if i else plots.INK, label=source)
    for text, s in (("cone", 1.2), ("base", 2.95), ("sting", 4.8)):
        for side in (-s, s):
            axes.annotate(text, (side, 0.97), xycoords=("data", "axes fraction"), ha="center", va="top", color="#888888")
    axes.set_xlim(-END, END)
    axes.set_ylim(bottom=min(0, axes.get_ylim()[0]))
    axes.legend(loc="center right")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", required=True)
    parser.add_argument("--measured")
    parser.add_argument("walls", nargs="+", metavar="LABEL=WALL.vtu")
    options = parser.parse_args()
    measured = {}
    if options.measured:
        with open(options.measured, encoding="utf-8") as file:
            for row in csv.DictReader(line for line in file if not line.startswith("#")):
                for source in (key for key in row if key not in ("s_over_rn", "bound")):
                    measured.setdefault(source, []).append((float(row["s_over_rn"]), float(row[source])))
    plots.save(draw([(label, curve(name)) for label, name in (wall.split("=", 1) for wall in options.walls)], measured),
               options.o)


if __name__ == "__main__":
    main()
