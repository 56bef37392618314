#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading B by elements of first and of second order: error against processor time, level by level, beside dolfinx with
quadratic and cubic elements on meshes by Gmsh (reference.py --spheres).

Usage: orders.py [--orders 1 2] [--levels N N] [--max-cells N N] [--bulk SHARE] [--sizes2 H...] [--sizes3 H...]
                 [--out FOLDER] [--tools FOLDER]

--levels and --max-cells have a number for each order. The mesh of level 0 is given to all and not timed. Processor time
of ours is that of all programs of all levels up to this one, from the file of level 0: solve, mark, refine, with starting
and with files. That of dolfinx is of one solution with its forces, without Gmsh, without imports and without compiling forms. An error
is that of the value over the truth (truth.csv); `bar/error` is the printed error bar over the true error.
Exit code 1 if the last level of an order has a bar that, with what the truth is known to, does not hold it.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import resource
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"
REFERENCE = HERE / "reference.py"
QUANTITIES = ("force-x", "force-z")


def read_truth():
    with open(HERE / "truth.csv", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {row["quantity"]: (float(row["value"]), float(row["known"])) for row in rows if row["case"] == "reading-b"}


def cpu_seconds(command):
    """Runs it; the processor time that it took with all its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def head():
    columns = "".join(f" {name:>12} {'error':>9} {'bar/error':>9}" for name in QUANTITIES)
    print(f"{'':14} level    cells unknowns   CPU s{columns}", flush=True)


def show(name, level, cells, unknowns, seconds, values, bars, truth):
    """One row; the bars that do not hold the truth."""
    text, missed = f"{name:14} {level:>5} {cells:8} {unknowns:8} {seconds:7.2f}", []
    for quantity, value, bar in zip(QUANTITIES, values, bars):
        true, known = truth[quantity]
        error = abs(value - true)
        ratio = f"{bar / error:9.2f}" if bar is not None else f"{'':9}"
        text += f" {value:12.7f} {error / abs(true):9.1e} {ratio}"
        if bar is not None and error > bar + known:
            missed.append(f"{name} level {level} {quantity}")
    print(text, flush=True)
    return missed


def run_order(o, order, levels, max_cells, mesh, truth):
    case = o.out / f"order{order}.toml"
    text = (CASES / "charged-spheres" / "reading-b.toml").read_text(encoding="utf-8")
    case.write_text(text + f"\n[solver]\norder = {order}\n", encoding="utf-8")
    seconds, start, missed = 0.0, [], []
    for level in range(levels + 1):
        solved, report = o.out / "solved.hdf", o.out / f"order{order}-{level}.json"
        seconds += cpu_seconds(["pamr-pb", case, "--mesh", mesh, "-o", solved, "--force", "--quiet", "--json", report, *start])
        result = json.loads(report.read_text())
        best = [result["best"]["sphere"][quantity] for quantity in QUANTITIES]
        missed = show(f"order {order}", level, result["cells"], result["unknowns"], seconds, [b["value"] for b in best],
                      [b["error"] for b in best], truth)
        if level == levels or result["cells"] >= 0.97 * max_cells:
            break
        marked, refined = o.out / "marked.hdf", o.out / "refined.hdf"
        seconds += cpu_seconds(["pamr-mark", solved, "-o", marked, "--force", "--quiet", "--bulk-of", f"goal_error:{o.bulk}",
                                "--max-cells", str(max_cells)])
        seconds += cpu_seconds(["pamr-refine", marked, "-o", refined, "--force", "--quiet"])
        mesh, start = refined, ["--start", "potential"]
    return missed


def reference(degree, size):
    command = ["/usr/bin/python3", REFERENCE, "--degree", str(degree), "--size", str(size), "--spheres"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def run_dolfinx(degree, sizes, truth):
    if sizes:
        reference(degree, 0.3)  # compiles the forms, which dolfinx keeps
    for size in sizes:
        text = reference(degree, size)
        cells, unknowns = re.search(r"(\d+) cells, (\d+) unknowns", text).groups()
        force_x = re.search(r"mid-plane (\S+)", text).group(1)
        force_z = re.search(r"force-z (\S+)", text).group(1)
        seconds = re.search(r"solved in (\S+)", text).group(1)
        show(f"dolfinx P{degree}", "", cells, unknowns, float(seconds), [float(force_x), float(force_z)], [None, None], truth)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--orders", type=int, nargs="*", default=[1, 2])
    parser.add_argument("--levels", type=int, nargs="*", default=[6, 5])
    parser.add_argument("--max-cells", type=int, nargs="*", default=[700000, 42000])
    parser.add_argument("--bulk", type=float, default=0.5)
    parser.add_argument("--sizes2", type=float, nargs="*", default=[0.15, 0.1, 0.07, 0.05])
    parser.add_argument("--sizes3", type=float, nargs="*", default=[0.15, 0.1, 0.08])
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "out" / "orders")
    parser.add_argument("--tools")
    o = parser.parse_args()
    if o.tools:
        os.environ["PATH"] = o.tools + os.pathsep + os.environ["PATH"]
    o.out.mkdir(parents=True, exist_ok=True)
    truth = read_truth()
    mesh = o.out / "mesh.hdf"
    subprocess.run(["pamr-mesh", CASES / "charged-spheres" / "reading-b.toml", "-o", mesh, "--force", "--quiet"], check=True)
    head()
    missed = []
    for order, levels, max_cells in zip(o.orders, o.levels, o.max_cells):
        missed += run_order(o, order, levels, max_cells, mesh, truth)
    run_dolfinx(2, o.sizes2, truth)
    run_dolfinx(3, o.sizes3, truth)
    for name in missed:
        print(f"orders.py: expected {name} within its bar, found it outside", file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
