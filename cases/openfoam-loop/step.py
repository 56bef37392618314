#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of the loop between two runs of OpenFOAM's solver, under mpirun.

    step.py start OUT          the mesh of level 0 and its case
    step.py next OUT LEVEL     measures the solution of a level, marks, refines, and writes the case of the next one
    step.py last OUT LEVEL     measures only
"""
import csv
import os
import pathlib
import re
import shutil
import sys

import numpy as np
import pamr
from mpi4py import MPI
from pamr import openfoam

COMM = MPI.COMM_WORLD
HERE = pathlib.Path(__file__).parent
HOT, COLD, R1, R2 = 400.0, 300.0, 1.0, 2.0
FORMATS = ("ascii", "binary")  # in turn, from level to level


def exact(r):
    """Temperature between spheres of constant temperature."""
    return HOT + (COLD - HOT) * (1 / R1 - 1 / r) / (1 / R1 - 1 / R2)


EXACT_FLUX = 4 * np.pi * (HOT - COLD) / (1 / R1 - 1 / R2) / 8  # of an octant, for a conductivity of 1


def shell(n=4, layers=4):
    """An octant of the shell: n^2 triangles on a sphere times layers of prisms, three cells each; all on rank 0."""
    corner = {(i, j): k for k, (i, j) in enumerate((i, j) for i in range(n + 1) for j in range(n + 1 - i))}
    direction = np.array([(n - i - j, i, j) for i, j in corner], float)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    flat = [(corner[i, j], corner[i + 1, j], corner[i, j + 1]) for i in range(n) for j in range(n - i)]
    flat += [(corner[i + 1, j], corner[i + 1, j + 1], corner[i, j + 1]) for i in range(n - 1) for j in range(n - 1 - i)]
    points = np.concatenate([direction * r for r in np.linspace(R1, R2, layers + 1)])
    cells = []
    for layer in range(layers):
        low, high = layer * len(direction), (layer + 1) * len(direction)
        for a, b, c in map(sorted, flat):  # the diagonals of the sides go by the order of the numbers
            cells += [(low + a, low + b, low + c, high + c), (low + a, low + b, high + b, high + c),
                      (low + a, high + a, high + b, high + c)]
    cells = np.array(cells)
    faces = np.sort(np.concatenate([cells[:, [1, 2, 3]], cells[:, [0, 2, 3]], cells[:, [0, 1, 3]], cells[:, [0, 1, 2]]]), axis=1)
    faces, count = np.unique(faces, axis=0, return_counts=True)
    faces = faces[count == 1]
    at = points[faces]
    on_plane = np.abs(at).max(axis=1) < 1e-12  # x, y, z
    tag = np.where(on_plane.any(axis=1), 3 + on_plane.argmax(axis=1), np.where(np.linalg.norm(at[:, 0], axis=1) < 1.5, 1, 2))
    return np.where(np.abs(points) < 1e-15, 0.0, points), cells, faces, tag


def start(out):
    points, cells, faces, tags = shell()
    points, cells, faces, tags = (a if COMM.rank == 0 else a[:0] for a in (points, cells, faces, tags))
    names = {1: ("inner", "wall"), 2: ("outer", "wall")} | {3 + k: (f"symmetry{'XYZ'[k]}", "symmetryPlane") for k in range(3)}
    mesh = pamr.Mesh.from_arrays(COMM, points, cells, (faces, tags), names, length_unit="m", repair=True)
    mesh.associate({"inner": pamr.Sphere((0, 0, 0), R1), "outer": pamr.Sphere((0, 0, 0), R2)}
                   | {f"symmetry{'XYZ'[k]}": pamr.Plane((0, 0, 0), np.eye(3)[k]) for k in range(3)})
    mesh = pamr.balance(mesh)
    make_case(out, 0)
    if COMM.rank == 0:
        os.makedirs(out / "level0" / "start", exist_ok=True)
        shutil.copy(HERE / "template/0/T", out / "level0/start/T")
    COMM.barrier()
    put(mesh, out, 0, openfoam.read_fields(mesh, out / "level0", "start", ["T"]))


def make_case(out, level):
    """The files of a case that do not depend on the mesh."""
    if COMM.rank == 0:
        case = out / f"level{level}"
        shutil.rmtree(case, ignore_errors=True)
        shutil.copytree(HERE / "template/constant", case / "constant")
        shutil.copytree(HERE / "template/system", case / "system")
        control = case / "system/controlDict"
        control.write_text(control.read_text().replace("WRITE_FORMAT", FORMATS[level % 2]))
    COMM.barrier()


def put(mesh, out, level, fields):
    case = out / f"level{level}"
    openfoam.write_mesh(mesh, case, ranks="own" if COMM.size > 1 else None)
    openfoam.write_fields(fields, case, "0")
    for name in list(mesh.cell_fields):
        del mesh.cell_fields[name]
    mesh.write(out / f"level{level}.hdf")


def measure(mesh, out, level):
    """Reads the solution, and adds a row to the table."""
    case = out / f"level{level}"
    openfoam.read_fields(mesh, case, "1", ["gradTx", "gradTy", "gradTz"])
    fields = openfoam.read_fields(mesh, case, "1", ["T"])
    temperature, volume = mesh.cell_fields["T"], mesh.volumes()
    center = mesh.points[mesh.cells].mean(axis=1)
    error = temperature - exact(np.linalg.norm(center, axis=1))
    l2 = np.sqrt(COMM.allreduce((volume * error ** 2).sum()) / COMM.allreduce(volume.sum())) / (HOT - COLD)
    faces = mesh.boundary_faces()
    corners = mesh.points[faces.nodes]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    flux = []
    for patch, wall, sign in (("inner", HOT, 1), ("outer", COLD, -1)):
        of = faces.patches == mesh.patches.index(patch)
        away = corners[of].mean(axis=1) - center[faces.cells[of]]
        slope = (wall - temperature[faces.cells[of]]) * (area[of] ** 2).sum(axis=1) / (area[of] * away).sum(axis=1)
        flux.append(sign * COMM.allreduce(slope.sum()))
    log = (case / "log").read_text()
    residuals = [float(r) for r in re.findall(r"Solving for T, Initial residual = ([^,]+),", log)]
    row = {"level": level, "cells": mesh.n_cells, "l2": l2, "flux": flux[0], "flux_error": abs(flux[0] / EXACT_FLUX - 1),
           "flux_difference": abs(flux[0] / flux[1] - 1), "first_residual": residuals[0], "last_residual": residuals[-1],
           "min_mean_ratio": pamr.quality(mesh)["mean_ratio"]["min"], "format": FORMATS[level % 2]}
    if COMM.rank == 0:
        print("  ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()), flush=True)
        with open(out / "table.csv", "a" if level else "w", newline="", encoding="ascii") as file:
            writer = csv.DictWriter(file, row.keys())
            if not level:
                writer.writeheader()
            writer.writerow(row)
    return fields


def refine(mesh, out, level, fields):
    """Cells with the largest changes of temperature, by OpenFOAM's own gradient, down to 60 % of the sum of their squares."""
    gradient = np.stack([mesh.cell_fields[f"gradT{x}"] for x in "xyz"], axis=1)
    change = mesh.volumes() ** (5 / 3) * (gradient ** 2).sum(axis=1)
    flags = pamr.mark.flags(mesh, pamr.mark.bulk(mesh, change, 0.6))
    for name in ("gradTx", "gradTy", "gradTz"):
        del mesh.cell_fields[name]
    result = pamr.refine(mesh, flags)
    make_case(out, level + 1)
    put(result.mesh, out, level + 1, fields.after(result))


def main(action, out, level="0"):
    out, level = pathlib.Path(out), int(level)
    if action == "start":
        return start(out)
    mesh = pamr.Mesh.read(COMM, out / f"level{level}.hdf")
    fields = measure(mesh, out, level)
    if action == "next":
        refine(mesh, out, level, fields)


main(*sys.argv[1:])
