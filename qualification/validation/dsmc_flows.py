# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation cases of pamr-dsmc in the gas itself: viscosity, steps that vary with the cells, trace species."""
import math
import subprocess
import sys

import numpy as np

import dsmc_cases as cases
import dsmc_runs as runs
from dsmc_runs import ARGON, ARGON_SOFT, BOLTZMANN, NITROGEN, case_text, check, compute, cube, fields, gas, mean, refined, tool, walls
from linear_couette import shear_of

XENON = dict(mass=2.18e-25, diameter=5.74e-10, omega=0.85, t_ref=273.0)


def box(name, *numbers):
    if not (runs.OUT / name).exists():
        subprocess.run([sys.executable, str(cases.ROOT / "cases/box_mesh.py"), str(runs.OUT / "box.msh"), *map(str, numbers)], check=True)
        tool("pamr-convert", "box.msh", name, "--quiet", ranks=1)
    return name


def conductivity(species, seed, partner="nearest", finer=1, per_cell=40.0, steps=(1000, 3000)):
    """Conductivity over that of kinetic theory, 15/4 k/m mu, and particle-steps a second: heat from wall to wall over the slope of
    the temperature in the middle half, six mean free paths and more from the walls. Cells: bricks of a mean free path, 6 each,
    `finer` times as many along each edge. `steps`: before sampling and with it."""
    paths, low, high = 25, 200.0, 400.0
    bricks = paths * finer
    t = 0.5 * (low + high)
    n = cases.free_path(species, 1, t) * paths
    k = compute("conductivity", {**gas(Ar=species), "stream.free": dict(density=n, temperature=t),
                                 **walls(xmin={"kind": "diffuse", "temperature": high}, xmax={"kind": "diffuse", "temperature": low}),
                                 "collisions": dict(partner=partner), "particles": dict(per_cell=per_cell),
                                 "time": dict(step=0.2 / paths / cases.fast(t, species["mass"])), "run": dict(transient=steps[0], sampling=steps[1]),
                                 "reference": dict(area=4.0 / bricks**2)}, box(f"channel-{finer}.hdf", bricks, 2, 2, 0, 1), seed)
    heat = 0.5 * k["reference"]["dynamic_pressure"] * k["reference"]["speed"] * (k["patches"]["xmax"]["C_H"]["value"] - k["patches"]["xmin"]["C_H"]["value"])
    middle, volume, density, temperature = fields("conductivity", "n", "T")
    core = np.abs(middle[:, 0] - 0.5) < 0.25
    slope, _ = np.polyfit(middle[core, 0], temperature[core], 1, w=np.sqrt(density[core]))
    at = np.average(temperature[core])
    return (-heat / slope / (15 / 4 * BOLTZMANN / species["mass"] * cases.viscosity(species, at)),
            k["particle_steps_per_second_per_core"])


def conductivity_cases():
    for name, species in (("VHS", ARGON), ("VSS", ARGON_SOFT)):
        value, error = mean([conductivity(species, seed)[0] for seed in range(1, runs.SEEDS + 1)])
        check("19", f"conductivity of argon over kinetic theory's, {name}", 1.0, value, error, bar=0.02)


def partners():
    """What each choice of partners costs, and the conductivity that it gives in the same run. `subcell` has parts of its own in
    the crowded cells only."""
    lines = ["| partner | particles a cell | edge of a cell, mean free paths | conductivity over kinetic theory's | standard error "
             "| million particle-steps a CPU second |", "|---|---|---|---|---|---|"]
    for finer, per_cell, steps in ((2, 40.0, (1000, 3000)), (1, 400.0, (600, 900))):
        for partner in ("any", "nearest", "subcell"):
            found = [conductivity(ARGON, seed, partner, finer, per_cell, steps) for seed in range(1, runs.SEEDS + 1)]
            value, error = mean([one for one, _ in found])
            check("19", f"conductivity, partner {partner}, {per_cell:.0f} a cell", 1.0, value, error, bar=0.01)
            lines.append(f"| `{partner}` | {per_cell:.0f} | {6**(-1 / 3) / finer:.2f} | {value:.4f} | {error:.4f} "
                         f"| {1e-6 * np.median([rate for _, rate in found]):.1f} |")
    print("\n".join(["", *lines]))


def couette_profile(species, n, t_wall, u, height):
    """Couette flow of a gas with mu ~ T^omega between walls at -u/2 and u/2 with slip and temperature jump (diffuse walls, hard
    spheres: 0.987 and 1.890 mu sqrt(2RT)/p; Y. Sone, Molecular Gas Dynamics, 2007, section 3.1): shear, and T and y at speeds
    from 0 to the gas's at the wall. Energy: T falls as (2/15) v^2 / R from the middle."""
    r = BOLTZMANN / species["mass"]
    slip, jump, p = 0.0, 0.0, n * BOLTZMANN * t_wall
    for _ in range(200):
        v = np.linspace(0, u / 2 - slip, 2001)
        temperature = t_wall + jump + 2 / 15 / r * (v[-1]**2 - v**2)
        mu = np.array([cases.viscosity(species, x) for x in temperature])
        way = np.concatenate([[0], np.cumsum(0.5 * (mu[1:] + mu[:-1]) * np.diff(v))])
        shear = 2 * way[-1] / height
        y = way / shear
        p = n * BOLTZMANN * (height / 2) / np.sum(np.diff(y) * (1 / temperature[1:] + 1 / temperature[:-1]) / 2)
        length = mu[-1] * math.sqrt(2 * r * temperature[-1]) / p
        slip = 0.987 * length * shear / mu[-1]
        jump = 1.890 * length * shear * v[-1] / (15 / 4 * r * mu[-1])
    return shear, temperature, y, v, p


def couette_flow(species, seed, sampling):
    """Shear on the walls of Couette flow at Kn 0.01 over that of the flow equations with slip."""
    paths, t, u, per_cell = 100, 273.0, 1000.0, 30.0
    n = cases.free_path(species, 1, t) * paths
    shear, temperature, y, v, p = couette_profile(species, n, t, u, 1.0)
    streams, regions = {"stream.free": dict(density=n, temperature=t)}, []
    for i in range(paths):
        x = (i + 0.5) / paths - 0.5
        there = float(np.interp(abs(x), y, temperature))
        streams[f"stream.s{i}"] = dict(density=float(p / (BOLTZMANN * there)), temperature=there,
                                       velocity=[0.0, math.copysign(float(np.interp(abs(x), y, v)), x), 0.0])
        regions.append(dict(box=[i / paths, -1.0, -1.0, (i + 1) / paths, 2.0, 2.0], stream=f"s{i}"))
    k = compute("couette-flow", {**gas(Ar=species), **streams, **cases.between_walls(t, [-u / 2, u / 2]), "initial": {}, "initial.region": regions,
                                 "particles": dict(per_cell=per_cell), "time": dict(step=0.2 / paths / cases.fast(t, species["mass"])),
                                 "run": dict(transient=4000, sampling=sampling), "reference": dict(area=1 / paths**2, pitch_axis=[0.0, 0.0, 1.0])},
                box("column.hdf", paths, 1, 1, 0, 1), seed)
    return [(value / shear, error / shear) for value, error in cases.wall_loads(k)[0]]


def couette_cases():
    for name, species in (("VHS", ARGON), ("VSS", ARGON_SOFT)):
        found = [one for seed in range(1, runs.SEEDS + 1) for one in couette_flow(species, seed, 40000)]
        value, error = runs.together(found)
        check("19", f"Couette flow at Kn 0.01, 1000 m/s, {name}: wall shear over that of the flow equations with slip", 1.0, value, error, bar=0.02)


def slow_couette():
    """Shear between walls that move slowly against each other, a gas of hard spheres, over p U / sqrt(2 k T / m)."""
    spheres, t, cells = {**ARGON, "omega": 0.5}, 273.0, 20
    c = cases.fast(t, spheres["mass"])
    n = cases.viscosity(spheres, t) * c / (BOLTZMANN * t)  # delta = 1 on a height of 1
    u, found = 0.2 * c, []
    for seed in range(1, runs.SEEDS + 1):
        k = compute("slow-couette", {**gas(Ar=spheres), "stream.free": dict(density=n, temperature=t), **cases.between_walls(t, [-u / 2, u / 2]),
                                     "particles": dict(per_cell=400.0), "time": dict(step=0.05 / c), "run": dict(transient=400, sampling=20000),
                                     "reference": dict(area=1 / cells**2, pitch_axis=[0.0, 0.0, 1.0])}, box("slow.hdf", cells, 1, 1, 0, 1), seed)
        filled = k["particles"] / (6 * cells * 400.0)
        unit = n * BOLTZMANN * t * u / c * filled
        found += [(value / unit, error / unit) for value, error in cases.wall_loads(k)[0]]
    value, error = runs.together(found)
    # the diameter of variable hard spheres follows from the first approximation of the viscosity, the truth from the whole
    exact = shear_of("hard_spheres", 1.0, of_first_approximation=True)
    check("19", "Couette flow of hard spheres at delta = 1, walls of 0.2 sqrt(2 k T / m): shear", exact, value, error, most=0.003 * value)


def jumping_mesh():
    """Kuhn's cube with a corner refined three times: sizes jump by eight."""
    level = cube(3)
    for k in (1, 2, 3):
        level = refined(level, f"jump{k}.hdf", "--box", "0,0,0,0.34,0.34,0.34")
    return level


def steps():
    on = jumping_mesh()
    n, t = 1e19, 300.0
    c = cases.fast(t, NITROGEN["mass"])
    u = [c, 0.3 * c, 0.0]
    tables = {**gas(N2=NITROGEN), "stream.free": dict(density=n, temperature=t, velocity=u), **walls("inflow"), "particles": dict(total=40000.0),
              "time": dict(step=0.2 / c, cell_fraction=0.4), "run": dict(transient=80, sampling=200)}
    found = {}
    for seed in range(1, 3 * runs.SEEDS + 1):
        compute("steps", tables, on, seed)
        middle, volume, density, velocity, t_tr = fields("steps", "n", "u", "T_tr")
        size = np.round(np.log2(volume.max() / volume) / 3).astype(int)
        groups = {f"cells of size 1/{2**k}": size == k for k in range(4)}
        groups |= {f"the plane layer x = {0.25 * k + 0.125}": np.abs(middle[:, 0] - 0.25 * k - 0.125) < 0.125 for k in range(4)}
        for name, group in groups.items():
            w = volume[group]
            molecules = (density[group] * w).sum()
            flow = (density[group] * velocity[group, 0] * w).sum()
            row = {"flux": flow / w.sum() / n / c}
            if name.startswith("cells"):
                # About the mean velocity of all: that of each cell has been fitted to few independent samples.
                weights = density[group] * w / molecules
                thermal = 3 * BOLTZMANN / NITROGEN["mass"] * t_tr[group] + (velocity[group]**2).sum(axis=1)
                square = (weights * thermal).sum() - ((weights[:, None] * velocity[group]).sum(axis=0)**2).sum()
                row |= {"density": molecules / w.sum() / n, "velocity": flow / molecules / c, "temperature": square / (3 * BOLTZMANN / NITROGEN["mass"] * t)}
            for quantity, value in row.items():
                found.setdefault((quantity, name), []).append(value)
    for (quantity, name), values in found.items():
        value, error = mean(values)
        check("22", f"uniform stream, {quantity} in {name}", 1.0, value, error)
    # Case 7 again: what a step varying from face to face lets in.
    expected = n * c / (2 * math.sqrt(math.pi)) * cases.chi(1.0)
    tables |= {**walls("outflow", xmin={"kind": "inflow"}), "initial": {"stream": "vacuum"}, "stream.free": dict(density=n, temperature=t, velocity=[c, 0.0, 0.0]),
               "particles": {"weight": 1e15}}
    values = [mean([row["entered_per_step"] * 1e15 / (0.2 / c) for row in compute("steps-flux", tables, on, seed)["history"]]) for seed in range(1, runs.SEEDS + 1)]
    value, error = runs.together(values)
    check("22", "flux at s = 1 through a side of cells of all sizes (1/m2/s)", expected, value, error, bar=1e-3 * value, most=0.001 * value)


def trace():
    """Conduction through argon with one part in a thousand of a heavy gas, with equal weights and with 0.01 for the trace."""
    t, cubes, per_cell = 320.0, 6, 20.0
    n = cases.free_path(ARGON, 1, t) / 0.2
    found = {}
    for weight in (1.0, 0.01):
        for seed in range(1, 2 * runs.SEEDS + 1):
            tables = {"species.Ar": ARGON, "species.Xe": XENON, "gas": {"fractions": {"Ar": 0.999, "Xe": 0.001}},
                      "stream.free": dict(density=n, temperature=t),
                      **walls(xmin={"kind": "diffuse", "temperature": 373.0}, xmax={"kind": "diffuse", "temperature": 273.0}),
                      "particles": dict(weight=n / (6 * cubes**3 * per_cell), species_weights={"Xe": weight}),
                      "time": dict(step=0.08 / cases.fast(t, ARGON["mass"])), "run": dict(transient=200, sampling=1000), "reference": dict(area=1.0)}
            k = compute("trace", tables, cube(cubes), seed)
            middle, volume, density, heavy, temperature = fields("trace", "n", "n_Xe", "T")
            x, molecules = middle[:, 0], density * volume
            half = lambda values: (values * volume)[x < 0.5].sum() / (values * volume).sum()
            heat = k["patches"]["xmax"]["C_H"]["value"] - k["patches"]["xmin"]["C_H"]["value"]
            row = {"heat flux": heat, "temperature of the warm quarter (K)": np.average(temperature[x < 0.25], weights=molecules[x < 0.25]),
                   "temperature of the cold quarter (K)": np.average(temperature[x > 0.75], weights=molecules[x > 0.75]),
                   "part of the argon in the warm half": half(density), "part of the trace in the warm half": half(heavy)}
            for name, value in row.items():
                found.setdefault(name, {}).setdefault(weight, []).append(value)
    for name, values in found.items():
        (reference, error0), (value, error) = mean(values[1.0]), mean(values[0.01])
        check("23", f"{name}, weight 0.01 against 1", reference, value, math.hypot(error0, error))
