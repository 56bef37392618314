# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of compare.sh: medians of ours and of the peers, ratios, and notes on what a row holds.

Usage: table.py RESULTS PEER...   RESULTS holds pamr.*.json (Google Benchmark), pamr.quality (bench_quality_control),
<peer>.json (lines as printed by the peers) and <peer>.note (why a peer has none)
"""
import json
import pathlib
import re
import statistics
import sys

COARSENING_HEAD = ["back to level 0 from", "code", "cells", "cells left", "calls", "CPU s", "us a cell", "runs"]
HEAD = ["workload", "code", "cells out", "CPU s", "M cells / CPU s", "ours / theirs", "with neighbors: M cells / CPU s",
        "ours / theirs", "peak bytes / cell out", "worst mean ratio", "runs"]
NEIGHBORS = {
    "netgen": "faces of the cells: part of bisection, by `UpdateTopology` after uniform refinement",
    "dolfinx": "by `create_entities(2)` and `create_connectivity`; the edges that `refine` needs are made untimed",
    "ug": "part of the call; all levels are kept",
    "dmplex": "part of the call; uniform only: the adaptive transform `refine_sbr` takes no tetrahedra",
    "gmsh": "none; uniform only",
}


def our_rows(folder):
    """{(workload, level): row} with the keys of `peer_rows`; neighbors are part of the call."""
    worst = {}
    for line in (folder / "pamr.quality").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if cells[0] == "removable":
            worst["W3", int(cells[1])] = float(cells[4])
    runs = {}
    for path in sorted(folder.glob("pamr.*.json")):
        for run in json.loads(path.read_text())["benchmarks"]:
            if run["run_type"] == "iteration":
                workload, level = re.match(r"(W\d)(?:.*level:(\d+))?", run["name"]).groups()
                runs.setdefault((workload, int(level or 1)), []).append(run)
    rows = {}
    for key, group in runs.items():
        cells = group[0]["cells_out"]
        cpu = statistics.median(1e-6 * cells / run["Mcells_per_cpu_s"] for run in group)
        # Runs after the first find memory of the one before; the greatest peak is that of a fresh process.
        peak = max(run["peak_bytes_per_cell"] for run in group)
        rows[key] = {"code": "PAMR", "cells": cells, "cpu": cpu, "all_cpu": cpu, "peak": peak, "worst": worst.get(key),
                     "runs": len(group)}
    return rows


def peer_rows(folder, peer):
    runs = {}
    path = folder / f"{peer}.json"
    for line in path.read_text().splitlines() if path.exists() else []:
        run = json.loads(line)
        if "workload" in run:
            runs.setdefault((run["workload"], run["level"]), []).append(run)
    rows = {}
    for key, group in runs.items():
        first = group[0]
        cpu = statistics.median(run["cpu"] for run in group)
        all_cpu = statistics.median(run["cpu"] + run.get("relate_cpu", 0) for run in group)
        rows[key] = {"code": first["peer"], "cells": first["cells"], "cpu": cpu,
                     "all_cpu": None if peer == "gmsh" else all_cpu, "peak": first["peak"] / first["cells"],
                     "worst": first.get("worst"), "runs": len(group)}
    return rows


def coarsening_rows(folder, peer):
    """Of going all the way back, one level a call: medians."""
    runs = {}
    path = folder / f"{peer}.json"
    for line in path.read_text().splitlines() if path.exists() else []:
        run = json.loads(line)
        if "coarsening" in run:
            runs.setdefault((run["coarsening"], run["level"]), []).append(run)
    for (workload, level), group in sorted(runs.items()):
        cpu = statistics.median(run["cpu"] for run in group)
        cells = group[0]["cells"]
        yield [f"W3 level {level}" if workload == "W3" else workload, group[0]["peer"], f"{cells:,.0f}",
               f"{group[0]['cells_left']:,.0f}", str(group[0]["calls"]), number(cpu), number(1e6 * cpu / cells),
               str(len(group))]


def rate(row, key):
    return 1e-6 * row["cells"] / row[key] if row and row[key] else None


def number(value, digits=3):
    if value is None:
        return "-"
    return f"{value:.{digits}g}" if value < 100 else f"{value:.0f}"


def format_row(name, row, ours):
    values = [name, row["code"], f"{row['cells']:,.0f}", number(row["cpu"])]
    for key in "cpu", "all_cpu":
        its, our = rate(row, key), rate(ours, key)
        is_ours = row is ours
        values += [number(its), "1" if is_ours else number(our / its) if its and our else "-"]
    return values + [number(row["peak"]), number(row["worst"]), str(row["runs"])]


def print_row(values):
    print("| " + " | ".join(values) + " |")


def print_head(names):
    print_row(names)
    print("|" + "---|" * len(names))


def main():
    folder, peers = pathlib.Path(sys.argv[1]), sys.argv[2:]
    ours = our_rows(folder)
    theirs = {peer: peer_rows(folder, peer) for peer in peers}
    print_head(HEAD)
    for key in sorted(ours):
        name = f"W3 level {key[1]}" if key[0] == "W3" else key[0]
        for row in [ours[key]] + [theirs[peer][key] for peer in peers if key in theirs[peer]]:
            print_row(format_row(name, row, ours[key]))
    for peer in peers:
        note = folder / f"{peer}.note"
        for line in note.read_text().splitlines() if note.exists() else []:
            print_row(["-", f"{peer}: {line}"] + ["-"] * (len(HEAD) - 2))
    coarsening = [row for peer in peers for row in coarsening_rows(folder, peer)]
    if coarsening:
        print()
        print_head(COARSENING_HEAD)
        for row in coarsening:
            print_row(row)
    print("\nPAMR: neighbors, global ids and lineage are part of the call; W2 and W3 with the default quality control.")
    last = max(level for workload, level in ours if workload == "W3")
    for peer in peers:
        if not theirs[peer]:
            continue
        reached = max((level for workload, level in theirs[peer] if workload == "W3"), default=None)
        limit = f"; W3 up to level {reached}, the next might not fit into memory" if reached and reached < last else ""
        print(f"{peer}: neighbors: {NEIGHBORS[peer]}{limit}.")


main()
