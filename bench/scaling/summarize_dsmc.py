#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Table from the reports of bench_dsmc that scaling-dsmc.sh collects.

    summarize_dsmc.py FOLDER     with run-RANKS.txt in it; exit code 1 when a bar is missed or results differ
"""
import pathlib
import re
import sys

BARS = {"exchanges": 2.0, "reductions": 3.0}  # a step
RANK = re.compile(r"rank \d+: (\S+) CPU s, (\S+) of them computing; (\d+) particles, (\d+) cells in the halo, (\S+) messages of (\S+) bytes a step, "
                  r"(\S+) MB")


def read(path):
    text = path.read_text()
    names = ("cpu", "computing", "particles", "halo", "messages", "bytes", "memory")
    per_rank = [dict(zip(names, map(float, found))) for found in RANK.findall(text)]
    head = re.search(r"(\d+) particles, (\d+) cells, (\d+) ranks, (\d+) steps", text)
    step = re.search(r"per step: (\S+) exchanges, (\S+) reductions", text)
    assert head and step and len(per_rank) == int(head[3]), path
    return {"particles": int(head[1]), "cells": int(head[2]), "steps": int(head[4]), "ranks": per_rank,
            "same": re.search(r"in all: .*", text)[0], "exchanges": float(step[1]), "reductions": float(step[2])}


def main():
    runs = {int(path.stem.split("-")[1]): read(path) for path in pathlib.Path(sys.argv[1]).glob("run-*.txt")}
    first = runs[min(runs)]
    print(f"{first['particles']} particles at the end, {first['cells']} cells, {first['steps']} steps.\n")
    print("| ranks | particles of the fullest rank over the mean | computing, s: all | slowest rank | over the mean | messages a step, of the rank "
          "with the most | KB a step, same | exchanges | reductions | cells of the halo, most | MB of a rank, most |")
    print("|" + "---|" * 11)
    missed = []
    for n, run in sorted(runs.items()):
        def most(name, ranks=run["ranks"]):
            return max(rank[name] for rank in ranks)

        def mean(name, ranks=run["ranks"]):
            return sum(rank[name] for rank in ranks) / len(ranks)

        print(f"| {n} | {most('particles') / mean('particles'):.3f} | {n * mean('computing'):.2f} | {most('computing'):.3f} | "
              f"{most('computing') / mean('computing'):.2f} | {most('messages'):.1f} | {most('bytes') / 1000:.1f} | {run['exchanges']:.2f} | "
              f"{run['reductions']:.2f} | {most('halo'):.0f} | {most('memory'):.0f} |")
        missed += [f"{n} ranks: {run[name]} {name} a step" for name, bar in BARS.items() if run[name] > bar]
        if run["same"] != first["same"]:
            missed.append(f"{n} ranks: {run['same']}, not {first['same']}")
    print()
    for line in missed:
        print("FAIL:", line)
    if not missed:
        print("pass: at most 2 exchanges and 3 reductions a step; crossings and collisions are the same on all numbers of ranks")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
