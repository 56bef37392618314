#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flows in ducts and vessels beside what is known of them: see ducts.sh. Each run takes at most three minutes, of
the channel ten, at delta = 10 on two processors."""
import datetime
import math
import pathlib
import subprocess
import sys

import numpy as np

import dsmc_cases as cases
import dsmc_runs as runs
from bgk_channel import Channel
from dsmc_flows import box
from dsmc_runs import ARGON, BOLTZMANN, NITROGEN, computed_once, fields, gas, mesh

T = 300.0
FOUR_ERRORS = 4 / 2.262  # four standard errors in bounds of 95 % of ten groups
MESH = 0.002  # of a truth: what cells and time steps of these runs may change
rows, misses = [], []


def row(case, quantity, truth, found, bound, most=0.01, model=MESH):
    """Compares with what is known. `bound`: of 95 %, at most `most` of the truth, since a wide bar would let any value pass.
    `model`: what the truth may be off, relative to it."""
    rows.append((case, quantity, f"{truth:.4g}", f"{found:.4g} +- {bound:.2g}", f"{100 * (found / truth - 1):+.2f} %"))
    print("  ".join(rows[-1]), flush=True)
    allowed = FOUR_ERRORS * bound + model * abs(truth)
    if not abs(found - truth) <= allowed:
        misses.append(f"NOT AS EXPECTED: {case}: {quantity}: expected {truth:.4g} within {allowed:.2g}, found {found:.4g}")
    if not bound <= most * abs(truth):
        misses.append(f"NOT AS EXPECTED: {case}: {quantity}: expected a bound of at most {most * abs(truth):.2g}, found {bound:.2g}")


def section(name, x):
    return dict(name=name, point=[x, 0.0, 0.0], normal=[1.0, 0.0, 0.0])


def passed(report, name):
    """Molecules a second along x through a plane, and their bound."""
    net = report["fluxes"]["planes"][name]["net"]["molecules"]
    return net["value"], net["ci95"]


def bound_of_particles(report):
    """Of the mean number of particles, relative to it: from ten groups."""
    groups = np.mean(np.reshape([one["particles"] for one in cases.averaged(report)], (10, -1)), axis=1)
    return 2.26 * groups.std(ddof=1) / groups.mean() / math.sqrt(10)


def transmission(case, length, truth, on, boundary, volume, particles=60000, n=1e16):
    """Gas of a vessel at rest through a duct along x into a vacuum, without collisions: at three sections, over what enters."""
    dt = 1 / cases.fast(T, NITROGEN["mass"])
    report = computed_once(case.replace(" ", "-").replace("/", "-"), {
        **gas(N2=NITROGEN), "stream.free": dict(pressure=n * BOLTZMANN * T, temperature=T), "boundary": boundary,
                        "collisions": {"enabled": False}, "particles": dict(weight=n * volume / particles), "time": dict(step=dt),
                        "run": dict(transient=40 + 20 * length, sampling=400),
                        "plane": [section(f"at {part:g} L", part * length) for part in (0.2, 0.5, 0.8)]}, on)
    inlet = "inlet" if "inlet" in boundary else "xmin"
    entered = report["fluxes"]["patches"][inlet]["in"]["molecules"]["value"]
    for part in (0.2, 0.5, 0.8):
        value, bound = passed(report, f"at {part:g} L")
        row(case, f"transmission, at {part:g} L", truth, value / entered, bound / entered)


def tube():
    for length, truth, size in cases.TUBES:
        boundary = {"wall": {"kind": "diffuse", "temperature": T}, "inlet": {"kind": "inflow"}, "outlet": {"kind": "outflow"}}
        transmission(f"tube L/R = {length}", length, truth, cases.tube_mesh(length, size), boundary, math.pi * length)


def slit_by_integral():
    """Transmission of a slit as long as high with diffuse walls: Clausing's integral equation, by Gauss's points."""
    x, w = np.polynomial.legendre.leggauss(400)
    x, w = 0.5 * (x + 1), 0.5 * w
    onto = lambda x: 0.5 * (1 - x / np.sqrt(1 + x * x))  # a wall at x from an end
    arrives = np.linalg.solve(np.eye(len(x)) - 0.5 * w / ((x[:, None] - x)**2 + 1)**1.5, onto(x))
    return math.sqrt(2) - 1 + 2 * (w * arrives * onto(1 - x)).sum()


def slit_by_rays(accommodation, n=16000000):
    """The same with Maxwell's walls, by straight rays from wall to wall, without a mesh: within 0.0002."""
    draw = np.random.default_rng(1)
    leaving = lambda n: np.sqrt(-np.log(draw.random(n)))
    y, x, along, across = draw.random(n), np.zeros(n), leaving(n), draw.normal(size=n) / math.sqrt(2)
    through = 0
    while len(x):
        x = x + along * np.where(across > 0, 1 - y, -y) / across
        through += np.count_nonzero(x >= 1)
        inside = (x > 0) & (x < 1)
        x, up, along, across = x[inside], across[inside] > 0, along[inside], across[inside]
        y = np.where(up, 1.0, 0.0)
        diffuse = draw.random(len(x)) < accommodation
        along = np.where(diffuse, draw.normal(size=len(x)) / math.sqrt(2), along)
        across = np.where(diffuse, np.where(up, -1, 1) * leaving(len(x)), -across)
    return through / n


def slit():
    for kind, truth in (({"kind": "diffuse"}, slit_by_integral()), ({"kind": "maxwell", "accommodation": 0.5}, slit_by_rays(0.5))):
        sides = dict(xmin={"kind": "inflow"}, xmax={"kind": "outflow"}, **{y: {**kind, "temperature": T} for y in ("ymin", "ymax")})
        case = f"slit L = H, {kind['kind']}" + (" .5" if "accommodation" in kind else "")
        transmission(case, 1, truth, box("slit.hdf", 4, 4, 1, 0, 1), runs.walls(**sides)["boundary"], 0.25)


VESSEL = '''[mesh]
shape = "surfaces"
length_unit = "1"
region = "(-vessel | -tube) & +left & -right"
bounds = [[-1.5, -1, -1], [1.5, 1, 1]]
[mesh.sizes]
far = 0.3
near = { tube = 0.2 }
[[surface]]
name = "vessel"
kind = "sphere"
center = [0, 0, 0]
radius = 1
[[surface]]
name = "tube"
kind = "cylinder"
point = [0, 0, 0]
axis = [1, 0, 0]
radius = 0.5
''' + "".join(f'''[[surface]]
name = "{name}"
kind = "plane"
point = [{x}, 0, 0]
normal = [1, 0, 0]
''' for name, x in (("left", -1.5), ("right", 1.5)))


def vessel():
    """A ball with two equal tubes, at other pressures at their ends: the gas inside has the mean, without collisions."""
    (runs.OUT / "vessel.toml").write_text(VESSEL)
    on = mesh("vessel.hdf", "vessel.toml")
    n = 1e16
    dt = 0.3 / cases.fast(T, NITROGEN["mass"])
    wall = {"kind": "diffuse", "temperature": T}
    for name, low in (("vessels at the ends", 0.5), ("inlet and outlet", 0.9)):  # of the second the squared speed counts: small
        streams = {"stream.free": dict(density=n, temperature=T), "stream.low": dict(density=low * n, temperature=T)}
        end = dict(left={"kind": "inflow"}, right={"kind": "inflow", "stream": "low"})
        if name.startswith("inlet"):
            end = dict(left={"kind": "inlet"}, right={"kind": "outlet", "pressure": low * n * BOLTZMANN * T})
        file, case = "vessel-" + name.split()[0], "vessel, " + name
        report = computed_once(file, {**gas(N2=NITROGEN), **streams, "boundary": {"vessel": wall, "tube": wall, **end},
                            "collisions": {"enabled": False}, "particles": dict(total=30000.0), "time": dict(step=dt),
                            "run": dict(transient=600, sampling=2400),
                            "plane": [section("left tube", -1.2), section("middle", 0.0), section("right tube", 1.2)]}, on)
        middle, volume, density = fields(file, "n")
        v = np.where(np.linalg.norm(middle, axis=1) < 0.8, volume, 0)
        inside = np.average(density, weights=v) / n
        row(case, f"density inside, {low:g} at the other end", 0.5 * (1 + low), inside, inside * bound_of_particles(report))
        first, *others = [passed(report, plane) for plane in ("left tube", "middle", "right tube")]
        for place, (value, bound) in zip(("middle", "right tube"), others):
            row(case, f"flow, {place} over left tube", 1.0, value / first[0], math.hypot(bound, first[1]) / first[0],
                most=0.1 if name.startswith("inlet") else 0.03)  # of little flow chance is a large part


def flow():
    """A duct of mirrors, a mass flow in, a pressure at the end: a uniform flow."""
    mass, n, u = ARGON["mass"], 2e20, 60.0
    on = box("duct.hdf", 20, 4, 4, 0, 1)
    p = n * BOLTZMANN * T
    area = (4 / 20)**2
    report = computed_once("duct", {**gas(Ar=ARGON), "stream.free": dict(density=0.5 * n, temperature=T),
                                    **runs.walls(xmin={"kind": "inlet", "mass_flow": n * mass * u * area}, xmax={"kind": "outlet", "pressure": p}),
                                    "particles": dict(weight=n * area / 30000), "time": dict(step=4e-5),
                                    "run": dict(transient=1500, sampling=3000), "plane": [section(f"x = {x}", x) for x in (0.2, 0.5, 0.8)]}, on)
    case = "duct of mirrors, mass flow in, pressure at the end"
    for x in (0.2, 0.5, 0.8):
        value, bound = passed(report, f"x = {x}")
        row(case, f"mass flow at x = {x} over that asked for", 1.0,
            value / (n * u * area), bound / (n * u * area))
    _, volume, density, temperature = fields("duct", "n", "T")
    row(case, "pressure (Pa)", p, BOLTZMANN * np.average(density * temperature, weights=volume), p * bound_of_particles(report))


def bars(n_runs=24, fewest=21):
    """How many bounds of net fluxes between an inlet and an outlet hold the mean of all runs: fewer than `fewest` of 24 that hold
    with 95 % come once in 170 times."""
    on, p = box("bars.hdf", 8, 2, 2, 0, 1), 0.36
    wall = {"kind": "diffuse", "temperature": T}
    tables = {**gas(N2=NITROGEN), "stream.free": dict(pressure=p, temperature=T),
              **runs.walls(xmin={"kind": "inlet"}, xmax={"kind": "outlet", "pressure": 0.9 * p}, ymin=wall, ymax=wall, zmin=wall, zmax=wall),
              "particles": dict(per_cell=8.0), "time": dict(step=1 / 40 / cases.fast(T, NITROGEN["mass"])), "run": dict(transient=2000, sampling=8000)}
    reports = [computed_once(f"bars-{seed}", tables, on, seed) for seed in range(1, n_runs + 1)]
    for patch in ("xmin", "xmax"):
        found = np.array([[one["fluxes"]["patches"][patch]["net"]["molecules"][key] for key in ("value", "ci95")] for one in reports])
        holds = int((abs(found[:, 0] - found[:, 0].mean()) < found[:, 1]).sum())
        rows.append(("duct between inlet and outlet", f"runs of {n_runs} whose bound of the net flux through {patch} holds their mean", "95 %", str(holds), ""))
        print("  ".join(rows[-1]), flush=True)
        if holds < fewest:
            misses.append(f"NOT AS EXPECTED: bounds of the flux through {patch}: expected {fewest} that hold at least, found {holds}")
    print("passage", reports[0]["averages"])


def flow_of_bgk(delta, n=400):
    """Reduced flow rate G of plane Poiseuille flow with diffuse walls: the linearized equation of Bhatnagar, Gross and Krook
    (C. Cercignani and A. Daneri, J. Appl. Phys. 34, 3509, 1963). Its integral equation, with the gap as unit,
        W(x) - delta / sqrt(pi) int T_-1(delta |x - x'|) W(x') dx' = 1 / (2 delta),   G = 2 int W dx - 1 / delta,
    by Galerkin's method on n equal pieces; T_k(s) = int_0^inf c^k exp(-c^2 - s / c) dc, T_1'' = T_-1."""
    c, step = np.linspace(-12.0, 2.0, 561, retstep=True)
    c = np.exp(c)
    t1 = step * (c**2 * np.exp(-c**2 - delta * np.arange(n + 1)[:, None] / n / c)).sum(axis=1)
    entries = np.empty(n)
    entries[0] = 1 / n - 2 * (t1[0] - t1[1]) / delta / math.sqrt(math.pi)
    entries[1:] = (t1[2:] - 2 * t1[1:-1] + t1[:-2]) / delta / math.sqrt(math.pi)
    apart = np.abs(np.arange(n)[:, None] - np.arange(n))
    w = np.linalg.solve(np.eye(n) / n - entries[apart], np.full(n, 0.5 / delta / n))
    return 2 * w.mean() - 1 / delta


def fall_of(x, pressure, length):
    """Of pressure over the middle half, by a parabola, with its bound from what is left."""
    fit, spread = np.polyfit(x - length / 2, pressure, 2, cov=True)
    return -length / 2 * fit[1], length / 2 * 2.11 * math.sqrt(spread[1, 1])


def channel(sizes=(8, 60000.0), lasts=1.0):
    """Argon in a channel 20 times as long as high, between an inlet and an outlet of half its pressure: the middle half."""
    unit, mass, length = cases.fast(T, ARGON["mass"]), ARGON["mass"], 20
    # At delta = 10 the gas flies 0.07 heights between two collisions: steps and cells of the others would be as long.
    for delta, step, time, finer in ((0.1, 0.1, 4500, 1), (1.0, 0.1, 1500, 1), (10.0, 0.02, 600, 2)):
        across, particles = finer * sizes[0], finer * sizes[1]
        p = delta * cases.viscosity(ARGON, T) * unit  # the gap is 1 m; in the middle, about
        n = p / BOLTZMANN / T
        at = lambda x: float(4 / 3 - 2 / 3 * x / length)
        streams = {f"stream.s{i}": dict(density=n * at(i + 0.5), temperature=T) for i in range(length)}
        regions = [dict(box=[float(i), -1.0, -1.0, i + 1.0, 2.0, 2.0], stream=f"s{i}") for i in range(length)]
        wall = {"kind": "diffuse", "temperature": T}
        relaxation = round(length / step)
        ends = dict(xmin={"kind": "inlet", "relaxation": relaxation},
                    xmax={"kind": "outlet", "pressure": at(length) * p, "relaxation": relaxation}, ymin=wall, ymax=wall)
        name = f"channel-{delta:g}"
        report = computed_once(name, {**gas(Ar=ARGON), "stream.free": dict(density=n * at(0), temperature=T), **streams,
                                      **runs.walls(**ends), "initial": {}, "initial.region": regions,
                                      "particles": dict(weight=n * length / across / particles), "time": dict(step=step / unit),
                                      "run": dict(transient=round(lasts * 400 / step), sampling=round(lasts * time / step)),
                                      "plane": [section(f"x = {x}", x) for x in (5.0, 7.5, 10.0, 12.5, 15.0)]},
                               box(f"channel-{across}.hdf", length * across, across, 1, 0, length))
        x = np.arange(5.25, 15.0, 0.5)
        ends = Channel(float(length), delta, across=10, cell=1 / across).with_density(at(0), at(length))
        true_fall, _ = fall_of(x, ends.pressure(x), length)
        middle, volume, density, temperature = fields(name, "n", "T")
        slab = [np.abs(middle[:, 0] - one) < 0.25 for one in x]
        pressure = BOLTZMANN * np.array([np.average((density * temperature)[s], weights=volume[s]) for s in slab])
        fall, off = fall_of(x, pressure / p, length)
        # The same molecules pass all planes: their bounds are not divided by the root of their number.
        flows = [passed(report, f"x = {one}") for one in (5.0, 7.5, 10.0, 12.5, 15.0)]
        flow, bound = (np.mean(one) * across / n / unit for one in zip(*flows))
        case = f"channel, delta = {delta:g} at its middle"
        row(case, "flow between both pressures", ends.flow, flow, bound, most=0.03, model=0.03)
        g = length / fall  # of a flow: over half of the gradient, with pressures over p
        row(case, f"reduced flow rate G; without ends {flow_of_bgk(delta):.4g}", length * ends.flow / true_fall, g * flow,
            g * math.hypot(bound, flow * off / fall), most=0.03, model=0.03)


def page():
    cpu = subprocess.run("sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1", shell=True, capture_output=True, text=True).stdout.strip()
    commit = subprocess.run(["git", "-C", str(cases.ROOT), "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True).stdout.strip()
    table = "\n".join("| " + " | ".join(one) + " |" for one in rows)
    return f"""# Ducts and vessels

    qualification/validation/ducts.sh

Does `pamr-dsmc` give the flows in tubes, slits and vessels that are known, with [its boundaries for them](../tools/pamr-dsmc-ducts.md)?

{datetime.date.today():%-d %B %Y}, commit {commit}, {cpu}, {runs.RANKS} rank(s), shared with other work; one seed.
+- are bounds of 95 % of chance; no value was fitted.

| case | quantity | truth | ours | off |
|---|---|---|---|---|
{table}

- **Tubes** of length L and radius R, **slits** as long as high (diffuse walls, Maxwell's with .5): gas of a vessel at rest, an `inflow` by pressure, flows into a vacuum without collisions.
  The transmission is the net flow through planes at three sections over what enters.
  Truths: Clausing's for tubes; for slits his integral equation by 400 Gauss points, and with Maxwell's walls 16 million straight rays without a mesh, within 0.0002.
  Values of .6848 and .8196, which are quoted for these slits, are 0.06 and 0.12 % above.
- **Vessel**: a ball of radius 1 with two tubes of radius 0.5 at other pressures, without collisions.
  Its gas has the mean, and as much leaves as comes.
  Between inlet and outlet that holds but for the square of the speed at the ends: at 0.5 instead of 0.9 the density was 1.9 % above the mean.
- **Duct of mirrors**: argon, 60 m/s, a fifth as high as long, with collisions.
  It begins at rest with half the density, and must come to the speed of the mass flow and the pressure of the outlet everywhere.
- **Channel**: argon between diffuse walls, 20 times as long as high, mirrors beside, an `inlet` and an `outlet` of half its pressure, about the minimum of Knudsen.
  delta is height times pressure over viscosity and sqrt(2 k T / m), the reduced flow rate G the mass flow over height squared, width and pressure gradient, times sqrt(2 k T / m).
  The first row of each is the flow itself, over height, sqrt(2 k T / m) and the density at the mean of both pressures.
  G is measured in the middle half: the mean flow of five planes over the fall of pressure between x = 5 and 15 heights, by a parabola through the pressures of 20 slabs.
  Truth: the linearized equation of Bhatnagar, Gross and Krook for the same channel with its ends, in two dimensions, measured alike (`bgk_channel.py`; the entering gas has the pressures, the speed of the flow and, at the outlet, the temperature of the gas there).
  For a channel without ends the script solves the integral equation of Cercignani and Daneri (J. Appl. Phys. 34, 3509, 1963).
  The particles collide as variable hard spheres, not by this equation, hence 3 % and bars; bounds are those of a single plane, since the planes count the same molecules.

Bounds of densities and pressures come from the number of particles in ten groups of steps, the others from the blocks of each run.
"""


def main():
    runs.OUT, runs.RANKS = pathlib.Path(sys.argv[1]).resolve(), int(sys.argv[2])
    all_cases = {"tube": tube, "slit": slit, "vessel": vessel, "flow": flow, "bars": bars, "channel": channel}
    for name in sys.argv[3:] or all_cases:
        all_cases[name]()
    (runs.OUT / "ducts-and-vessels.md").write_text(page())
    print("\n".join(misses))
    sys.exit(1 if misses else 0)


if __name__ == "__main__":
    main()
