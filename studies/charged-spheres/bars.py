#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do the error bars of corrected goals hold on elements of second order, and how much too wide are they? Cases of known
values, at level 0 and on levels refined by `--bulk-of goal_error:0.5`.

Usage: bars.py [CASE...] [--order 1|2] [--levels N] [--max-cells N] [--out FOLDER] [--tools FOLDER]

CASE is the beginning of a name: rod (cases/charged-rod), isolated (pairs without plate, sphere-pair), sphere (charges,
charged-sphere), pair and reading-b (pairs.csv, truth.csv), ellipsoid (ellipsoid-plate). Default: all.

A row for each level and goal: the errors of the value and of the corrected value, the bar and what the truth is known
to, all over the value (f_x and the torque of the ellipsoid over its f_z), and the bar over the error. Where the error is
within what the truth is known to, it is no error: no ratio. A bar misses if the error is larger than the bar and what
the truth is known to. A bar that pamr-pb withholds has no part in this. Exit code 1 if more than one bar in twenty misses or the median of the ratios is above 15.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
CASES = HERE.parents[1] / "cases"
sys.path += [str(CASES / "charged-sphere"), str(CASES / "sphere-pair")]
import pair_case  # noqa: E402
import pairs  # noqa: E402
import run as one_sphere  # noqa: E402

SPHERES = [(0.325, 1), (0.325, 3), (0.325, 5), (1, 1), (1, 3), (1, 5), (2, 3), (2, 5)]
#: By reference.py with degree 3 and --size 0.1; its coarser mesh differs by this.
ELLIPSOID = {"force-z": (10.2006, 1.3e-3), "torque-y": (0.2607, 1e-4), "force-x": (0.0, 3e-4), "charge": (15.1592, 5e-4)}


def rows_of(name):
    with open(name, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def with_order(text, order):
    return text + f"\n[solver]\norder = {order}\n"


def with_goals(text, goals):
    return re.sub(r'(?m)^goals? = .*$', "goals = " + json.dumps(goals), text)


def make_mesh(folder):
    subprocess.run(["pamr-mesh", folder / "case.toml", "-o", folder / "mesh.hdf", "--force", "--quiet"], check=True)


class Case:
    """Writes case.toml and mesh.hdf into a folder; `truth` has goals with their value, how well it is known, and what
    errors are relative to."""

    def __init__(self, name, text, truth, prepare=make_mesh):
        self.name, self.text, self.truth, self.prepare = name, text, truth, prepare


def relative(values):
    return {goal: (value, known, abs(value)) for goal, (value, known) in values.items()}


def rods():
    exact = {"case": {}, "eccentric": {}}
    energy = {"goals.1.corrected": "energy", "goals.2.corrected": "energy"}
    for row in rows_of(CASES / "charged-rod" / "expected.csv"):
        goal = energy.get(row["quantity"], row["quantity"].split(".")[-2])
        exact[row["case"]][goal] = (float(row["value"]), 1e-9)
    for name, values in exact.items():
        yield Case(f"rod {name}", (CASES / "charged-rod" / f"{name}.toml").read_text(), relative(values))


def isolated():
    for row in rows_of(CASES / "sphere-pair" / "expected.csv"):
        radius, distance = (float(number) for number in row["case"].split("-")[:2])
        away = radius + 11  # the box of the case is too near for these errors
        box = f"half_length = {distance / 2 + away}\nwidth = {away}\ntop = {away}\n"
        text = pair_case.case_of(row["case"]).replace("[mesh.sizes]", box + "\n[mesh.sizes]")
        value = float(row["value"])
        yield Case(f"isolated {row['case']}", text, relative({"midplane": (value, 1e-7 * value)}))


def spheres():
    for row in rows_of(CASES / "charged-sphere" / "expected.csv"):
        radius, potential = float(row["radius"]), float(row["potential"])
        if (radius, potential) not in SPHERES:
            continue

        def prepare(folder, radius=radius, potential=potential):
            text = (folder / "case.toml").read_text()
            one_sphere.octant_case(folder, radius, potential)
            (folder / "case.toml").write_text((folder / "case.toml").read_text() + text)

        charge = 4 * 3.141592653589793 * radius**2 * float(row["charge_density"])
        yield Case(f"sphere {radius:g} {potential:g}", "", relative({"charge": (charge, 1e-9 * charge)}), prepare)


def over_plate():
    for row in rows_of(HERE / "pairs.csv"):
        name = "pair " + " ".join(f"{float(row[key]):g}" for key in ("radius", "distance", "height", "sphere", "plate"))
        truth = {f"force-{axis}": (float(row[f"force-{axis}"]), float(row[f"known-{axis}"])) for axis in "xz"}
        yield Case(name, pairs.case_of(row).split("\n[solver]")[0], relative(truth))
    truth = {row["quantity"]: (float(row["value"]), float(row["known"])) for row in rows_of(HERE / "truth.csv")
             if row["case"] == "reading-b"}
    yield Case("reading-b", (CASES / "charged-spheres" / "reading-b.toml").read_text(), relative(truth))


def ellipsoid():
    def prepare(folder):
        subprocess.run([sys.executable, CASES / "ellipsoid-plate" / "make_body.py", folder / "ellipsoid.stl"], check=True)
        make_mesh(folder)

    truth = {goal: (value, known, abs(value) if goal == "charge" else ELLIPSOID["force-z"][0])
             for goal, (value, known) in ELLIPSOID.items()}
    yield Case("ellipsoid", (CASES / "ellipsoid-plate" / "case.toml").read_text(), truth, prepare)


def levels_of(case, o):
    """Reports of the levels of a case."""
    folder = o.out / case.name.replace(" ", "_")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "case.toml").write_text(with_order(case.text, o.order), encoding="utf-8")
    case.prepare(folder)
    subprocess.run([CASES / "goal_loop.sh", folder / "case.toml", folder / "mesh.hdf", folder, "1", str(o.levels),
                    str(o.max_cells), "--bulk-of", "goal_error:0.5"], check=True)
    for mesh in folder.glob("*.hdf"):
        mesh.unlink()
    return [json.loads(name.read_text()) for name in sorted(folder.glob("solve*.json"))]


def goal_of(report, wanted):
    """The goal of that name; the force through the mid-plane is one along x."""
    names = [wanted, "midplane"] if wanted == "force-x" else [wanted]
    return next(goal for goal in report["goals"] if goal["name"] in names)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--order", type=int, default=2)
    parser.add_argument("--levels", type=int, default=1)
    parser.add_argument("--max-cells", type=int, default=60000)
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "out" / "bars")
    parser.add_argument("--tools")
    o = parser.parse_args()
    if o.tools:
        os.environ["PATH"] = o.tools + os.pathsep + os.environ["PATH"]
    ratios, n_rows, missed = [], 0, []
    print(f"{'case':32} level    cells unknowns  goal      error of value  corrected       bar     known  bar/error")
    for case in (*rods(), *isolated(), *spheres(), *over_plate(), *ellipsoid()):
        if o.cases and not any(case.name.startswith(name) for name in o.cases):
            continue
        for level, report in enumerate(levels_of(case, o)):
            for name, (value, known, unit) in case.truth.items():
                goal = goal_of(report, name)
                error, bar = abs(goal["corrected"] - value), goal["error_bar"]
                if bar is None:
                    print(f"{case.name:32} {level:5} {report['cells']:8} {report['unknowns']:8}  {name:9} no bar: "
                          f"{goal['error_withheld']}", flush=True)
                    continue
                n_rows += 1
                ratio = ""
                if error > known:
                    ratios.append(bar / error)
                    ratio = f"{ratios[-1]:.2f}"
                if error > bar + known:
                    missed.append(f"{case.name} level {level} {name}")
                    ratio += " missed"
                print(f"{case.name:32} {level:5} {report['cells']:8} {report['unknowns']:8}  {name:9} "
                      f"{abs(goal['value'] - value) / unit:14.1e} {error / unit:10.1e} {bar / unit:9.1e} "
                      f"{known / unit:9.1e}  {ratio}", flush=True)
    if not n_rows:
        sys.exit("bars.py: expected the beginning of a case's name, found none that fits")
    median = statistics.median(ratios) if ratios else 0
    print(f"{n_rows} bars, {len(missed)} missed; {len(ratios)} errors beyond what the truth is known to, median of "
          f"bar/error {median:.1f}")
    return 1 if 20 * len(missed) > n_rows or median > 15 else 0


if __name__ == "__main__":
    sys.exit(main())
