# SPDX-License-Identifier: GPL-3.0-or-later
"""The workloads of docs/reports/performance.md and peers.md for codes that speak Python: mesh, marks, clock, memory.

Command line, also of the codes in C++:

    CODE WORKLOAD MESH LEVELS [assess]           refines LEVELS times and prints a line of JSON for each level
    CODE front kuhn:N LEVELS STEPS [assess]      follows a sphere through the cube in STEPS steps, a line for each

WORKLOAD  uniform: all cells; shell: centroid within 0.06 of the sphere r = 0.35 about the middle; wall: cells with a
          corner on the wall of the hole; sphere:X,Y,Z,R: cells cut by that sphere; box:X0,Y0,Z0,X1,Y1,Z1: centroid in it
MESH      kuhn:N, the cube of 6 N^3 cells, or a Gmsh file of format 2.2, text; "hole" in its name: assess.py says which
front     cells that the sphere cuts are split until their longest edge is that of level LEVELS, others may be coarsened

Keys: cells; cpu: s of the call, or of all calls of a step; peak: bytes over those before the mesh was made; relate_cpu: s
of `relate`, absent without; calls, cells_in: of a step. With `assess` also volume; worst, low, mean: the smallest, 0.1 %
and mean of the mean ratio; split: cells of the mesh before that are gone; open: faces of one cell that are not of the
boundary; wall_nodes, off, farthest: nodes of the wall of the hole, those off it, and how far; -1: not known. There is a line
for level 0 then. No further level that might not fit into the memory that is free.

A code defines a class with
    name            name and version
    start(cells, nodes)   makes the mesh in its own data structure, returns it
    mark(m, flags)  hands over a flag for each cell: 1 split, -1 coarsen if possible, 0 keep; not timed. Codes that refine
                    uniformly have none
    refine(m)       the timed call: returns the refined mesh, all of it refined where `mark` was not called
    relate(m)       the way to the cells on both sides of each face; timed apart; None where `refine` includes it or the
                    code has none
    count(m)        number of cells
    corners(m)      corners of the cells, n_cells x 4 x 3
and calls `main`.
"""

import ctypes
import gc
import json
import pathlib
import sys
import time

import numpy as np

import assess
from warm_memory import warm_memory

AXIS_ORDERS = ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0))  # the last three are odd
BYTES_OF_CELL = 200  # of what a call takes, for `warm_memory`
GROWTH = 4.5  # of a level around a sphere over the one before, in memory
MIDDLE = 0.5
RADIUS = 0.35
MAX_CALLS = 40  # of a step
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


def cells_in_shell(corners):
    return np.abs(np.linalg.norm(corners.mean(axis=1) - MIDDLE, axis=1) - RADIUS) < SHELL_WIDTH


def cells_at_wall(corners):
    return np.linalg.norm(corners, axis=2).min(axis=1) <= assess.ON_WALL * assess.HOLE_RADIUS


def cells_cut_by_sphere(corners, center, radius):
    distance = np.linalg.norm(corners - center, axis=2)
    return (distance.min(axis=1) < radius) & (distance.max(axis=1) > radius)


def read_mesh(name):
    """Cells and nodes of `kuhn:N` or of a Gmsh file of format 2.2, text."""
    if name.startswith("kuhn:"):
        return kuhn_cube(int(name[5:]))
    lines = pathlib.Path(name).read_text(encoding="ascii").splitlines()
    begin = lines.index("$Nodes") + 2
    rows = [line.split() for line in lines[begin : begin + int(lines[begin - 1])]]
    number = {row[0]: i for i, row in enumerate(rows)}
    begin = lines.index("$Elements") + 2
    elements = (line.split() for line in lines[begin : begin + int(lines[begin - 1])])
    cells = [[number[tag] for tag in row[-4:]] for row in elements if row[1] == str(TETRAHEDRON)]
    return np.array(cells), np.array([row[1:] for row in rows], dtype=float)


def law_named(name):
    if name in ("uniform", "shell", "wall"):
        return {"uniform": None, "shell": cells_in_shell, "wall": cells_at_wall}[name]
    kind, _, numbers = name.partition(":")
    numbers = np.array(numbers.split(",") if numbers else [], dtype=float)
    if kind == "sphere" and len(numbers) == 4:
        return lambda corners: cells_cut_by_sphere(corners, numbers[:3], numbers[3])
    if kind == "box" and len(numbers) == 6:
        return lambda corners: np.all(
            (numbers[:3] <= corners.mean(axis=1)) & (corners.mean(axis=1) <= numbers[3:]), axis=1
        )
    raise ValueError(f"expected uniform, shell, wall, front, sphere:X,Y,Z,R or box:X0,Y0,Z0,X1,Y1,Z1, found {name}")


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


def assessed(peer, mesh, mesh_name, cells_before):
    return assess.assess(peer.corners(mesh), assess.domain_of(mesh_name), cells_before)


def report(peer, workload, level, values):
    print(json.dumps({"peer": peer.name, "workload": workload, "level": level, **values}), flush=True)


def follow_levels(peer, workload, mesh_name, levels, assesses):
    law = law_named(workload)
    start = read_mesh(mesh_name)
    before = status_bytes("VmRSS")
    mesh = peer.start(*start)
    del start
    cells = None
    if assesses:
        values, cells = assessed(peer, mesh, mesh_name, None)
        report(peer, workload, 0, {"cells": peer.count(mesh), **values})
    for level in range(1, levels + 1):
        n_cells = n_split = peer.count(mesh)
        if law:
            flags = law(peer.corners(mesh)).astype(np.int8)
            n_split = np.count_nonzero(flags)
            peer.mark(mesh, flags)
            del flags
        warm_memory(int(BYTES_OF_CELL * (n_cells + 8 * n_split)))
        forget_peak()
        mesh, cpu = measured(peer.refine, mesh)
        values = {"cells": peer.count(mesh), "cpu": cpu, "peak": status_bytes("VmHWM") - before}
        if peer.relate and workload == "uniform":
            _, values["relate_cpu"] = measured(peer.relate, mesh)
        if assesses:
            found, cells = assessed(peer, mesh, mesh_name, cells)
            values.update(found)
        report(peer, workload, level, values)
        if GROWTH * values["peak"] > status_bytes("MemAvailable", "/proc/meminfo"):
            break


def flags_at_front(corners, x, size, coarsens):
    distance = np.linalg.norm(corners - [assess.FRONT_START + x, MIDDLE, MIDDLE], axis=2)
    nearest, farthest, longest = distance.min(axis=1), distance.max(axis=1), assess.longest_edges(corners)
    radius = assess.FRONT_RADIUS
    is_cut = (nearest < radius) & (radius < farthest)
    is_near = (nearest < radius + longest) & (farthest > radius - longest)
    return np.where(is_cut & (longest > size), 1, np.where(is_near | (not coarsens), 0, -1)).astype(np.int8)


def meet_front(peer, mesh, x, size):
    """Calls until no cell that the front cuts is too large."""
    cpu = 0.0
    for calls in range(MAX_CALLS):
        flags = flags_at_front(peer.corners(mesh), x, size, calls == 0)
        if calls > 0 and not (flags > 0).any():
            return mesh, {"cpu": cpu, "calls": calls}
        peer.mark(mesh, flags)
        mesh, seconds = measured(peer.refine, mesh)
        cpu += seconds
    return mesh, {"cpu": cpu, "calls": MAX_CALLS}


def follow_front(peer, mesh_name, levels, steps, assesses):
    size = 1.01 * 3**0.5 / int(mesh_name.partition(":")[2]) / 2**levels
    start = read_mesh(mesh_name)
    before = status_bytes("VmRSS")
    mesh, _ = meet_front(peer, peer.start(*start), 0.0, size)
    for step in range(1, steps + 1):
        cells_in = peer.count(mesh)
        cells = assessed(peer, mesh, mesh_name, None)[1] if assesses else None
        warm_memory(2 * BYTES_OF_CELL * cells_in)
        forget_peak()
        mesh, values = meet_front(peer, mesh, assess.FRONT_SHIFT * step, size)
        values.update(cells=peer.count(mesh), cells_in=cells_in, peak=status_bytes("VmHWM") - before)
        if assesses:
            values.update(assessed(peer, mesh, mesh_name, cells)[0])
        report(peer, "front", step, values)


def main(peer):
    arguments = sys.argv[1:]
    assesses = arguments[-1:] == ["assess"]
    if assesses:
        arguments.pop()
    if len(arguments) != (4 if arguments[:1] == ["front"] else 3):
        sys.exit(
            f"usage: {sys.argv[0]} WORKLOAD MESH LEVELS [assess] | {sys.argv[0]} front kuhn:N LEVELS STEPS [assess]"
        )
    if arguments[0] == "front":
        follow_front(peer, arguments[1], int(arguments[2]), int(arguments[3]), assesses)
    else:
        follow_levels(peer, *arguments[:2], int(arguments[2]), assesses)
