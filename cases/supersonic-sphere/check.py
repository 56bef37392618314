#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS RUN: the tables of meshes and flows; exit code 1 when a bound of expected.csv does not hold.

RUN: mach-4.2, full, mach-8, mach-8-full (which expected.csv has no flows of) or smoke.
"""
import csv
import json
import math
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.append(str(FOLDER.parent))
from bounds import rows_of  # noqa: E402

OUT, LEVELS, RUN = pathlib.Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
FOUR_ERRORS = 4 / 2.262  # four standard errors in bounds of 95 % of ten groups
CONTROLS = ("none", "isotropic", "short-edge", "removable")
MACH = 8.0 if RUN.startswith("mach-8") else 4.2
BEHIND = 4 * MACH**2 / (MACH**2 + 3)  # density behind a normal shock over that before it, of a monatomic gas


def read(name):
    with open(OUT / f"{name}.json", encoding="utf-8") as file:
        return json.load(file)


def stand_off(name, free):
    """Radii from the sphere to the middle of the shock on the stagnation line: where the density has risen halfway."""
    with open(OUT / f"{name}-lines.csv", encoding="utf-8") as file:
        rows = [(float(r["x"]), float(r["value"]) / free) for r in csv.DictReader(file) if r["quantity"] == "n"]
    half = 0.5 * (1 + BEHIND)
    for (x0, n0), (x1, n1) in zip(rows, rows[1:]):
        if n0 < half <= n1:
            return -(x0 + (half - n0) / (n1 - n0) * (x1 - x0)) - 1
    return math.nan


def mesh_row(label, level, name):
    q = read(name)
    counts, edges = q["mean_ratio"]["histogram"]["counts"], q["mean_ratio"]["histogram"]["edges"]
    poor = sum(c for c, e in zip(counts, edges) if e < 0.2 - 1e-9)
    print(f"{label:12} {level:5d} {q['cells']:9d} {q['mean_ratio']['min']:9.3f} {q['mean_ratio']['mean']:6.3f} {poor:10d} "
          f"{q['min_dihedral']['min']:9.2f}")
    return q


def flow_row(label, level, name, free):
    r = read(name)
    d, h = r["C_D"], r["C_H"]
    few = 100 * (1 - r["quality"]["dense_gas_below_5_particles"])
    print(f"{label:12} {level:5d} {r['particles']:9d} {few:5.0f} % {r['averages_from_step'] - r['began_at_step']:8d} "
          f"{r['steps'] - r['averages_from_step']:7d} {r['averages']['passage_steps']:8d} {d['value']:8.4f} {d['ci95']:.4f} "
          f"{h['value']:8.4f} {h['ci95']:.4f} {stand_off(name, free):8.3f}")
    return r


def free_density():
    text = (OUT / "case0.toml").read_text(encoding="utf-8")
    return next(float(line.split()[2]) for line in text.splitlines() if line.startswith("density ="))


def expected(quantity, level=""):
    """The row of expected.csv, None where it has none of this run."""
    rows = [row for row in rows_of(FOLDER / "expected.csv") if row["run"] in (RUN, "all")]
    return next((row for row in rows if row["quantity"] == quantity and row["level"] == str(level)), None)


def mean_of(flows):
    """Mean and bound of 95 % of independent values with theirs; a flow that several controls share counts once."""
    flows = sorted(set(flows))
    return sum(v for v, _ in flows) / len(flows), math.sqrt(sum(e * e for _, e in flows)) / len(flows)


def unexpected_means(reports):
    """Of C_D and C_H, level by level over the controls. `reports`: by level those of the controls."""
    for level, of_level in reports.items():
        for quantity in ("C_D", "C_H"):
            row = expected(quantity, level)
            if row is None:
                continue
            value, half = mean_of([(r[quantity]["value"], r[quantity]["ci95"]) for r in of_level])
            allowed = FOUR_ERRORS * math.hypot(half, float(row["ci95"])) + float(row["mesh"])
            if not half <= 2 * float(row["ci95"]):  # a wide bar would let any value pass
                yield f"level {level}: the bound of 95 % of {quantity} is {half:.4f}, expected {row['ci95']}, at most twice that"
            if not abs(value - float(row["value"])) <= allowed:
                yield (f"level {level}: the mean of {quantity} over the controls is {value:.4f} +- {half:.4f}, "
                       f"expected {row['value']} within {allowed:.4f}")


def main():
    failed = []
    least = float(expected("min_mean_ratio")["value"])

    for kind, words in (("recorded", "on one recorded sequence of marks"), ("own", "each with its own flow")):
        print(f"meshes, {words}\nquality      level     cells  smallest   mean  below 0.2  smallest\n"
              "control                    mean ratio                       angle")
        mesh_row("-", 0, "level0-quality")
        for control in CONTROLS:
            for level in range(1, LEVELS + 1):
                q = mesh_row(control, level, f"{kind}/{control}{level}-quality")
                if control == "removable" and not q["mean_ratio"]["min"] >= least:
                    failed.append(f"{kind}, {control}, level {level}: the smallest mean ratio is {q['mean_ratio']['min']:.4f}, expected "
                                  f"at least {least:g}")
        print()
    print("flows; +-: 95 % bounds\nquality      level particles  5 or steps:             passage      C_D  +-         C_H  +-     stand-off\n"
          "control                      more  discarded, averaged")
    free, drags, reports = free_density(), [], {}
    for control, level in [("-", 0)] + [(c, k) for c in CONTROLS for k in range(1, LEVELS + 1)]:
        name = "flow0" if level == 0 else f"own/{control}{level}-flow"
        r = flow_row(control, level, name, free)
        where = f"{control}, level {level}"
        if r["lost_particles"] != 0:
            failed.append(f"{where}: lost particles")
        reports.setdefault(level, []).append(r)
        if level == LEVELS:
            drags.append((control, r["C_D"]["value"], r["C_D"]["ci95"]))
    mean = sum(d for _, d, _ in drags) / len(drags)
    for control, drag, half in drags:
        if RUN != "smoke" and not abs(drag - mean) <= 2 * half:
            failed.append(f"{control}: C_D {drag:.4f} +- {half:.4f} differs from the mean of the controls, {mean:.4f}")
    failed += unexpected_means(reports)
    print("5 or more: share of the cells in gas denser than the free stream's with at least five particles; stand-off in radii")
    print("\n".join(failed) if failed else "within the bounds")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
