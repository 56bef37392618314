#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints a table of the levels of a Poisson-Boltzmann run and compares its last level with expected.csv.

Usage: goal_levels.py FOLDER COLUMN... [--expected FILE --case NAME]

FOLDER holds solve<i>.json. COLUMN is `title=path`, a path like forces.sphere.midplane.dimensionless.0 in the report of
pamr-pb. The rows `case,quantity,value,tolerance` of FILE whose case is NAME are compared with the last level: tolerances
are relative. Exit code 1 when a number is not as expected or none.
"""
import argparse
import csv
import json
import os
import sys


def value_at(report, path):
    for key in path.split("."):
        report = report[int(key)] if isinstance(report, list) else report[key]
        if report is None:
            return None
    return report


def shown(value):
    return "-" if value is None else f"{value}" if isinstance(value, int) else f"{value:.6g}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("columns", nargs="*")
    parser.add_argument("--expected")
    parser.add_argument("--case")
    o = parser.parse_args()
    reports = []
    while os.path.exists(name := os.path.join(o.folder, f"solve{len(reports)}.json")):
        with open(name, encoding="utf-8") as file:
            reports.append(json.load(file))
    if not reports:
        sys.exit(f"goal_levels.py: expected solve0.json in {o.folder}, found none")

    columns = [c.split("=", 1) for c in ["nodes=nodes", "cells=cells", *o.columns]]
    rows = [["level"] + [title for title, _ in columns]]
    for level, report in enumerate(reports):
        rows.append([str(level)] + [shown(value_at(report, path)) for _, path in columns])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        print("  ".join(cell.rjust(width) for cell, width in zip(row, widths)))

    wrong = compared = 0
    if o.expected:
        with open(o.expected, encoding="utf-8") as file:
            for row in csv.DictReader(line for line in file if not line.startswith("#")):
                if row["case"] != o.case:
                    continue
                compared += 1
                found, wanted = value_at(reports[-1], row["quantity"]), float(row["value"])
                most = float(row["tolerance"]) * abs(wanted)
                if found is None or not abs(found - wanted) <= most:
                    print(f"{o.case}: expected {row['quantity']} = {wanted:g} within {shown(most)}, found {shown(found)}",
                          file=sys.stderr)
                    wrong = 1
        if compared == 0:
            sys.exit(f"goal_levels.py: expected rows of {o.case} in {o.expected}, found none to compare with")
    return wrong


if __name__ == "__main__":
    sys.exit(main())
