#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Force and interaction energy over the distance of the spheres or over their height, or force over the place of the end
wall, each value by its own mesh and loop of solving, marking and refining.

Usage: sweep.py CASE.toml --vary distance|height|half_length VALUE... [--levels N] [--max-cells N] [--ranks N]
                [--out FOLDER] [--tools FOLDER]

CASE.toml has [mesh.geometry] and [pair] with this length (reading-b.toml), or half_length, the place x of the end wall,
in [mesh.geometry] (end-wall.toml; the force is f_x by the volume form, without an energy). VALUES are in the unit of the
mesh, Debye lengths. Prints a table and writes FOLDER/sweep.csv. The energy (unit: force unit times Debye length) is the
integral of the force, f_x over the distance or f_z over the height, from the value to infinity: between the values the
force is taken as exponential, beyond the last as exp(-distance) (pairs) or exp(-height).
"""
import argparse
import csv
import json
import math
import os
import pathlib
import re
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"


def replaced(text, table, key, value):
    """The case with another number for `key` of [table]."""
    pattern = re.compile(rf"(?ms)^\[{re.escape(table)}\]\n.*?^{key} = ([^\n#]*)")
    found = pattern.search(text)
    if not found:
        raise SystemExit(f"sweep.py: expected {key} in [{table}] of the case")
    return text[:found.start(1)] + repr(value) + " " + text[found.end(1):]


def energies(places, forces):
    """Integrals of the force from each place to infinity."""
    result = [forces[-1]]
    for i in range(len(places) - 2, -1, -1):
        a, b, width = forces[i], forces[i + 1], places[i + 1] - places[i]
        rate = math.log(a / b) if a * b > 0 else 0
        part = width * ((a - b) / rate if abs(rate) > 1e-9 else (a + b) / 2)
        result.insert(0, result[0] + part)
    return result


def solve(o, value):
    folder = o.out / f"{o.vary}-{value:g}"
    folder.mkdir(parents=True, exist_ok=True)
    text = pathlib.Path(o.case).read_text(encoding="utf-8")
    for table in ("mesh.geometry",) if o.vary == "half_length" else ("mesh.geometry", "pair"):
        text = replaced(text, table, o.vary, value)
    (folder / "case.toml").write_text(text, encoding="utf-8")
    subprocess.run(["pamr-mesh", folder / "case.toml", "-o", folder / "mesh.hdf", "--force", "--quiet"], check=True)
    goal = "goal_error:0.5"
    subprocess.run([CASES / "goal_loop.sh", folder / "case.toml", folder / "mesh.hdf", folder, str(o.ranks), str(o.levels),
                    str(o.max_cells), "--bulk-of", goal], check=True)
    last = max(folder.glob("solve*.json"), key=lambda name: int(re.search(r"\d+", name.stem).group()))
    report = json.loads(last.read_text())
    for mesh in folder.glob("*.hdf"):
        mesh.unlink()
    force = report["forces"]["sphere"]
    if o.vary == "distance":
        return report["cells"], force["midplane"]["dimensionless"][0], report["goal"]["correction"], report["units"]
    if o.vary == "half_length":
        return report["cells"], force["volume"]["dimensionless"][0], report["goal"]["correction"], report["units"]
    return report["cells"], force["volume"]["dimensionless"][2], 0.0, report["units"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case")
    parser.add_argument("--vary", choices=("distance", "height", "half_length"), required=True)
    parser.add_argument("values", type=float, nargs="+")
    parser.add_argument("--levels", type=int, default=4)
    parser.add_argument("--max-cells", type=int, default=200000)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "out" / "sweep")
    parser.add_argument("--tools")
    o = parser.parse_args()
    if o.tools:
        os.environ["PATH"] = o.tools + os.pathsep + os.environ["PATH"]
    o.values.sort()
    rows = [solve(o, value) for value in o.values]
    forces = [force for _, force, _, _ in rows]
    # The wall is no coordinate of the spheres: there is no energy to a force over its place.
    energy = [math.nan] * len(forces) if o.vary == "half_length" else energies(o.values, forces)
    unit = rows[0][3]["force_newton"]
    with open(o.out / "sweep.csv", "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([o.vary, "cells", "force", "estimated_error", "force_newton", "energy"])
        print(f"{o.vary:>11}   cells        force  estim. error     newton         energy")
        for value, (cells, force, correction, _), total in zip(o.values, rows, energy):
            writer.writerow([value, cells, force, correction, unit * force, total])
            print(f"{value:11g} {cells:>7} {force:>12.5e} {correction:>13.2e} {unit * force:>10.3e} {total:>14.5e}")


if __name__ == "__main__":
    main()
