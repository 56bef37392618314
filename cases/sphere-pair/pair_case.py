#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints case.toml with the numbers of another pair, its mesh sizes in proportion.

Usage: pair_case.py RADIUS-DISTANCE-POTENTIAL-EQUATION
"""
import pathlib
import re
import sys

CASE = pathlib.Path(__file__).resolve().with_name("case.toml")


def case_of(name):
    radius, distance, potential, equation = name.split("-")
    gap = float(distance) - 2 * float(radius)
    text = CASE.read_text(encoding="utf-8")
    text = text.replace("radius = 1.0", f"radius = {radius}").replace("distance = 3.0", f"distance = {distance}")
    text = text.replace("value = 3.0", f"value = {potential}")
    sphere = min(0.4 * float(radius), 0.45 if gap > 3 else 0.5 * gap if gap < 1 else 0.3)
    text = re.sub("(?m)^sphere = .*$", f"sphere = {sphere:g}", text)
    text = re.sub("(?m)^far = .*$", f"far = {1.0 if gap > 6 else 1.5}", text)
    if equation == "linear":
        text = text.replace("[force]", "[equation]\nlinear = true\n\n[force]", 1)
    return text


if __name__ == "__main__":
    sys.stdout.write(case_of(sys.argv[1]))
