#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Charges of one sphere of constant potential, by nodal reactions, compared with the table of expected.csv.

Usage: run.py sector|octant [--tools FOLDER] [--out FOLDER] [--ranks N] [--layers M] [--max-cells N] [--radius A]...

sector  a narrow sector of the shell, one solve for each row of the table, M layers of cells (default 220)
octant  an octant refined by the loop solve, mark, refine (goal: the charge) up to N cells (default 300,000); rows with
        a radius of at most 2 Debye lengths
Exit code 1 when a charge is farther from the table than expected.csv allows.
"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys

import shell

HERE = pathlib.Path(__file__).resolve().parent
FULL_LAYERS = 220  # for which expected.csv has tolerances


def write_case(name, radius, potential, sides, goal):
    text = f'[[sphere]]\npatch = "sphere"\ncenter = [0, 0, 0]\nradius = {radius}\n'
    if goal:
        text += '[estimator]\ngoal = "charge"\ngoal_patch = "sphere"\n'
    text += f'[boundary.sphere]\nkind = "potential"\nvalue = {potential}\n'
    text += '[boundary.outer]\nkind = "far-field"\n'
    text += "".join(f'[boundary.{side}]\nkind = "symmetry"\n' for side in sides)
    pathlib.Path(name).write_text(text, encoding="utf-8")


def write_mesh(name, radius, **options):
    points, cells, neighbors, patches = shell.shell(radius, radius + 8, **options)
    toml = "".join(f'[[surface]]\nname = "{surface}"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = {float(r)!r}\n'
                   for surface, r in (("sphere", radius), ("outer", radius + 8)))
    shell.write(name, points, cells, neighbors, patches, ["sphere", "outer", "", "", ""], toml)
    return patches[2:]


def sector(o, folder, radius, potential):
    sides = write_mesh(folder / "mesh.hdf", radius, n=10, layers=o.layers, growth=40, width=0.05)
    write_case(folder / "case.toml", radius, potential, sides, False)
    subprocess.run(["mpirun", "-n", str(o.ranks), "pamr-pb", folder / "case.toml", "--mesh", folder / "mesh.hdf",
                    "-o", folder / "psi.hdf", "--force", "--quiet", "--json", folder / "solve0.json"], check=True)
    return [json.loads((folder / "solve0.json").read_text())]


def octant_case(folder, radius, potential):
    n, layers = (8, 16) if radius >= 1 else (6, 20)
    sides = write_mesh(folder / "mesh.hdf", radius, n=n, layers=layers, growth=8 / radius if radius < 1 else 10)
    write_case(folder / "case.toml", radius, potential, sides, True)


# The cells of this mesh have mean ratios from 0.45: with the default floor of 0.35 half as many marks fit into the cells.
def octant(o, folder, radius, potential):
    octant_case(folder, radius, potential)
    subprocess.run([HERE.parent / "goal_loop.sh", folder / "case.toml", folder / "mesh.hdf", folder,
                    str(o.ranks), "8", str(o.max_cells), "--bulk-of", "goal_error:0.5", "--shape-floor", "0.3"], check=True)
    reports = []
    while (name := folder / f"solve{len(reports)}.json").exists():
        reports.append(json.loads(name.read_text()))
    return reports


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("sector", "octant"))
    parser.add_argument("--tools")
    parser.add_argument("--out", default=HERE / "out", type=pathlib.Path)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--layers", type=int, default=FULL_LAYERS)
    parser.add_argument("--max-cells", type=int, default=300000)
    parser.add_argument("--radius", type=float, action="append")
    o = parser.parse_args()
    if o.tools:
        os.environ["PATH"] = o.tools + os.pathsep + os.environ["PATH"]
    with open(HERE / "expected.csv", encoding="utf-8") as file:
        rows = [(float(r["radius"]), float(r["potential"]), float(r["charge_density"]), float(r[o.part] or 0))
                for r in csv.DictReader(line for line in file if not line.startswith("#"))]
    wrong = 0
    print("radius  potential     cells  charge density       exact  rel. error   levels before")
    for radius, potential, exact, tolerance in rows:
        if (o.part == "octant" and radius > 2) or (o.radius and radius not in o.radius):
            continue
        folder = o.out / f"{o.part}-{radius:g}-{potential:g}"
        folder.mkdir(parents=True, exist_ok=True)
        reports = globals()[o.part](o, folder, radius, potential)
        errors = [r["charge_densities"]["sphere"] / exact - 1 for r in reports]
        last = reports[-1]
        print(f"{radius:<9g} {potential:>7g} {last['cells']:>9}  {last['charge_densities']['sphere']:>14.8f} "
              f"{exact:>11.8f}  {errors[-1]:>10.2e}   " + " ".join(f"{e:.1e}" for e in errors[:-1]), flush=True)
        if o.part == "sector":
            tolerance *= (FULL_LAYERS / o.layers)**2
        if not abs(errors[-1]) <= tolerance:
            print(f"run.py: radius {radius:g}, {potential:g} kT/Ze: expected {exact:.8f} within {tolerance:.1e} of it", file=sys.stderr)
            wrong = 1
        for mesh in folder.glob("*.hdf"):
            mesh.unlink()
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
