#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS RANKS: a run compared with expected.csv; exit code 1 if a quantity is out of its bounds."""
import csv
import math
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from bounds import all_within  # noqa: E402

out, levels, ranks = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
with open(out / "table.csv", encoding="ascii") as file:
    rows = list(csv.DictReader(file))
first, last = ({k: float(v) for k, v in row.items() if k != "format"} for row in (rows[0], rows[-1]))


def bad_checks():
    """Reports of checkMesh that do not end well."""
    logs = [out / f"level{level}" / name for level in range(levels + 1)
            for name in ["log.checkMesh"] + (["log.checkMesh-parallel"] if ranks > 1 else [])]
    return sum("\nMesh OK.\n" not in log.read_text() for log in logs)


def lost_kinds():
    boundary = (out / f"level{levels}/constant/polyMesh/boundary").read_text()
    kinds = dict(re.findall(r"(\w+)\s*\{\s*type\s+(\w+);", boundary))
    wanted = {"inner": "wall", "outer": "wall", "symmetryX": "symmetryPlane", "symmetryY": "symmetryPlane",
              "symmetryZ": "symmetryPlane"}
    return sum(kinds.get(name) != kind for name, kind in wanted.items())


def lost_entries():
    """Entries of boundaryField that are not those of the template."""
    text = (out / f"level{levels}/0/T").read_text(encoding="latin1")
    return sum(len(re.findall(entry, text)) != 1 for entry in (r"value\s+uniform 400;", r"value\s+uniform 300;",
                                                               r"dimensions\s+\[0 0 0 1 0 0 0\];"))


ratio = last["cells"] / first["cells"]
measured = {
    "bad_reports_of_checkMesh": bad_checks(),
    "lost_patch_kinds": lost_kinds(),
    "lost_entries": lost_entries(),
    "flux_error": last["flux_error"],
    "l2_rate": math.log(first["l2"] / last["l2"]) / math.log(ratio),
    "flux_difference": max(float(row["flux_difference"]) for row in rows),
    "first_residual": max(float(row["first_residual"]) for row in rows[1:]),
    "min_mean_ratio": min(float(row["min_mean_ratio"]) for row in rows),
}
good = all_within(measured, pathlib.Path(__file__).parent / "expected.csv")
sys.exit(0 if good and len(rows) == levels + 1 else 1)
