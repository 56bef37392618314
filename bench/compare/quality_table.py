# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of quality_peers.sh: cells, smallest, 0.1 % and mean of the mean ratio, by code and level.

Usage: quality_table.py RESULTS   RESULTS holds pamr (bench_quality_control) and <peer>.json (as printed by the peers)
"""
import json
import pathlib
import sys


def our_rows(text):
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if cells[0].startswith("removable "):
            yield f"PAMR, floor {cells[0].split()[1]}", int(cells[1]), int(cells[3]), *map(float, cells[4:7])


def peer_rows(text):
    for line in text.splitlines():
        row = json.loads(line)
        yield row["peer"], row["level"], row["cells"], row["worst"], row["low"], row["mean"]


def main():
    folder = pathlib.Path(sys.argv[1])
    codes = {}
    rows = list(our_rows((folder / "pamr").read_text()))
    for path in sorted(folder.glob("*.json")):
        rows += peer_rows(path.read_text())
    for code, level, cells, *shapes in rows:
        codes.setdefault(code, {})[level] = [f"{cells:,}"] + [f"{value:.3f}" for value in shapes]
    levels = range(max(level for by_level in codes.values() for level in by_level) + 1)
    print("| code | quantity | level " + " | ".join(map(str, levels)) + " |")
    print("|---" * (2 + len(levels)) + "|")
    for code, by_level in codes.items():
        for i, quantity in enumerate(("cells", "smallest", "0.1 %", "mean")):
            values = [by_level[level][i] if level in by_level else "-" for level in levels]
            print(f"| {code if i == 0 else ''} | {quantity} | " + " | ".join(values) + " |")


main()
