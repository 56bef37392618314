#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-dsmc as a user runs it: the free-molecular sphere, restart, carrying a flow, the plan, bad input."""
import csv
import json
import math
import os
import pathlib
import signal
import subprocess
import time
import xml.etree.ElementTree as xml

import h5py
import numpy as np

from gas_cases import NITROGEN, gas_in_a_cube
from tool_run import (BIN, LAUNCHER, LIMIT, RANKS, add_cell_field, kuhn_cube, of_full_level, of_one_process, prepare_alone,
                      refuses, run, run_tests, same_bytes)

prepare_alone("pamr-mark", "pamr-refine")

SPECIES = NITROGEN + "rotational_degrees = 2\n"

SPHERE = SPECIES + """
[gas]
fractions = { N2 = 1.0 }
[stream.free]
density = 1e17
temperature = 300.0
velocity = [2110.3806, 0.0, 0.0]
[boundary.sphere]
kind = "diffuse"
temperature = 300.0
[boundary.box]
kind = "inflow"
[collisions]
enabled = false
[particles]
per_cell = 12.0
[domain]
unit = 1.0
[time]
step = 1e-4
[run]
transient = 60
sampling = 240
block = 12
[reference]
area = 3.141592653589793
length = 2.0
"""

# Gas streams through a cube past a warm floor.
CUBE = gas_in_a_cube(
    SPECIES, rotation="[gas.rotation]\nz_infinity = 18.1\nt_star = 91.5\n", per_cell=15.0,
    end="block = 4\n[[plane]]\nname = \"disk\"\npoint = [0.5, 0.5, 0.5]\nnormal = [1.0, 0.0, 0.0]\nradius = 0.3\n[reference]\narea = 1.0\n", ymin='kind = "symmetry"',
    ymax='kind = "cll", temperature = 400.0, normal_accommodation = 0.5, tangential_accommodation = 0.9',
    zmin='kind = "diffuse", temperature = 500.0, velocity = [10.0, 0.0, 0.0]',
    zmax='kind = "maxwell", temperature = 300.0, accommodation = 0.5')


def write(name, text):
    pathlib.Path(name).write_text(text)
    return name


def compute(case, mesh, out, *more, **kwargs):
    return run("pamr-dsmc", case, "--mesh", mesh, "-o", out, *more, **kwargs)


@of_one_process
def test_free_molecular_sphere_has_the_drag_and_heat_of_the_closed_form():
    case = write("sphere.toml", SPHERE)
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", "sphere.hdf", "--quiet", serial=True)
    report = compute(case, "sphere.hdf", "flow.hdf", "--surface", "wall.vtu", "--history", "h.csv", "--json", "-",
                     "--quiet", "--check-resolution").json

    # The closed forms integrated over the facets of the sphere: 2.31553 and 1.03960 for the sphere itself.
    bound = report["plan"]["free_molecular"]
    assert 2.1 < bound["C_D"] < 2.31553 and 0.93 < bound["C_H"] < 1.0396, bound
    for name, exact in (("C_D", 2.31553), ("C_H", 1.03960)):
        facets = report["resolution"][name]["facets"]
        assert abs(bound[name] + facets - exact) < 0.03 * facets, (name, bound, facets)
    assert report["lost_particles"] == 0 and report["abandoned_particles"] == 0
    for name in ("C_D", "C_H"):
        error = report[name]["stderr"]
        assert 0 < error < 0.01 * bound[name], report[name]
        assert abs(report[name]["value"] - bound[name]) < 4 * error, (report[name], bound[name])
    for name in ("C_L", "C_m"):
        assert abs(report[name]["value"] - bound[name]) < 4 * report[name]["stderr"] + 1e-4, (name, report[name])
    assert report["blocks"] == 20 and report["steps"] == 300
    # The stream passes the cube of side 4 in 19 steps: blocks of 12 go together in pairs.
    assert report["averages"].pop("student_95") * report["C_D"]["stderr"] == report["C_D"]["ci95"]
    for name, change in report["averages"].pop("change").items():
        assert abs(change["value"]) < 4 * change["stderr"] < 0.1 * report[name]["value"], (name, change)
        assert change["ci95"] > 2 * change["stderr"] and not change["drifts"], change
    assert report["averages"].pop("begun") == "case" and report["averages"].pop("restarts") == 0
    assert report["averages"] == {"passage_steps": 20, "blocks": 20, "block_steps": 12, "groups": 10, "group_steps": 24,
                                  "independent": True}, report["averages"]
    # In newtons and watts, and the same from what the wall was hit by.
    pressure = 0.5 * 1e17 * 4.65e-26 * 2110.3806**2 * math.pi
    flux = report["fluxes"]["patches"]["sphere"]
    for of_body, name, unit, net in (("drag", "C_D", pressure, flux["net"]["momentum"]["value"][0]),
                                     ("heat", "C_H", pressure * 2110.3806, flux["net"]["energy"]["value"])):
        for part in ("value", "ci95"):
            assert abs(report[of_body][part] / (unit * report[name][part]) - 1) < 1e-9, (of_body, report[of_body])
        assert abs(net / report[of_body]["value"] - 1) < 1e-6, (net, report[of_body])
    assert flux["net"]["molecules"]["value"] == 0 < flux["out"]["molecules"]["value"] == flux["in"]["molecules"]["value"]
    balance = report["balance"]
    assert balance["holds"] and balance["particles"]["unexplained"] == 0 and balance["intervals"] > 20, balance
    assert balance["particles"]["after"] == report["particles"] and balance["momentum"]["off"] <= balance["momentum"]["allowed"], balance
    for key in ("particles", "particle_steps_per_second_per_core", "species", "lambda_inf", "reference"):
        assert report[key], key

    # On the screen +- are bounds of 95 %.
    shown = compute(case, "sphere.hdf", "short.hdf", "--steps", "180", "--json", "-")
    drag = shown.json["C_D"]
    assert f"C_D {drag['value']:.4f} +- {drag['ci95']:.4f} ({shown.json['drag']['value']:.4g} +- {shown.json['drag']['ci95']:.2g} N)" in shown.err, shown.err
    assert drag["ci95"] > 2 * drag["stderr"] and "\npatch sphere: " in shown.err and "\nbalance: " in shown.err, shown.err

    # No average is no zero.
    moving = compute(write("moving.toml", SPHERE.replace('[boundary.sphere]\n', '[boundary.sphere]\nvelocity = [10.0, 0.0, 0.0]\n')), "sphere.hdf",
                     "none.hdf", "--steps", "1", "--json", "-")
    assert moving.json["C_D"] == {"value": None, "stderr": None} == moving.json["patches"]["sphere"]["heat"] and moving.json["blocks"] == 0, moving.json
    assert moving.json["fluxes"]["patches"]["sphere"]["net"]["momentum"]["value"] == [None] * 3, moving.json["fluxes"]
    assert "before the averages began" in moving.err and "the velocity of the wall sphere leads out of its plane" in moving.err, moving.err

    # A sixteenth of a turn says nothing about forces across the stream.
    sector = compute(write("sector.toml", SPHERE + "multiplier = 16.0\n"), "sphere.hdf", "x.hdf", "--steps", "84", "--json",
                     "-")
    assert {"C_D", "C_H"} <= set(sector.json) and not {"C_L", "C_m"} & set(sector.json), sector.json
    assert not {"C_L", "C_m"} & (set(sector.json["patches"]["sphere"]) | set(sector.json["plan"]["newtonian"])), sector.json
    assert "C_D" in sector.err and "C_L" not in sector.err and "C_m" not in sector.err, sector.err
    # Two blocks, both shorter than a passage.
    assert "standard errors come from 2 groups of 12 steps, fewer than the 20" in sector.err, sector.err
    assert "use sampling = 200" in sector.err, sector.err

    # Averages from the first step on, while the stream drives out the dense gas of the start: not steady, and said so.
    early = SPHERE.replace("transient = 60", "transient = 0").replace("sampling = 240\nblock = 12", "sampling = 20\nblock = 2")
    early += "[initial]\nstream = \"dense\"\n[stream.dense]\ndensity = 3e17\ntemperature = 300.0\nvelocity = [2110.0, 0.0, 0.0]\n"
    early = compute(write("early.toml", early), "sphere.hdf", "early.hdf", "--json", "-")
    assert "the flow was not steady: the drag changed by " in early.err and "(transient in [run])" in early.err, early.err
    change = early.json["averages"]["change"]["C_D"]
    assert abs(change["value"]) > 4 * change["stderr"] > 0 and change["drifts"], change

    # The same, beginning to average when the flow is found steady and ending when the drag is known to 1 %.
    alone = SPHERE.replace("transient = 60\n", "").replace("sampling = 240\nblock = 12", "sampling = 4000\nblock = 4\nstop_error = 0.01")
    alone = compute(write("alone.toml", alone), "sphere.hdf", "alone.hdf", "--json", "-", "--quiet").json
    assert 40 <= alone["averages_from_step"] < 1000 and alone["steady"].startswith("steady after step"), alone["steady"]
    assert alone["averages"]["begun"] == "steady", alone["averages"]
    assert alone["steps"] < 4000 and 0 < alone["C_D"]["stderr"] < 0.01 * alone["C_D"]["value"], alone["C_D"]
    assert abs(alone["C_D"]["value"] - bound["C_D"]) < 4 * alone["C_D"]["stderr"]

    # Ahead of the sphere, what it sends back comes on top of the free stream.
    root = xml.parse("wall.vtu").getroot()
    arrays = {a.get("Name"): np.array(a.text.split(), dtype=float) for a in root.iter("DataArray")}
    units = {a.get("Name"): a.findtext("InformationKey") for a in root.iter("DataArray")}
    assert [units[name] for name in ("p", "tau", "q", "area", "hits")] == ["Pa", "Pa", "W/m^2", "m^2", None], units
    assert abs(arrays["area"].sum() / (4 * math.pi) - 1) < 0.1
    assert (arrays["hits"] > 0).mean() > 0.5 and (arrays["p_stderr"][arrays["hits"] > 0.1] > 0).all()
    with h5py.File("flow.hdf") as file:
        data = file["VTKHDF/CellData"]
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        upstream = points[cells].mean(axis=1)[:, 0] < -1.7
        n = data["n"][:][upstream]
        assert 1e17 < n.mean() < 2e17, n.mean()
        assert 1000 < data["u"][:][upstream].mean(axis=0)[0] < 2110
        assert (data["n_stderr"][:] > 0).mean() > 0.9
    rows = list(csv.DictReader(open("h.csv")))
    assert rows[-1]["step"] == "300" and sum(row["averaged"] == "1" for row in rows) == 20


def test_the_resolution_is_checked_with_a_quarter_of_the_particles():
    case, mesh = write("case.toml", CUBE), kuhn_cube("cube.hdf", 3)
    plain = compute(case, mesh, "a.hdf", "--json", "-")
    apart = plain.json["quality"]["wall_separation"]
    assert 0 < apart and f"partners that collide at the walls are {apart:.2g} mean free paths apart" in plain.err, plain.err
    checked = compute(case, mesh, "b.hdf", "--check-resolution", "--json", "-")
    assert same_bytes("a.hdf", "b.hdf") and "resolution" not in plain.json
    found, drag = checked.json["resolution"]["C_D"], checked.json["C_D"]
    assert drag == plain.json["C_D"] and found["difference"] == found["value"] - drag["value"], (found, drag)
    here, with_a_quarter = (math.hypot(1, one) for one in (apart, 4**(1 / 3) * apart))
    factor = (here - 1) / (with_a_quarter - here)
    assert abs(found["error"] - max(abs(found["difference"]), 2 * found["difference_stderr"]) * factor) < 1e-9, (found, factor)
    assert abs(found["bound"] - drag["ci95"] - found["error"]) < 1e-12 and found["facets"] == 0, found
    assert 0.2 < checked.json["resolution"]["particles"] / checked.json["particles"] < 0.3, checked.json["resolution"]
    assert f"C_D {drag['value']:.4f} +- {found['bound']:.4f} (" in checked.err and "mean free paths apart" not in checked.err, checked.err
    refuses("pamr-dsmc", write("window.toml", CUBE.replace("block = 4\n", "window = 20\n")), "--mesh", mesh, "-o", "x.hdf", "--check-resolution",
            says=["window.toml", "--check-resolution"], creates="x.hdf")


def test_the_cells_at_the_walls_are_checked_too_with_the_same_numbers_on_any_ranks():
    case, mesh = write("case.toml", CUBE), kuhn_cube("cube.hdf", 3)
    check = ("--check-resolution", "--check-cells")
    shown = compute(case, mesh, "a.hdf", *check, "--json", "-", ranks=1)
    found, quality = shown.json["resolution"], shown.json["quality"]
    # CUBE has walls at three sides with two triangles a square; along the edge of ymax and zmin three cells lie at both.
    assert found["cells"]["split"] == 3 * 2 * 9 - 3, found["cells"]
    assert found["cells"]["cells"] > 162 + 7 * found["cells"]["split"], found["cells"]
    assert 0.9 < found["cells"]["particles"] / (4 * found["particles"]) < 1.1 and found["cells"]["steps"] == found["steps"], found
    assert "with a quarter of the particles, " in shown.err and " of coarse cells and " in shown.err, shown.err
    drag, viscous = found["C_D"], math.sqrt(16 / (45 * math.pi)) * quality["wall_cell_size"]
    here, halved = math.hypot(1, viscous), math.hypot(1, viscous / 2)
    factor = (here - 1) / (here - halved)
    cells = drag["cells"]
    assert 4 / 3 < factor < 2, quality
    assert abs(cells["error"] - factor * max(abs(cells["difference"]), 2 * cells["difference_stderr"])) < 1e-9, (cells, factor)
    assert abs(drag["bound"] - shown.json["C_D"]["ci95"] - drag["error"] - cells["error"] - drag["facets"]) < 1e-12, drag
    assert f"C_D {shown.json['C_D']['value']:.4f} +- {drag['bound']:.4f} (" in shown.err, shown.err
    if RANKS > 1:
        others = compute(case, mesh, "b.hdf", *check, "--json", "-", "--quiet").json
        assert others["resolution"] == found and others["quality"] == quality, (others["resolution"], found)

    # Walls that no heat reaches count by their area, and no others than those of the body.
    sides = {side: 'kind = "specular"' for side in ("ymin", "ymax", "zmin", "zmax")}
    floor = '[reference]\npatches = ["ymin"]\narea = 1.0\n'
    mirrors = compute(write("mirrors.toml", gas_in_a_cube(SPECIES, end=floor, **sides)), mesh, "m.hdf", "--json", "-", "--quiet").json["quality"]
    assert mirrors["wall_separation"] > 0, mirrors
    with h5py.File("m.hdf") as file:
        grid = file["VTKHDF"]
        corners = grid["Points"][:][grid["Connectivity"][:].reshape(-1, 4)]
        at_floor = np.count_nonzero(corners[:, :, 1] == 0, axis=1) == 3
        size = np.mean(np.cbrt(1 / 162) / grid["CellData/lambda"][:][at_floor])
    assert np.count_nonzero(at_floor) == 18 and abs(mirrors["wall_cell_size"] / size - 1) < 1e-6, (mirrors, size)

    more = ("--mesh", mesh, "-o", "x.hdf")
    refuses("pamr-dsmc", case, *more, "--check-cells", says=["--check-cells", "--check-resolution"], creates="x.hdf")
    sides = {side: 'kind = "symmetry"' for side in ("ymin", "ymax", "zmin", "zmax")}
    refuses("pamr-dsmc", write("open.toml", gas_in_a_cube(SPECIES, **sides)), *more, *check, says=["open.toml", "on a wall"], creates="x.hdf")
    refuses("pamr-dsmc", write("thin.toml", CUBE + "[collisions]\nenabled = false\n"), *more, *check, says=["thin.toml", "collisions"], creates="x.hdf")
    refuses("pamr-dsmc", case, *more, check[0], "--steps", "17", says=["--check-resolution", "--steps"], creates="x.hdf")
    refuses("pamr-dsmc", write("long.toml", CUBE.replace("block = 4\n", "block = 11\n")), *more, check[0],
            says=["long.toml", "sampling = 20 and block = 11"], creates="x.hdf")
    sides["zmin"] = 'kind = "diffuse", temperature = 300.0'
    sides |= {side: f'kind = "periodic", partner = "{other}"' for side, other in (("ymin", "ymax"), ("ymax", "ymin"))}
    refuses("pamr-dsmc", write("loop.toml", gas_in_a_cube(SPECIES, **sides)), *more, *check, says=["loop.toml:", "periodic", "ymax"], creates="x.hdf")


def test_restart_gives_the_same_bytes_as_a_run_without_interruption():
    case, mesh = write("case.toml", CUBE), kuhn_cube("cube.hdf", 4)
    compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--history", "a.csv", "--surface", "a.vtu", "--quiet", ranks=1)
    compute(case, mesh, "b.hdf", "--checkpoint", "b.ck", "--steps", "17", "--quiet")
    compute(case, mesh, "c.hdf", "--restart", "b.ck", "--checkpoint", "c.ck", "--history", "c.csv", "--surface",
            "c.vtu", "--quiet", ranks=max(1, RANKS - 1))
    for a, c in (("a.hdf", "c.hdf"), ("a.ck", "c.ck"), ("a.csv", "c.csv"), ("a.vtu", "c.vtu")):
        assert same_bytes(a, c), f"{a} differs from {c}"
    row = list(csv.DictReader(open("a.csv")))[-1]
    assert float(row["disk:out_per_s"]) > float(row["disk:in_per_s"]) > 0 and float(row["disk:Fx"]) > 0, row
    assert float(row["zmin:out_per_s"]) == float(row["zmin:in_per_s"]), row

    again = compute(case, mesh, "d.hdf", "--restart", "c.ck")
    assert "nothing left to do: c.ck has 30 steps, all that the case asks for" in again.out, again.out
    assert same_bytes("a.hdf", "d.hdf")
    assert "all that --steps asks for" in compute(case, mesh, "d.hdf", "--restart", "b.ck", "--steps", "9", "--force").out


def test_inlets_and_outlets_are_shown_and_go_on_with_the_same_bytes():
    def duct(outlet):
        return gas_in_a_cube(SPECIES, xmin='kind = "inlet", relaxation = 5', xmax=outlet, **{y: 'kind = "symmetry"' for y in ("ymin", "ymax", "zmin", "zmax")})

    mesh, case = kuhn_cube("cube.hdf", 3), write("case.toml", duct('kind = "outlet", pressure = 0.4'))
    whole = compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--json", "-", ranks=1)
    assert "\npatch xmax: gas enters at 0.4 Pa, " in whole.err and "\npatch xmin: gas enters at 0.4142 Pa, 300 K and " in whole.err, whole.err
    entering = whole.json["fluxes"]["patches"]["xmax"]["entering"]
    assert entering["pressure"] == 0.4 and 100 < entering["temperature"] < 500 and entering["limited"] is False, entering
    compute(case, mesh, "b.hdf", "--checkpoint", "b.ck", "--steps", "17", "--quiet")
    compute(case, mesh, "c.hdf", "--restart", "b.ck", "--checkpoint", "c.ck", "--quiet")
    assert same_bytes("a.hdf", "c.hdf") and same_bytes("a.ck", "c.ck")

    fast = compute(write("fast.toml", duct('kind = "outflow"').replace("speed = 400.0", "speed = 800.0").replace("relaxation = 5", "relaxation = 1")), mesh, "d.hdf")
    assert "warning: patch xmin: gas would enter faster than sound and is held at 353" in fast.err, fast.err
    refuses("pamr-dsmc", write("bad.toml", duct('kind = "outlet"')), "--mesh", mesh, "-o", "x.hdf", says=["bad.toml:", "pressure"], creates="x.hdf")


def test_a_flow_through_patches_is_steady_when_what_passes_them_is():
    # Drag and heat of its walls are noise about nothing, and would never be.
    walls = {side: 'kind = "diffuse", temperature = 300.0' for side in ("ymin", "ymax", "zmin", "zmax")}
    def duct(left, right):
        text = gas_in_a_cube(SPECIES, sampling=400, end="most_transient = 9000\n", xmin=left, xmax=right, **walls)
        return write("duct.toml", text.replace("transient = 10\n", "", 1).replace("speed = 400.0\n", "[stream.thin]\ndensity = 5e19\ntemperature = 300.0\n"))
    mesh = kuhn_cube("cube.hdf", 3)
    # Volume over open area, times four over the mean speed of molecules: their stay; four times as long, or 8 relaxations.
    stay = 0.5 * 4 / math.sqrt(8 * 1.380649e-23 * 300 / (math.pi * 4.65e-26)) / 5e-5
    for left, right, passage in (('kind = "inlet", relaxation = 40', 'kind = "outlet", pressure = 0.35, relaxation = 60', 480),
                                 ('kind = "inflow"', 'kind = "inflow", stream = "thin"', 4 * stay)):
        shown = compute(duct(left, right), mesh, "a.hdf", "--force", "--json", "-", ranks=1)
        averages = shown.json["averages"]
        assert abs(averages["passage_steps"] - max(passage, 4 * stay)) <= 10, (averages, stay)
        assert averages["begun"] == "steady" and "the molecules through xmin changed only" in shown.json["steady"], shown.json["steady"]
        assert set(averages["change"]) == {"C_D", "C_H", "xmin", "xmax"}, averages
        assert not averages["independent"] and " in which the flow forgets itself, and may be too small: " in shown.err, shown.err
        net = shown.json["fluxes"]["patches"]["xmax"]["net"]["molecules"]
        assert f", net {net['value']:.4g} +- {net['ci95']:.2g} molecules/s; net (" in shown.err, shown.err
        drag, heat = shown.json["drag"], shown.json["heat"]
        assert f"({drag['value']:.4g} +- {drag['ci95']:.2g} N)" in shown.err and f"({heat['value']:.4g} +- {heat['ci95']:.2g} W)" in shown.err, shown.err


def test_vibration_is_shown_and_goes_on_with_the_same_bytes_and_is_carried():
    mesh, cold = kuhn_cube("cube.hdf", 3), CUBE.replace(SPECIES, "").replace("N2 = 1.0", "N2 = 0.6, CO2 = 0.4")
    hot = cold.replace("temperature = 300.0\nspeed", "temperature = 3000.0\nspeed")
    case = write("case.toml", hot.replace("[gas]\n", "[gas]\nvibration = true\n").replace("speed", "vibrational_temperature = 900.0\nspeed").replace(
        "tangential_accommodation = 0.9", "tangential_accommodation = 0.9, vibrational_accommodation = 0.2"))
    whole = compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--history", "a.csv", "--surface", "a.vtu", "--json", "-", ranks=1)
    assert "vibration of CO2: modes of 959.66, 959.66, 1918.7, 3382.1 K, relaxes in " in whole.err, whole.err
    assert "above 2,500 K molecules react, which is not modeled" in whole.err and "vibrate" not in whole.err, whole.err
    assert [s["vibration"]["temperatures"] for s in whole.json["species"]] == [[959.66, 959.66, 1918.7, 3382.1], [3371.0]]
    assert whole.json["balance"]["holds"], whole.json["balance"]
    compute(case, mesh, "b.hdf", "--checkpoint", "b.ck", "--steps", "17", "--quiet")
    compute(case, mesh, "c.hdf", "--restart", "b.ck", "--checkpoint", "c.ck", "--history", "c.csv", "--surface", "c.vtu", "--quiet")
    for a, c in (("a.hdf", "c.hdf"), ("a.ck", "c.ck"), ("a.csv", "c.csv"), ("a.vtu", "c.vtu")):
        assert same_bytes(a, c), f"{a} differs from {c}"
    temperatures = [float(row["T_vib"]) for row in csv.DictReader(open("a.csv"))]
    for row in csv.DictReader(open("a.csv")):
        for way in ("out", "in"):
            parts = [float(row[f"xmin:{species}:{way}_per_s"]) for species in ("N2", "CO2")]
            assert all(part > 0 for part in parts) and abs(sum(parts) / float(row[f"xmin:{way}_per_s"]) - 1) < 1e-7, row
    net = whole.json["fluxes"]["planes"]["disk"]["species"]["CO2"]["net"]["molecules"]
    lines = whole.err.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("plane disk: "))
    assert lines[at + 1].startswith("  CO2: ") and lines[at + 1].endswith(f", net {net['value']:.4g} +- {net['ci95']:.2g} molecules/s"), lines[at:at + 3]
    assert all(850 < t < 1000 for t in temperatures), temperatures
    with h5py.File("a.hdf") as file:
        fields = {name: file[f"VTKHDF/CellData/{name}"][:] for name in ("T_tr", "T_rot", "T_vib", "T")}
    assert 800 < np.mean(fields["T_vib"]) < 1100 < np.mean(fields["T"]) < np.mean(fields["T_rot"]), fields

    # Formats, other cases, wrong levels, and flows carried between gases with and without vibration.
    plain = write("plain.toml", hot)
    compute(plain, mesh, "d.hdf", "--checkpoint", "d.ck", "--history", "d.csv", "--quiet")
    assert pathlib.Path("a.ck").read_bytes()[8] == 2 and pathlib.Path("d.ck").read_bytes()[8] == 1
    assert "T_vib" not in open("d.csv").readline()
    refuses("pamr-dsmc", plain, "--mesh", mesh, "-o", "x.hdf", "--restart", "a.ck", says=("species.N2.vibration", "nothing"), creates="x.hdf")
    damaged("a.ck", "bad.ck", lambda header, tables: tables["particles"].view(np.int64).__setitem__((3, 9), -1))
    refuses("pamr-dsmc", case, "--mesh", mesh, "-o", "x.hdf", "--restart", "bad.ck", says=("particles, row 3", "levels"), creates="x.hdf")
    compute(plain, mesh, "e.hdf", "--carry", "a.ck", "--quiet")
    compute(case, mesh, "f.hdf", "--carry", "d.ck", "--history", "f.csv", "--quiet")
    begun = float(next(csv.DictReader(open("f.csv")))["T_vib"])
    assert 850 < begun < 1000, begun
    other = write("other.toml", pathlib.Path(case).read_text() + """[species.N2]
mass = 4.65e-26
diameter = 4.17e-10
omega = 0.74
t_ref = 273.0
rotational_degrees = 2
[species.N2.vibration]
temperatures = [3000.0]
c1 = 9.1
c2 = 220.0
""")
    refuses("pamr-dsmc", other, "--mesh", mesh, "-o", "x.hdf", "--carry", "a.ck", says=("modes of [3371.0] K of N2",), creates="x.hdf")


def test_planes_are_counted_and_bad_ones_refused():
    mesh = kuhn_cube("cube.hdf", 2)
    plane = CUBE[CUBE.index("[[plane]]"):CUBE.index("[reference]")]

    def refused(text, *says):
        refuses("pamr-dsmc", write("bad.toml", CUBE.replace(plane, text)), "--mesh", mesh, "-o", "x.hdf", says=says, creates="x.hdf")

    refused('[[plane]]\nname = "xmin"\npoint = [0.5, 0.5, 0.5]\nnormal = [1.0, 0.0, 0.0]\n', "bad.toml:", "[[plane]]", '"xmin"')
    rest = '[[plane]]\nname = "p"\npoint = [0.5, 0.5, 0.5]\n'
    refused(rest, "bad.toml:", "normal")
    refused(rest + "normal = [0.0, 0.0, 0.0]\n", "bad.toml:", "a direction")
    refused(rest + "normal = [0.0, 0.0, 1.0]\nradius = 0.0\n", "bad.toml:", "radius")
    refused(plane + plane, "bad.toml:", "a name that no other counted plane has")
    refused(rest.replace("0.5, 0.5, 0.5", "0.5, 0.5, 1.5") + "normal = [0.0, 0.0, 1.0]\n", '"p"', "cuts the mesh")
    refused('[[plane]]\nname = "p"\ncorner = [0.0, 0.0, 0.5]\nalong = [1.0, 0.0, 0.0]\nacross = [2.0, 0.0, 0.0]\n', "bad.toml:", "across")
    section = '[[plane]]\nname = "section"\ncorner = [0.0, 0.0, 0.5]\nalong = [1.0, 0.0, 0.0]\nacross = [0.0, 1.0, 0.0]\n'
    report = compute(write("case.toml", CUBE.replace(plane, section)), mesh, "a.hdf", "--checkpoint", "a.ck", "--json", "-", "--quiet").json
    found = report["fluxes"]["planes"]["section"]
    assert found["along"]["molecules"]["value"] > 0 and found["against"]["energy"]["value"] > 0, found
    # Planes are part of the case: another set is refused.
    refuses("pamr-dsmc", write("case.toml", CUBE), "--mesh", mesh, "-o", "x.hdf", "--restart", "a.ck",
            says=("plane.section", "plane.disk"), creates="x.hdf")


def test_a_species_file_of_sparta_is_called_so():
    for name, text in (("air.species", "# ID molwt mass rot\n\nN2 28.01 4.65e-26 2 0.2 2 1.9e-4 3371.0 1.0 0.0\n"),
                       ("air.vss", "N2  4.07E-10 0.74 273.15 1.6\n"), ("ar.species", "Ar 39.9 6.63E-26 0 0 0 0 0 1 0\n")):
        write(name, text)
        case = write("case.toml", CUBE.replace("[gas]\n", f"[gas]\nspecies_file = \"{name}\"\n"))
        refuses("pamr-dsmc", case, "--mesh", kuhn_cube("cube.hdf", 2), "-o", "x.hdf", says=(name, "SPARTA", "[species.NAME]"), creates="x.hdf")


def test_gases_are_found_by_name_and_air_by_its_altitude_and_hot_molecules_are_warned_about():
    mesh = kuhn_cube("cube.hdf", 2)
    known = CUBE.replace(SPECIES, "")
    cold = compute(write("own.toml", CUBE), mesh, "own.hdf", "--quiet")
    compute(write("known.toml", known), mesh, "known.hdf", "--quiet")
    assert same_bytes("own.hdf", "known.hdf") and "2,500 K" not in cold.err, cold.err

    air = known.replace("fractions = { N2 = 1.0 }\n", "").replace("step = 5e-5", "step = 1e-5").replace(
        "density = 1e20\ntemperature = 300.0\nspeed = 400.0", "altitude = 100e3\nspeed = 7500.0")
    hot = compute(write("air.toml", air), mesh, "air.hdf", "--json", "-")
    assert [s["name"] for s in hot.json["species"]] == ["Ar", "He", "N2", "O", "O2"], hot.json["species"]
    assert "free stream: n 1.18853e+19 1/m3, T 195.081 K" in hot.err, hot.err
    assert "the total temperature of the free stream is 27978 K" in hot.err and "the hottest cell has " in hot.err, hot.err
    assert hot.err.count("above 2,500 K molecules vibrate and react") == 2 and hot.json["quality"]["max_temperature"] > 2500, hot.err
    for text, says in ((known.replace("temperature = 500.0", "temperature = 2600.0"), "the wall zmin has 2600 K"),
                       (known + "[stream.puff]\ndensity = 1e20\ntemperature = 2600.0\n", "the total temperature of stream puff is 2600 K")):
        assert f"warning: {says}: above 2,500 K" in run("pamr-dsmc", write("warm.toml", text), "--mesh", mesh, "--plan", serial=True).err, says
    mixed = air.replace("altitude = 100e3\n", "altitude = 100e3\nfractions = { N2 = 0.25, O2 = 0.75 }\n")
    assert "species O2: 0.75 of the molecules" in run("pamr-dsmc", write("mixed.toml", mixed), "--mesh", mesh, "--plan", serial=True).out
    free = compute(write("free.toml", air + "[collisions]\nenabled = false\n"), mesh, "free.hdf", "--quiet")
    assert "2,500 K" not in free.err, free.err
    refuses("pamr-dsmc", write("bad.toml", air.replace("100e3", "100")), "--mesh", mesh, "-o", "x.hdf",
            says=("bad.toml:", "altitude", "80000 and 200000"), creates="x.hdf")


def stopped(command, number, before, checkpoint):
    """Exit code and messages of a run that gets this signal once its checkpoint is there; `before`: what SIGHUP does first."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          preexec_fn=lambda: signal.signal(signal.SIGHUP, before)) as process:
        deadline = time.monotonic() + LIMIT
        while not os.path.exists(checkpoint) and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.05)
        assert process.poll() is None, process.communicate()
        process.send_signal(number)
        out, err = process.communicate(timeout=LIMIT)
    return process.returncode, out, err


def test_a_signal_ends_the_run_with_a_checkpoint_to_go_on_from():
    case, mesh = write("case.toml", CUBE.replace("sampling = 20", "sampling = 100000")), kuhn_cube("cube.hdf", 3)
    short = write("short.toml", CUBE)
    for number in (signal.SIGTERM, signal.SIGHUP):
        name = f"{number.name}.ck"
        command = [str(BIN / "pamr-dsmc"), case, "--mesh", mesh, "-o", "a.hdf", "--checkpoint", name, "--every", "7"]
        code, out, err = stopped(command, number, signal.SIG_DFL, name)
        assert code == 6 and f"-> {name}" in out, (number, code, out, err)
        assert not os.path.exists("a.hdf") and not os.path.exists(f"{name}.partial")
        compute(short, mesh, f"{number.name}.hdf", "--restart", name, "--quiet")


def test_a_run_under_nohup_goes_on_when_its_terminal_is_gone():
    case, mesh = write("case.toml", CUBE.replace("sampling = 20", "sampling = 1000")), kuhn_cube("cube.hdf", 3)
    command = [str(BIN / "pamr-dsmc"), case, "--mesh", mesh, "-o", "a.hdf", "--checkpoint", "a.ck", "--every", "20", "--quiet"]
    code, out, err = stopped(command, signal.SIGHUP, signal.SIG_IGN, "a.ck")
    assert code == 0 and os.path.exists("a.hdf"), (code, out, err)


def computing_here():
    """Ids of the processes of pamr-dsmc that work in this folder."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if (entry / "exe").readlink().name == "pamr-dsmc" and (entry / "cwd").readlink() == pathlib.Path.cwd():
                found.append(int(entry.name))
        except OSError:  # gone meanwhile, or another user's
            pass
    return found


def test_a_killed_run_resumes_from_its_last_checkpoint():
    case, mesh = write("long.toml", CUBE.replace("transient = 10", "transient = 100000")), kuhn_cube("cube.hdf", 3)
    command = [str(BIN / "pamr-dsmc"), case, "--mesh", mesh, "-o", "a.hdf", "--checkpoint", "a.ck", "--every", "5", "--quiet"]
    with subprocess.Popen([*LAUNCHER, *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        deadline = time.monotonic() + LIMIT
        while not os.path.exists("a.ck") and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.02)
        killed = computing_here()
        for pid in killed:
            os.kill(pid, signal.SIGKILL)
        process.wait(timeout=LIMIT)
    assert len(killed) == RANKS and process.returncode != 0 and not os.path.exists("a.hdf")
    for partial in pathlib.Path(".").glob("*.partial"):  # of a kill in the middle of writing
        partial.unlink()
    kept = pathlib.Path("a.ck").read_bytes()
    pathlib.Path("kept.ck").write_bytes(kept)
    n = int(json.loads(kept[32:32 + int.from_bytes(kept[16:24], "little")])["steps_done"])
    assert n > 0 and n % 5 == 0
    compute(case, mesh, "b.hdf", "--restart", "kept.ck", "--steps", n + 7, "--checkpoint", "b.ck", "--quiet")
    compute(case, mesh, "c.hdf", "--steps", n + 7, "--checkpoint", "c.ck", "--quiet", ranks=1)
    assert same_bytes("b.ck", "c.ck")


MIXTURE = CUBE.replace("[gas]\n", SPECIES.replace("N2", "X").replace("4.17e-10", "3e-10") + "[gas]\n").replace(
    "{ N2 = 1.0 }", "{ N2 = 0.99, X = 0.01 }")


def owed_energy(checkpoint):
    """J, from the table of cells: molecules a particle are its tenth word, what is owed the last."""
    words = np.fromfile(checkpoint, dtype="<u8")
    text = words[4:4 + int(words[2]) // 8].tobytes()
    table = next(one for one in json.loads(text)["sections"] if one["name"] == "cells")
    begin = 4 + len(text) // 8 + table["offset"] // 8
    cells = words[begin:begin + table["rows"] * table["width"]].view("<f8").reshape(table["rows"], table["width"])
    return (cells[:, 9] * cells[:, -1]).sum()


@of_full_level
def test_a_trace_species_has_a_weight_of_its_own():
    mesh = kuhn_cube("cube.hdf", 4)
    alike = write("alike.toml", MIXTURE)
    case = write("case.toml", MIXTURE.replace("per_cell = 15.0", "per_cell = 30.0\nspecies_weights = { X = 0.01 }"))
    a = compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--history", "a.csv", "--json", "-", "--quiet", ranks=1).json
    compute(case, mesh, "b.hdf", "--checkpoint", "b.ck", "--steps", "17", "--quiet")
    compute(case, mesh, "c.hdf", "--restart", "b.ck", "--checkpoint", "c.ck", "--history", "c.csv", "--quiet")
    for x, y in (("a.hdf", "c.hdf"), ("a.ck", "c.ck"), ("a.csv", "c.csv")):
        assert same_bytes(x, y), f"{x} differs from {y}"
    b = compute(alike, mesh, "alike.hdf", "--checkpoint", "alike.ck", "--json", "-", "--quiet").json
    with h5py.File("a.hdf") as one, h5py.File("alike.hdf") as other:
        x, y = (file["VTKHDF/CellData"] for file in (one, other))
        for name, bar in (("n", 0.02), ("n_N2", 0.02), ("T", 0.03), ("rho", 0.02)):
            assert abs(x[name][:].mean() / y[name][:].mean() - 1) < bar, name
        assert abs(x["n_X"][:].mean() / (0.01 * x["n"][:].mean()) - 1) < 0.05
        assert abs(x["particles"][:].mean() / 30 - 1) < 0.2, x["particles"][:].mean()
        assert np.allclose(x["n"][:], x["n_X"][:] + x["n_N2"][:])
    assert abs(a["C_D"]["value"] - b["C_D"]["value"]) < 5 * (a["C_D"]["stderr"] + b["C_D"]["stderr"])

    # A flow with one weight goes on with two: as many molecules, a hundred times as many particles of the trace.
    compute(case, mesh, "d.hdf", "--carry", "alike.ck", "--checkpoint", "d.ck", "--steps", "12", "--quiet")
    # What energy the cells owe goes on with the flow, shared by volume: without collisions it stays.
    run("pamr-mark", "a.hdf", "-o", "m.hdf", "--box", "0,0,0,1,1,0.3", "--quiet", "--force")
    run("pamr-refine", "m.hdf", "-o", "fine.hdf", "--quiet")
    still = write("still.toml", pathlib.Path(case).read_text().replace("[run]", "[collisions]\nenabled = false\n[run]"))
    compute(still, "fine.hdf", "e.hdf", "--carry", "a.ck", "--checkpoint", "e.ck", "--steps", "31", "--quiet")
    before, after = owed_energy("a.ck"), owed_energy("e.ck")
    assert before > 0 and abs(after / before - 1) < 1e-12, (before, after)
    refuses("pamr-dsmc", case, "--mesh", mesh, "-o", "x.hdf", "--restart", "alike.ck", says=("alike.ck",), creates="x.hdf")
    refuses("pamr-dsmc", write("bad.toml", MIXTURE.replace("per_cell = 15.0", "per_cell = 30.0\nspecies_weights = { X = -0.01 }")),
            "--mesh", mesh, "-o", "x.hdf", says=("bad.toml:", "-0.01"), creates="x.hdf")
    refuses("pamr-dsmc", write("bad.toml", MIXTURE.replace("per_cell = 15.0", "per_cell = 30.0\nspecies_weights = { N2 = 0.5, X = 0.1 }")),
            "--mesh", mesh, "-o", "x.hdf", says=("bad.toml:", "greatest is 1"), creates="x.hdf")


def test_a_flow_is_carried_through_a_refinement():
    case, mesh = write("case.toml", CUBE), kuhn_cube("cube.hdf", 4)
    first = compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--json", "-", "--quiet").json
    run("pamr-mark", "a.hdf", "-o", "m.hdf", "--box", "0,0,0,1,1,0.3", "--quiet")
    run("pamr-refine", "m.hdf", "-o", "fine.hdf", "--quiet")
    weight = write("weight.toml", CUBE.replace("per_cell = 15.0", "total = 11520.0"))  # twice as many particles
    plan = run("pamr-dsmc", weight, "--mesh", "fine.hdf", "--plan", "--carry", "a.ck", "--json", "-").json
    out = compute(weight, "fine.hdf", "b.hdf", "--carry", "a.ck", "--checkpoint", "b.ck", "--json", "b.json")
    compute(weight, "fine.hdf", "c.hdf", "--carry", "a.ck", "--checkpoint", "c.ck", "--quiet", ranks=1)
    assert same_bytes("b.hdf", "c.hdf") and same_bytes("b.ck", "c.ck")
    line = next(line for line in out.out.splitlines() if line.startswith("carried"))
    carried, removed, new = (int(line.split()[i]) for i in (1, 6, 11))
    assert carried == first["particles"] and removed <= 2, line
    assert abs(new / (2 * carried) - 1) < 0.05, line
    assert plan["particles"] == 11520 and abs(plan["particles_at_start"] / (2 * carried) - 1) < 1e-9, plan
    assert first["plan"]["particles_at_start"] == 0

    # On the same mesh, one that has a field parent of its own: all particles stay where they are.
    line = next(line for line in compute(weight, "fine.hdf", "d.hdf", "--carry", "b.ck").out.splitlines() if line.startswith("carried"))
    carried, removed, same = (int(line.split()[i]) for i in (1, 6, 11))
    assert removed == 0 and same == carried, line


def test_stations_and_lines_show_the_flow_where_they_are():
    case = write("case.toml", CUBE + """
[[station]]
name = "floor"
x = 0.5
r = 0.4
half_width = 0.2
[[station]]
name = "nearest"
x = 0.5
r = 0.4
half_width = 1e-9
[[line]]
name = "across"
from = [0.1, 0.3, 0.2]
to = [0.9, 0.3, 0.2]
points = 5
[[line]]
name = "outside"
from = [2.0, 0.3, 0.2]
[[plane]]
name = "section"
corner = [0.1, 0.3, 0.0]
along = [0.8, 0.0, 0.0]
across = [0.0, 0.0, 2.0]
points = [5, 11]
""")
    warnings = compute(case, kuhn_cube("cube.hdf", 4), "a.hdf", "--lines", "a.csv", "--quiet").err.splitlines()
    assert [line for line in warnings if "has no rows" in line] == [
        'pamr-dsmc: warning: [[line]] "outside" has no rows: no part of it lies in the gas or on a wall'], warnings
    compute(case, "cube.hdf", "b.hdf", "--lines", "b.csv", "--quiet", ranks=1)
    assert same_bytes("a.csv", "b.csv")
    refuses("pamr-dsmc", case, "--mesh", "cube.hdf", "-o", "c.hdf", "--lines", "c.vtu", says=["--lines", "ends in .csv"], creates="c.vtu")
    told = compute(write("plain.toml", CUBE), "cube.hdf", "c.hdf", "--lines", "c.csv", "--steps", 2, "--quiet", ranks=1).err
    assert "--lines: the case has no [[station]], [[line]] or [[plane]], and c.csv no rows" in told, told
    rows = list(csv.DictReader(open("a.csv")))
    line = [row for row in rows if row["name"] == "across" and row["quantity"] == "n"]
    assert [float(row["s"]) for row in line] == [0, 0.2, 0.4, 0.6, 0.8]
    assert all(0.2e20 < float(row["value"]) < 5e20 for row in line), line
    assert not [row for row in rows if row["name"] == "outside"]
    plane = [row for row in rows if row["name"] == "section" and row["quantity"] == "n"]
    assert len(plane) == 5 * 6, len(plane)  # half of it is outside
    assert [float(row["x"]) for row in plane[:6]] == [0.1, 0.3, 0.5, 0.7, 0.9, 0.1] and float(plane[5]["z"]) == 0.2
    assert [row["value"] for row in plane[5:10]] == [row["value"] for row in line]  # the line lies in the plane
    floor = {row["quantity"]: row for row in rows if row["name"] == "floor"}
    near = {row["quantity"]: row for row in rows if row["name"] == "nearest"}
    pressure = 1e20 * 1.380649e-23 * 300
    assert int(floor["p"]["s"]) > 1 and int(near["p"]["s"]) == 1
    assert 0.5 * pressure < float(floor["p"]["value"]) < 4 * pressure and float(floor["p"]["stderr"]) > 0


def test_a_region_that_fills_no_cell_is_refused():
    mesh = kuhn_cube("cube.hdf", 5)
    dense = '[stream.dense]\ndensity = 3e20\ntemperature = 300.0\n'
    region = '[[initial.region]]\n{}\nstream = "dense"\n'
    corner, centroid = 'box = [0.0, 0.0, 0.0, 0.4, 0.4, 0.4]', "[0.09, 0.04, 0.14, 0.16, 0.06, 0.16]"
    lost = "expected an [[initial.region]] in the gas, found no centroid of a cell in it; the mesh lies in the box [0, 0, 0, 1, 1, 1]"
    for places, which, says in (([corner, "box = [2.0, 0.0, 0.0, 3.0, 1.0, 1.0]"], 1, lost),
                                (["box = [0.4, 0.4, 0.4, 0.0, 0.0, 0.0]"], 0, lost), (["sphere = [0.0, 0.0, 0.0, 0.01]"], 0, lost),
                                ([corner, "sphere = [0.0, 0.0, 0.0, 0.8]"], 0, "found later regions in all of its 48")):
        text = CUBE + dense
        lines = []
        for place in places:
            lines.append(text.count("\n") + 1)
            text += region.format(place)
        for how in (("-o", "x.hdf"), ("--plan",)):
            refuses("pamr-dsmc", write("case.toml", text), "--mesh", mesh, *how, says=[f"case.toml:{lines[which]}:1: ", says], creates="x.hdf")
    text = CUBE + dense + region.format(corner) + region.format(f"box = {centroid}")  # one cell, of one rank
    run("pamr-dsmc", write("good.toml", text), "--mesh", mesh, "--plan", "--quiet")
    # A run that does not start with the regions may have any.
    compute(write("case.toml", CUBE), mesh, "a.hdf", "--checkpoint", "a.ck", "--steps", "3", "--quiet")
    add_cell_field("a.hdf", "parent", np.arange(750))
    compute(write("case.toml", CUBE + dense + region.format("sphere = [9.0, 9.0, 9.0, 1.0]")), "a.hdf", "b.hdf", "--carry", "a.ck",
            "--steps", "3", "--quiet")


def test_time_steps_follow_the_flow_that_an_earlier_run_found():
    mesh = kuhn_cube("cube.hdf", 4)
    dense = CUBE.replace("density = 1e20", "density = 2e21").replace("step = 5e-5", "step = 1e-5")
    compute(write("first.toml", dense), mesh, "a.hdf", "--quiet")
    local = dense.replace("step = 1e-5", "step = 1e-5\ncell_fraction = 0.3\ncollision_fraction = 0.25\nfrom_fields = true")
    case = write("case.toml", local.replace("per_cell = 15.0", "total = 9000.0"))
    out = compute(case, "a.hdf", "b.hdf", "--checkpoint", "b.ck", "--json", "-", "--quiet").json
    compute(case, "a.hdf", "c.hdf", "--checkpoint", "c.ck", "--quiet", ranks=1)
    assert same_bytes("b.hdf", "c.hdf") and same_bytes("b.ck", "c.ck")
    assert abs(out["plan"]["particles"] / 9000 - 1) < 1e-9, out["plan"]
    with h5py.File("a.hdf") as before, h5py.File("b.hdf") as after:
        a, b = before["VTKHDF/CellData"], after["VTKHDF/CellData"]
        volume = 1 / 384
        fast = np.linalg.norm(a["u"][:], axis=1) + np.sqrt(2 * 1.380649e-23 * a["T_tr"][:] / 4.65e-26)
        step = np.minimum(1e-5, np.minimum(0.3 * volume**(1 / 3) / fast, 0.25 * a["tau_c"][:]))
        assert step.max() > 1.2 * step.min() and step.max() < 1e-5
        assert np.allclose(b["collision_probability"][:] * b["tau_c"][:], step, rtol=1e-9)
        weight = b["n"][:] * volume / b["particles"][:]
        assert np.ptp(weight / step) < 1e-9 * (weight / step).mean()
        assert abs(b["particles"][:].sum() / 9000 - 1) < 0.1
    quality = out["quality"]
    assert quality["collision_probability_below_1"] == 1 and quality["size_below_mean_free_path"] == 0
    refuses("pamr-dsmc", case, "--mesh", mesh, "-o", "x.hdf", says=("from_fields",), creates="x.hdf")
    bad = write("bad.toml", dense.replace("step = 1e-5", "step = 1e-5\nfrom_fields = true"))
    refuses("pamr-dsmc", bad, "--mesh", "a.hdf", "-o", "x.hdf", says=("bad.toml:", "from_fields"), creates="x.hdf")


def test_plan_computes_nothing():
    case, mesh = write("case.toml", CUBE), kuhn_cube("cube.hdf", 2)
    plan = run("pamr-dsmc", case, "--mesh", mesh, "--plan", "--json", "-").json
    assert abs(plan["speed_ratio"] - 400 / math.sqrt(2 * 1.380649e-23 * 300 / 4.65e-26)) < 1e-9
    assert abs(plan["particles"] - 48 * 15) < 1e-6 and plan["lambda_inf"] > 0
    assert os.listdir(".").count("case.toml") == 1 and len(os.listdir(".")) == 2


@of_one_process
def test_plan_gives_free_molecular_coefficients_of_the_walls_of_the_case():
    mesh, mass, temperature = kuhn_cube("cube.hdf", 2), 4.65e-26, 300.0
    s = 400 / math.sqrt(2 * 1.380649e-23 * temperature / mass)
    chi = math.exp(-s * s) + math.sqrt(math.pi) * s * (1 + math.erf(s))
    incident = (s * math.exp(-s * s) / math.sqrt(math.pi) + (0.5 + s * s) * (1 + math.erf(s))) / s**2
    diffuse = 0.5 * math.sqrt(500 / temperature) * chi / s**2
    heat = ((s * s + 2) * math.exp(-s * s) + math.sqrt(math.pi) * s * (s * s + 2.5) * (1 + math.erf(s)) + chi
            - 3 * 500 / temperature * chi) / (2 * math.sqrt(math.pi) * s**3)
    for wall, drag, heated in (
            ('kind = "diffuse", temperature = 500.0', incident + diffuse, heat),
            ('kind = "specular"', 2 * incident, 0),
            ('kind = "maxwell", temperature = 500.0, accommodation = 0.2', 1.8 * incident + 0.2 * diffuse, 0.2 * heat),
            ('kind = "cll", temperature = 500.0, normal_accommodation = 1.0, tangential_accommodation = 0.0', incident + diffuse, None),
            ('kind = "diffuse", temperature = 500.0, velocity = [1.0, 9.0, 0.0]', None, None)):
        case = write("case.toml", gas_in_a_cube(SPECIES, end="[reference]\narea = 1.0\n", xmax=wall))
        shown = run("pamr-dsmc", case, "--mesh", mesh, "--plan", "--json", "-")
        if drag is None:  # it moves through its own face
            assert "the wall xmax moves out of its plane" in shown.err and "free_molecular" not in shown.json, shown.err
            continue
        found = shown.json["free_molecular"]
        assert abs(found["C_D"] / drag - 1) < 1e-6, (wall, found, drag)
        assert heated is None or abs(found["C_H"] - heated) < 1e-9, (wall, found, heated)


def test_a_group_of_the_mesh_gives_all_its_patches_their_condition():
    """Half of the floor is in the groups `zmin` and `plates`, half of the ceiling in `zmax` and `plates`."""
    run("pamr-convert", kuhn_cube("cube.hdf", 1), "cube.msh", "--text", "--gmsh-version", "2.2", "--quiet")
    head, elements = pathlib.Path("cube.msh").read_text().split("$Elements\n")
    lines = elements.split("\n")[1:19]
    floor, ceiling = ([line.split() for line in lines if line.split()[1] == "2" and line.split()[3] == group][0] for group in "56")
    lines += [" ".join([str(19 + i), *face[1:3], "9", *face[4:]]) for i, face in enumerate((floor, ceiling))]
    names = head.replace("$PhysicalNames\n6", "$PhysicalNames\n7").replace("$EndPhysicalNames", '2 9 "plates"\n$EndPhysicalNames')
    write("groups.msh", names + "$Elements\n20\n" + "\n".join(lines) + "\n$EndElements\n")
    assert run("pamr-convert", "groups.msh", "mesh.hdf", "--json", "-").json["patches"] == [
        "xmin", "xmax", "ymin", "ymax", "zmin", "zmax", "zmin+plates", "zmax+plates"]
    case, wall = gas_in_a_cube(end='[reference]\narea = 1.0\npatches = ["plates"]\n'), 'kind = "diffuse", temperature = 300.0'
    text = case.replace("[boundary]\n", "[boundary]\nplates = { " + wall + " }\n").replace(
        'zmin = { kind = "inflow" }\nzmax = { kind = "inflow" }\n', '"z*" = { kind = "inflow" }\n')
    patch_by_patch = text.replace("plates = { " + wall, '"zmin+plates" = { ' + wall + ' }\n"zmax+plates" = { ' + wall).replace(
        '["plates"]', '["zmin+plates", "zmax+plates"]')
    by_group, by_patch = (run("pamr-dsmc", write(name, of), "--mesh", "mesh.hdf", "--plan", "--json", "-").json["free_molecular"]
                          for name, of in (("group.toml", text), ("patch.toml", patch_by_patch)))
    assert by_group == by_patch and by_patch["C_H"] > 0, (by_group, by_patch)
    clash = case.replace("[boundary]\n", "[boundary]\nplates = { " + wall + " }\n")
    refuses("pamr-dsmc", write("clash.toml", clash), "--mesh", "mesh.hdf", "-o", "x.hdf", creates="x.hdf",
            says=['expected one name that stands for "zmin+plates", found "plates" and "zmin"'])
    sides = clash.replace("plates = { " + wall, 'plates = { kind = "periodic", partner = "xmin"').replace(
        'xmin = { kind = "inflow"', 'xmin = { kind = "periodic", partner = "plates"').replace(
        "zmin = {", '"zmin+plates" = { ' + wall + ' }\n"zmax+plates" = { ' + wall + " }\nzmin = {").replace('patches = ["plates"]\n', "")
    refuses("pamr-dsmc", write("sides.toml", sides), "--mesh", "mesh.hdf", "-o", "x.hdf", creates="x.hdf",
            says=['expected one patch of kind "periodic", found that "plates" stands for 2'])


def test_bad_cases_are_refused_with_their_line():
    mesh = kuhn_cube("cube.hdf", 2)

    def refused(old, new, *says):
        assert old in CUBE
        case = write("bad.toml", CUBE.replace(old, new))
        refuses("pamr-dsmc", case, "--mesh", mesh, "-o", "x.hdf", says=says, creates="x.hdf")

    def line_of(text):
        return f"bad.toml:{CUBE[:CUBE.index(text)].count(chr(10)) + 1}:"

    refused("speed = 400.0", "sped = 400.0", line_of("speed"), "unknown key 'sped'", "did you mean 'speed'?")
    refused("density = 1e20", "density = -1e20", line_of("density"), "-1e+20")
    refused('zmin = { kind = "diffuse", temperature = 500.0, velocity = [10.0, 0.0, 0.0] }\n', "", "boundary", "zmin")
    refused("zmin = {", "floor = { kind = \"symmetry\" }\nzmin = {", '"floor"', "xmin")
    refused("per_cell = 15.0", "weight = 0.0", line_of("per_cell"), "weight")
    refused("step = 5e-5", 'step = "short"', line_of("step"), '"short"')
    refused("step = 5e-5", "step = 0.0", line_of("step"))
    side = '{ kind = "inflow" }'
    refused(f"xmin = {side}", 'xmin = { kind = "periodic", partner = "xmax" }', line_of("xmin"), "periodic", '"xmax"')
    refused(f"xmin = {side}", 'xmin = { kind = "periodic" }', line_of("xmin"), "partner")
    refused(f"xmin = {side}\nxmax = {side}\nymin = {{ kind = \"symmetry\" }}",
            f'xmin = {{ kind = "periodic", partner = "ymin" }}\nxmax = {side}\nymin = {{ kind = "periodic", partner = "xmin" }}',
            '"xmin"', '"ymin"', "face of cell")
    refused('"cll"', '"sticky"', line_of("ymax"), '"sticky"')
    refused("z_infinity = 18.1", "probability = 0.2\nz_infinity = 18.1", "one of probability")
    refused("fractions = { N2 = 1.0 }", "fractions = { N2 = 0.9 }", line_of("fractions"), "0.9")
    refused("unit = 1.0", "unit = -1.0", line_of("unit"))
    line = '[[line]]\nname = "a"\nfrom = [0.1, 0.1, 0.1]\n'
    refused("[domain]", line + line + "[domain]", "no other [[line]] has", '"a" again')
    refused("speed = 400.0", "velocity = [1e200, 0.0, 0.0]", line_of("speed"), "1e+200", "m/s")
    refused("velocity = [10.0, 0.0, 0.0]", "velocity = [1e200, 0.0, 0.0]", line_of("zmin"), "1e+200")
    refused("temperature = 300.0\nspeed", "temperature = 1e-300\nspeed", "temperature", "1e-300")
    refused("speed = 400.0", "speed = 1e-200", line_of("speed"), "0 or a number between")
    refused("density = 1e20", "density = 1e-20", line_of("density"), "0 or a number between")
    refused("mass = 4.65e-26", "mass = 4.65e-200", line_of("mass"), "mass")
    refused("diameter = 4.17e-10", "diameter = 4.17e-100", line_of("diameter"), "diameter")
    refused("z_infinity = 18.1", "z_infinity = 1e-300", line_of("z_infinity"), "z_infinity")
    refused("unit = 1.0", "unit = 1e100", line_of("unit"), "1e+100")
    refused("unit = 1.0", "unit = 1e15", "coordinates of at most", "1e+15 m")
    refused("area = 1.0", "area = 1e-300", line_of("area"), "area")
    refused("area = 1.0", "area = 1.0\npoint = [1e300, 0.0, 0.0]", "point", "1e+12 m each")
    refused("step = 5e-5", "step = 1e-300", line_of("step"), "step")
    refused("step = 5e-5", "step = 5e-5\ncell_fraction = 1e-300", "cell_fraction")
    refused("[run]", "[runs]", "unknown key 'runs'", "did you mean 'run'?")
    refused("[gas]\n", "[gas]\nfrac tions\n", "expected TOML")
    refuses("pamr-dsmc", "absent.toml", "--mesh", mesh, "-o", "x.hdf", says=("absent.toml",))


def test_what_the_machine_cannot_compute_is_refused_before_it_begins():
    mesh = kuhn_cube("cube.hdf", 4)

    def refused(old, new, *says):
        assert old in CUBE
        case = write("bad.toml", CUBE.replace(old, new))
        refuses("pamr-dsmc", case, "--mesh", mesh, "-o", "x.hdf", says=("bad.toml: ",) + says, creates="x.hdf")
        shown = run("pamr-dsmc", case, "--mesh", mesh, "--plan", "--quiet")
        assert "warning: no run of this is possible here: " in shown.err, shown.err

    refused("per_cell = 15.0", "weight = 1e-6", "particles a rank", "1e+26" if RANKS == 1 else "e+25")
    refused("per_cell = 15.0", "weight = 1e3", "particles a rank")
    refused("per_cell = 15.0", "total = 2e9", "of memory a rank", "2e+09 particles in all")
    refused("per_cell = 15.0", "weight = 1e3\n[initial]\nstream = \"vacuum\"", "particles a rank")
    refused("per_cell = 15.0", "weight = 1e58", "a particle at least")
    refused("step = 5e-5", "step = 1.0", "passes at most 1000 cells")
    refused("step = 5e-5", "step = 5e-2", "collides at most 1000 times")


def test_more_particles_than_an_inflow_face_can_number_are_refused_before_it_begins():
    case = write("case.toml", CUBE.replace("density = 1e20", "density = 1e26").replace("per_cell = 15.0", "weight = 1e20").replace(
        "step = 5e-5", "step = 1e-3").replace("[particles]", "[collisions]\nenabled = false\n[particles]"))
    refuses("pamr-dsmc", case, "--mesh", kuhn_cube("cube.hdf", 2), "-o", "x.hdf", says=("each inflow face",), creates="x.hdf")


def damaged(source, target, edit):
    """A copy of a checkpoint whose header (JSON) and tables (NumPy arrays) were edited, with right checksums."""
    words = np.fromfile(source, dtype="<u8")
    size = int(words[2])
    header = json.loads(words[4:4 + size // 8].tobytes())
    body, tables = words[4 + size // 8:], {}
    for entry in header["sections"]:
        begin = entry["offset"] // 8
        tables[entry["name"]] = body[begin:begin + entry["rows"] * entry["width"]].reshape(entry["rows"], entry["width"]).copy()
    names = [entry["name"] for entry in header["sections"]]
    edit(header, tables)
    with np.errstate(over="ignore"):
        for entry, name in zip(header["sections"], names):
            entry["checksum"] = int(table_sum(tables[name].ravel()))
        text = json.dumps(header).encode()
        text += b" " * (-len(text) % 8)
        hashed = np.uint64(0)
        for byte in text:
            hashed = combine(hashed, np.uint64(byte))
    fixed = np.array([words[0], words[1], len(text), hashed], dtype="<u8")
    pathlib.Path(target).write_bytes(fixed.tobytes() + text + b"".join(tables[name].tobytes() for name in names))
    return target


def mix(x):
    x = x + np.uint64(0x9e3779b97f4a7c15)
    x = (x ^ (x >> np.uint64(30))) * np.uint64(0xbf58476d1ce4e5b9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94d049bb133111eb)
    return x ^ (x >> np.uint64(31))


def combine(seed, word):
    return mix(seed ^ mix(word))


def table_sum(words):
    return combine(np.arange(len(words), dtype=np.uint64), words).sum(dtype=np.uint64)


def test_a_checkpoint_with_right_checksums_and_wrong_contents_is_refused():
    case, mesh = write("case.toml", CUBE), kuhn_cube("cube.hdf", 2)
    compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--steps", "20", "--quiet")
    run("pamr-mark", mesh, "-o", "m.hdf", "--box", "0,0,0,1,1,0.3", "--quiet")
    run("pamr-refine", "m.hdf", "-o", "fine.hdf", "--quiet")
    restart = ("pamr-dsmc", case, "--mesh", mesh, "-o", "x.hdf", "--force", "--restart")
    carry = ("pamr-dsmc", case, "--mesh", "fine.hdf", "-o", "x.hdf", "--force", "--carry")
    damaged("a.ck", "same.ck", lambda header, tables: None)
    run(*restart, "same.ck", "--quiet")  # the edit by itself does no harm
    os.remove("x.hdf")

    def refused(edit, *says, how=(restart, carry)):
        damaged("a.ck", "b.ck", edit)
        for command in how:
            refuses(*command, "b.ck", says=("b.ck",) + says, creates="x.hdf")

    def put(table, row, word, value):
        def edit(header, tables):
            kind = np.int64 if isinstance(value, int) else np.float64
            tables[table].view(kind)[row, word] = value
        return edit

    refused(put("particles", 5, 5, math.inf), "particles, row 5", "a velocity")
    refused(put("particles", 5, 2, 1e300), "particles, row 5", "a position")
    refused(put("particles", 0, 2, 0.9), "outside of the cell", how=(restart,))
    refused(put("particles", 7, 1, 99), "particles, row 7", "a species")
    refused(put("cells", 3, 0, -1), "cells, row 3", "particles")
    refused(put("cells", 3, 0, 0), "particles, as its cells have")
    refused(put("cells", 3, 1, 1e300), "cells, row 3", "(sigma c_r)_max")
    refused(put("cells", 3, 9, 1e60), "memory for them", how=(carry,))
    refused(put("faces", 3, 1, 2**62), "faces, row 3", how=(restart,))
    refused(lambda header, tables: header.update(steps_done=-1), "steps_done")
    refused(lambda header, tables: header["run"].update(in_interval=1e300), "in_interval", how=(restart,))
    refused(lambda header, tables: header["run"]["blocks"].append([]), "a block of loads", how=(restart,))
    refused(lambda header, tables: header["sections"][0].update(offset=8), "one behind the other")
    refused(lambda header, tables: header["sections"][0].update(name=3), "expected name = a text")
    refused(lambda header, tables: header.pop("setup"), "setup")
    refused(lambda header, tables: header.update(case=[]), "expected a checkpoint of this case", how=(restart,))


def test_a_checkpoint_that_does_not_fit_is_refused():
    case, mesh, other = write("case.toml", CUBE), kuhn_cube("cube.hdf", 2), kuhn_cube("other.hdf", 3)
    compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--steps", "3", "--quiet")
    again = ("pamr-dsmc", case, "--mesh", mesh, "-o", "x.hdf", "--restart")
    refuses("pamr-dsmc", case, "--mesh", other, "-o", "x.hdf", "--restart", "a.ck", says=("another mesh",), creates="x.hdf")
    refuses("pamr-dsmc", case, "--mesh", other, "-o", "x.hdf", "--carry", "a.ck", says=("parent",), creates="x.hdf")
    with h5py.File(mesh) as file:
        n = len(file["VTKHDF/Types"])
    add_cell_field("other.hdf", "parent", np.minimum(np.arange(162, dtype=np.int64), n - 1))
    refuses("pamr-dsmc", case, "--mesh", other, "-o", "x.hdf", "--carry", "a.ck", says=("other volumes",), creates="x.hdf")
    whole = pathlib.Path("a.ck").read_bytes()
    for length in (0, 5, 31, 40, len(whole) // 2, len(whole) - 1):
        pathlib.Path("cut.ck").write_bytes(whole[:length])
        refuses(*again, "cut.ck", says=("cut.ck",), creates="x.hdf")
    for place in (3, 20, 100, len(whole) // 2, len(whole) - 5):
        flipped = bytearray(whole)
        flipped[place] ^= 16
        pathlib.Path("flipped.ck").write_bytes(flipped)
        refuses(*again, "flipped.ck", says=("flipped.ck",), creates="x.hdf")
    refuses(*again, mesh, says=("checkpoint of pamr-dsmc",), creates="x.hdf")


def test_a_restart_with_another_case_is_refused_by_name_and_carry_is_the_way_on():
    case, mesh = write("case.toml", CUBE), kuhn_cube("cube.hdf", 2)
    compute(case, mesh, "a.hdf", "--checkpoint", "a.ck", "--steps", "15", "--quiet")
    for old, new, says in (
            ("temperature = 500.0", "temperature = 400.0", "boundary.zmin.temperature: the checkpoint has 500.0, the case 400.0"),
            ("temperature = 300.0\nspeed", "temperature = 310.0\nspeed", "stream.free.temperature: the checkpoint has 300.0, the case 310.0"),
            ("mass = 4.65e-26", "mass = 4.66e-26", "species.N2.mass: the checkpoint has 4.65e-26, the case 4.66e-26"),
            ("z_infinity = 18.1", "z_infinity = 18.2", "gas.rotation.z_infinity: "),
            ("transient = 10", "transient = 10\nseed = 2", "run.seed: the checkpoint has 1, the case 2"),
            ("transient = 10", "transient = 12", "run.transient: the checkpoint has 10, the case 12"),
            ("step = 5e-5", "step = 4e-5", "time.step: "),
            ("[run]", "[collisions]\nenabled = false\n[run]", "collisions.enabled: the checkpoint has true, the case false")):
        assert CUBE.count(old) == 1, old
        other = write("other.toml", CUBE.replace(old, new))
        refuses("pamr-dsmc", other, "--mesh", mesh, "-o", "x.hdf", "--restart", "a.ck", says=("a.ck", says, "--carry"), creates="x.hdf")
    compute(other, mesh, "x.hdf", "--carry", "a.ck", "--steps", "17", "--quiet")

    # One of a version that did not describe its case.
    damaged("a.ck", "old.ck", lambda header, tables: header.pop("case"))
    refuses("pamr-dsmc", case, "--mesh", mesh, "-o", "y.hdf", "--restart", "old.ck", says=("old.ck", "earlier version", "--carry"), creates="y.hdf")
    compute(case, mesh, "y.hdf", "--carry", "old.ck", "--steps", "17", "--quiet")


def test_coarse_time_steps_and_few_particles_are_warned_about():
    mesh = kuhn_cube("cube.hdf", 2)
    case = write("case.toml", CUBE.replace("step = 5e-5", "step = 2e-2").replace("per_cell = 15.0", "per_cell = 2.0"))
    result = compute(case, mesh, "x.hdf", "--steps", "2", "--quiet")
    assert "cell sizes in one time step" in result.err and "particles a cell" in result.err, result.err
    few = write("few.toml", CUBE.replace("per_cell = 15.0", "per_cell = 2.0").replace("zmax = { kind = \"maxwell\"", "zmax = { kind = \"diffuse\"").replace(
        ", accommodation = 0.5 }", " }"))
    result = compute(few, mesh, "y.hdf", "--quiet")
    assert "denser than the free stream have fewer than 5 particles" in result.err, result.err


run_tests(globals(), on_ranks=(test_the_cells_at_the_walls_are_checked_too_with_the_same_numbers_on_any_ranks,
                               test_restart_gives_the_same_bytes_as_a_run_without_interruption,
                               test_inlets_and_outlets_are_shown_and_go_on_with_the_same_bytes,
                               test_vibration_is_shown_and_goes_on_with_the_same_bytes_and_is_carried,
                               test_a_signal_ends_the_run_with_a_checkpoint_to_go_on_from,
                               test_a_killed_run_resumes_from_its_last_checkpoint, test_a_flow_is_carried_through_a_refinement,
                               test_stations_and_lines_show_the_flow_where_they_are, test_a_checkpoint_that_does_not_fit_is_refused,
                               test_time_steps_follow_the_flow_that_an_earlier_run_found))
