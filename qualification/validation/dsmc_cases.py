#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The validation cases of pamr-dsmc that take longer than a test: see dsmc.sh. Formulas: G. A. Bird, Molecular Gas Dynamics
and the Direct Simulation of Gas Flows, 1994, chapters 4, 7 and 12."""
import math
import pathlib
import subprocess
import sys

import numpy as np

import dsmc_runs as runs
from dsmc_runs import (ARGON, ARGON_SOFT, BOLTZMANN, NITROGEN, case_text, check, compute, cube, fields, gas, mean, mesh, refined,
                       together, tool, walls)
from shakhov import heat_between_plates

ROOT = pathlib.Path(__file__).resolve().parents[2]


def fast(t, mass):
    return math.sqrt(2 * BOLTZMANN * t / mass)


def frequency(s, n, t):
    return 4 * s["diameter"]**2 * n * math.sqrt(math.pi * BOLTZMANN * s["t_ref"] / s["mass"]) * (t / s["t_ref"])**(1 - s["omega"])


def free_path(s, n, t):
    return 1 / (math.sqrt(2) * math.pi * s["diameter"]**2 * n * (s["t_ref"] / t)**(s["omega"] - 0.5))


def viscosity(s, t):
    """Of variable soft spheres; alpha 1: hard ones."""
    a, w = s.get("alpha", 1.0), s["omega"]
    soft = (a + 1) * (a + 2) / 6 / a  # against hard spheres of the same diameter
    hard = 15 * math.sqrt(math.pi * s["mass"] * BOLTZMANN * s["t_ref"]) / (2 * math.pi * s["diameter"]**2 * (5 - 2 * w) * (7 - 2 * w))
    return soft * hard * (t / s["t_ref"])**w


def chi(s):
    return math.exp(-s * s) + math.sqrt(math.pi) * s * (1 + math.erf(s))


def plate_forces(s, theta, degrees):
    """Pressure, shear and heat coefficients of a diffuse plate at the gas's temperature."""
    sn, half = s * math.sin(theta), 0.5 * degrees
    gauss, rise, root = math.exp(-sn * sn), 1 + math.erf(sn), math.sqrt(math.pi)
    pressure = (sn * gauss / root + (0.5 + sn * sn) * rise + 0.5 * chi(sn)) / s**2
    heat = ((s * s + 2) * gauss + root * sn * (s * s + 2.5) * rise + half * chi(sn) - (2 + half) * chi(sn)) / (2 * root * s**3)
    return pressure, math.cos(theta) * chi(sn) / (s * root), heat


def averaged(report):
    return [row for row in report["history"] if row["averaged"] == 1]


def collision_rate(partner="nearest", per_cell=12.0, cubes=12, case="3"):
    n, t, dt = 7.07043e22, 273.15, 7e-9
    found = []
    for seed in range(1, runs.SEEDS + 1):
        report = compute("collision-rate", {**gas(Ar=ARGON_SOFT), "stream.free": dict(density=n, temperature=t), **walls("specular"),
                                            "collisions": {"partner": partner}, "particles": dict(per_cell=per_cell),
                                            "domain": dict(unit=1e-4), "time": dict(step=dt),
                                            "run": dict(transient=50, sampling=200, block=10)}, cube(cubes), seed)
        rows = averaged(report)
        real = rows[0]["particles"] / (6 * cubes**3 * per_cell) * n
        at = frequency(ARGON_SOFT, real, rows[-1]["T_tr"]) / frequency(ARGON_SOFT, n, t)
        found.append(mean([2 * row["collisions_per_particle_step"] / dt / at for row in rows]))
    value, error = together(found)
    name, bar = ("", 0) if case == "3" else (f", partner {partner}", 1e5)
    check(case, "collisions of a molecule a second" + name, 2.01953e7, value, error, bar=bar, most=0.001 * value)


def relaxation():
    """Rotation of nitrogen, one probability and Parker's number: both temperatures against the rate equation."""
    n, tau = 1e22, 2.43426e-7
    dt, zt, cubes, per_cell = 0.2 * tau, 5 - 2 * 0.74, 16, 20.0
    exact = {20: (410.02, 234.97), 40: (371.59, 292.62), 100: (343.08, 335.38)}
    models = {"P = 0.2": {"probability": 0.2}, "Parker": {"z_infinity": 18.1, "t_star": 91.5}}
    for model, keys in models.items():
        off, end, ratio = {}, {}, []
        for seed in range(1, runs.SEEDS + 1):
            report = compute("relaxation", {**gas(N2=NITROGEN), "gas.rotation": keys,
                                            "stream.free": dict(density=n, temperature=500.0, rotational_temperature=100.0),
                                            **walls("specular"), "particles": dict(per_cell=per_cell), "domain": dict(unit=1.5e-3),
                                            "time": dict(step=dt), "run": dict(transient=0, sampling=160, block=1)}, cube(cubes), seed)
            rows = report["history"]
            real = rows[0]["particles"] / (6 * cubes**3 * per_cell) * n
            t, r = rows[0]["T_tr"], rows[0]["T_rot"]
            total = 3 * t + 2 * r
            exact_ratio = []
            for step in range(2, 161):
                for _ in range(40):
                    z = 18.1 / (1 + math.pi**1.5 / 2 * math.sqrt(91.5 / t) + (math.pi + math.pi**2 / 4) * 91.5 / t)
                    chance = 0.2 if "probability" in keys else (2 + zt) / (z * zt)
                    r += dt / 40 * frequency(NITROGEN, real, t) * chance * zt / (zt + 2) * (t - r)
                    t = (total - 2 * r) / 3
                if step > 120:
                    exact_ratio.append(r / t)
                if step in (20, 40, 100):
                    end[step] = (t, r)
                    off.setdefault(step, []).append((rows[step - 1]["T_tr"] - t, rows[step - 1]["T_rot"] - r))
            late = rows[120:]
            ratio.append(mean([sum(x["T_rot"] for x in late[i:i + 8]) / sum(x["T_tr"] for x in late[i:i + 8]) for i in range(0, 40, 8)]))
            particles = rows[0]["particles"]
        # Parker's number goes by the cells' temperatures, smoothed over 50 steps: it lags behind the equation.
        gated = "probability" in keys
        for step, differences in off.items():
            for k, (name, spread) in enumerate((("T_tr", math.sqrt(2 / 3)), ("T_rot", 1))):
                reference = exact[step][k] if gated else end[step][k]
                error = reference * spread / math.sqrt(particles * len(differences))
                check("5" if gated else "6", f"{name} after {step // 5} tau, {model}", reference, reference + np.mean([d[k] for d in differences]), error,
                      bar=0.3, most=0.3, gated=gated)
        value, error = together(ratio)
        check("6", f"T_rot / T_tr after 24 to 32 tau, {model}", np.mean(exact_ratio), value, error, bar=0.003)


def equilibrium_ratio(fraction, partner, species, cubes=14, per_cell=20.0):
    """Rotation over translation of a gas in equilibrium, from 10 to 50 collision times."""
    n, t = 1e22, 340.0
    dt = fraction / frequency(NITROGEN, n, t)
    start, end = round(10 / fraction), round(50 / fraction)
    found = []
    for seed in range(1, runs.SEEDS + 1):
        rows = compute("equilibrium", {**gas(**species), "gas.rotation": {"probability": 0.2}, "stream.free": dict(density=n, temperature=t),
                                       **walls("specular"), "collisions": {"partner": partner}, "particles": dict(per_cell=per_cell),
                                       "domain": dict(unit=1.3e-3), "time": dict(step=dt),
                                       "run": dict(transient=0, sampling=end, block=1)}, cube(cubes), seed)["history"][start:]
        found += [sum(x["T_rot"] for x in part) / sum(x["T_tr"] for x in part) for part in np.array_split(rows, 8)]
    return mean(found)


def equilibrium():
    """Nitrogen, and its mixture with argon, in equilibrium stay there, whatever the step."""
    pure, mixed = dict(N2=NITROGEN), dict(Ar=ARGON, N2=NITROGEN)
    for fraction, partner, species in ((0.2, "nearest", pure), (0.1, "nearest", pure), (0.05, "nearest", pure), (0.2, "any", pure),
                                       (0.2, "nearest", mixed)):
        value, error = equilibrium_ratio(fraction, partner, species)
        case, name, most = ("6", "", 0.0007) if species is pure else ("20", ", argon and nitrogen half each", 0.001)
        check(case, f"T_rot / T_tr in equilibrium, step {fraction} tau, partner {partner}{name}", 1.0, value, error, bar=0.003, most=most)


def subcell():
    """Partners of the same sub-cell in cells of many particles: rates, equilibrium, and conduction at Kn 0.1 over cells of two to four
    mean free paths, where partners from all of a cell carry heat across it."""
    collision_rate("subcell", 400.0, 4, "24")
    value, error = equilibrium_ratio(0.2, "subcell", dict(N2=NITROGEN), 5, 400.0)
    check("24", "T_rot / T_tr in equilibrium, step 0.2 tau, partner subcell", 1.0, value, error, bar=0.003, most=0.0007)
    t, kn = 320.0, 0.1
    n = free_path(ARGON, 1, t) / kn

    def heat(partner, cubes, per_cell):
        return conduction("subcell", n, t, cubes, per_cell, 0.03 / fast(t, ARGON["mass"]), 200, 800, partner=partner)

    fine, fine_error = heat("nearest", 10, 14.0)
    for partner, gated in (("nearest", True), ("subcell", True), ("any", False)):
        value, error = heat(partner, 3, 500.0)
        check("24", f"conduction at Kn {kn} in coarse cells over that in fine ones, partner {partner}", 1.0, value / fine,
              math.hypot(error / fine, fine_error / fine), bar=0.02, gated=gated)


def between_walls(t, speeds):
    """Walls x = 0 and x = 1 that move along y; periodic in y and z."""
    return walls(**{side: {"kind": "diffuse", "temperature": t, "velocity": [0.0, u, 0.0]} for side, u in zip(("xmin", "xmax"), speeds)},
                 **{axis + a: {"kind": "periodic", "partner": axis + b} for axis in "yz" for a, b in (("min", "max"), ("max", "min"))})


def wall_loads(k):
    """Shear of both walls (Pa, against the upper one's motion) and what heats them (W/m2), for a reference area like a wall's."""
    pressure, speed = k["reference"]["dynamic_pressure"], k["reference"]["speed"]
    turn = {"xmin": -1, "xmax": 1}  # lift points along -y
    shear = [(turn[side] * pressure * k["patches"][side]["C_L"]["value"], pressure * k["patches"][side]["C_L"]["stderr"]) for side in turn]
    return shear, [(pressure * speed * k["patches"][side]["C_H"]["value"], pressure * speed * k["patches"][side]["C_H"]["stderr"]) for side in turn]


def flux():
    n, t, weight = 1e20, 300.0, 1e16
    for s in (0.0, 1.0, 5.0, -1.0):
        expected = n * fast(t, ARGON["mass"]) / (2 * math.sqrt(math.pi)) * chi(s)
        dt = 4000 * weight / expected
        found = []
        for seed in range(1, runs.SEEDS + 1):
            report = compute("flux", {**gas(Ar=ARGON), "stream.free": dict(density=n, temperature=t, velocity=[s * fast(t, ARGON["mass"]), 0.0, 0.0]),
                                      **walls("outflow", xmin={"kind": "inflow"}), "initial": {"stream": "vacuum"},
                                      "collisions": {"enabled": False}, "particles": {"weight": weight}, "time": dict(step=min(dt, 2e-3)),
                                      "run": dict(transient=0, sampling=400, block=10)}, cube(4), seed)
            found.append(mean([row["entered_per_step"] * weight / min(dt, 2e-3) for row in report["history"]]))
        value, error = together(found)
        check("7", f"flux at s = {s:g} (1/m2/s)", expected, value, error, bar=1e-4 * value, most=0.001 * value)


def plate(variant="diffuse"):
    n, t, s = 1e18, 200.0, 5.0
    v = s * fast(t, NITROGEN["mass"])
    wall = {"kind": "diffuse", "temperature": t} if variant == "diffuse" else {"kind": "maxwell", "temperature": t, "accommodation": 0.5}
    for angle in (0, 20, 90):
        theta = math.radians(angle)
        exact = list(plate_forces(s, theta, 2))
        if variant != "diffuse":  # half of the molecules leave as from a mirror
            sn = s * math.sin(theta)
            mirror = 2 * (sn * math.exp(-sn * sn) / math.sqrt(math.pi) + (0.5 + sn * sn) * (1 + math.erf(sn))) / s**2
            exact = [0.5 * (exact[0] + mirror), 0.5 * exact[1], 0.5 * exact[2]]
        found = []
        for seed in range(1, runs.SEEDS + 1):
            k = compute("plate", {**gas(N2=NITROGEN), "stream.free": dict(density=n, temperature=t, velocity=[v * math.sin(theta), v * math.cos(theta), 0.0]),
                                  **walls("inflow", xmax=wall), "collisions": {"enabled": False}, "particles": dict(per_cell=60.0),
                                  "time": dict(step=0.1 / v), "run": dict(transient=60, sampling=300 if angle else 900, block=15),
                                  "reference": dict(area=1.0, pitch_axis=[0.0, 0.0, 1.0])}, cube(6), seed)
            d, l, h = (k[name] for name in ("C_D", "C_L", "C_H"))
            sine, cosine = math.sin(theta), math.cos(theta)
            turn = lambda a, b: (a * d["value"] + b * l["value"], math.hypot(a * d["stderr"], b * l["stderr"]))
            found.append((turn(sine, cosine), turn(cosine, -sine), (h["value"], h["stderr"])))
        case = "8" if variant == "diffuse" else "21"
        for i, name in enumerate(("C_p", "C_tau", "C_H")):
            value, error = together([one[i] for one in found])
            # Gated where the coefficient is the drag; the others hold to four standard errors.
            is_drag = (angle == 90 and i == 0) or (angle == 0 and i == 1)
            most = None if case == "21" else 0.001 * exact[i] if is_drag else 0.002 * exact[i] if i == 2 else None
            check(case, f"plate, {name} at {angle} degrees" + ("" if case == "8" else ", Maxwell 0.5"), exact[i], value, error, most=most)


def sphere():
    """Drag and heat of a sphere: beside the closed form on the mesh's facets, whose own error against the sphere is known."""
    exact = {1: (4.75375, 1.78606), 5: (2.31553, 1.03960), 10: (2.13811, 1.00998)}
    level0 = mesh("sphere0.hdf", "--shape", "sphere-in-box")
    level1 = refined(level0, "sphere1.hdf", "--patch", "sphere")
    for s, on, sampling, extra in ((1, level0, 2200, {}), (5, level0, 700, {}), (10, level0, 700, {}), (5, level1, 1000, {"cell_fraction": 0.4})):
        v = s * fast(300.0, NITROGEN["mass"])
        found = []
        for seed in range(1, runs.SEEDS + 1):
            found.append(compute("sphere", {**gas(N2=NITROGEN), "stream.free": dict(density=1e17, temperature=300.0, velocity=[v, 0.0, 0.0]),
                                            "boundary": {"sphere": {"kind": "diffuse", "temperature": 300.0}, "box": {"kind": "inflow"}},
                                            "collisions": {"enabled": False}, "particles": dict(total=86000.0),
                                            "time": dict(step=0.1 / (v + 0.5 * fast(300.0, NITROGEN["mass"])), **extra),
                                            "run": dict(transient=120, sampling=sampling, block=35),
                                            "reference": dict(area=math.pi, length=2.0, patches=["sphere"])}, on, seed))
        case, note = ("22", ", step varying with the cells") if extra else ("9", "")
        for name, most, sphere_value in (("C_D", 0.001, exact[s][0]), ("C_H", 0.002, exact[s][1])):
            value, error = together([(k[name]["value"], k[name]["stderr"]) for k in found])
            facets = found[0]["plan"]["free_molecular"][name]
            check(case, f"{name} at s = {s}{note} (sphere: {sphere_value})", facets, value, error, most=most * value)


def newton():
    """Closed forms of free-molecular and Newtonian flow integrated over the cone's facets, level by level."""
    level = [mesh("cone0.hdf", "--shape", "blunt-cone")]
    for k in (1, 2):
        level.append(refined(level[-1], f"cone{k}.hdf", "--patch", "forebody"))
    exact = {0: dict(C_D=2.4639, C_H=0.7757, newton=1.7213), 10: dict(C_D=2.4226, C_L=-0.0711, C_m=-0.0693, C_H=0.7645, newton=1.6565)}
    for angle, values in exact.items():
        plans = [compute("cone", {**gas(N2=NITROGEN), "stream.free": dict(density=1.116e21, temperature=13.6, speed=1502.0, angle=float(angle)),
                                  "boundary": {"forebody": {"kind": "diffuse", "temperature": 300.0}, "base": {"kind": "specular"},
                                               "sting": {"kind": "specular"}, "inflow": {"kind": "inflow"}, "outflow": {"kind": "outflow"},
                                               "symmetry": {"kind": "symmetry"}},
                                  "particles": dict(per_cell=1.0), "time": dict(step=1e-7),
                                  "reference": dict(area=1.963495e-3, length=0.05, multiplier=2.0, patches=["forebody"])}, on, 1, plan=True) for on in level]
        for name, value in values.items():
            series = [p["newtonian"]["C_D"] if name == "newton" else p["free_molecular"][name] for p in plans]
            shown = "Newtonian C_D" if name == "newton" else f"free-molecular {name}"
            off = [abs(x - value) for x in series]
            check("11" if name == "newton" else "17", f"{shown}, {angle} degrees, facets of level 0, 1, 2: " + ", ".join(f"{x:.4f}" for x in series),
                  value, series[-1], 0.0, bar=max(0.001 * abs(value), 6e-5), most=None)
            print(f"        off by {off}", flush=True)


def conduction(name, n, t, cubes, per_cell, step, transient, sampling, collisions=True, partner="nearest"):
    """Heat from a wall x = 0 at 373 K to x = 1 at 273 K, W/m2, for as many molecules as were asked for."""
    found = []
    for seed in range(1, runs.SEEDS + 1):
        k = compute(name, {**gas(Ar=ARGON), "stream.free": dict(density=n, temperature=t),
                           **walls(xmin={"kind": "diffuse", "temperature": 373.0}, xmax={"kind": "diffuse", "temperature": 273.0}),
                           "collisions": {"enabled": collisions, "partner": partner}, "particles": dict(per_cell=per_cell), "time": dict(step=step),
                           "run": dict(transient=transient, sampling=sampling), "reference": dict(area=1.0)}, cube(cubes), seed)
        low, high = k["patches"]["xmin"]["C_H"], k["patches"]["xmax"]["C_H"]
        unit = 0.5 * k["reference"]["dynamic_pressure"] * k["reference"]["speed"] / (k["particles"] / (6 * cubes**3 * per_cell))
        found.append((unit * (high["value"] - low["value"]), unit * math.hypot(high["stderr"], low["stderr"])))
    return together(found)


def fourier():
    value, error = conduction("fourier", 1e18, 320.0, 4, 60.0, 0.4 / fast(320.0, ARGON["mass"]), 60, 4000, collisions=False)
    check("12", "free-molecular conduction, 373 and 273 K (W/m2)", 0.283110, value, error, most=0.003 * value)


def transition():
    """Conduction at Kn 0.2 and 320 K. Sherman's interpolation 1 / (1 + q_FM / q_cont) knows no temperature jump: towards the continuum it
    goes as if the jump were 0.85 of what it is."""
    t, kn = 320.0, 0.2
    n = free_path(ARGON, 1, t) / kn
    r = BOLTZMANN / ARGON["mass"]
    molecular = 2 * BOLTZMANN * n * 100 / (math.sqrt(math.pi * ARGON["mass"] / (2 * BOLTZMANN)) * (373**-0.5 + 273**-0.5))
    continuum = 15 / 4 * r * viscosity(ARGON, t) * 100
    value, error = conduction("transition", n, t, 8, 16.0, 0.06 / fast(t, ARGON["mass"]), 300, 1600)
    model = heat_between_plates(n * BOLTZMANN * t / (viscosity(ARGON, t) * math.sqrt(2 * r * t)))
    for name, reference in (("beside the linearized Shakhov model", model), ("beside Sherman's interpolation", 1 / (1 + molecular / continuum))):
        check("12", f"conduction at Kn {kn} over its free-molecular limit, {name}", reference, value / molecular, error / molecular, gated=False)


def couette():
    """Free-molecular flow along y between a wall at rest and one that moves: each takes up what the other gives."""
    n, t, u, cubes, per_cell = 1e18, 273.0, 300.0, 4, 60.0
    shear, heat = [], []
    for seed in range(1, runs.SEEDS + 1):
        k = compute("couette", {**gas(Ar=ARGON), "stream.free": dict(density=n, temperature=t), **between_walls(t, [0.0, u]),
                                "collisions": {"enabled": False}, "particles": dict(per_cell=per_cell), "time": dict(step=0.4 / fast(t, ARGON["mass"])),
                                "run": dict(transient=60, sampling=1200), "reference": dict(area=1.0, pitch_axis=[0.0, 0.0, 1.0])}, cube(cubes), seed)
        taken_up, heats = wall_loads(k)
        filled = k["particles"] / (6 * cubes**3 * per_cell)
        shear += [(value / filled, error / filled) for value, error in taken_up]
        heat += [(value / filled, error / filled) for value, error in heats]
    for quantity, exact, estimates in (("shear (Pa)", 1.89196e-3, shear), ("heat of a wall (W/m2)", 0.283793, heat)):
        value, error = together(estimates)
        check("13", f"free-molecular Couette flow, 300 m/s: {quantity}", exact, value, error, most=0.003 * value)


TUBES = ((1, 0.6720, 0.3), (2, 0.5142, 0.3), (10, 0.1910, 0.4))  # length over radius, transmission, size of the cells


def tube_mesh(length, size):
    """A tube of radius 1 along x, its wall refined twice; patches wall, inlet and outlet."""
    text = f'''[mesh]
shape = "surfaces"
length_unit = "1"
region = "-outlet & +inlet & -wall"
bounds = [[0, -1, -1], [{length}, 1, 1]]
[mesh.sizes]
far = {size}
[[surface]]
name = "wall"
kind = "cylinder"
point = [0, 0, 0]
axis = [1, 0, 0]
radius = 1
[[surface]]
name = "inlet"
kind = "plane"
point = [0, 0, 0]
normal = [1, 0, 0]
[[surface]]
name = "outlet"
kind = "plane"
point = [{length}, 0, 0]
normal = [1, 0, 0]
'''
    (runs.OUT / f"tube{length}.toml").write_text(text)
    level = mesh(f"tube{length}-0.hdf", f"tube{length}.toml")
    for k in (1, 2):
        level = refined(level, f"tube{length}-{k}.hdf", "--patch", "wall")
    return level


def tube():
    """Transmission of a tube of radius 1: the mean flux over all cross-sections over what enters."""
    for length, exact, size in TUBES:
        level = tube_mesh(length, size)
        dt, n = 1 / fast(300.0, NITROGEN["mass"]), 1e16
        found = []
        total = 20000.0
        weight = n * math.pi * length / total
        for seed in range(1, runs.SEEDS + 1):
            k = compute("tube", {**gas(N2=NITROGEN), "stream.free": dict(density=n, temperature=300.0),
                                 "boundary": {"wall": {"kind": "diffuse", "temperature": 300.0}, "inlet": {"kind": "inflow"}, "outlet": {"kind": "outflow"}},
                                 "collisions": {"enabled": False}, "particles": dict(weight=weight), "time": dict(step=dt),
                                 "run": dict(transient=40 + 20 * length, sampling=420)}, level, seed)
            _, volume, density, u = fields("tube", "n", "u")
            through = (density * u[:, 0] * volume).sum() / length
            entered = np.mean([row["entered_per_step"] for row in averaged(k)]) * weight / dt
            molecules = entered * dt / weight * 420
            found.append((through / entered, math.sqrt(exact * (1 - exact) / molecules)))  # one by one they pass or not
        value, error = together(found)
        check("14", f"transmission, length over radius {length}", exact, value, error, bar=0.001, most=0.0005)


def main():
    runs.OUT, runs.RANKS, runs.SEEDS = pathlib.Path(sys.argv[1]).resolve(), int(sys.argv[2]), int(sys.argv[3])
    from dsmc_flows import conductivity_cases, couette_cases, partners, slow_couette, steps, trace
    all_cases = {"collision-rate": collision_rate, "relaxation": relaxation, "equilibrium": equilibrium, "flux": flux,
                 "plate": lambda: (plate(), plate("maxwell")), "sphere": sphere, "newton": newton, "fourier": fourier, "couette": couette,
                 "transition": transition, "tube": tube, "conductivity": conductivity_cases, "viscosity": couette_cases, "slow-couette": slow_couette, "steps": steps, "trace": trace,
                 "subcell": subcell, "partners": partners}
    for name in sys.argv[4:] or all_cases:
        all_cases[name]()
    sys.exit(1 if runs.write_results() else 0)


if __name__ == "__main__":
    main()
