# SPDX-License-Identifier: GPL-3.0-or-later
"""The workloads of docs/reports/performance.md for peers that speak Python: mesh, marks, clock, memory, quality.

A peer defines a class with
    name            name and version
    start(n)        makes the Kuhn cube K(n) in the peer's own data structure, returns the mesh
    load(cells, nodes)   the same of any mesh, for `shapes`; only of peers that have `mark`
    mark(m, flags)  hands the peer a boolean for each cell; not timed. Peers that refine uniformly have none
    refine(m)       the timed call: returns the refined mesh, all of it refined where `mark` was not called
    relate(m)       the peer's way to the cells on both sides of each face; timed apart; None where `refine` includes it
                    or the peer has none
    count(m)        number of cells
    corners(m)      corners of the cells, n_cells x 4 x 3; only of peers that have `mark`
and calls `main`. Command line: PEER.py WORKLOAD N LEVELS REPEATS BUDGET, with WORKLOAD one of W1, W2, W3. At most
REPEATS runs, no further one when BUDGET, in CPU seconds of the whole process, would be passed; no further level of W3
that might not fit into the memory that is free. Prints one line of JSON for each level of each run; keys as in `report`.
Or PEER.py shapes MESH LAW LEVELS: a line for each level with its cells, smallest, 0.1 % and mean of the mean ratio.
MESH is kuhn:N or a Gmsh file of format 2.2, text; LAW is sphere:X,Y,Z,R for the cells cut by a
sphere or box:X0,Y0,Z0,X1,Y1,Z1 for those with their centroid in a box.
"""
import ctypes
import gc
import itertools
import json
import pathlib
import sys
import time

import numpy as np

AXIS_ORDERS = ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0))  # the last three are odd
GROWTH = 4.5  # of a level of W3 over the one before, in memory
MIDDLE = 0.5
RADIUS = 0.35
SHELL_WIDTH = 0.06
TETRAHEDRON = 4  # Gmsh's type of element


def kuhn_cube(n):
    """Cells (6 n^3 x 4, int64) and nodes ((n+1)^3 x 3) of the unit cube, numbered as lib/pamr/mesh/kuhn_cube.hpp."""
    k, j, i = (a.ravel() for a in np.meshgrid(*[np.arange(n)] * 3, indexing="ij"))
    first = i + (n + 1) * (j + (n + 1) * k)
    step = np.array([1, n + 1, (n + 1) ** 2])
    cells = np.empty((n**3, 6, 4), dtype=np.int64)
    for order, axes in enumerate(AXIS_ORDERS):
        path = [first, first + step[axes[0]], first + step[axes[0]] + step[axes[1]], first + step.sum()]
        if order >= 3:
            path[1], path[2] = path[2], path[1]
        cells[:, order] = np.stack(path, axis=1)
    z, y, x = (a.ravel() for a in np.meshgrid(*[np.arange(n + 1) / n] * 3, indexing="ij"))
    return cells.reshape(-1, 4), np.stack([x, y, z], axis=1)


def is_kuhn_cube(corners, n):
    """Whether every cell has its longest edge along (1,1,1) / n, as Kuhn's have."""
    edges = np.stack([corners[:, b] - corners[:, a] for a, b in itertools.combinations(range(4), 2)], axis=1)
    longest = np.take_along_axis(edges, np.linalg.norm(edges, axis=2).argmax(axis=1)[:, None, None], axis=1)[:, 0] * n
    return len(corners) == 6 * n**3 and bool(np.allclose(longest * np.sign(longest[:, :1]), 1))


def cells_in_shell(corners):
    return np.abs(np.linalg.norm(corners.mean(axis=1) - MIDDLE, axis=1) - RADIUS) < SHELL_WIDTH


def cells_cut_by_sphere(corners, center=MIDDLE, radius=RADIUS):
    distance = np.linalg.norm(corners - center, axis=2)
    return (distance.min(axis=1) < radius) & (distance.max(axis=1) > radius)


def mean_ratios(corners):
    """12 (3V)^(2/3) / sum of squared edges, 1 for a regular tetrahedron; in slabs, to bound the memory."""
    ratios = []
    for begin in range(0, len(corners), 1 << 18):
        p = corners[begin:begin + (1 << 18)]
        volume = np.abs(np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0])) / 6
        squares = sum(((p[:, b] - p[:, a]) ** 2).sum(axis=1) for a, b in itertools.combinations(range(4), 2))
        ratios.append(12 * (3 * volume) ** (2 / 3) / squares)
    return np.concatenate(ratios)


def read_mesh(name):
    """Cells and nodes of `kuhn:N` or of a Gmsh file of format 2.2, text."""
    if name.startswith("kuhn:"):
        return kuhn_cube(int(name[5:]))
    lines = pathlib.Path(name).read_text(encoding="ascii").splitlines()
    begin = lines.index("$Nodes") + 2
    rows = [line.split() for line in lines[begin:begin + int(lines[begin - 1])]]
    number = {row[0]: i for i, row in enumerate(rows)}
    begin = lines.index("$Elements") + 2
    elements = (line.split() for line in lines[begin:begin + int(lines[begin - 1])])
    cells = [[number[tag] for tag in row[-4:]] for row in elements if row[1] == str(TETRAHEDRON)]
    return np.array(cells), np.array([row[1:] for row in rows], dtype=float)


def law_named(name):
    kind, numbers = name.split(":")
    numbers = np.array(numbers.split(","), dtype=float)
    if kind == "sphere" and len(numbers) == 4:
        return lambda corners: cells_cut_by_sphere(corners, numbers[:3], numbers[3])
    if kind == "box" and len(numbers) == 6:
        return lambda corners: np.all((numbers[:3] <= corners.mean(axis=1)) & (corners.mean(axis=1) <= numbers[3:]), axis=1)
    raise ValueError(f"expected sphere:X,Y,Z,R or box:X0,Y0,Z0,X1,Y1,Z1, found {name}")


def status_bytes(key, file="/proc/self/status"):
    with open(file, encoding="ascii") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith(key + ":"))


def forget_peak():
    """Gives back what is free, so that the peak to come is that of the call."""
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    with open("/proc/self/clear_refs", "w", encoding="ascii") as clear:
        clear.write("5")


def measured(call, mesh):
    begin = time.process_time()
    result = call(mesh)
    return result, time.process_time() - begin


def report(peer, workload, level, run, values):
    """cpu: s of `refine`; relate_cpu: s of `relate`, absent without; peak: bytes over those before the mesh was made."""
    print(json.dumps({"peer": peer.name, "workload": workload, "level": level, "run": run, **values}), flush=True)


def one_run(peer, workload, n, levels, run):
    before = status_bytes("VmRSS")
    mesh = peer.start(n)
    for level in range(1, levels + 1):
        if workload != "W1":
            select = cells_in_shell if workload == "W2" else cells_cut_by_sphere
            peer.mark(mesh, select(peer.corners(mesh)))
        forget_peak()
        refined, cpu = measured(peer.refine, mesh)
        values = {"cpu": cpu, "peak": status_bytes("VmHWM") - before}
        mesh = refined
        del refined
        if peer.relate:
            _, values["relate_cpu"] = measured(peer.relate, mesh)
        if workload == "W3" and run == 1:
            values["worst"] = float(mean_ratios(peer.corners(mesh)).min())
        report(peer, workload, level, run, {"cells": peer.count(mesh), **values})
        if GROWTH * values["peak"] > status_bytes("MemAvailable", "/proc/meminfo"):
            break


def follow_shapes(peer, mesh_name, law_name, levels):
    mesh = peer.load(*read_mesh(mesh_name))
    law = law_named(law_name)
    for level in range(levels + 1):
        if level > 0:
            peer.mark(mesh, law(peer.corners(mesh)))
            mesh = peer.refine(mesh)
        ratios = np.sort(mean_ratios(peer.corners(mesh)))
        print(json.dumps({"peer": peer.name, "level": level, "cells": len(ratios), "worst": ratios[0],
                          "low": ratios[len(ratios) // 1000], "mean": ratios.mean()}), flush=True)
        if GROWTH * status_bytes("VmHWM") > status_bytes("MemAvailable", "/proc/meminfo"):
            break


def main(peer):
    if sys.argv[1] == "shapes":
        follow_shapes(peer, sys.argv[2], sys.argv[3], int(sys.argv[4]))
        return
    workload, (n, levels, repeats), budget = sys.argv[1], map(int, sys.argv[2:5]), float(sys.argv[5])
    one_run(peer, workload, n, levels, 1)
    duration = time.process_time()
    for run in range(2, repeats + 1):
        if time.process_time() + duration > budget:
            break
        one_run(peer, workload, n, levels, run)
