#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""box_mesh.py FILE.msh NX NY NZ X0 X1 [WIDTH]: a box of NX x NY x NZ bricks of six tetrahedra each as a Gmsh file (2.2, text)
with the physical surfaces xmin xmax ymin ymax zmin zmax. x runs from X0 to X1; y and z begin at 0 and have bricks of the same
edges as x, or WIDTH in all."""
import itertools
import sys

name, nx, ny, nz = sys.argv[1], *map(int, sys.argv[2:5])
x0, x1 = map(float, sys.argv[5:7])
edge = (x1 - x0) / nx
width = [edge, edge] if len(sys.argv) < 8 else [float(sys.argv[7]) / ny, float(sys.argv[7]) / nz]
number = lambda i, j, k: 1 + i + (nx + 1) * (j + (ny + 1) * k)

cells = []
for i, j, k in itertools.product(range(nx), range(ny), range(nz)):
    for order in itertools.permutations(range(3)):  # Kuhn: one tetrahedron for each way along the edges to the far corner
        at, path = [i, j, k], [number(i, j, k)]
        for axis in order:
            at[axis] += 1
            path.append(number(*at))
        if order in ((0, 2, 1), (1, 0, 2), (2, 1, 0)):  # odd: turned over
            path[1], path[2] = path[2], path[1]
        cells.append(path)

lattice = lambda n: ((n - 1) % (nx + 1), (n - 1) // (nx + 1) % (ny + 1), (n - 1) // (nx + 1) // (ny + 1))
sides = []
for cell in cells:
    for face in itertools.combinations(cell, 3):
        corners = [lattice(n) for n in face]
        for axis, n in enumerate((nx, ny, nz)):
            for end, at in enumerate((0, n)):
                if all(corner[axis] == at for corner in corners):
                    sides.append((2 * axis + end + 1, face))

with open(name, "w") as out:
    out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n7\n")
    for tag, side in enumerate(("xmin", "xmax", "ymin", "ymax", "zmin", "zmax"), 1):
        out.write(f'2 {tag} "{side}"\n')
    out.write('3 7 "gas"\n$EndPhysicalNames\n')
    nodes = [(x0 + edge * i, width[0] * j, width[1] * k)
             for k, j, i in itertools.product(range(nz + 1), range(ny + 1), range(nx + 1))]
    out.write(f"$Nodes\n{len(nodes)}\n")
    out.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(nodes, 1))
    out.write(f"$EndNodes\n$Elements\n{len(sides) + len(cells)}\n")
    out.writelines(f"{i} 2 2 {tag} {tag} {a} {b} {c}\n" for i, (tag, (a, b, c)) in enumerate(sides, 1))
    out.writelines(f"{i} 4 2 7 1 {a} {b} {c} {d}\n" for i, (a, b, c, d) in enumerate(cells, len(sides) + 1))
    out.write("$EndElements\n")
