#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS: the runs compared with expected.csv; exit code 1 if a quantity is out of its bounds."""
import csv
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from bounds import all_within  # noqa: E402

out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
with open(out / "table.csv", encoding="ascii") as file:
    rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
last = rows[-1]
checks = [out / f"levels{level}" / "turn9/log.checkMesh" for level in range(1, levels + 1)]
measured = {
    "cells": last["cells"],
    "bad_reports_of_checkMesh": sum("\nMesh OK.\n" not in log.read_text() for log in checks),
    "error": last["error"],
    "rate": math.log2(rows[-2]["error"] / last["error"]),
    "peak": last["peak"],
    "least": last["least"],
    "off": last["off"],
    "lost_when_adapting": max(row["lost_when_adapting"] for row in rows),
    "lost_in_all": last["lost_in_all"],
    "min_mean_ratio": min(row["min_mean_ratio"] for row in rows),
}
good = all_within(measured, pathlib.Path(__file__).parent / "expected.csv")
sys.exit(0 if good and len(rows) == levels else 1)
