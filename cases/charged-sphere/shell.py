#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a part of a spherical shell as a native mesh file: an octant, or a narrow sector whose three side planes pass
through the center. Lengths in Debye lengths.

Usage: shell.py -o MESH --radius A [--outer R] [--edges N] [--layers M] [--growth G] [--width W]

  --radius A   of the sphere
  --outer R    outer radius (default A + 8)
  --edges N    edges along each side of the spherical triangle (default 10)
  --layers M   layers of cells from the sphere outwards (default 60)
  --growth G   thickness of the last layer over the first (default 40)
  --width W    sector: angle in radians between the middle of the triangle and its corners; without it an octant

Patches: `sphere`, `outer`, and the sides `symmetry_x symmetry_y symmetry_z` of the octant or `side0 side1 side2` of the sector.
"""
import argparse

import h5py
import numpy as np


def triangle(width):
    """Corners of the spherical triangle on the unit sphere."""
    if width is None:
        return np.eye(3)
    angles = 2 * np.pi * np.arange(3) / 3 + 0.3
    return np.array([[np.sin(width) * np.cos(t), np.sin(width) * np.sin(t), np.cos(width)] for t in angles])


def surface_grid(corners, n):
    """Unit vectors and triangles of the spherical triangle cut n times along each side, and how far (in n-ths) each
    point is from the side opposite each corner."""
    weights = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)])
    number = {(i, j): k for k, (i, j, _) in enumerate(weights)}
    points = weights @ corners / n
    points /= np.linalg.norm(points, axis=1)[:, None]
    triangles = []
    for i in range(n):
        for j in range(n - i):
            triangles.append((number[i, j], number[i + 1, j], number[i, j + 1]))
            if i + j < n - 1:
                triangles.append((number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]))
    return points, np.array(triangles), weights


def radii(inner, outer, layers, growth):
    """Layers whose thickness grows geometrically."""
    ratio = growth ** (1 / max(1, layers - 1))
    steps = ratio ** np.arange(layers)
    at = np.concatenate([[0], np.cumsum(steps)]) / steps.sum()
    return inner + (outer - inner) * at


def shell(inner, outer, n, layers, growth, width=None):
    """Points, cells, neighbors (-(patch + 1) on the boundary) and the names of the patches."""
    unit, triangles, weights = surface_grid(triangle(width), n)
    at = radii(inner, outer, layers, growth)
    points = (at[:, None, None] * unit[None]).reshape(-1, 3)
    # Each prism becomes three tetrahedra; diagonals run from the smaller number below, so that neighbors agree.
    a, b, c = np.sort(triangles, axis=1).T
    cells = []
    for layer in range(layers):
        low, high = layer * len(unit), (layer + 1) * len(unit)
        cells += [np.column_stack(t) for t in ((a + low, b + low, c + low, c + high),
                                               (a + low, b + low, b + high, c + high),
                                               (a + low, a + high, b + high, c + high))]
    cells = np.concatenate(cells)
    p = points[cells]
    volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0])
    cells[volume < 0] = cells[volume < 0][:, [1, 0, 2, 3]]
    names = ["sphere", "outer"] + (["symmetry_x", "symmetry_y", "symmetry_z"] if width is None else ["side0", "side1", "side2"])

    level, spot = np.divmod(np.arange(len(points)), len(unit))
    on = np.column_stack([level == 0, level == layers] + [weights[spot][:, k] == 0 for k in range(3)])
    return points, cells, neighbors(cells, on), names


def neighbors(cells, on):
    """Across the face opposite each corner: the other cell, or the patch whose nodes these are."""
    m = len(cells)
    faces = np.stack([np.delete(cells, i, axis=1) for i in range(4)], axis=1).reshape(-1, 3)
    faces = np.sort(faces, axis=1)
    order = np.lexsort(faces.T)
    same = (faces[order[1:]] == faces[order[:-1]]).all(axis=1)
    result = np.full(4 * m, np.iinfo(np.int64).min)
    first, second = order[:-1][same], order[1:][same]
    result[first], result[second] = second // 4, first // 4
    bare = np.flatnonzero(result == np.iinfo(np.int64).min)
    patch = on[faces[bare]].all(axis=1)
    assert patch.any(axis=1).all()
    result[bare] = -(patch.argmax(axis=1) + 1)
    return result.reshape(m, 4)


def write(name, points, cells, cell_to_cell, patches, surfaces, toml):
    with h5py.File(name, "w") as file:
        vtk = file.create_group("VTKHDF")
        vtk.attrs["Version"] = np.array([1, 0], dtype=np.int64)
        vtk.attrs["Type"] = np.bytes_("UnstructuredGrid")
        vtk["NumberOfPoints"] = np.array([len(points)])
        vtk["NumberOfCells"] = np.array([len(cells)])
        vtk["NumberOfConnectivityIds"] = np.array([cells.size])
        vtk["Points"] = points
        vtk["Connectivity"] = cells.ravel()
        vtk["Offsets"] = np.arange(0, cells.size + 1, 4)
        vtk["Types"] = np.full(len(cells), 10, dtype=np.uint8)
        pamr = file.create_group("PAMR")
        pamr.attrs["format"] = 2
        pamr.attrs["length_unit"] = "1"
        pamr["cell_to_cell"] = cell_to_cell
        pamr["patches/names"] = patches
        pamr["patches/surfaces"] = surfaces
        pamr["surfaces"] = toml


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--radius", type=float, required=True)
    parser.add_argument("--outer", type=float)
    parser.add_argument("--edges", type=int, default=10)
    parser.add_argument("--layers", type=int, default=60)
    parser.add_argument("--growth", type=float, default=40)
    parser.add_argument("--width", type=float)
    o = parser.parse_args()
    outer = o.outer or o.radius + 8
    points, cells, cell_to_cell, patches = shell(o.radius, outer, o.edges, o.layers, o.growth, o.width)
    toml = "".join(f'[[surface]]\nname = "{name}"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = {radius!r}\n'
                   for name, radius in (("sphere", float(o.radius)), ("outer", float(outer))))
    write(o.output, points, cells, cell_to_cell, patches, ["sphere", "outer", "", "", ""], toml)
    print(f"{len(cells)} cells, {len(points)} nodes -> {o.output}")


if __name__ == "__main__":
    main()
