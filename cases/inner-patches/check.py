#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py OUT LEVELS: compares meshes, gas and exports with expected.csv; exit code 1 if a quantity is out of its bounds."""
import json
import math
import pathlib
import re
import sys

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from bounds import all_within  # noqa: E402

out, levels = pathlib.Path(sys.argv[1]), int(sys.argv[2])
RADIUS, AREA = 0.5, 0.8
NAMES = ("ball", "sheet", "assembly")


def quality(name, level):
    return json.loads((out / f"{name}{level}.json").read_text())


def volume_of(name, region, level):
    with h5py.File(out / f"{name}-1/level{level}.hdf") as file:
        points = file["VTKHDF/Points"][:]
        cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        cells = cells[file["VTKHDF/CellData/region"][:] == region]
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    return math.fsum(np.abs(np.linalg.det(edges)) / 6)


def same(name, file):
    """Whether a file has the same bytes on 1, 3 and 7 ranks."""
    return len({(out / f"{name}-{ranks}/{file}.hdf").read_bytes() for ranks in (1, 3, 7)}) == 1


def comes_back(name):
    """Whether coarsening ends at the mesh that was read: nodes, cells, neighbors and patches inside."""
    with h5py.File(out / f"{name}-1/level0.hdf") as first, h5py.File(out / f"{name}-1/back.hdf") as last:
        return all(np.array_equal(first[f"VTKHDF/{data}"][:], last[f"VTKHDF/{data}"][:])
                   for data in ("Points", "Connectivity", "CellData/inner_patch", "CellData/region"))


def free_molecular(towards, temperature, ratio=2.0, angle=30.0):
    """Pressure, shear and heat of a diffuse wall over rho V^2/2 and rho V^3/2, nitrogen at 300 K. Source: G. A. Bird, Molecular Gas
    Dynamics and the Direct Simulation of Gas Flows, 1994, section 7.6. `towards`: 1: the side looks into the stream, -1: away from it."""
    s = towards * ratio * math.sin(math.radians(angle))
    bell, tail = math.exp(-s * s), 1 + math.erf(s)
    flux = bell + math.sqrt(math.pi) * s * tail
    root = math.sqrt(temperature / 300)
    pressure = (s / math.sqrt(math.pi) * bell + (0.5 + s * s) * tail + 0.5 * root * flux) / ratio ** 2
    shear = math.cos(math.radians(angle)) * flux / (math.sqrt(math.pi) * ratio)
    gamma = 1.4
    heat = ((ratio ** 2 + gamma / (gamma - 1) - 0.5 * (gamma + 1) / (gamma - 1) * temperature / 300) * flux - 0.5 * bell) \
        / (2 * math.sqrt(math.pi) * ratio ** 3)
    return pressure, shear, heat


def off_of_gas():
    """Largest difference of the six loads from their closed forms, over their bounds of 95 % of chance; and the largest bound over the
    force or the heat of both sides together."""
    gas = json.loads((out / "gas.json").read_text())
    speed, density = math.hypot(731.0573, 422.0761), 1e17 * 4.65e-26
    rows = []
    for side, towards, temperature in (("front", 1, 600.0), ("back", -1, 150.0)):
        net = gas["fluxes"]["patches"][f"sheet:{side}"]["net"]
        force = AREA * density * speed ** 2 / 2
        p, tau, q = free_molecular(towards, temperature)
        exact = (towards * p * force, tau * force, q * force * speed)
        found = (net["momentum"]["value"][2], net["momentum"]["value"][0], net["energy"]["value"])
        bound = (net["momentum"]["ci95"][2], net["momentum"]["ci95"][0], net["energy"]["ci95"])
        rows += [(f"{side} {what}", e, f, b) for what, e, f, b in zip(("pressure", "shear", "heat"), exact, found, bound)]
    print("thin plate: closed form, found +- 95 %")
    for what, exact, found, bound in rows:
        print(f"  {what:15} {exact:12.5e} {found:12.5e} +- {bound:.1e}")
    return max(abs(f - e) / b for _, e, f, b in rows), max(b / abs(e) for w, e, _, b in rows if w.startswith("front"))


def errors_of_ball(name, region):
    """Relative errors of its volume, by level."""
    exact = 4 / 3 * math.pi * RADIUS ** 3
    errors = [abs(volume_of(name, region, level) / exact - 1) for level in range(levels + 1)]
    print(f"{name}: level, cells, error of the ball's volume\n" + "\n".join(
        f"  {level} {quality(name, level)['cells']:8} {error:.3e}" for level, error in enumerate(errors)))
    return errors


def falls(errors):
    return min(a / b for a, b in zip(errors, errors[1:]))


errors = errors_of_ball("ball", 21)
in_assembly = errors_of_ball("assembly", 2)
assembled = [quality("assembly", level) for level in range(levels + 1)]
contact = [abs(mesh["patches"]["solid_1_solid_3"]["area"] / (math.pi * 0.4 ** 2) - 1) for mesh in assembled]
print("assembly: error of the area between box and can\n  " + " ".join(f"{error:.3e}" for error in contact))
off, chance = off_of_gas()
in_zone = int(re.search(r"sheet\s*{.*?List<label>\s*(\d+)", (out / "foam/constant/polyMesh/faceZones").read_text(), re.DOTALL)[1])
sheets = [quality("sheet", level)["patches"]["sheet"] for level in range(levels + 1)]
measured = {
    "min_fall_of_the_ball_error": falls(errors),
    "min_fall_in_the_assembly": min(falls(in_assembly), falls(contact)),
    "box_and_ball_of_the_assembly_off": max(abs(mesh["regions"]["solid_1"]["volume"] + mesh["regions"]["solid_2"]["volume"] - 8)
                                            for mesh in assembled),
    "interface_off_surface": max(sum(patch["off_surface_nodes"] for patch in quality(name, level)["patches"].values())
                                 for name in NAMES for level in range(levels + 1)),
    "min_mean_ratio_of_the_assembly": min(mesh["mean_ratio"]["min"] for mesh in assembled),
    "area_of_the_sheet_off": max(abs(sheet["area"] / AREA - 1) for sheet in sheets),
    "same_bytes": sum(same(name, file) for name in NAMES for file in [f"level{k}" for k in range(levels + 1)] + ["back"]),
    "come_back": sum(comes_back(name) for name in NAMES),
    "gas_off_over_bound": off,
    "gas_bound": chance,
    "faces_in_the_zone_of_openfoam_off": abs(in_zone - sheets[-1]["faces"]),
}
if (out / "dolfinx.json").exists():
    measured["integrals_in_dolfinx_off"] = max(max(abs(on / AREA - 1), abs(at / 4 - 1))
                                               for on, at in json.loads((out / "dolfinx.json").read_text()))
sys.exit(0 if all_within(measured, pathlib.Path(__file__).parent / "expected.csv") else 1)
