#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables from the reports that scaling-pb.sh collects.

Usage: summarize_pb.py FOLDER

FOLDER holds run-<preconditioner>-<ranks>-<k>.json, what `bench_pb` prints. Prints markdown. Exit code 1 when iterations
grow with the ranks or forces and charges depend on them.
"""
import glob
import json
import math
import os
import re
import statistics
import sys

from summarize import BANDWIDTH, LATENCY, number, table

STEPS = ["read", "topology", "balance", "domain", "matrix", "solve", "analyze"]
SOLVER = ["domain", "matrix", "solve", "analyze"]
# Jacobi's iterates are the same on any ranks but for rounding; sweeps of multigrid stop at the borders of the ranks.
MOST_ITERATIONS = {"jacobi": 1.02, "boomeramg": 1.06}
# Of the largest number of its kind (charge, force, torque, energy).
MOST_DIFFERENCE = 1e-8


class Runs:
    """The runs with one preconditioner on one number of ranks; every figure is the median over them."""

    def __init__(self, reports):
        self.reports, self.ranks, self.first = reports, reports[0]["ranks"], reports[0]

    def over(self, fold, quantity, *steps):
        def one(report):
            return fold([sum(rank) for rank in zip(*(report["steps"][step][quantity] for step in steps))])
        return statistics.median(one(report) for report in self.reports)

    def of_rank(self, fold, name):
        return statistics.median(fold(report["of_rank"][name]) for report in self.reports)

    def modeled(self, *steps):
        """Seconds on a cluster: the slowest rank's work, its messages and bytes, its part in reductions."""
        hops = math.ceil(math.log2(self.ranks)) if self.ranks > 1 else 0
        return (self.over(max, "compute", *steps)
                + (self.over(max, "messages", *steps) + hops * self.over(max, "reductions", *steps)) * LATENCY
                + self.over(max, "bytes", *steps) / BANDWIDTH)


def load(folder):
    found = {}
    for path in sorted(glob.glob(os.path.join(folder, "run-*-*-*.json"))):
        name, ranks = re.search(r"run-(\w+)-(\d+)-\d+\.json$", path).groups()
        with open(path, encoding="utf-8") as file:
            found.setdefault(name, {}).setdefault(int(ranks), []).append(json.load(file))
    if not found:
        sys.exit(f"summarize_pb.py: expected reports run-*-*-*.json in {folder}, found none")
    return {name: [Runs(by_ranks[p]) for p in sorted(by_ranks)] for name, by_ranks in found.items()}


def difference(run, first):
    """Largest difference of a result from that of `first`, of the largest of its kind."""
    worst = 0
    for report in run.reports:
        for name, value in first.first["results"].items():
            kind = name.split()[0]
            size = max([1e-3] + [abs(v) for k, v in first.first["results"].items() if k.split()[0] == kind])
            worst = max(worst, abs(report["results"][name] - value) / size)
    return worst


def milliseconds(run, *steps):
    return f"{1e3 * run.over(sum, 'compute', *steps):.0f} ({1e3 * run.over(max, 'compute', *steps):.0f})"


def print_tables(name, runs):
    first, head = runs[0], ["ranks"] + [str(r.ranks) for r in runs]
    print(f"Preconditioner `{name}`, {first.first['cells']} cells, {first.first['nodes']} nodes. Compute in ms of processor "
          "time outside of MPI: sum over the ranks (largest rank)\n")
    rows = [[step] + [milliseconds(r, step) for r in runs] for step in STEPS]
    rows.append(["domain to analyze"] + [milliseconds(r, *SOLVER) for r in runs])
    rows.append(["of that on the first"] + [f"{r.over(sum, 'compute', *SOLVER) / first.over(sum, 'compute', *SOLVER):.2f}"
                                            for r in runs])
    rows.append(["Newton steps"] + [r.first["newton_iterations"] for r in runs])
    rows.append(["CG iterations"] + [r.first["linear_iterations"] for r in runs])
    rows.append(["messages of a rank in solve, most"] + [number(r.over(max, "messages", "solve")) for r in runs])
    rows.append(["MB sent by a rank in solve, most"] + [number(1e-6 * r.over(max, "bytes", "solve")) for r in runs])
    rows.append(["operations of all ranks in solve"] + [number(r.over(max, "reductions", "solve")) for r in runs])
    rows.append(["unknowns, largest rank over mean"] + [
        f"{r.of_rank(max, 'unknowns') * r.ranks / r.first['nodes']:.3f}" for r in runs])
    rows.append(["copies of others' nodes, most"] + [number(r.of_rank(max, "copies")) for r in runs])
    rows.append(["neighbors, most"] + [number(r.of_rank(max, "neighbors")) for r in runs])
    rows.append(["faces between ranks: runs of the file"] + [r.first["edge_cut_before"] for r in runs])
    rows.append(["faces between ranks: used"] + [r.first["edge_cut"] for r in runs])
    rows.append(["peak memory of a rank, MB"] + [number(1e-6 * r.of_rank(max, "peak_rss_bytes")) for r in runs])
    rows.append(["modeled seconds, domain to analyze"] + [f"{r.modeled(*SOLVER):.3f}" for r in runs])
    rows.append(["largest difference of a force or charge"] + [f"{difference(r, first):.1g}" for r in runs])
    table(head, rows)


def find_bars(name, runs):
    first = runs[0]
    for run in runs[1:]:
        yield (f"{name}, {run.ranks} ranks: CG iterations of those on {first.ranks}",
               run.first["linear_iterations"] / first.first["linear_iterations"], MOST_ITERATIONS.get(name, 1.3))
        yield (f"{name}, {run.ranks} ranks: largest difference of a force or charge", difference(run, first),
               MOST_DIFFERENCE)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    groups = load(sys.argv[1])
    bars = []
    for name, runs in groups.items():
        print_tables(name, runs)
        bars += find_bars(name, runs)
    table(["requirement", "found", "at most", ""],
          [[what, number(found), number(most), "pass" if found <= most else "FAIL"] for what, found, most in bars])
    return 0 if all(found <= most for _, found, most in bars) else 1


if __name__ == "__main__":
    sys.exit(main())
