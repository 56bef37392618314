#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads rows of bench_balance and prints for each mesh, and for all, how many times the faces of compact parts Scotch's
parts have: geometric mean, least and most. Exit code 1 where Scotch's parts of a mesh have more than the rule allows."""
import statistics
import sys

MOST = 1.5  # docs/tools/pamr-refine-balance.md; of the five meshes one has as much

by_mesh = {}
for line in sys.stdin:
    words = [word.strip() for word in line.split("|")]
    if len(words) > 6 and words[4] == "scotch":
        by_mesh.setdefault(words[1], []).append(float(words[6]))
if not by_mesh:
    sys.exit("compare_with_compact.py: expected rows of Scotch's parts, found none")
print("| mesh | Scotch over compact: geometric mean | least | most |\n|---|---|---|---|")
for mesh, ratios in [*by_mesh.items(), ("all", [r for ratios in by_mesh.values() for r in ratios])]:
    print(f"| {mesh} | {statistics.geometric_mean(ratios):.2f} | {min(ratios):.2f} | {max(ratios):.2f} |")
missed = [f"compare_with_compact.py: expected at most {MOST} times the faces of compact parts, found {max(ratios):.2f} of {mesh}"
          for mesh, ratios in by_mesh.items() if max(ratios) > MOST]
sys.exit("\n".join(missed) if missed else 0)
