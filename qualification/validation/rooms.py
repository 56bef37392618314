# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes better than those of level 0: rooms with flat walls, meshed by Gmsh, split with and without bent edges inside.

    rooms.py BIN_FOLDER [NAME,...]          # L, U, steps, wedge, box around a box: with all edges of the table

A row a room: cells and the smallest mean ratio of level 0; after splitting all cells once and twice with straight edges
(--bend walls, nothing to bend here) and with all edges inside bent (--bend all); the latter over level 0's; with --bend all
and a shape floor of 0.4, a fifth of all cells marked at random three times (four seeds): the smallest ratio of each level,
and the cells beside those of --bend none with that floor. Exit code 1 where splitting by bent edges gives worse shapes than
by straight ones, or where a ratio with that floor is under 0.4 and under that of level 0.
"""
import pathlib
import sys
import tempfile

import numpy as np

import curved_walls
import other_bodies

BOX = "{} = occ.addBox({})\n"
L_ROOM = BOX.format("a", "0, 0, 0, 2, 1, 1") + BOX.format("b", "0, 0, 0, 1, 2, 1") + "occ.fuse([(3, a)], [(3, b)])\n"
BOX_AROUND_BOX = (BOX.format("a", "-1, -1, -1, 2, 2, 2") + BOX.format("b", "-0.3, -0.4, -0.35, 0.6, 0.8, 0.7")
                  + "occ.cut([(3, a)], [(3, b)])\n")
STEPS = (BOX.format("a", "0, 0, 0, 3, 1, 1") + BOX.format("b", "0, 0, 1, 2, 1, 0.5") + BOX.format("c", "0, 0, 1.5, 1, 1, 0.5")
         + "occ.fuse([(3, a)], [(3, b), (3, c)])\n")
U_ROOM = BOX.format("a", "0, 0, 0, 3, 1, 2") + BOX.format("b", "1, 0, 1, 1, 1, 1.5") + "occ.cut([(3, a)], [(3, b)])\n"
WEDGE = "occ.addWedge(0, 0, 0, 2, 1, 1, -1, 0.6)\n"
ROOMS = {f"{name}, {size}": (body, size) for name, body, sizes in (
    ("L", L_ROOM, (0.25, 0.35, 0.45, 0.6)), ("box around a box", BOX_AROUND_BOX, (0.4, 0.6)), ("steps", STEPS, (0.3, 0.4, 0.5)),
    ("U", U_ROOM, (0.3, 0.4)), ("wedge", WEDGE, (0.25, 0.4))) for size in sizes}
GROUPS = """
import gmsh
occ = gmsh.model.occ
{body}occ.synchronize()
gmsh.option.setNumber('General.NumThreads', 1)
for end in ('Min', 'Max'): gmsh.option.setNumber('Mesh.MeshSize' + end, {size})
gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)])
gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)])
"""
FLOOR = 0.4


def smallest(mesh):
    return curved_walls.mean_ratios(mesh).min()


def split_all(pamr, mesh, bend):
    """The smallest mean ratio after splitting all cells once, and twice."""
    ratios = []
    for _ in range(2):
        mesh = pamr.refine(mesh, np.ones(mesh.n_cells, bool), bend=bend).mesh
        ratios.append(smallest(mesh))
    return ratios


def refine_at_random(pamr, first, bend):
    """The smallest mean ratio at each of three levels, and the cells at the end; of four seeds."""
    ratios, cells = [1.0] * 3, 0
    for seed in range(4):
        rng, mesh = np.random.default_rng(seed), first
        for level in range(3):
            mesh = pamr.refine(mesh, rng.random(mesh.n_cells) < 0.2, bend=bend, shape_floor=FLOOR).mesh
            ratios[level] = min(ratios[level], smallest(mesh))
        cells += mesh.n_cells
    return ratios, cells


def measure(pamr, comm, name):
    """Prints the row of a room; whether it holds."""
    body, size = ROOMS[name]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        other_bodies.run_gmsh(folder, GROUPS.format(body=body, size=size))
        first = pamr.Mesh.read(comm, folder / "body.msh")
    start, straight, bent = smallest(first), split_all(pamr, first, "walls"), split_all(pamr, first, "all")
    (ratios, cells), (_, cells_straight) = (refine_at_random(pamr, first, bend) for bend in ("all", "none"))
    row = [name, f"{first.n_cells:,}", f"{start:.3f}", *(", ".join(f"{q:.3f}" for q in of) for of in (straight, bent)),
           f"{bent[1] / start:.2f}", ", ".join(f"{q:.3f}" for q in ratios), f"{100 * (cells / cells_straight - 1):+.0f} %"]
    print("| " + " | ".join(row) + " |", flush=True)
    return bent[0] > straight[0] and bent[1] > straight[1] and min(ratios) >= min(FLOOR, start) - 1e-12


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    bin_folder = pathlib.Path(sys.argv[1]).resolve()
    sys.path.insert(0, str(bin_folder.parent / "python"))
    import pamr  # of the same build
    from mpi4py import MPI
    head = ("room, edges", "cells", "level 0", "straight: 1, 2", "bent: 1, 2", "gain", "floor 0.4: 1, 2, 3", "cells")
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    wanted = sys.argv[2].split(",") if len(sys.argv) == 3 else [name.split(",")[0] for name in ROOMS]
    holds = [measure(pamr, MPI.COMM_SELF, name) for name in ROOMS if name.split(",")[0] in wanted]
    return 0 if all(holds) else 1


if __name__ == "__main__":
    sys.exit(main())
