#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of compare-pb.sh.

Usage: compare_pb_table.py FOLDER    FOLDER holds ours- and theirs-<preconditioner>-<k>.json

Exit code 1 when the energies differ.
"""
import glob
import json
import os
import statistics
import sys

# Stages that both have, and the steps of `bench_pb` that they are.
STAGES = {"topology": ["topology"], "space": ["domain"], "matrix": ["matrix"], "solve": ["solve"]}
BOTH = ["space", "matrix", "solve"]


def load(folder, side, preconditioner):
    reports = []
    for path in sorted(glob.glob(os.path.join(folder, f"{side}-{preconditioner}-*.json"))):
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
        if side == "ours":
            steps = report["steps"]
            report["seconds"] = {stage: sum(steps[step]["cpu"][0] for step in names) for stage, names in STAGES.items()}
            report["seconds"]["analyze"] = steps["analyze"]["cpu"][0]
            report["energy"] = report["results"]["energy"]
            for name in ("peak_to_solution_bytes", "bytes_before_topology"):
                report[name] = report["of_rank"][name][0]
        reports.append(report)
    if not reports:
        sys.exit(f"compare_pb_table.py: expected reports {side}-{preconditioner}-*.json in {folder}, found none")
    return reports


def seconds(reports, *stages):
    return statistics.median(sum(report["seconds"][stage] for stage in stages) for report in reports)


def megabytes(reports, added):
    return statistics.median((r["peak_to_solution_bytes"] - (r["bytes_before_topology"] if added else 0)) / 1e6
                             for r in reports)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    columns = [(side, pc, load(sys.argv[1], side, pc)) for pc in ("jacobi", "boomeramg") for side in ("ours", "theirs")]
    print(f"{columns[0][2][0]['cells']} cells, one rank, CPU seconds\n")
    print("| stage | " + " | ".join(f"{'PAMR' if side == 'ours' else 'dolfinx'}, {pc}" for side, pc, _ in columns)
          + " | ratio, jacobi | ratio, boomeramg |")
    print("|---" * 7 + "|")

    def row(name, values, digits=3):
        ratios = [f"{values[k + 1] / values[k]:.2f}" for k in (0, 2)]
        print(f"| {name} | " + " | ".join(f"{value:.{digits}f}" for value in values) + " | " + " | ".join(ratios) + " |")

    for stage in STAGES:
        row(stage, [seconds(reports, stage) for _, _, reports in columns])
    row("space to solve, what both do", [seconds(reports, *BOTH) for _, _, reports in columns])
    row("the same with topology", [seconds(reports, "topology", *BOTH) for _, _, reports in columns])
    ours = [seconds(reports, "analyze") for side, _, reports in columns if side == "ours"]
    print(f"| analyze: charges, forces, error estimate, energy | {ours[0]:.3f} | - | {ours[1]:.3f} | - | | |")
    row("peak memory beyond the arrays, MB", [megabytes(reports, True) for _, _, reports in columns], 0)
    row("peak memory of the process, MB", [megabytes(reports, False) for _, _, reports in columns], 0)
    for key in ("newton_iterations", "linear_iterations"):
        print(f"| {key.replace('_', ' ')} | " + " | ".join(str(reports[0][key]) for _, _, reports in columns) + " | | |")
    print("| energy | " + " | ".join(f"{reports[0]['energy']:.9f}" for _, _, reports in columns) + " | | |")
    energies = [reports[0]["energy"] for _, _, reports in columns]
    return 0 if max(energies) - min(energies) < 1e-7 * max(energies) else 1


if __name__ == "__main__":
    sys.exit(main())
