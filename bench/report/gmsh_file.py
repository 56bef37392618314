# SPDX-License-Identifier: GPL-3.0-or-later
"""The Kuhn cube as a binary Gmsh file of format 2.2, with the sides as one physical surface: gmsh_file.py N OUT.msh."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "compare"))
import workload  # noqa: E402

TRIANGLE, TETRAHEDRON = 2, 4
FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))


def rows_of(elements, first_number, physical):
    """Number, physical and geometric tag and nodes of each, the latter from 1."""
    rows = np.empty((len(elements), 3 + elements.shape[1]), dtype=np.int32)
    rows[:, 0] = np.arange(first_number, first_number + len(elements))
    rows[:, 1:3] = physical
    rows[:, 3:] = elements + 1
    return rows


def sides_of(cells, nodes):
    sides = []
    for face in FACES:
        triangles = cells[:, face]
        on_side = np.zeros(len(cells), dtype=bool)
        for axis in range(3):
            x = nodes[:, axis][triangles]
            on_side |= (x == 0).all(axis=1) | (x == 1).all(axis=1)
        sides.append(triangles[on_side])
    return np.concatenate(sides)


def main(n, target):
    cells, nodes = workload.kuhn_cube(int(n))
    triangles = sides_of(cells, nodes)
    with open(target, "wb") as file:
        file.write(b"$MeshFormat\n2.2 1 8\n" + np.int32(1).tobytes() + b"\n$EndMeshFormat\n")
        file.write(b'$PhysicalNames\n2\n2 1 "sides"\n3 2 "inside"\n$EndPhysicalNames\n')
        table = np.empty(len(nodes), dtype=[("tag", "<i4"), ("x", "<f8", 3)])
        table["tag"], table["x"] = np.arange(1, len(nodes) + 1), nodes
        file.write(b"$Nodes\n%d\n" % len(nodes))
        table.tofile(file)
        file.write(b"\n$EndNodes\n$Elements\n%d\n" % (len(triangles) + len(cells)))
        for elements, kind, first, physical in (
            (triangles, TRIANGLE, 1, 1),
            (cells, TETRAHEDRON, 1 + len(triangles), 2),
        ):
            np.array([kind, len(elements), 2], dtype=np.int32).tofile(file)
            rows_of(elements, first, physical).tofile(file)
        file.write(b"\n$EndElements\n")


main(*sys.argv[1:])
