#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases of sparta.sh: the same gas, body and stream in pamr-dsmc and in SPARTA, and tables of both.

    sparta_cases.py OUT SPARTA RANKS SEED QUICK [CASE...]      QUICK: yes or no

Exit code 1 if a difference, or its bound, is not what sparta.csv has of the case; --quick compares nothing.

Bodies without incidence are axisymmetric in SPARTA and a sector or a half in pamr-dsmc. Both take near partners. Bounds are those
of 95 %, from blocks as long as a passage of the free stream, with Student's factor.
"""
import json
import math
import pathlib
import re
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.append(str(ROOT / "cases"))
from bounds import rows_of  # noqa: E402

BOLTZMANN = 1.380649e-23
ARGON = dict(name="Ar", mass=6.63e-26, diameter=4.17e-10, omega=0.81, t_ref=273.0, degrees=0)
NITROGEN = dict(name="N2", mass=4.65e-26, diameter=4.17e-10, omega=0.74, t_ref=273.0, degrees=2)
# Two-sided factors of 95 % for n - 1 degrees of freedom, by n (M. Abramowitz, I. A. Stegun, table 26.10).
STUDENT = {2: 12.706, 3: 4.303, 4: 3.182, 5: 2.776, 10: 2.262, 20: 2.093}
OUT, SPARTA, RANKS, SEED, QUICK = pathlib.Path("."), "spa_serial", 1, 1, False
N_BLOCKS = 10
missed = []  # a line for each difference that is not as sparta.csv has it


def tool(name, *arguments, ranks=None):
    n = RANKS if ranks is None else ranks
    launcher = ["mpirun", "-n", str(n)] if n > 1 else []
    done = subprocess.run([*launcher, name, *map(str, arguments)], cwd=OUT, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{name} {' '.join(map(str, arguments))}: {done.stderr}")


def estimate(values):
    """Mean and half width of 95 % of independent values."""
    values = np.asarray(values, float)
    n = len(values)
    return values.mean(), STUDENT[n] * values.std(ddof=1) / math.sqrt(n)


def sparta(name, lines):
    """One run of SPARTA; what it printed in the columns of its statistics goes to NAME.log."""
    text = "\n".join([f"seed {12344 + SEED}", *lines]) + "\n"
    (OUT / f"in.{name}").write_text(text)
    done = subprocess.run([SPARTA, "-in", f"in.{name}", "-log", f"{name}.log", "-screen", "none"], cwd=OUT, capture_output=True,
                          text=True)
    log = (OUT / f"{name}.log").read_text() if (OUT / f"{name}.log").exists() else ""
    if done.returncode != 0 or "ERROR" in log:
        errors = [line for line in log.splitlines() if "ERROR" in line]
        raise SystemExit(f"SPARTA, in.{name}: {' '.join(errors) or done.stderr}")


def write_gas(gas):
    """SPARTA's files of a species; rotation relaxes with the probability 0.2, vibration is switched off."""
    amu = gas["mass"] / 1.66053907e-27
    (OUT / f"{gas['name']}.species").write_text(
        f"{gas['name']} {amu:.6g} {gas['mass']:g} {gas['degrees']} {0.2 if gas['degrees'] else 0.0} 0 0.0 0.0 1.0 0.0\n")
    (OUT / f"{gas['name']}.vss").write_text(f"{gas['name']} {gas['diameter']:g} {gas['omega']} {gas['t_ref']} 1.0\n")
    return [f"species {gas['name']}.species {gas['name']}", f"collide vss gas {gas['name']}.vss"]


def gas_commands(gas, mixture, near=True):
    """`near`: partners are the nearest of 20 particles of a cell, else any of it."""
    species, collide = write_gas(gas)
    return [species, f"mixture gas {gas['name']} {mixture}", collide,
            f"collide_modify rotate {'smooth' if gas['degrees'] else 'no'} vibrate no" + (" nearcp yes 20" if near else "")]


def blocks_of(name):
    """The last rows of a file of `fix ave/time`, the step left out; that fix begins at a multiple of its length only."""
    rows = np.loadtxt(OUT / name, ndmin=2)[-N_BLOCKS:, 1:]
    assert len(rows) == N_BLOCKS, f"{name}: expected {N_BLOCKS} blocks, found {len(rows)}"
    return rows


def compare(case, what, difference, bound):
    """In words whether the difference of a quantity, and its bound of 95 %, are as sparta.csv has them."""
    row = next((row for row in rows_of(HERE / "sparta.csv") if (row["case"], row["quantity"]) == (case, what)), None)
    if row is None or QUICK:
        return "not compared"
    recorded, its_bound = float(row["difference"]), float(row["bound"])
    allowed = 2 * math.hypot(bound, its_bound)
    if bound <= 2 * its_bound and abs(difference - recorded) <= allowed:
        return "ok"
    missed.append(f"{case}: {what}: expected a difference of {recorded:.4f} within {allowed:.4f} and a bound of {its_bound:.4f}, at most "
                  f"twice that, found {difference:.4f} and {bound:.4f}")
    return "NOT AS EXPECTED"


def table(case, title, rows):
    """rows: quantity, ours and SPARTA's (value, half width). Compares each with sparta.csv."""
    print(f"\n{title}\n{'':34} {'pamr-dsmc':>10}  +-        {'SPARTA':>10}  +-        difference, and its bound")
    for what, (a, da), (b, db) in rows:
        unit = 1 / abs(b) if abs(b) > 0.2 else 1
        difference, bound = (a - b) * unit, math.hypot(da, db) * unit
        text = f"{difference:+.4f}, {bound:.4f}" if unit == 1 else f"{100 * difference:+.2f} %, {100 * bound:.2f} %"
        print(f"{what:34} {a:10.5g}  {da:<8.2g}  {b:10.5g}  {db:<8.2g}  {text}  {compare(case, what, difference, bound)}")
    sys.stdout.flush()


def value_of(report, name):
    return report[name]["value"], report[name]["ci95"]


# --- A box of gas at rest: collisions of a molecule a second.

def frequency(gas, n, t):
    """Of kinetic theory: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, chapter 4."""
    return 4 * gas["diameter"]**2 * n * math.sqrt(math.pi * BOLTZMANN * gas["t_ref"] / gas["mass"]) * (t / gas["t_ref"])**(
        1 - gas["omega"])


def box():
    n, t, dt, edge = 7.07043e22, 273.15, 7e-9, 1e-4
    particles, steps = (20000, 200) if QUICK else (124416, 1000)
    per_block = steps // N_BLOCKS
    for gas in (ARGON, NITROGEN):
        name = f"box-{gas['name']}"
        sparta(name, [
            "dimension 3", "global gridcut 0.0", "boundary p p p", f"create_box 0 {edge} 0 {edge} 0 {edge}",
            "create_grid 21 21 21", f"global nrho {n} fnum {n * edge**3 / particles}", *gas_commands(gas, f"temp {t} nrho {n}"),
            f"create_particles gas n {particles}", f"timestep {dt}", "compute t temp", "variable rate equal ncoll/np",
            "run 50", f"fix mean ave/time 1 {per_block} {per_block} v_rate c_t file {name}.dat", f"run {steps + per_block}"])
        found = blocks_of(f"{name}.dat")
        theirs = [2 * rate / dt / frequency(gas, n, temperature) for rate, temperature in found]

        cubes = 8 if QUICK else 12
        tool("pamr-mesh", "--shape", "kuhn-cube", "--n", cubes, "-o", "box.hdf", "--force", "--quiet", ranks=1)
        rotation = "[gas.rotation]\nprobability = 0.2\n" if gas["degrees"] else ""
        (OUT / f"{name}.toml").write_text(
            f'[gas]\nspecies_file = "{ROOT}/cases/species.toml"\nfractions = {{ {gas["name"]} = 1.0 }}\n{rotation}'
            f"[stream.free]\ndensity = {n}\ntemperature = {t}\n[boundary]\n"
            + "".join(f'{side} = {{ kind = "specular" }}\n' for side in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax"))
            + f"[particles]\nper_cell = {particles / (6 * cubes**3)}\n[domain]\nunit = {edge}\n[time]\nstep = {dt}\n"
            f"[run]\ntransient = 50\nsampling = {steps}\nblock = {per_block}\nseed = {SEED}\n")
        tool("pamr-dsmc", f"{name}.toml", "--mesh", "box.hdf", "-o", f"{name}.hdf", "--history", f"{name}.csv", "--force", "--quiet")
        rows = np.genfromtxt(OUT / f"{name}.csv", delimiter=",", names=True)
        rows = rows[rows["averaged"] == 1]
        full = particles  # the number that stands for the density n
        ours = [2 * r["collisions_per_particle_step"] / dt / frequency(gas, n * r["particles"] / full, r["T_tr"]) for r in rows]
        table(name, f"box of {gas['name']} at rest, {particles} particles, steps of {dt:g} s",
              [("collisions over kinetic theory's", estimate(ours), estimate(theirs))])


# --- Bodies.

def write_lines(name, points):
    """A meridian from nose to rear, gas on its left: a line a segment."""
    text = f"surf file\n\n{len(points)} points\n{len(points) - 1} lines\n\nPoints\n\n"
    text += "".join(f"{i} {x:.15g} {r:.15g}\n" for i, (x, r) in enumerate(points, 1)) + "\nLines\n\n"
    text += "".join(f"{i} {i} {i + 1}\n" for i in range(1, len(points)))
    (OUT / name).write_text(text)


def write_triangles(name, points, n_around):
    """The meridian turned by half a turn, y >= 0, as triangles with their normals into the gas."""
    nodes, number = [], {}

    def node(i, k):
        x, r = points[i]
        key = (i, k if r > 0 else 0)
        if key not in number:
            angle = math.pi * k / n_around
            y = 0.0 if k in (0, n_around) else r * math.sin(angle)
            nodes.append((x, y, r * math.cos(angle)))
            number[key] = len(nodes)
        return number[key]

    triangles = []
    for i in range(len(points) - 1):
        for k in range(n_around):
            a, b, c, d = node(i, k), node(i + 1, k), node(i + 1, k + 1), node(i, k + 1)
            triangles += [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]
    text = f"surf file\n\n{len(nodes)} points\n{len(triangles)} triangles\n\nPoints\n\n"
    text += "".join(f"{i} {x:.15g} {y:.15g} {z:.15g}\n" for i, (x, y, z) in enumerate(nodes, 1)) + "\nTriangles\n\n"
    text += "".join(f"{i} {a} {b} {c}\n" for i, (a, b, c) in enumerate(triangles, 1))
    (OUT / name).write_text(text)


def body_run(name, gas, domain, cells, stream, wall, surfaces, dt, fnum, passage, three_d=False, near=True):
    """Blocks of the force in x and z (N) and the heat (W) on the surfaces; `surfaces`: files, the first ones summed as the body."""
    transient, sampling = (passage // 2, N_BLOCKS * max(1, passage // 20)) if QUICK else (3 * passage, N_BLOCKS * passage)
    block = sampling // N_BLOCKS
    n, u, t = stream
    sides = "xlo yhi zlo zhi" if three_d else "xlo yhi"
    lines = [f"dimension {3 if three_d else 2}", "global gridcut 0.0 surfmax 2000",
             f"boundary o {'ro oo' if three_d else 'ao p'}", "create_box " + " ".join(f"{v:g}" for v in domain),
             "create_grid " + " ".join(map(str, cells)), "balance_grid rcb cell",
             f"global nrho {n} fnum {fnum}" + ("" if three_d else " weight cell radius"),
             *gas_commands(gas, f"nrho {n} vstream {u[0]} {u[1]} {u[2]} temp {t}", near)]
    for i, file in enumerate(surfaces):
        lines.append(f"read_surf {file} group part{i}")
    lines += [f"surf_collide wall diffuse {wall} 1.0", "surf_modify all collide wall", f"fix in emit/face gas {sides}",
              "create_particles gas n 0", f"timestep {dt}", f"stats {max(1, transient // 5)}", "stats_style step cpu np ncoll nscoll",
              f"run {transient}"]
    lines += ["compute load surf part0 all fx fz etot norm flow", "compute sum reduce sum c_load[1] c_load[2] c_load[3]",
              f"fix mean ave/time 1 {block} {block} c_sum[1] c_sum[2] c_sum[3] file {name}.dat", f"run {sampling + block}"]
    sparta(name, lines)
    return blocks_of(f"{name}.dat")


# Argon past a sphere, the two cases of cases/supersonic-sphere: density, speed, SPARTA's step, weight of pamr-dsmc's particles.
MACH_4_2 = dict(title="Mach 4.2, Kn 0.1035", n=6.438e18, speed=1355.25, dt=1.5e-5, weight=5e15)
MACH_8 = dict(title="Mach 8, Kn 0.03", n=2.2211e19, speed=2581.43, dt=4e-6, weight=1.5e16)


def sphere(name="sphere", more=1, finer=1, near=True, size=0.1, three_d=False, stream=MACH_4_2):
    """Argon past a sphere, on one mesh that is fine throughout.

    `more`: times the particles of both codes. `finer`: SPARTA's cells along each axis, times 20 a radius. `near`: SPARTA's partners.
    `size`: edges of pamr-dsmc's mesh at the wall. `three_d`: SPARTA computes half of the body with particles of one weight; where it
    is axisymmetric, those that come closer to the axis are cloned, and a clone may be the partner of its original.
    """
    n, speed, dt, t = stream["n"], stream["speed"], stream["dt"], 300.0
    circle = [(-math.cos(a), math.sin(a)) for a in np.linspace(0, math.pi, 61 if three_d else 121)]
    circle[0], circle[-1] = (-1.0, 0.0), (1.0, 0.0)
    passage = round(7 / speed / dt)
    if three_d:
        write_triangles(f"{name}.surf", circle, 60)
        domain, cells = (-3, 4, 0, 5, -5, 5), (140 * finer, 100 * finer, 200 * finer)
        fnum = n * 0.5 * math.pi * 25 * 7 / (more * (50000 if QUICK else 400000))
    else:
        write_lines(f"{name}.surf", circle)
        domain, cells = (-3, 4, 0, 5, -0.5, 0.5), (140 * finer, 100 * finer, 1)
        # a cell's weight: its radius, 2.5 on average, times its length
        fnum = n * math.pi * 25 * 7 / (more * (20000 if QUICK else 80000)) / (2.5 * 0.05 / finer)
    loads = body_run(name, ARGON, domain, cells, (n, (speed, 0, 0), t), 300.0, [f"{name}.surf"], dt, fnum, passage, three_d, near)
    q = 0.5 * ARGON["mass"] * n * speed**2 * math.pi * (0.5 if three_d else 1)

    text = (ROOT / "cases/supersonic-sphere/case.toml").read_text().replace("../species.toml", str(ROOT / "cases/species.toml"))
    text = text.replace("far = 0.8", "far = 0.4").replace("sphere = 0.25", f"sphere = {size}")
    steps = 40 if QUICK else 4500
    text = text.replace("density = 6.438e18", f"density = {n}").replace("velocity = [1355.25,", f"velocity = [{speed},")
    text = text.replace("weight = 3.5e15", f"weight = {(4 if QUICK else 1) * stream['weight'] / more}").replace(
        "sampling = 1000", f"sampling = {steps}\nseed = {SEED}" + ("\ntransient = 40" if QUICK else ""))
    (OUT / f"{name}.toml").write_text(text)
    tool("pamr-mesh", f"{name}.toml", "-o", f"{name}.hdf", "--force", "--quiet", ranks=1)
    tool("pamr-dsmc", f"{name}.toml", "--mesh", f"{name}.hdf", "-o", f"{name}-flow.hdf", "--json", f"{name}.json", "--force",
         "--quiet")
    report = json.loads((OUT / f"{name}.json").read_text())
    table(name, f"{name}: argon, {stream['title']} ({report['averages']['groups']} groups of {report['averages']['group_steps']} steps, a "
          f"passage has {report['averages']['passage_steps']}; SPARTA: {N_BLOCKS} of {passage})",
          [("C_D", value_of(report, "C_D"), estimate(loads[:, 0] / q)),
           ("C_H", value_of(report, "C_H"), estimate(loads[:, 2] / (q * speed)))])


def meridian(outflow):
    """The cone of cases/blunt-cone in m, nose to outflow: fore-body and base, and the sting apart."""
    def arc(x, r, radius, start, end, n):
        return [(x + radius * math.cos(a), r + radius * math.sin(a)) for a in np.linspace(math.radians(start), math.radians(end), n)]

    points = arc(12.5, 0, 12.5, 180, 160, 15)
    points += arc(9.172293, 23.75, 1.25, 160, 0, 25)
    points += arc(12.502293, 8.33, 2.08, 180, 270, 10)
    points[0] = (0.0, 0.0)
    points = [(x * 1e-3, r * 1e-3) for x, r in points]
    return points, [points[-1], (outflow, points[-1][1])]


def cone_run(angle, finer=1, sector=False):
    """Nitrogen at Mach 20 about the 70-degree cone: Set 1 without incidence, Set 2 at 10 degrees. Fore-body, base and sting.

    `finer`: SPARTA's cells along each axis, times those of `cone`; above 1 pamr-dsmc's cells in two layers at the fore-body are
    split, once. Both have its square times the particles. `sector`: pamr-dsmc computes a sixteenth of a turn instead of half.
    """
    ten = angle != 0
    n, speed, t = (1.116e21, 1502.0, 13.6) if ten else (3.715e20, 1502.57, 13.3)
    name = "cone-10" if ten else "cone-sector" if sector else "cone" if finer == 1 else "cone-cells"
    rear = 0.06 if ten else 0.03
    points, sting = meridian(rear)
    area, direction = math.pi * 0.025**2, (math.cos(math.radians(angle)), math.sin(math.radians(angle)))
    q = 0.5 * NITROGEN["mass"] * n * speed**2 * area
    dt = 1.5e-7
    passage = round((0.09 if ten else 0.05) / speed / dt)
    u = (speed * direction[0], 0, speed * direction[1])
    if ten:
        write_triangles("cone-10.surf", points + sting[1:], 60)
        domain, cells = (-0.03, rear, 0, 0.06, -0.06, 0.06), (113, 75, 150)
        fnum = n * 0.5 * math.pi * 0.06**2 * 0.09 / (100000 if QUICK else 1500000)
    else:
        write_lines(f"{name}.surf", points + sting[1:])
        domain, cells = (-0.02, rear, 0, 0.045, -0.5, 0.5), (125 * finer, 112 * finer, 1)
        fnum = n * math.pi * 0.045**2 * 0.05 / (finer**2 * (20000 if QUICK else 120000)) / (0.0225 * 0.0004 / finer)
    loads = body_run(name, NITROGEN, domain, cells, (n, u, t), 300.0, [f"{name}.surf"], dt, fnum, passage, ten)
    half = 2 if ten else 1
    drag = half * (loads[:, 0] * direction[0] + loads[:, 1] * direction[1]) / q
    lift = half * (loads[:, 1] * direction[0] - loads[:, 0] * direction[1]) / q
    heat = half * loads[:, 2] / (q * speed)

    case = HERE / "cone_sector.toml" if sector else ROOT / "cases/blunt-cone" / ("case.toml" if ten else "heat-flux.toml")
    text = re.sub(r"species_file = \S+", f'species_file = "{ROOT}/cases/species.toml"', case.read_text())
    text = text.replace('patches = ["forebody", "base"]', 'patches = ["forebody", "base", "sting"]')
    steps = 40 if QUICK else 4700 if sector else 3300
    text = text.replace("sampling = 1000", f"sampling = {steps}\nseed = {SEED}" + ("\ntransient = 40" if QUICK else ""))
    weight = 2e12 if ten else 6e10 if sector else 1.4e12 / finer**2
    text = re.sub(r"weight = \S+", f"weight = {10 * weight if QUICK else weight:g}", text, count=1)
    (OUT / f"{name}.toml").write_text(text)
    shape = [f"{name}.toml"] if sector else ["--shape", "blunt-cone"]
    tool("pamr-mesh", *shape, "-o", f"{name}.hdf", "--force", "--quiet", ranks=1)
    if finer > 1 and not sector:
        tool("pamr-mark", f"{name}.hdf", "--patch", "forebody", "--layers", 2, "-o", f"{name}-marked.hdf", "--force", "--quiet")
        tool("pamr-refine", f"{name}-marked.hdf", "-o", f"{name}.hdf", "--force", "--quiet")
    tool("pamr-dsmc", f"{name}.toml", "--mesh", f"{name}.hdf", "-o", f"{name}-flow.hdf", "--json", f"{name}.json", "--force", "--quiet")
    report = json.loads((OUT / f"{name}.json").read_text())
    rows = [("C_D, with the sting", value_of(report, "C_D"), estimate(drag))]
    if ten:
        rows.append(("C_L", value_of(report, "C_L"), estimate(lift)))
    rows.append(("C_H", value_of(report, "C_H"), estimate(heat)))
    table(name, f"{name}, nitrogen, {'Set 2' if ten else 'Set 1'}, {angle} degrees ({report['averages']['groups']} groups of "
          f"{report['averages']['group_steps']} steps, a passage has {report['averages']['passage_steps']}; SPARTA: {N_BLOCKS} of "
          f"{passage})", rows)


def main():
    global OUT, SPARTA, RANKS, SEED, QUICK
    OUT, SPARTA, RANKS, SEED = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    SPARTA = str(pathlib.Path(SPARTA).resolve())
    QUICK = sys.argv[5] == "yes"
    cases = {"box": box, "sphere": sphere, "cone": lambda: cone_run(0), "cone-10": lambda: cone_run(10),
             "cone-cells": lambda: cone_run(0, 2),  # smaller cells, partners that are closer
             "cone-sector": lambda: cone_run(0, 2, sector=True),  # and our particles six times as dense
             "sphere-4": lambda: sphere("sphere-4", more=4),  # the partners of both are closer
             "sphere-cells": lambda: sphere("sphere-cells", more=4, finer=2, size=0.06),  # and cells smaller
             "sphere-finest": lambda: sphere("sphere-finest", more=16, finer=4, size=0.06),  # SPARTA's once more, partners closer
             "sphere-3d": lambda: sphere("sphere-3d", more=4, three_d=True),  # and SPARTA's without clones
             "sphere-mach-8": lambda: sphere("sphere-mach-8", more=4, finer=2, size=0.06, stream=MACH_8),
             "sphere-any": lambda: sphere("sphere-any", more=4, finer=2, near=False, size=0.06)}  # and SPARTA's of the whole cell
    for name in sys.argv[6:] or ["box", "sphere", "cone"]:
        if name not in cases:
            raise SystemExit(f"sparta_cases.py: unknown case {name}: expected one of {', '.join(cases)}")
        cases[name]()
    for text in missed:
        print(f"sparta_cases.py: {text}", file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
