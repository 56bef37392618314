#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints one table of the levels of the blunt cone from their reports, and compares it with geometry.csv.

Usage: geometry.py FOLDER LEVELS    reads quality<i>.json (0 <= i <= LEVELS), refine<i>.json (1 <= i) and version.txt in FOLDER.
Exit code 1 when a number is not as expected, or when the error of the body's area or of the gas volume grows from one
level to the next.
"""
import csv
import json
import math
import os
import platform
import sys

# The body, mm (README.md gives the source): nose radius, largest radius, shoulder radius, fillet radius, sting radius,
# half angle, and where the gas ends.
NOSE, LARGEST, SHOULDER, FILLET, STING, ANGLE = 12.5, 25.0, 1.25, 2.08, 6.25, math.radians(70)
MADE_WITH = "CGAL 5.5.1"  # geometry.csv, on x86-64
INFLOW, OUTFLOW, OUTER, ROUNDING = -30.0, 60.0, 60.0, 30.0


def arc(center_r, radius, start, end):
    """Area and volume of revolution under an arc whose polar angle runs from `start` to `end`; x grows along it."""
    def area(angle):
        return 2 * math.pi * radius * (center_r * angle - radius * math.cos(angle))

    def volume(angle):  # integral of pi r^2 dx with r = center_r + radius sin, dx = -radius sin dangle
        cosine, sine = math.cos(angle), math.sin(angle)
        return -math.pi * radius * (-center_r ** 2 * cosine + center_r * radius * (angle - sine * cosine)
                                    + radius ** 2 * (cosine ** 3 / 3 - cosine))

    return abs(area(end) - area(start)), volume(end) - volume(start)


def exact():
    """Areas of the half body's patches, mm^2, and volume of the half gas, mm^3."""
    # Polar angles are measured from the x axis; along the nose they fall from 180 to 90 + 70 degrees.
    normal = math.pi / 2 + ANGLE
    nose_area, nose_volume = arc(0, NOSE, math.pi, normal)
    nose_end = (NOSE + NOSE * math.cos(normal), NOSE * math.sin(normal))
    shoulder_r = LARGEST - SHOULDER
    cone_end_r = shoulder_r + SHOULDER * math.sin(normal)
    cone_end_x = nose_end[0] + (cone_end_r - nose_end[1]) / math.tan(ANGLE)
    cone_area = math.pi * (nose_end[1] + cone_end_r) * math.hypot(cone_end_x - nose_end[0], cone_end_r - nose_end[1])
    cone_volume = math.pi / 3 * (cone_end_x - nose_end[0]) * (
        nose_end[1] ** 2 + nose_end[1] * cone_end_r + cone_end_r ** 2)
    shoulder_x = cone_end_x - SHOULDER * math.cos(normal)
    shoulder_area, shoulder_volume = arc(shoulder_r, SHOULDER, normal, 0)
    base_x, fillet_r = shoulder_x + SHOULDER, STING + FILLET
    base_area = math.pi * (shoulder_r ** 2 - fillet_r ** 2)
    fillet_area, fillet_volume = arc(fillet_r, FILLET, math.pi, 1.5 * math.pi)
    sting_length = OUTFLOW - base_x - FILLET
    body = (nose_volume + cone_volume + shoulder_volume + fillet_volume
            + math.pi * STING ** 2 * sting_length)
    # The tunnel: a cylinder whose front edge is rounded.
    _, rounding = arc(OUTER - ROUNDING, ROUNDING, math.pi, math.pi / 2)
    tunnel = rounding + math.pi * OUTER ** 2 * (OUTFLOW - INFLOW - ROUNDING)
    areas = {"forebody": nose_area + cone_area + shoulder_area, "base": base_area + fillet_area,
             "sting": 2 * math.pi * STING * sting_length}
    return {name: area / 2 for name, area in areas.items()}, (tunnel - body) / 2


def read(folder, name):
    with open(os.path.join(folder, name + ".json"), encoding="utf-8") as file:
        return json.load(file)


def table_row(level, report, refinement, errors):
    distance = max(patch["worst_distance"] for patch in report["patches"].values())
    ratio, dihedral = report["mean_ratio"], report["min_dihedral"]
    seconds = f"{refinement['seconds']['total']['max']:8.2f}" if refinement else "       -"
    return (f"{level:5d} {report['cells']:10d} {report['nodes']:9d}  {ratio['min']:.3f}  {ratio['mean']:.3f}"
            f"  {dihedral['min']:6.2f}   {distance:8.1e} " + "".join(f"  {error:+9.2e}" for error in errors) + seconds)


def tolerance_column(folder):
    """That of geometry.csv for meshes which are the same as there bit for bit, else that for another level 0."""
    with open(os.path.join(folder, "version.txt"), encoding="utf-8") as file:
        same = MADE_WITH + "," in file.read() and platform.machine() == "x86_64"
    return "same" if same else "other"


def unexpected(reports, column):
    """Differences from geometry.csv: its rows name a level, a path in the quality report, a value and two tolerances."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "geometry.csv"), encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            if int(row["level"]) >= len(reports):
                continue
            found = reports[int(row["level"])]
            for key in row["quantity"].split("/"):
                found = found[key]
            if not abs(found - float(row["value"])) <= float(row[column]):
                yield (f"level {row['level']}: expected {row['quantity']} = {row['value']} within {row[column]}, "
                       f"found {found}")


def main():
    folder, levels = sys.argv[1], int(sys.argv[2])
    areas, volume = exact()
    body_area = sum(areas.values())
    print("level      cells     nodes  mean ratio    min      worst    error of   error of   error of   refine")
    print("                            min   mean  dihedral  distance  fore-body  body area  gas volume seconds")
    reports = [read(folder, f"quality{level}") for level in range(levels + 1)]
    errors = []
    for level, report in enumerate(reports):
        area = {name: report["patches"][name]["area"] * 1e6 for name in areas}
        errors.append((area["forebody"] / areas["forebody"] - 1, sum(area.values()) / body_area - 1,
                       report["volume"] * 1e9 / volume - 1))
        print(table_row(level, report, read(folder, f"refine{level}") if level else None, errors[-1]))
    print("distance in m from the exact surfaces; relative errors against half of the exact body and gas:")
    print("  " + ", ".join(f"{name} {value:.6f} mm2" for name, value in areas.items()) + f", gas {volume:.6f} mm3")
    trouble = list(unexpected(reports, tolerance_column(folder)))
    for what, column in (("fore-body's area", 0), ("body's area", 1), ("gas volume", 2)):
        if any(abs(fine[column]) > abs(coarse[column]) for coarse, fine in zip(errors, errors[1:])):
            trouble.append(f"the error of the {what} grows from one level to the next")
    for text in trouble:
        print("geometry.py: error: " + text, file=sys.stderr)
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
