#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS: the table of levels; exit code 1 when a number is not as in expected.csv."""
import json
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.append(str(FOLDER.parent))
from bounds import rows_of  # noqa: E402

out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
rows = rows_of(FOLDER / "expected.csv")
exact, largest_error = ({row["quantity"]: float(row[column]) for row in rows} for column in ("value", "largest_error"))
failed = []
print("+-: bounds of 95 %\nlevel      C_D  +-        facets    sphere   off       C_H  +-        facets    sphere   off")
last = None
for level in range(levels + 1):
    report = json.load(open(out / f"level{level}.json"))
    facets = report["plan"]["free_molecular"]
    cells, offs = [], {}
    for name in ("C_D", "C_H"):
        value, error, half = (report[name][key] for key in ("value", "stderr", "ci95"))
        cells.append(f"{value:8.4f}  {half:7.4f}  {facets[name]:8.4f}  {exact[name]:8.4f} {100 * (value / exact[name] - 1):+6.2f}%")
        if not error <= largest_error[name] * value:
            failed.append(f"level {level}: the standard error of {name} is {error:.4f}, expected at most {largest_error[name] * value:.4f}")
        if not abs(value - facets[name]) <= 4 * error:
            failed.append(f"level {level}: {name} is {value:.4f} +- {half:.4f}, the closed form on the facets is {facets[name]:.4f}")
        offs[name] = abs(facets[name] / exact[name] - 1)
        if last and offs[name] > last[name] / 3:
            failed.append(f"level {level}: the facets' error of {name} is {offs[name]:.5f} after {last[name]:.5f}: not three times smaller")
    if report["lost_particles"] != 0:
        failed.append(f"level {level}: lost particles")
    last = offs
    print(f"{level:5}  " + "  ".join(cells))
print("\n".join(failed) if failed else "all as expected")
sys.exit(1 if failed else 0)
