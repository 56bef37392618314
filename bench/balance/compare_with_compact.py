#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads rows of bench_balance and prints for each mesh, and for all, how many times the faces of compact parts Scotch's
parts have: geometric mean, least and most."""
import statistics
import sys

by_mesh = {}
for line in sys.stdin:
    words = [word.strip() for word in line.split("|")]
    if len(words) > 6 and words[4] == "scotch":
        by_mesh.setdefault(words[1], []).append(float(words[6]))
print("| mesh | Scotch over compact: geometric mean | least | most |\n|---|---|---|---|")
for mesh, ratios in [*by_mesh.items(), ("all", [r for ratios in by_mesh.values() for r in ratios])]:
    print(f"| {mesh} | {statistics.geometric_mean(ratios):.2f} | {min(ratios):.2f} | {max(ratios):.2f} |")
