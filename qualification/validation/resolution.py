#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coverage of pamr-dsmc --check-resolution: see resolution.sh. Each run takes at most three minutes."""
import json
import math
import pathlib
import statistics
import subprocess
import sys

NUMBERS, MANY, SEEDS = (10000, 20000, 40000), 320000, 10
COEFFICIENTS = ("C_D", "C_H")
OUT, RANKS = pathlib.Path("."), 1
SPEED = 5 * math.sqrt(2 * 1.380649e-23 * 200 / 4.65e-26)  # m/s

# A stream of nitrogen at Mach 6 and 200 K. Mean free paths: 0.12 m (sphere, of radius 1), 0.48 m (the same in thinner gas),
# 0.04 m (plate of length 1).
COMMON = f"""
[gas]
fractions = {{ N2 = 1.0 }}
[stream.free]
density = DENSITY
temperature = 200.0
velocity = [{SPEED!r}, 0.0, 0.0]
[domain]
unit = 1.0
[time]
step = {0.03 / SPEED!r}
"""
SPHERE = (("--shape", "sphere-in-box", "--size", "0.6"), """
[boundary.sphere]
kind = "diffuse"
temperature = 300.0
[boundary.box]
kind = "inflow"
[reference]
area = 3.141592653589793
patches = ["sphere"]
""")
BODIES = {
    "sphere": (*SPHERE, 1e19),
    "thin": (*SPHERE, 2.5e18),
    "plate": (("--shape", "kuhn-cube", "--n", "5"), """
[boundary]
xmin = { kind = "inflow" }
xmax = { kind = "outflow" }
ymin = { kind = "symmetry" }
ymax = { kind = "symmetry" }
zmin = { kind = "diffuse", temperature = 300.0 }
zmax = { kind = "inflow" }
[reference]
area = 1.0
patches = ["zmin"]
""", 2.9e19),
}
# The same bodies, whose truths have finer cells at this wall too: split as often by `pamr-refine`.
WALLS, TIMES_SPLIT = {"sphere-cells": "sphere", "plate-cells": "zmin"}, 2
BODIES |= {name: BODIES[name.removesuffix("-cells")] for name in WALLS}


def tool(name, *arguments, ranks):
    launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    subprocess.run([*launcher, name, *map(str, arguments)], cwd=OUT, check=True, stderr=subprocess.DEVNULL)


def mesh_of(body, times_split):
    """Its cells at the wall split so many times; the wall stays as flat."""
    name = f"{body}-{times_split}.hdf"
    if (OUT / name).exists():
        return name
    if times_split == 0:
        tool("pamr-mesh", *BODIES[body][0], "-o", name, "--quiet", ranks=1)
    else:
        tool("pamr-mark", mesh_of(body, times_split - 1), "-o", "marked.hdf", "--patch", WALLS[body], "--force", "--quiet", ranks=1)
        tool("pamr-refine", "marked.hdf", "-o", name, "--no-project", "--quality-control", "none", "--quiet", ranks=1)
    return name


def report(body, number, seed):
    """Of a run, kept from an earlier call. The one with most particles is not checked, and averages for longer."""
    name = f"{body}-{number}-{seed}"
    kept = OUT / f"{name}.json"
    if not kept.exists():
        _, rest, density = BODIES[body]
        many = number == MANY
        mesh = mesh_of(body, TIMES_SPLIT if many and body in WALLS else 0)
        checks = [] if many else ["--check-resolution"] + (["--check-cells"] if body in WALLS else [])
        run = f"[particles]\ntotal = {number}.0\n[run]\ntransient = 200\nsampling = {600 if many else 400}\nblock = 20\nseed = {seed}\n"
        (OUT / f"{name}.toml").write_text(COMMON.replace("DENSITY", repr(density)) + rest + run)
        tool("pamr-dsmc", f"{name}.toml", "--mesh", mesh, "-o", "flow.hdf", "--force", "--quiet", "--json", "new.json",
             *checks, ranks=RANKS)
        found = json.loads((OUT / "new.json").read_text())
        kept.write_text(json.dumps({key: found.get(key) for key in (*COEFFICIENTS, "resolution", "particles", "quality")}))
    return json.loads(kept.read_text())


def coverage(body):
    """The rows of a body, and whether enough bounds contain the truth."""
    truth = report(body, MANY, 1)
    for c in COEFFICIENTS:
        print(f"{body}: {c} {truth[c]['value']:.4f} +- {truth[c]['ci95']:.4f} with {truth['particles']} particles", flush=True)
    print("| body | particles | distance of partners at the walls, mean free paths | bounds of chance that hold | with resolution | "
          "median bound over miss | mean miss of C_D, C_H | mean difference |\n|---|---|---|---|---|---|---|---|")
    held = n = 0
    all_bounds, all_misses = [], []
    for number in NUMBERS:
        runs = [report(body, number, seed) for seed in range(1, SEEDS + 1)]
        bounds, misses, by_chance, by_check = [], [], 0, 0
        for one in runs:
            for c in COEFFICIENTS:
                miss = abs(one[c]["value"] - truth[c]["value"])
                bound = one[c]["ci95"] + one["resolution"][c]["error"] + one["resolution"][c].get("cells", {"error": 0})["error"]  # the truth has the same facets
                by_chance += miss <= math.hypot(one[c]["ci95"], truth[c]["ci95"])
                by_check += miss <= math.hypot(bound, truth[c]["ci95"])
                bounds.append(bound)
                misses.append(miss)
        mean = lambda values: statistics.mean(values(one) for one in runs)
        off = ", ".join(f"{100 * (mean(lambda one: one[c]['value']) / truth[c]['value'] - 1):+.1f} %" for c in COEFFICIENTS)
        differ = ", ".join(f"{100 * mean(lambda one: one['resolution'][c]['difference']) / truth[c]['value']:+.1f} %" for c in COEFFICIENTS)
        apart = mean(lambda one: one["quality"]["wall_separation"])
        print(f"| {body} | {number} | {apart:.2f} | {by_chance} of {len(bounds)} | {by_check} of {len(bounds)} | "
              f"{statistics.median(bounds) / statistics.median(misses):.2f} | {off} | {differ} |", flush=True)
        held, n = held + by_check, n + len(bounds)
        all_bounds += bounds
        all_misses += misses
    ratio = statistics.median(all_bounds) / statistics.median(all_misses)
    print(f"{body}: {held} of {n} bounds hold (at least 54 of 60 wanted), median bound {ratio:.2f} times the median miss (at most 3 wanted)")
    return held >= 0.9 * n and ratio <= 3


def main():
    global OUT, RANKS
    OUT, RANKS = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    OUT.mkdir(parents=True, exist_ok=True)
    good = [coverage(body) for body in sys.argv[3:] or BODIES]
    sys.exit(0 if all(good) else 1)


main()
