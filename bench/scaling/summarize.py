#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and bars from the reports that scaling.sh collects.

Usage: summarize.py FOLDER [--no-bars | --counts]

FOLDER holds run-<ranks>-<k>.json, reports of `pamr-refine --each-rank`, and base-<ranks>.json of a mesh of next to
nothing, and own-<ranks>.txt what own_memory.cpp counts on it. With --counts only bars of what is counted, not of times. Prints
markdown; writes steps.csv (each step on each number of ranks) and ranks.csv (each rank's share of each
step) there. Exit code 1 when a bar is missed.
"""
import csv
import glob
import json
import math
import os
import re
import statistics
import sys

# The network of the model: HDR InfiniBand as published for Azure's HBv3 nodes, 1.2 microseconds and 192 Gbit/s one way
# (https://docs.azure.cn/en-us/virtual-machines/hbv3-performance, OSU benchmarks), shared by 16 ranks a node.
LATENCY = 1.2e-6
RANKS_A_NODE = 16
BANDWIDTH = 192e9 / 8 / RANKS_A_NODE

# Our steps under the paper's modules; what is not named here is preprocessing. Its table stops before output.
MODULES = {"close": "I", "number": "II", "project": "III", "subdivide": "III", "transfer": "III", "relink": "IV",
           "write": "write"}
MODULE_NAMES = ["preprocessing", "I", "II", "III", "IV", "write"]
AFTER_BALANCING = ["number", "project", "subdivide", "relink", "transfer"]
BALANCING = ["balance", "migrate"]  # one rank has neither
LIBRARIES = {"read": "HDF5", "balance": "Scotch", "write": "HDF5"}
ORDER = ["read", "preprocessing", "close", "balance", "migrate", "number", "project", "subdivide", "relink",
         "transfer", "write"]
QUANTITIES = ["compute", "library", "wait", "messages", "bytes", "bytes_received", "rounds", "reductions"]

# Table 2 of the paper, seconds: 2, 4, 8, 16, 32, 64 processors.
PAPER_RANKS = [2, 4, 8, 16, 32, 64]
PAPER = {"preprocessing": [12.5, 13.5, 14.4, 15.4, 19.5, 18.2],
         "I": [92.1, 24.8, 6.2, 2.0, 1.5, 2.4],
         "II": [977.9, 267.4, 68.5, 23.2, 10.2, 9.9],
         "III": [0.9, 1.8, 2.0, 3.3, 3.8, 6.9],
         "IV": [19.5, 9.7, 5.4, 2.9, 2.1, 2.4],
         "total": [1103.0, 317.2, 96.5, 46.7, 37.1, 39.8]}


def median(values):
    return statistics.median(list(values))


class Runs:
    """The runs on one number of ranks; every figure is the median over them."""

    def __init__(self, ranks, reports, base, own):
        self.ranks, self.reports, self.base, self.own = ranks, reports, base, own
        self.cells_out = reports[0]["cells_out"]
        self.steps = [s for s in ORDER if s in reports[0]["steps"]]
        self.steps += [s for s in reports[0]["steps"] if s not in self.steps]

    def over(self, fold, quantity, *steps):
        """Median over the runs of `fold` over the ranks of the sum of the steps."""
        def one(report):
            shares = [report["of_rank"][step][quantity] for step in steps if step in report["of_rank"]]
            return fold([sum(rank) for rank in zip(*shares)] if shares else [0] * self.ranks)
        return median(one(report) for report in self.reports)

    def sum(self, quantity, *steps):
        return self.over(sum, quantity, *steps)

    def max(self, quantity, *steps):
        return self.over(max, quantity, *steps)

    def imbalance(self, *steps):
        return self.over(lambda all_: max(all_) * len(all_) / sum(all_) if sum(all_) > 0 else 1, "compute", *steps)

    def cells_imbalance(self):
        """Cells of the refined mesh: largest rank over mean."""
        cells = self.reports[0]["of_rank"]["cells_out"]
        return max(cells) * self.ranks / sum(cells)

    def messages_a_neighbor(self, step):
        """Most messages that a rank sends for each exchange and each rank that it shares nodes with."""
        def one(of_rank):
            neighbors = of_rank["neighbors_closing" if step == "close" else "neighbors"]
            return max(messages / max(1, n * rounds) for messages, n, rounds in zip(
                of_rank[step]["messages"], neighbors, of_rank[step]["rounds"]))
        return median(one(report["of_rank"]) for report in self.reports)

    def memory(self):
        """Peak of the largest rank beyond that of a process without cells, bytes; without the memory that MPI shares
        between the processes of one machine, which grows with their number and their traffic."""
        def own(report):
            of_rank = report["of_rank"]
            return max(p - s for p, s in zip(of_rank["peak_rss_bytes"], of_rank["shared_rss_bytes"]))
        return median(own(report) for report in self.reports) - own(self.base)

    def modeled(self, step):
        """Seconds of a step on a cluster: the slowest rank's work, its messages, its bytes, its part in reductions."""
        hops = math.ceil(math.log2(self.ranks)) if self.ranks > 1 else 0
        moved = max(self.max("bytes", step), self.max("bytes_received", step))
        return (self.max("compute", step) + (self.max("messages", step) + hops * self.max("reductions", step)) * LATENCY
                + moved / BANDWIDTH)


def load(folder):
    by_ranks = {}
    for path in sorted(glob.glob(os.path.join(folder, "run-*-*.json"))):
        ranks = int(re.search(r"run-(\d+)-\d+\.json$", path).group(1))
        with open(path, encoding="utf-8") as file:
            by_ranks.setdefault(ranks, []).append(json.load(file))
    runs = []
    for ranks in sorted(by_ranks):
        with open(os.path.join(folder, f"base-{ranks}.json"), encoding="utf-8") as file:
            runs.append(Runs(ranks, by_ranks[ranks], json.load(file), load_own(folder, ranks)))
    if not runs:
        sys.exit(f"summarize.py: expected reports run-*-*.json in {folder}, found none")
    return runs


def load_own(folder, ranks):
    """Most that a rank took for our own arrays on the mesh of next to nothing, bytes, and kB of its pages: its own, of
    files, shared between processes; none where it was not counted."""
    path = os.path.join(folder, f"own-{ranks}.txt")
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8") as file:
        rows = [[int(word) for word in line.split()] for line in file]
    return [max(column) for column in zip(*rows)]


def own_bytes_a_rank(runs):
    """Bytes of our own arrays by which a rank more makes the largest rank grow: the most between the largest number of
    ranks and each of the smaller ones from 16 on. Few cells are left there."""
    counted = [run for run in runs if run.own]
    if not counted:
        return None
    last = counted[-1]
    slopes = [(last.own[0] - run.own[0]) / (last.ranks - run.ranks) for run in counted[:-1] if run.ranks >= 16]
    return max(slopes) if slopes else None


def write_csv(folder, runs):
    with open(os.path.join(folder, "steps.csv"), "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["ranks", "step", "quantity", "sum", "min", "mean", "max"])
        for run in runs:
            for step in run.steps:
                for q in QUANTITIES:
                    total = run.sum(q, step)
                    out.writerow([run.ranks, step, q, total, run.over(min, q, step), total / run.ranks,
                                  run.max(q, step)])
    with open(os.path.join(folder, "ranks.csv"), "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["ranks", "rank", "step"] + QUANTITIES)
        for run in runs:
            for rank in range(run.ranks):
                for step in run.steps:
                    out.writerow([run.ranks, rank, step] + [
                        median(r["of_rank"][step][q][rank] for r in run.reports) for q in QUANTITIES])


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(x) for x in row) + " |")
    print()


def number(value):
    if value == 0:
        return "0"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def print_tables(runs):
    first = runs[0]
    head = ["ranks"] + [str(run.ranks) for run in runs]
    steps = [step for step in ORDER if any(step in run.steps for run in runs)]
    print(f"{first.reports[0]['cells_in']} cells, {first.reports[0]['marked']} of them marked, to {first.cells_out} "
          f"cells, {first.reports[0]['nodes_out']} nodes.\n")

    print("Compute, ms of processor time outside of communication: sum over the ranks (largest rank)\n")
    rows = [[step] + [f"{1e3 * run.sum('compute', step):.0f} ({1e3 * run.max('compute', step):.1f})" for run in runs]
            for step in steps]
    rows.append(["all"] + [f"{1e3 * run.sum('compute', *run.steps):.0f} ({1e3 * run.max('compute', *run.steps):.1f})"
                           for run in runs])
    rows.append(["of which after balancing"] +
                [f"{1e3 * run.sum('compute', *AFTER_BALANCING):.0f} ({1e3 * run.max('compute', *AFTER_BALANCING):.1f})"
                 for run in runs])
    rows += [[f"{step}: {library}, work and waiting"] + [f"{1e3 * run.sum('library', step):.0f} "
              f"({1e3 * run.max('library', step):.1f})" for run in runs] for step, library in LIBRARIES.items()]
    rows.append(["largest rank over mean, after balancing"] +
                [f"{run.imbalance(*AFTER_BALANCING):.2f}" for run in runs])
    rows.append(["largest rank over mean, cells"] + [f"{run.cells_imbalance():.3f}" for run in runs])
    table(head, rows)

    print("Messages sent by the rank that sends most (exchanges of messages; operations of all ranks)\n")
    table(head, [[step] + [f"{number(run.max('messages', step))} ({number(run.max('rounds', step))}; "
                           f"{number(run.max('reductions', step))})" for run in runs] for step in steps])
    print("kB sent or received by the rank that does most\n")
    table(head, [[step] + [number(1e-3 * moved(run, step)) for run in runs] for step in steps])
    print("Memory of the largest rank, and ranks that a rank shares nodes with\n")
    table(head, [
        ["peak, MB"] + [number(1e-6 * median(r["peak_rss_bytes"] for r in run.reports)) for run in runs],
        ["of a process without cells, MB"] + [number(1e-6 * run.base["peak_rss_bytes"]) for run in runs],
        ["difference (without shared memory) times ranks, of that on one"] + [
            f"{run.memory() * run.ranks / (first.memory() * first.ranks):.2f}" for run in runs],
        ["without cells: our own arrays, kB"] + [number(1e-3 * run.own[0]) if run.own else "-" for run in runs],
        ["without cells: pages of its own; of libraries, which processes share, MB"] + [
            f"{1.024e-3 * run.own[1]:.1f}; {1.024e-3 * run.own[2]:.1f}" if run.own else "-" for run in runs],
        ["most neighbors"] + [str(max(run.reports[0]["of_rank"]["neighbors"])) for run in runs]])

    print("Modeled seconds (not measured: the largest rank's compute, its messages and reductions at "
          f"{1e6 * LATENCY:.1f} us, its bytes at {1e-9 * BANDWIDTH:.1f} GB/s; without HDF5 and "
          "Scotch), beside those of the paper's Table 2\n")
    rows = []
    for name in MODULE_NAMES:
        cells = []
        for run in runs:
            own = sum(run.modeled(s) for s in run.steps if MODULES.get(s, "preprocessing") == name)
            cells.append(f"{own:.4f} / {paper(name, run.ranks)}")
        rows.append([name] + cells)
    rows.append(["total but write"] + [
        f"{sum(run.modeled(s) for s in run.steps if s != 'write'):.4f} / {paper('total', run.ranks)}" for run in runs])
    table(["ours / the paper's"] + [str(run.ranks) for run in runs], rows)


def moved(run, step):
    return max(run.max("bytes", step), run.max("bytes_received", step))


def paper(name, ranks):
    if name not in PAPER or ranks not in PAPER_RANKS:
        return "-"
    return f"{PAPER[name][PAPER_RANKS.index(ranks)]:.1f}"


def find_counted_bars(runs):
    """(what, found, most) for what depends neither on the machine nor on what else it does."""
    bars = []
    for run in runs[1:]:
        for step in ("close", "project", "relink"):
            bars.append((f"{run.ranks} ranks: {step}, messages for each exchange and neighbor by shared nodes",
                         run.messages_a_neighbor(step), 1))
    slope = own_bytes_a_rank(runs)
    if slope is not None:
        bars.append((f"{runs[-1].ranks} ranks: our own arrays, bytes for each rank more", slope, 64))
    prints = {r["fingerprint"] for run in runs for r in run.reports}
    bars.append(("different meshes", len(prints), 1))
    return bars


def find_bars(runs):
    """(what, found, most) for each bar."""
    first = runs[0]
    bars = []
    for run in runs[1:]:
        most = {32: 1.25, 64: 1.35}.get(run.ranks)
        if most:
            total = first.sum("compute", *first.steps)
            rest = [s for s in run.steps if s not in BALANCING]
            bars.append((f"{run.ranks} ranks: summed compute over that of {first.ranks}",
                         run.sum("compute", *run.steps) / total, most))
            bars.append((f"{run.ranks} ranks: the same without balancing, which {first.ranks} has not",
                         run.sum("compute", *rest) / total, most))
        bars.append((f"{run.ranks} ranks: largest rank over mean, after balancing", run.imbalance(*AFTER_BALANCING),
                     1.15))
        bars.append((f"{run.ranks} ranks: largest rank over mean, cells", run.cells_imbalance(), 1.05))
        for step in run.steps:
            bars.append((f"{run.ranks} ranks: {step}, bytes of a rank for each cell of an even share",
                         moved(run, step) * run.ranks / run.cells_out, BYTES_A_CELL))
        bars.append((f"{run.ranks} ranks: memory of the largest rank, of an even share of that on {first.ranks}",
                     run.memory() * run.ranks / (first.memory() * first.ranks), 1.3 if run.ranks == 64 else 2))
    return bars + find_counted_bars(runs)


BYTES_A_CELL = 250  # a row of every array of the file, its fields and numbers, once


def print_bars(bars):
    """Prints those that are missed, and the closest of each kind. Returns whether all are kept."""
    closest = {}
    for what, found, most in bars:
        kind = re.sub(r"^\d+ ranks: ", "", what)
        if kind not in closest or found / most > closest[kind][1] / closest[kind][2]:
            closest[kind] = (what, found, most)
    shown = [bar for bar in bars if bar[1] > bar[2] or closest.get(re.sub(r"^\d+ ranks: ", "", bar[0])) == bar]
    print("Bars: of each kind the closest, and all that are missed\n")
    table(["bar", "found", "at most", ""],
          [[what, number(found), number(most), "pass" if found <= most else "FAIL"] for what, found, most in shown])
    return all(found <= most for _, found, most in bars)


def main():
    arguments = [a for a in sys.argv[1:] if a not in ("--no-bars", "--counts")]
    if len(arguments) != 1:
        sys.exit(__doc__)
    runs = load(arguments[0])
    write_csv(arguments[0], runs)
    print_tables(runs)
    if "--no-bars" in sys.argv[1:] or len(runs) < 2:
        return 0
    return 0 if print_bars(find_counted_bars(runs) if "--counts" in sys.argv[1:] else find_bars(runs)) else 1


if __name__ == "__main__":
    sys.exit(main())
