#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT: collision rate and relaxation compared with expected.csv; exit code 1 if they differ by more than four
standard errors and the bound. Both are compared at the temperatures and the density that the particles drawn have."""
import csv
import math
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.append(str(FOLDER.parent))
from bounds import rows_of, student_95  # noqa: E402

out = pathlib.Path(sys.argv[1])
expected = {r["quantity"]: r for r in rows_of(FOLDER / "expected.csv")}
failed = False


def history(name):
    return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(open(out / f"{name}.csv"))]


def show(what, value, error, factor, theory, bar, largest_error=math.inf):
    """`factor`: from the standard error `error` to the bound of 95 %."""
    global failed
    ok = abs(value - theory) <= 4 * error + bar and error <= largest_error
    failed = failed or not ok
    print(f"{what:14} {value:12.6g} +- {factor * error:9.3g}   theory {theory:12.6g}   {'ok' if ok else 'NOT AS EXPECTED'}")


rows = [r for r in history("collision-rate") if r["averaged"] == 1]
rates = [2 * r["collisions_per_particle_step"] / 7e-9 for r in rows]
mean = sum(rates) / len(rates)
error = math.sqrt(sum((r - mean) ** 2 for r in rates) / (len(rates) - 1) / len(rates))
temperature = rows[-1]["T_tr"]
show("nu (1/s)", mean, error, student_95(len(rates)), float(expected["nu"]["value"]) * (temperature / 273.15) ** 0.19, 0,
     float(expected["nu"]["largest_error"]))

rows = history("case")
n, tau = rows[0]["particles"], 2.43426e-7
for times in (4, 8, 20):
    row = rows[5 * times - 1]
    for name, degrees in (("T_tr", 3), ("T_rot", 2)):
        one = expected[f"{name}({times} tau)"]
        # Spread of the mean energy of n molecules drawn at 500 K and 100 K, and of their exchange.
        spread = row["T_rot"] * math.sqrt(1 / n) * 2 / degrees + 500 * math.sqrt(2 / 3 / n) * 0.6
        show(f"{name}({times} tau)", row[name], spread, 1.96, float(one["value"]), float(one["bar"]))
sys.exit(1 if failed else 0)
