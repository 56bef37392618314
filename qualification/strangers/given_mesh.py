# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose points and cells are at hand: a .msh with a physical surface for each patch, and what is true of the shape."""
import numpy as np


class Given:
    """Like `Model`, but what is true comes from closed forms: of the walls, and the volume and areas that are given."""

    def __init__(self, made, points, cells, patches, volume, areas, flat=None):
        """`patches` has the triangles of each by name; `areas` those that are known, by patch;
        `flat` those that lie in a plane, without it all whose names begin so."""
        self.made, self.volume, self.areas = made, volume, areas
        self.points, self.entities = np.asarray(points, float), {name: np.asarray(t) for name, t in patches.items()}
        self.flat = flat or [name for name in patches if name.startswith("flat")]
        self.cells = np.asarray(cells)
        a, b, c, d = (self.points[self.cells[:, i]] for i in range(4))
        inverted = (np.cross(b - a, c - a) * (d - a)).sum(axis=1) < 0
        self.cells[inverted] = self.cells[inverted][:, [1, 0, 2, 3]]

    def write(self, path):
        """As text, every coordinate with all its digits."""
        names = list(self.entities)
        rows = [f"2 2 {tag} {tag} {a} {b} {c}" for tag, name in enumerate(names, 1) for a, b, c in self.entities[name] + 1]
        rows += [f"4 2 {len(names) + 1} 1 {a} {b} {c} {d}" for a, b, c, d in self.cells + 1]
        with open(path, "w") as file:
            print("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames", len(names) + 1, sep="\n", file=file)
            for tag, name in enumerate(names, 1):
                print(f'2 {tag} "{name}"', file=file)
            print(f'3 {len(names) + 1} "all"\n$EndPhysicalNames\n$Nodes\n{len(self.points)}', file=file)
            for number, (x, y, z) in enumerate(self.points.tolist(), 1):
                print(number, repr(x), repr(y), repr(z), file=file)
            print(f"$EndNodes\n$Elements\n{len(rows)}", file=file)
            for number, row in enumerate(rows, 1):
                print(number, row, file=file)
            print("$EndElements", file=file)
        return self

    def area(self, patch):
        """None where it is not known."""
        return self.areas.get(patch)

    def distance(self, patch, points):
        return self.made.walls[patch].distance(points)
