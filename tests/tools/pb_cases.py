# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of pamr-pb on cubes and in spheres, and their equation in one dimension."""
import json
import math
import pathlib
import re

import numpy as np

from tool_run import kuhn_cube, run


def boundary(**conditions):
    """patch = ("potential", 2), a condition without value or a table; all other patches are mirrors."""
    text = "[boundary]\n"
    for patch, stated in conditions.items():
        if isinstance(stated, dict):
            text += f"{patch} = {{ " + ", ".join(f"{key} = {json.dumps(value)}" for key, value in stated.items()) + " }\n"
            continue
        condition, value = (stated, None) if isinstance(stated, str) else stated
        text += f'{patch} = {{ kind = "{condition}"' + (f", value = {value!r} }}\n" if value is not None else " }\n")
    return text + '"*" = { kind = "symmetry" }\n'


def solve(text, mesh):
    """The report, and what is printed."""
    pathlib.Path("case.toml").write_text(text)
    result = run("pamr-pb", "case.toml", "--mesh", mesh, "-o", "psi.hdf", "--force", "--json", "report.json")
    report = json.loads(pathlib.Path("report.json").read_text())
    for name, value, bar in re.findall(r"^ +best (\S+) +(\S+) \+- ([^\s;]+)", result.out, re.M):  # has the digits that its bar is worth
        values = [of_patch[name]["value"] for of_patch in report["best"].values() if name in of_patch]
        assert min(abs(float(value) - known) for known in values) <= 0.06 * float(bar), (name, value, bar, values)
    return report, result


def cube(n):
    name = f"{n}.hdf"
    return name if pathlib.Path(name).exists() else kuhn_cube(name, n)


def goals_of(report):
    return {goal["name"]: goal for goal in report["goals"]}


SALT, MAGNESIUM, SEA = ((1, 1), (-1, 1)), ((2, 1), (-1, 2)), ((1, 3), (2, 1), (-1, 5))


def source(ions, psi):
    """Right-hand side of the equation: sinh psi of SALT."""
    return -sum(c * z * math.exp(-z * psi) for z, c in ions) / sum(c * z * z for z, c in ions)


def pressure(ions, psi):
    return sum(c * (math.exp(-z * psi) - 1) for z, c in ions) / sum(c * z * z for z, c in ions)


def stated(ions):
    return "".join(f"[[electrolyte.ion]]\ncharge = {z}\nconcentration = {c}\n" for z, c in ions)


def integrate(ions, start, to, slope, dimension, n=1200):
    """psi, slope and energy (over a solid angle of 1, or an area) from (r, psi) to `to`, by Runge and Kutta."""
    (r, psi), energy, h = start, 0.0, (to - start[0]) / n

    def slopes(r, psi, slope):
        psi = max(-20, min(20, psi))
        weight = r ** dimension
        return slope, source(ions, psi) - dimension * slope / r, weight * (slope * slope / 2 + pressure(ions, psi))

    for _ in range(n):
        a = slopes(r, psi, slope)
        b = slopes(r + h / 2, psi + h / 2 * a[0], slope + h / 2 * a[1])
        c = slopes(r + h / 2, psi + h / 2 * b[0], slope + h / 2 * b[1])
        d = slopes(r + h, psi + h * c[0], slope + h * c[1])
        psi, slope, energy = (value + h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k])
                              for k, value in enumerate((psi, slope, energy)))
        r += h
    return psi, slope, energy


PH = 6.0


def wall(site, density, pk, **more):
    """The condition of a wall with acid or basic sites of this density and pK."""
    return {"kind": "regulated", "site": site, "value": density, "pK": pk, **more}


def density_at(psi, site, density, pk, ph=PH, valence=1):
    """Mass action: of acid sites the share without a proton, of basic ones that with it."""
    protons = math.exp(-max(-300, min(300, psi)) / valence) * 10 ** -ph  # at the wall
    without = 10 ** -pk / (10 ** -pk + protons)
    return -density * without if site == "acid" else density * (1 - without)


def root(function, low, high):
    """Where it changes its sign."""
    sign = math.copysign(1, function(high))
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if sign * function(middle) > 0 else (middle, high)
    return (low + high) / 2


def between(low, high, ions=SALT, radii=None):
    """Plates at z = 0 and 1, or spheres of these radii, of which each has ("potential", value), ("charge", density) or sites.

    The potentials and charges of both, the energy (of an octant), and the force on the lower plate.
    """
    dimension, (a, b) = (0, (0.0, 1.0)) if radii is None else (2, radii)

    def density(psi, condition):
        return condition[1] if condition[0] == "charge" else density_at(psi, *condition)

    def shoot(x):  # from the wall at b, where x is the slope, or the potential
        psi, slope = (high[1], x) if high[0] == "potential" else (x, density(x, high))
        return psi, slope, integrate(ions, (b, psi), a, slope, dimension)

    def miss(psi, slope):
        return psi - low[1] if low[0] == "potential" else slope + density(psi, low)

    at_b, outer_slope, (at_a, slope, energy) = shoot(root(lambda x: miss(*shoot(x)[2][:2]), -8, 8))
    assert abs(miss(at_a, slope)) < 1e-8, (low, high, at_a, slope)
    area = (1, 1) if radii is None else (4 * math.pi * a * a, 4 * math.pi * b * b)
    return {"potential": (at_a, at_b), "charge": (-area[0] * slope, area[1] * outer_slope),
            "energy": -energy * (1 if radii is None else 4 * math.pi / 8), "force-z": slope ** 2 / 2 - pressure(ions, at_a)}


def radial(kind, order, r):
    """Modified spherical Bessel functions i_n (of `kind` "in"), which are finite at 0, or k_n ("out"), and their slopes."""
    if kind == "out":
        values = [np.exp(-r) / r, np.exp(-r) * (1 / r + 1 / r ** 2)]
        for n in range(1, order + 1):
            values.append(values[-2] + (2 * n + 1) / r * values[-1])
        slopes = [-values[1]] + [-values[n - 1] - (n + 1) / r * values[n] for n in range(1, order + 1)]
        return values[order], slopes[order]

    def series(n):
        term = r ** n / float(math.prod(range(1, 2 * n + 2, 2)))
        total = term
        for k in range(1, 60):
            term = term * (r * r / 2) / (k * (2 * n + 2 * k + 1))
            total = total + term
        return total

    return series(order), series(order + 1) + order / r * series(order)


def balls_in_a_shell(balls, shell, n_orders=32):
    """Balls (x, radius, charge density) on the axis, in a ball about 0 of radius `shell` at the potential 0; linear equation.

    The charge of the outer wall and the energy, by multipoles about each center that meet the conditions at points of the walls.
    """
    centers = [(x, radius, "out") for x, radius, _ in balls] + [(0.0, shell, "in")]
    columns = [(x, radius, kind, n) for x, radius, kind in centers for n in range(n_orders)]
    cosines, weights = np.polynomial.legendre.leggauss(80)

    def on(x, radius):  # potentials, and slopes away from the center, of all columns at points of this wall
        points = np.stack([x + radius * cosines, radius * np.sqrt(1 - cosines ** 2)])
        normal = np.stack([cosines, np.sqrt(1 - cosines ** 2)])
        values, slopes = [], []
        for center, of_radius, kind, n in columns:
            away = points - np.array([[center], [0.0]])
            r = np.hypot(*away)
            c = away[0] / r
            legendre = np.polynomial.legendre.Legendre.basis(n)
            f, df = (part / radial(kind, n, np.array([of_radius]))[0] for part in radial(kind, n, r))
            along = np.stack([1 - c * c, -c * away[1] / r]) / r  # gradient of c
            values.append(f * legendre(c))
            slopes.append((df * legendre(c) * (away / r) * normal).sum(axis=0) + f * legendre.deriv()(c) * (along * normal).sum(axis=0))
        return np.array(values).T, np.array(slopes).T

    walls = [(on(x, radius), radius, density) for x, radius, density in balls] + [(on(0.0, shell), shell, None)]
    left = np.concatenate([values if density is None else -slopes for (values, slopes), _, density in walls])
    right = np.concatenate([np.full(len(cosines), density or 0.0) for *_, density in walls])
    found = np.linalg.lstsq(left, right, rcond=None)[0]
    assert np.abs(left @ found - right).max() < 1e-9, np.abs(left @ found - right).max()
    area = [2 * math.pi * radius ** 2 for _, radius, _ in walls]
    energy = sum(a * weights @ (values @ found) * density for ((values, _), _, density), a in zip(walls[:-1], area)) / 2
    return {"charge": area[-1] * weights @ (walls[-1][0][1] @ found), "energy": energy}


CELL = """
[mesh]
shape = "charged-sphere"
length_unit = "1"
[mesh.geometry]
radius = 1.0
outer_radius = 3.0
[mesh.sizes]
far = {far}
sphere = {sphere}
outer = {far}
"""


def cell(name, sphere, far):
    pathlib.Path("mesh.toml").write_text(CELL.format(sphere=sphere, far=far))
    run("pamr-mesh", "mesh.toml", "-o", name, "--quiet")
    return name


def part_of_shell(name, bodies, shell, sizes, mirrors="yz"):
    """A mesh of what is outside all bodies (patch: kind and parameters of its surface) in the ball of radius `shell` about 0, patch outer.

    Of these coordinates it has the half above 0; sizes are those at the bodies and elsewhere.
    """
    surfaces = bodies | {"outer": {"kind": "sphere", "center": [0, 0, 0], "radius": shell}}
    surfaces |= {axis: {"kind": "plane", "point": [0, 0, 0], "normal": [float(axis == other) for other in "xyz"]} for axis in mirrors}
    low = [0 if axis in mirrors else -1.1 * shell for axis in "xyz"]
    text = ('[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "-outer & ' + " & ".join(f"+{patch}" for patch in [*bodies, *mirrors])
            + f'"\nbounds = [{low}, {[1.1 * shell] * 3}]\n[mesh.sizes]\nfar = {sizes[1]}\nnear = {{ '
            + ", ".join(f"{body} = {sizes[0]}" for body in bodies) + " }\n")
    for surface, of_surface in surfaces.items():
        text += f'[[surface]]\nname = "{surface}"\n' + "".join(f"{key} = {json.dumps(value)}\n" for key, value in of_surface.items())
    pathlib.Path("mesh.toml").write_text(text)
    run("pamr-mesh", "mesh.toml", "-o", name, "--force", "--quiet")
    return name


def ball(x, radius):
    return {"kind": "sphere", "center": [x, 0, 0], "radius": radius}
