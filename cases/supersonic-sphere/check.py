#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT: the table of meshes; exit code 1 when a bound of expected.csv does not hold."""
import csv
import json
import pathlib
import sys

out = pathlib.Path(sys.argv[1])
bounds = list(csv.DictReader(open(pathlib.Path(__file__).parent / "expected.csv")))
failed = []
print("mesh            cells  mean ratio  particles   steps      C_D  +-        C_H  +-")
for name in ("flow0", "none", "isotropic", "short-edge", "removable"):
    report = json.load(open(out / f"{name}.json"))
    quality = out / f"{name}-quality.json"
    cells, ratio = ("level 0", "")
    if quality.exists():
        q = json.load(open(quality))
        cells, ratio = q["cells"], f"{q['mean_ratio']['min']:.3f}"
    d, h = report["C_D"], report["C_H"]
    print(f"{name:12} {cells:>8}  {ratio:>10}  {report['particles']:>9}  {report['steps']:>6}  {d['value']:7.4f}  "
          f"{d['stderr']:.4f}  {h['value']:7.4f}  {h['stderr']:.4f}")
    if report["lost_particles"] != 0:
        failed.append(f"{name}: lost particles")
    for bound in bounds:
        e = report[bound["quantity"]]
        if not float(bound["low"]) - 4 * e["stderr"] <= e["value"] <= float(bound["high"]) + 4 * e["stderr"]:
            failed.append(f"{name}: {bound['quantity']} is {e['value']:.4f}, expected {bound['low']} to {bound['high']}")
print("\n".join(failed) if failed else "within the bounds")
sys.exit(1 if failed else 0)
