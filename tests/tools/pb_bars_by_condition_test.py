# SPDX-License-Identifier: GPL-3.0-or-later
"""How many error bars of pamr-pb hold, by what its walls are given, by order, on first meshes and refined ones.

    tests/tools/pb_bars_by_condition_test.py $PWD/build/release/bin 1

prints the table. Potentials, charges and sites between plates and between spheres, whose truths are integrals in one dimension, charged
balls in a shell, with multipoles, and ellipsoids, a torus and two balls as one body, with spectral elements in two dimensions.
"""
import json
import math
import pathlib
import statistics

import numpy as np

from pb_around_an_axis import around, ellipsoid, torus, two_balls
from pb_cases import PH, SALT, ball, balls_in_a_shell, between, boundary, cell, cube, part_of_shell, wall
from tool_run import run, run_tests

ACID, BASE = ("acid", 4.0, 5.0), ("base", 2.0, 7.0)
PLATES = [(("potential", 2), ("potential", -1)), (("potential", 1), ("potential", 0.3)), (("potential", -2.5), ("potential", -2.5)),
          (("charge", 1.5), ("potential", 0)), (("charge", 1), ("charge", -0.5)), (("potential", 0.5), ("charge", 2)),
          (ACID, BASE), (BASE, ("potential", 0.5)), (BASE, BASE)]
SPHERES = [(("potential", 1), ("potential", 0.5)), (("potential", 2), ("potential", -0.5)), (("potential", 0.5), ("charge", 1.5)),
           (("charge", 1.5), ("potential", 0.5)), (("charge", -2), ("charge", 0.3)), (("potential", 1), ("charge", 0.5)),
           (ACID, ("potential", 0.5)), (BASE, ("acid", 3.0, 6.0)), (("potential", 1), BASE)]

BALLS = [([(0.4, 0.8, 0.5)], 2.0), ([(-0.9, 0.7, 1.0), (0.9, 0.5, -0.5)], 2.5)]  # x, radius, charge; radius of the shell

SHELL = 2.2
HALF_AXES = ((0.5, 1.0), (1.2, 0.6))  # along the axis of revolution, x, and across it
RING = (1.0, 0.4)
PAIRS = ([(-0.5, 0.8), (0.5, 0.8)], [(-0.5, 0.8), (0.5, 0.6)])  # place along the axis and radius of balls that overlap
AROUND = [(("charge", 1.0), ("potential", 0.0), True), (("charge", 1.5), ("potential", 0.5), False),
          (("potential", 1.0), ("charge", 0.5), False)]  # of body and shell, linear or not


def stated(condition):
    return wall(*condition) if condition[0] in ("acid", "base") else condition


def solved(head, patch, goals, walls, mesh):
    """The quantities that are goals of this patch, on the mesh and on one that is refined by their error."""
    pathlib.Path("case.toml").write_text(f"{head}[estimator]\ngoals = {json.dumps(goals)}\ngoal_patch = \"{patch}\"\n"
                                         + boundary(**walls))
    report = run("pamr-pb", "case.toml", "--mesh", mesh, "-o", "out.hdf", "--force", "--levels", "1", "--json", "-").json
    assert len(report["levels"]) == 2, report["levels"]
    for level, of_level in enumerate(report["levels"]):
        of_goals = [q for q in of_level["quantities"] if q["quantity"] in goals and q["of"] in (patch, None, "", "all")]
        assert len(of_goals) == len(goals), (goals, of_level)
        for q in of_goals:
            yield level, q["quantity"], q["value"], q["error"]


def quantities(shape, order, mesh, low, high):
    """Kind of the walls, first or refined, name, value, bar and truth of each quantity between two walls that is not given."""
    inner, outer = ("zmin", "zmax") if shape == "plates" else ("sphere", "outer")
    exact = between(low, high, SALT, None if shape == "plates" else (1.0, 3.0))
    kinds = {"sites" if name in ("acid", "base") else name for name, *_ in (low, high)}
    kind = "sites" if "sites" in kinds else "charge" if "charge" in kinds else "potential"
    for patch, condition, end in ((inner, low, 0), (outer, high, 1)):
        goals = [] if condition[0] == "charge" else ["charge"]
        if end == 0:
            goals += ["energy"] + (["force-z"] if shape == "plates" else [])
        head = f"[electrolyte]\npH = {PH}\n[solver]\norder = {order}\n"
        for level, name, value, bar in solved(head, patch, goals, {inner: stated(low), outer: stated(high)}, mesh) if goals else ():
            yield kind, level, f"{name} of {patch} at {low} {high}", value, bar, exact[name][end] if name == "charge" else exact[name]


def quantities_of_balls(order, mesh, balls, shell):
    """The same of charged balls in a ball at the potential 0, linear equation."""
    exact = balls_in_a_shell(balls, shell)
    walls = {f"ball_{i}": ("charge", density) for i, (*_, density) in enumerate(balls, 1)} | {"outer": ("potential", 0)}
    head = f"[equation]\nlinear = true\n[solver]\norder = {order}\n"
    for level, name, value, bar in solved(head, "outer", ["charge", "energy"], walls, mesh):
        yield "charge", level, f"{name} of {balls}", value, bar, exact[name] / (4 if name == "energy" else 1)


def bodies_of_revolution():
    """Group, name, surfaces of the patches, mirrors, and the body as `around` takes it."""
    for along, across in HALF_AXES:
        surface = {"kind": "quadric", "coefficients": [along ** -2, across ** -2, across ** -2] + [0] * 6 + [-1]}
        yield "ellipsoids", f"ellipsoid {along} {across}", {"body": surface}, "xyz", ellipsoid(along, across, SHELL)
    surface = {"kind": "torus", "center": [0, 0, 0], "axis": [1, 0, 0], "major_radius": RING[0], "minor_radius": RING[1]}
    yield "torus", "torus", {"body": surface}, "xyz", torus(*RING, SHELL)
    for pair in PAIRS:
        surfaces = {f"ball_{i}": ball(*of_ball) for i, of_ball in enumerate(pair, 1)}
        yield "two balls in one", f"balls {pair}", surfaces, "yz", two_balls(pair, SHELL)


def quantities_around(order, mesh, name, patches, n_parts, truths):
    """The same of a body of revolution in a sphere."""
    for (inner, outer, linear), exact in zip(AROUND, truths):
        head = (f"[equation]\nlinear = {json.dumps(linear)}\n[solver]\norder = {order}\n"
                f"[[body]]\nname = \"whole\"\npatches = {json.dumps(patches)}\n")
        patch, end = ("outer", 1) if inner[0] == "charge" else ("whole", 0)
        walls = dict.fromkeys(patches, inner) | {"outer": outer}
        for level, quantity, value, bar in solved(head, patch, ["charge", "energy"], walls, mesh):
            truth = exact["charge"][end] if quantity == "charge" else exact["energy"] / n_parts
            yield inner[0], level, f"{quantity} of {name} at {inner} in {outer}", value, bar, truth


def test_the_truth_around_an_axis_is_that_of_other_methods():
    whole = around(ellipsoid(1.0, 1.0, 3.0), ("charge", 1.5), ("potential", 0.5), degree=20)
    exact = between(("charge", 1.5), ("potential", 0.5), SALT, (1.0, 3.0))
    assert abs(whole["energy"] / 8 - exact["energy"]) < 1e-8 and np.abs(np.subtract(whole["charge"], exact["charge"])).max() < 1e-8, whole
    # A ball beside the middle, by multipoles; two equal balls on one another are one.
    whole = around(two_balls([(0.4, 0.8), (0.4 - 1e-13, 0.8)], 2.0), ("charge", 0.5), ("potential", 0.0), linear=True)
    exact = balls_in_a_shell([(0.4, 0.8, 0.5)], 2.0)
    assert abs(whole["energy"] - exact["energy"]) < 1e-8 and abs(whole["charge"][1] - exact["charge"]) < 1e-8, (whole, exact)
    # Other grids give the same, also where balls meet in an edge.
    for *_, body in bodies_of_revolution():
        for inner, outer, linear in AROUND:
            one, other = (around(body, inner, outer, linear, **more) for more in ({}, {"degree": 8, "n_near": 3}))
            assert abs(one["energy"] - other["energy"]) < 2e-8 * one["energy"], (inner, one, other)
            assert np.abs(np.subtract(one["charge"], other["charge"])).max() < 2e-8 * max(np.abs(one["charge"])), (inner, one, other)


def test_bars_hold_for_every_condition_in_both_orders():
    rows = {}

    def count(order, shape, found):
        for kind, level, text, value, bar, truth in found:
            error = abs(value - truth) / abs(truth)
            rows.setdefault((order, shape, kind, level), []).append((error, None if bar is None else bar / abs(truth)))
            if bar is not None and abs(value - truth) > bar:
                print(f"missed by {abs(value - truth) / bar:.2f}: order {order}, level {level}, {text}: {value!r}, truth {truth!r}")

    for shape, walls, meshes in (("plates", PLATES, {1: cube(8), 2: cube(3)}),
                                 ("spheres", SPHERES, {1: cell("fine.hdf", 0.12, 0.17), 2: cell("coarse.hdf", 0.25, 0.7)})):
        for low, high in walls:
            for order, mesh in meshes.items():
                count(order, shape, quantities(shape, order, mesh, low, high))
    for balls, shell in BALLS:
        for order, sizes in ((1, (0.12, 0.2)), (2, (0.25, 0.6))):
            bodies = {f"ball_{i}": ball(x, radius) for i, (x, radius, _) in enumerate(balls, 1)}
            mesh = part_of_shell(f"balls_{order}.hdf", bodies, shell, sizes)
            count(order, "balls", quantities_of_balls(order, mesh, balls, shell))
    for group, name, surfaces, mirrors, body in bodies_of_revolution():
        truths = [around(body, *walls) for walls in AROUND]
        for order, sizes in ((1, (0.12, 0.2)), (2, (0.25, 0.6))):
            mesh = part_of_shell(f"around_{order}.hdf", surfaces, SHELL, sizes, mirrors)
            count(order, group, quantities_around(order, mesh, name, list(surfaces), 2 ** len(mirrors), truths))
    print("| order | walls | given | mesh | quantities | without a bar | held | median bar/error |\n|---|---|---|---|---|---|---|---|")
    total = {}
    for (order, shape, kind, level), found in sorted(rows.items()):
        total.setdefault(order, []).extend(found)
        print(f"| {order} | {shape} | {kind} | {'refined' if level else 'first'} " + counts(found)[0])
    for order, found in total.items():
        text, n, n_withheld, n_held, median = counts(found)
        print(f"| {order} | all | | " + text)
        # A bar of two standard deviations holds 95 of 100, in these cases all do; one that is withheld is a miss beyond a tenth of them.
        misses = n - n_withheld - n_held + max(0, n_withheld - n // 10)
        assert n >= 60 and misses <= 0.05 * n and n_withheld + n_held == n, (order, n, n_withheld, n_held)


def counts(found):
    ratios = [bar / error for error, bar in found if bar is not None and error > 0]
    n, n_withheld, n_held = len(found), sum(bar is None for _, bar in found), sum(bar is not None and error <= bar for error, bar in found)
    median = statistics.median(ratios) if ratios else math.nan
    return f"| {n} | {n_withheld} | {n_held} | {median:.1f} |", n, n_withheld, n_held, median


run_tests(globals())
