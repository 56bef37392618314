#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""heat_flux.py FOLDER LEVELS: heat flux at the thermocouples and drag of Set 1; exit code 1 when a bound does not hold."""
import csv
import json
import math
import pathlib
import sys

# kW/m2 by S/Rn: the experiment with the bound on the finest level, and two other codes.
with open(pathlib.Path(__file__).parent / "heat-flux.csv", encoding="utf-8") as table:
    STATIONS = {f"S/Rn {row['s_over_rn']}": (float(row["experiment"]), float(row["bound"]) if row["bound"] else None,
                                             float(row["PICLas"]), float(row["SPARTA"]), float(row["found"]), float(row["ci95"]))
                for row in csv.DictReader(line for line in table if not line.startswith("#"))}
DRAG = (1.640, 0.015)  # SPARTA, axisymmetric, fore-body with shoulder; 0.9 % below it were found
BLOCKS_95 = 2.093  # Student's factor of the twenty blocks that errors of faces come from
FOUR_ERRORS = 4 / BLOCKS_95
OTHER_MESH = 0.01  # how much another mesh of level 1 may change a heat flux

folder, finest = pathlib.Path(sys.argv[1]), int(sys.argv[2])
failed = []
print("level    cells    C_D  +-     " + "".join(f"  q({name})  +-   " for name in STATIONS))
for level in range(finest + 1):
    with open(folder / f"flow{level}.json", encoding="utf-8") as file:
        flow = json.load(file)
    with open(folder / f"quality{level}.json", encoding="utf-8") as file:
        cells = json.load(file)["cells"]
    with open(folder / f"lines{level}.csv", encoding="utf-8") as file:
        q = {row["name"]: (float(row["value"]) / 1e3, BLOCKS_95 * float(row["stderr"]) / 1e3)
             for row in csv.DictReader(file) if row["quantity"] == "q"}
    drag = flow["patches"]["forebody"]["C_D"]
    print(f"{level:5d} {cells:8d} {drag['value']:6.4f} {drag['ci95']:.4f}  "
          + "   ".join(f"{q[name][0]:9.2f} {q[name][1]:.2f}" for name in STATIONS))
print("experiment".ljust(31) + "   ".join(f"{v[0]:9.2f}     " for v in STATIONS.values()))
print("PICLas".ljust(31) + "   ".join(f"{v[2]:9.2f}     " for v in STATIONS.values()))
print(f"SPARTA         {DRAG[0]:6.3f}".ljust(31) + "   ".join(f"{v[3]:9.2f}     " for v in STATIONS.values()))
print("kW/m2, with bounds of 95 %; the last thermocouple has no bound: all codes lie above it")
for name, (measured, bound, _, _, before, its_half) in STATIONS.items():
    value, half = q[name]
    allowed = FOUR_ERRORS * math.hypot(half, its_half) + OTHER_MESH * before
    if finest == 1 and not (abs(value - before) <= allowed and half <= 2 * its_half):
        failed.append(f"{name}: expected {before} within {allowed:.2f}, its bound of 95 % at most {2 * its_half:.2f}, found {value:.2f} "
                      f"+- {half:.2f}")
    if bound is None:
        continue
    if half > 0.042 * value:
        failed.append(f"{name}: expected a bound of 95 % of at most 4.2 %, found {100 * half / value:.1f} %")
    if abs(value / measured - 1) > bound:
        failed.append(f"{name}: expected {measured} within {100 * bound:.0f} %, found {value:.2f}")
if not abs(drag["value"] / DRAG[0] - 1) <= DRAG[1]:
    failed.append(f"C_D: expected {DRAG[0]} within {100 * DRAG[1]:.1f} %, found {drag['value']:.4f}")
print("\n".join(failed) if failed else "within the bounds")
sys.exit(1 if failed else 0)
