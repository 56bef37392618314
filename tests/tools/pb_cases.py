# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of pamr-pb on cubes and in spheres, and their equation in one dimension."""
import json
import math
import pathlib
import re

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
