#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps between two runs of OpenFOAM's solver, under mpirun. A turn is one run of it, on one mesh, for 0.1 s.

    step.py start OUT LEVELS SCHEME       the mesh at the beginning, refined LEVELS times at the cloud, and the case of turn 0
    step.py next OUT LEVELS TURN SCHEME   splits before the cloud, takes splits back behind it, and writes the case of the next turn
    step.py last OUT LEVELS TURN          compares the cloud with the exact one: a row of the table
"""
import csv
import pathlib
import shutil
import sys

import numpy as np
import pamr
from mpi4py import MPI
from pamr import openfoam

COMM = MPI.COMM_WORLD
HERE = pathlib.Path(__file__).parent
STREAM, DIFFUSIVITY, WIDTH = np.array([0.9, 0.2, 0.1]), 0.005, 0.15  # as in template/; the standard deviation of the cloud at first
BEGIN = np.array([0.7, 0.8, 0.85])
TURN = 0.1
SPLIT, TAKE_BACK = 5e-4, 1.5e-4  # more dye than this: the cloud; less than this: behind it
# Four points of a cell with which polynomials of second degree have their exact mean (Hammer and Stroud 1956).
AT = np.full((4, 4), (5 - 5 ** 0.5) / 20) + np.eye(4) * 5 ** -0.5


def exact(mesh, time):
    """Means over the cells of this rank of a cloud that an unbounded stream carries: the product of three normal distributions."""
    variance = WIDTH ** 2 + 2 * DIFFUSIVITY * time
    points = np.einsum("qk,ckd->cqd", AT, mesh.points[mesh.cells])
    distance2 = ((points - BEGIN - STREAM * time) ** 2).sum(axis=2)
    return (WIDTH ** 2 / variance) ** 1.5 * np.exp(-distance2 / (2 * variance)).mean(axis=1)


def name_of(turn):
    """OpenFOAM's name of the time at which a turn begins."""
    return f"{TURN * turn:.6g}"


def amount(mesh):
    """All dye, in m3. Collective."""
    return COMM.allreduce((mesh.volumes() * mesh.cell_fields["T"]).sum())


def wanted(mesh, levels):
    """Where the dye is the cells of LEVELS levels, where there is none as few as there were."""
    dye = mesh.cell_fields["T"]
    return np.where((dye > SPLIT) & (mesh.levels < levels), 1, np.where(dye < TAKE_BACK, -1, 0)).astype(np.int8)


def make_case(mesh, fields, folder, turn, levels, scheme):
    """The case of a turn: files that do not depend on the mesh, the mesh, and the fields at the time at which the turn begins."""
    case = folder / f"turn{turn}"
    if COMM.rank == 0:
        shutil.rmtree(case, ignore_errors=True)
        for part in ("constant", "system"):
            shutil.copytree(HERE / "template" / part, case / part)
        words = {"START": name_of(turn), "END": name_of(turn + 1), "STEP": f"{0.04 / 2 ** levels:.6g}", "SCHEME": scheme}
        for name in ("controlDict", "fvSchemes"):
            text = (case / "system" / name).read_text()
            for word, value in words.items():
                text = text.replace(word, value)
            (case / "system" / name).write_text(text)
    COMM.barrier()
    openfoam.write_mesh(mesh, case, ranks="own" if COMM.size > 1 else None)
    openfoam.write_fields(fields, case, name_of(turn))
    mesh.write(folder / f"turn{turn}.hdf")


def start(out, levels, scheme):
    """The beginning has the exact means, on a mesh that was refined for them."""
    folder = out / f"levels{levels}"
    if COMM.rank == 0:
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "first").mkdir(parents=True)
        shutil.copytree(HERE / "template/start", folder / "first/0")
    COMM.barrier()
    mesh = pamr.balance(pamr.Mesh.read(COMM, out / "box.msh"))
    openfoam.write_mesh(mesh, folder / "first")
    fields = openfoam.read_fields(mesh, folder / "first", "0", ["T", "U"])
    for _ in range(levels):
        mesh.cell_fields["T"] = exact(mesh, 0.0)
        result = pamr.adapt(mesh, wanted(mesh, levels))
        mesh, fields = result.mesh, fields.after(result)
    mesh.cell_fields["T"] = exact(mesh, 0.0)
    make_case(mesh, fields, folder, 0, levels, scheme)


def solution(folder, turn):
    """The mesh of a turn with the fields that the solver left."""
    mesh = pamr.Mesh.read(COMM, folder / f"turn{turn}.hdf")
    for name in list(mesh.cell_fields):
        del mesh.cell_fields[name]
    fields = openfoam.read_fields(mesh, folder / f"turn{turn}", name_of(turn + 1), ["T", "U"])
    mesh.write(folder / f"turn{turn}-seen.hdf")
    return mesh, fields


def follow(out, levels, turn, scheme):
    folder = out / f"levels{levels}"
    mesh, fields = solution(folder, turn)
    before = amount(mesh)
    result = pamr.adapt(mesh, wanted(mesh, levels))
    lost = abs(amount(result.mesh) / before - 1)
    if COMM.rank == 0:
        with open(folder / "lost.csv", "a", encoding="ascii") as file:
            file.write(f"{turn},{before!r},{lost!r},{len(result.mesh.patches)}\n")
        print(f"  turn {turn}: {mesh.n_cells} -> {result.mesh.n_cells} cells", flush=True)
    make_case(result.mesh, fields.after(result), folder, turn + 1, levels, scheme)


def measure(out, levels, turn):
    """Adds a row to the table."""
    folder = out / f"levels{levels}"
    mesh, _ = solution(folder, turn)
    volume, dye, truth = mesh.volumes(), mesh.cell_fields["T"], exact(mesh, TURN * (turn + 1))
    norm2 = COMM.allreduce((volume * truth ** 2).sum())
    center = mesh.points[mesh.cells].mean(axis=1)
    carried = COMM.allreduce((volume * dye) @ center) / amount(mesh)
    lost = np.loadtxt(folder / "lost.csv", delimiter=",")
    row = {"levels": levels, "cells": mesh.n_cells, "error": np.sqrt(COMM.allreduce((volume * (dye - truth) ** 2).sum()) / norm2),
           "peak": COMM.allreduce(dye.max(), MPI.MAX) / COMM.allreduce(truth.max(), MPI.MAX), "least": COMM.allreduce(dye.min(), MPI.MIN),
           "off": np.linalg.norm(carried - BEGIN - STREAM * TURN * (turn + 1)), "lost_when_adapting": lost[:, 2].max(),
           "lost_in_all": abs(amount(mesh) / lost[0, 1] - 1), "min_mean_ratio": pamr.quality(mesh)["mean_ratio"]["min"]}
    if COMM.rank == 0:
        print("  ".join(f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()), flush=True)
        is_new = not (out / "table.csv").exists()
        with open(out / "table.csv", "a", newline="", encoding="ascii") as file:
            writer = csv.DictWriter(file, row.keys())
            if is_new:
                writer.writeheader()
            writer.writerow(row)


def main(action, out, levels, *rest):
    out, levels = pathlib.Path(out), int(levels)
    if action == "start":
        start(out, levels, *rest)
    elif action == "next":
        follow(out, levels, int(rest[0]), rest[1])
    else:
        measure(out, levels, int(rest[0]))


main(*sys.argv[1:])
