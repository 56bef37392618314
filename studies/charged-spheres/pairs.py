#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of other sizes, places and potentials over the plate: every level's forces with their error bars beside values of
another code (pairs.csv, made by reference.py --degree 3 --spheres).

Usage: pairs.py [--order 1|2] [--levels N] [--max-cells N] [--ranks N] [--out FOLDER] [--tools FOLDER]

Prints a row for each level and force; `bar/error` is the printed error bar over the true error. Exit code 1 if a bar of
a last level does not hold the other code's value, or if the median of bar/error over all rows is above 25.
"""
import argparse
import csv
import json
import os
import pathlib
import statistics
import subprocess
import sys

import sweep

HERE = pathlib.Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"


def case_of(pair, order=1):
    text = (CASES / "charged-spheres" / "reading-b.toml").read_text(encoding="utf-8")
    for key in ("radius", "distance", "height"):
        for table in ("mesh.geometry", "pair"):
            text = sweep.replaced(text, table, key, float(pair[key]))
    for patch in ("sphere", "plate"):
        text = sweep.replaced(text, f"boundary.{patch}", "value", float(pair[patch]))
    return text + f"\n[solver]\norder = {order}\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--order", type=int, default=1, help="of the elements")
    parser.add_argument("--levels", type=int, default=4)
    parser.add_argument("--max-cells", type=int, default=150000)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "out" / "pairs")
    parser.add_argument("--tools")
    o = parser.parse_args()
    if o.tools:
        os.environ["PATH"] = o.tools + os.pathsep + os.environ["PATH"]
    with open(HERE / "pairs.csv", encoding="utf-8") as file:
        pairs = list(csv.DictReader(line for line in file if not line.startswith("#")))
    ratios, missed = [], []
    print("radius distance height sphere plate  level    cells  force        value          bar   other code  bar/error")
    for number, pair in enumerate(pairs):
        folder = o.out / str(number)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "case.toml").write_text(case_of(pair, o.order), encoding="utf-8")
        subprocess.run(["pamr-mesh", folder / "case.toml", "-o", folder / "mesh.hdf", "--force", "--quiet"], check=True)
        subprocess.run([CASES / "goal_loop.sh", folder / "case.toml", folder / "mesh.hdf", folder, str(o.ranks), str(o.levels),
                        str(o.max_cells), "--bulk-of", "goal_error:0.5"], check=True)
        n_levels = len(list(folder.glob("solve*.json")))
        what = " ".join(f"{float(pair[key]):{width}g}" for key, width in
                        (("radius", 6), ("distance", 8), ("height", 6), ("sphere", 6), ("plate", 5)))
        for level in range(n_levels):
            report = json.loads((folder / f"solve{level}.json").read_text())
            for force in ("force-x", "force-z"):
                best, truth = report["best"]["sphere"][force], float(pair[force])
                error, bar = abs(best["value"] - truth), best["error"]
                is_last = level == n_levels - 1
                if is_last and (bar is None or error > bar):
                    missed.append(f"{what} {force}")
                if bar is not None:
                    ratios.append(bar / error)
                shown = f"{bar:12.2g} {truth:12.6g} {bar / error:10.2f}" if bar is not None else f"{'-':>12} {truth:12.6g}"
                print(f"{what} {level:6} {report['cells']:8}  {force} {best['value']:12.6g} {shown}", flush=True)
        for mesh in folder.glob("*.hdf"):
            mesh.unlink()
    median = statistics.median(ratios)
    print(f"{len(ratios)} values, {sum(r < 1 for r in ratios)} outside of their bars, median of bar/error {median:.2f}")
    for name in missed:
        print(f"pairs.py: expected {name} within its bar, found it outside", file=sys.stderr)
    return 1 if missed or median > 25 else 0


if __name__ == "__main__":
    sys.exit(main())
