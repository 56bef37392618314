# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls of pamr-pb whose charge follows from their potential by one pK, against the equation in one dimension."""
import json
import math
import pathlib
import shutil

import h5py

from pb_cases import PH, between, boundary, cell, cube, density_at, goals_of, root, solve, wall
from tool_run import RANKS, of_full_level, of_one_process, prepare_alone, refuses, run, run_tests

prepare_alone("pamr-mesh")
ACID, BASE = ("acid", 4.0, 5.0), ("base", 2.0, 7.0)  # site, density, pK


def head(order, goals=("charge", "energy", "force-z"), patch="zmin"):
    return (f"[electrolyte]\npH = {PH}\n[solver]\norder = {order}\n[estimator]\ngoals = {json.dumps(goals)}\n"
            f'goal_patch = "{patch}"\n')


def plates(low, high):
    """Flat walls of sites at z = 0 and 1: what holds at both."""
    exact = between(low, high)
    return exact | dict(zip(("zmin", "zmax"), exact["potential"])) | dict(zip(("charge", "charge at zmax"), exact["charge"]))


def require_bars(report, exact, order, where):
    for name, goal in goals_of(report).items():
        assert goal["error_bar"] is not None, (where, goal)
        assert abs(goal["corrected"] - exact[name]) < goal["error_bar"], (where, order, goal, exact[name])
        assert goal["error_bar"] < (0.02 if order == 1 else 1e-5) * max(1, abs(exact[name])), (where, goal)


@of_one_process
def test_one_plate_has_the_charge_of_its_sites_and_of_grahame():
    # The wall at z = 1 holds what the potential of a plate alone has fallen to there.
    for site, valence in ((ACID, 1), (BASE, 1), (ACID, 2)):
        alone = root(lambda psi: 2 * math.sinh(psi / 2) - density_at(psi, *site, valence=valence), -20, 20)
        far = 4 * math.atanh(math.tanh(alone / 4) * math.exp(-1))
        text = head(2).replace("[solver]", f'salt = "{valence}:{valence}"\n[solver]')
        stated = wall(*site)
        if valence == 2:  # in elementary charges on a square nanometer: eps eps0 kappa kT/(Z e) is 0.0214 of them
            text = text.replace("[solver]", "debye_length = 2.6e-9\n[solver]")
            of_unit = 78.5 * 8.8541878128e-12 * 1.380649e-23 * 298.15 / (2 * 1.602176634e-19 ** 2 * 2.6e-9) * 1e-18
            assert abs(of_unit / 0.0214344504 - 1) < 1e-8, of_unit
            stated |= {"value": stated["value"] * of_unit, "unit": "1/nm2"}
        report, printed = solve(text + boundary(zmin=stated, zmax=("potential", far)), cube(5))
        goal = goals_of(report)["charge"]
        exact = density_at(alone, *site, valence=valence)
        assert abs(goal["corrected"] - exact) < goal["error_bar"] < 1e-4 * abs(exact), (site, goal, exact)
        assert abs(report["mean_potentials"]["zmin"] - alone) < 1e-4, (report["mean_potentials"], alone)
        assert abs(report["charged_sites"]["zmin"] - abs(exact / site[1])) < 1e-4, report["charged_sites"]
        assert f"patch zmin: regulated, {'acid' if site[0] == 'acid' else 'basic'} sites 4" in printed.out or site is BASE
        assert f"alone a flat wall of them has {alone:.4f}"[:36] in " ".join(printed.out.split()), (alone, printed.out)


@of_one_process
def test_two_plates_keep_their_bars():
    exact = plates(ACID, BASE)
    for order, n in ((1, 8), (2, 4)):
        report, _ = solve(head(order) + boundary(zmin=wall(*ACID), zmax=wall(*BASE)), cube(n))
        require_bars(report, exact, order, "zmin")
    # The other wall, and both as one body.
    exact["charge"], exact["force-z"] = exact["charge at zmax"], -exact["force-z"]
    report, _ = solve(head(2, patch="zmax") + boundary(zmin=wall(*ACID), zmax=wall(*BASE)), cube(4))
    require_bars(report, exact, 2, "zmax")


@of_one_process
@of_full_level
def test_a_body_of_sites_and_of_a_given_potential_has_the_charge_of_both():
    exact = plates(ACID, BASE)
    body = '[[body]]\nname = "both"\npatches = ["zmin", "zmax"]\n'
    for order, n in ((1, 8), (2, 4)):
        text = head(order, goals=["charge"], patch="both") + body
        for low in (wall(*ACID), ("potential", exact["zmin"])):
            report, _ = solve(text + boundary(zmin=low, zmax=wall(*BASE)), cube(n))
            goal = report["goal"]
            if order == 1 and isinstance(low, tuple):
                continue  # no bar where a charge is computed on such cells
            both = exact["charge"] + exact["charge at zmax"]
            assert abs(goal["corrected"] - both) < goal["error_bar"] < 0.02, (order, low, goal, both)


@of_one_process
def test_the_profile_of_a_plate_can_be_split_off():
    found = []
    for split in ("true", "false"):
        text = f'{head(2, patch="zmax")}[equation]\nsplit = {split}\n[plate]\npatch = "zmin"\n'
        report, _ = solve(text + boundary(zmin=("potential", -1.0), zmax=wall(*BASE)), cube(4))
        found.append(goals_of(report))
    a, b = (goals["charge"] for goals in found)
    assert abs(a["corrected"] - b["corrected"]) < a["error_bar"] + b["error_bar"] < 1e-4, (a, b)


@of_one_process
def test_regulation_lies_between_a_potential_and_a_charge_that_are_held():
    """Walls that would have the same charge and potential alone: those that hold the charge repel most."""
    alone = root(lambda psi: 2 * math.sinh(psi / 2) - density_at(psi, *BASE), 0, 20)
    charge = density_at(alone, *BASE)
    force, far_pk = {}, ("base", charge, 30.0)  # all sites charged
    walls = {"potential": ("potential", alone), "charge": ("charge", charge), "sites": wall(*BASE), "all": wall(*far_pk)}
    for name, stated in walls.items():
        report, _ = solve(head(2, goals=["force-z"]) + boundary(zmin=stated, zmax=stated), cube(4))
        force[name] = -report["goal"]["corrected"]
    assert force["potential"] * 1.1 < force["sites"] < force["charge"] / 1.1, force
    assert abs(force["all"] / force["charge"] - 1) < 1e-9, force
    # Sites that are nearly all neutral hold no charge.
    report, _ = solve(head(2, goals=["force-z"]) + boundary(zmin=wall("base", 2.0, -4.0), zmax=("potential", 1)), cube(4))
    neutral, _ = solve(head(2, goals=["force-z"]) + boundary(zmin=("charge", 0), zmax=("potential", 1)), cube(4))
    assert abs(report["goal"]["corrected"] - neutral["goal"]["corrected"]) < 1e-8, (report["goal"], neutral["goal"])
    assert report["charged_sites"]["zmin"] < 1e-9, report["charged_sites"]


@of_one_process
def test_the_force_is_minus_the_derivative_of_the_free_energy_with_its_sites():
    cube(4)
    step, exact = 0.02, plates(ACID, BASE)["force-z"]
    for order in (1, 2):
        energy = []
        for gap in (1 - step, 1 + step):
            shutil.copy("4.hdf", "gap.hdf")
            with h5py.File("gap.hdf", "r+") as file:
                file["VTKHDF/Points"][:, 2] = file["VTKHDF/Points"][:, 2] * gap
                del file["PAMR/checksums"].attrs["VTKHDF/Points"]
            report, _ = solve(head(order, goals=[]) + boundary(zmin=wall(*ACID), zmax=wall(*BASE)), "gap.hdf")
            energy.append(report["free_energy"])
        # The force on the upper wall.
        force = {key: -(energy[1][key] - energy[0][key]) / (2 * step) for key in energy[0]}
        assert abs(force["as_stated"] / -exact - 1) < (0.08 if order == 1 else 1e-3), (order, force, exact)
        assert all(abs(force[key] / -exact - 1) > 0.1 for key in ("fixed_potential", "fixed_charge")), (force, exact)


def spheres(inner, outer):
    """A sphere of radius 1 with sites in one of radius 3 at a potential, or with sites: charges, energy of an octant."""
    exact = between(inner, outer if isinstance(outer, tuple) else ("potential", outer), radii=(1.0, 3.0))
    return exact | dict(zip(("charge", "charge of outer"), exact["charge"]))


@of_one_process
@of_full_level
def test_a_sphere_of_sites_keeps_its_bars():
    fine, finest = cell("fine.hdf", 0.2, 0.4), cell("finest.hdf", 0.1, 0.3)
    for inner, outer in ((ACID, 0.5), (BASE, ("acid", 3.0, 6.0)), (("acid", 8.0, 7.0), -0.3)):
        exact = spheres(inner, outer)
        stated = {"sphere": wall(*inner), "outer": wall(*outer) if isinstance(outer, tuple) else ("potential", outer)}
        for order, mesh in ((2, fine), (1, finest)):
            text = head(order, goals=["charge", "energy"], patch="sphere")
            report, _ = solve(text + boundary(**stated), mesh)
            for name, goal in goals_of(report).items():
                if order == 1 and goal["error_withheld"] and "layers high" in goal["error_withheld"]:
                    continue
                assert abs(goal["corrected"] - exact[name]) < goal["error_bar"], (inner, outer, order, goal, exact)
                assert goal["error_bar"] < (0.02 if order == 1 else 1e-5) * abs(exact[name]), (inner, outer, goal)
        if isinstance(outer, tuple):
            report, _ = solve(head(2, goals=["charge"], patch="outer") + boundary(**stated), fine)
            goal = report["goal"]
            assert abs(goal["corrected"] - exact["charge of outer"]) < goal["error_bar"] < 1e-4, (goal, exact)


@of_one_process
@of_full_level
def test_levels_and_a_start_go_on_with_sites():
    text = head(2, goals=["charge"], patch="sphere") + boundary(sphere=wall(*ACID), outer=("potential", 0.5))
    pathlib.Path("case.toml").write_text(text)
    report = run("pamr-pb", "case.toml", "--mesh", cell("coarse.hdf", 0.35, 1.0), "-o", "out.hdf", "--levels", "1",
                 "--json", "-").json
    first, second = ([q for q in level["quantities"] if q["quantity"] == "charge" and q["of"] == "sphere"][0]
                     for level in report["levels"])
    exact = spheres(ACID, 0.5)["charge"]
    assert second["error"] < 0.5 * first["error"] and abs(second["value"] - exact) < second["error"], (first, second, exact)
    again = run("pamr-pb", "case.toml", "--mesh", "out.hdf", "-o", "again.hdf", "--start", "potential", "--json", "-").json
    assert abs(again["goal"]["corrected"] - second["value"]) < 1e-7, (again["goal"], second)


def test_any_number_of_ranks_gives_the_same():
    for order, n in ((1, 6), (2, 3)):
        found = []
        for ranks in {1, RANKS}:
            pathlib.Path("case.toml").write_text(head(order) + boundary(zmin=wall(*ACID), zmax=wall(*BASE)))
            found.append(run("pamr-pb", "case.toml", "--mesh", cube(n), "-o", "psi.hdf", "--force", "--json", "-",
                             ranks=ranks).json)
        for goals in zip(*(report["goals"] for report in found)):
            for key in ("corrected", "error_bar"):
                values = [goal[key] for goal in goals if goal[key] is not None]
                assert all(abs(v - values[0]) < 1e-7 * abs(values[0]) for v in values), (order, key, values)


@of_one_process
def test_what_is_wrong_with_sites_is_said():
    cube(2)
    sound = wall(*ACID)
    for electrolyte, stated, says in (
            ("", sound, ["pH", "[electrolyte]"]),
            ("pH = 6\n", {**sound, "unit": "1/nm2"}, ["debye_length", "1/nm2"]),
            ("pH = 6\n", {**sound, "site": "salt"}, ["acid", "base", "salt"]),
            ("pH = 6\n", {**sound, "value": -1.0}, ["value", "-1"]),
            ("pH = 6\n", {key: sound[key] for key in sound if key != "pK"}, ["pK"]),
            ("pH = 6\n", {**sound, "pk": 3}, ["pk", "pK"]),
            ("pH = 6\n", {**sound, "value": 1e40}, ["value", "50"]),
            ("ph = 6\n", sound, ["pH"])):
        pathlib.Path("case.toml").write_text(f"[electrolyte]\n{electrolyte}" + boundary(zmin=stated))
        refuses("pamr-pb", "case.toml", "--mesh", "2.hdf", "-o", "no.hdf", says=says, creates="no.hdf")
    text = head(1, goals=["charge"]) + '[plate]\npatch = "zmin"\n' + boundary(zmin=sound)
    pathlib.Path("case.toml").write_text(text)
    refuses("pamr-pb", "case.toml", "--mesh", "2.hdf", "-o", "no.hdf", says=["zmin", "potential", "regulated"], creates="no.hdf")


run_tests(globals())
