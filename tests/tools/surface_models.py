# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed triangulated bodies for tests, as lists of points and of triangles seen counter-clockwise from outside."""
import math
import pathlib

import numpy as np


def icosphere(levels):
    """20 * 4^levels triangles with all their points on the unit sphere."""
    t = (1 + 5 ** 0.5) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t), (t, 0, -1),
              (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
                 (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
                 (8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                p = points[a] + points[b]
                points.append(p / np.linalg.norm(p))
                middles[key] = len(points) - 1
            return middles[key]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return np.array(points), triangles


def bored_cube(n):
    """The cube [-1, 1]^3 with a round hole of radius 0.5 along z, its rims of n chords (a multiple of 8)."""
    points = [(x, y, z) for z in (-1, 1) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    for z in (-1, 1):
        for i in range(n):
            angle = 2 * math.pi * (i + n / 8) / n
            points.append((0.5 * math.cos(angle), 0.5 * math.sin(angle), z))
    triangles = []
    for side in (0, 1):
        def rim(i):
            return 8 + side * n + i % n

        for corner in range(4):
            begin, middle, end = corner * n // 4, corner * n // 4 + n // 8, (corner + 1) * n // 4
            here, other = 4 * side + corner, 4 * side + (corner + 1) % 4
            flat = [(here, rim(i + 1), rim(i)) for i in range(begin, middle)] + [(here, other, rim(middle))]
            flat += [(other, rim(i + 1), rim(i)) for i in range(middle, end)]
            triangles += flat if side == 1 else [t[::-1] for t in flat]
    for corner in range(4):
        other = (corner + 1) % 4
        triangles += [(corner, other, 4 + other), (corner, 4 + other, 4 + corner)]
    for i in range(n):
        j = (i + 1) % n
        triangles += [(8 + i, 8 + n + j, 8 + j), (8 + i, 8 + n + i, 8 + n + j)]
    return np.array(points, dtype=float), triangles


def can(n):
    """A cylinder of radius 1 from z = -1 to 1 whose rims have n chords, with flat ends."""
    points = [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), z) for z in (-1, 1) for i in range(n)]
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, n + j), (i, n + j, n + i), (2 * n, j, i), (2 * n + 1, n + i, n + j)]
    return np.array(points + [(0, 0, -1), (0, 0, 1)], dtype=float), triangles


def wing(n):
    """A wing with flat ends from z = -1 to 1, n chords above and below: round in front (x = 0), sharp behind (x = 1, 48 degrees)."""
    m, layers = 2 * n, 8
    section = [(s, 0.9 * (math.sqrt(s) - s) * (1 if i <= n else -1))
               for i in range(m) for s in [(1 + math.cos(math.pi * i / n)) / 2]]
    points = [(x, y, 2 * k / layers - 1) for k in range(layers + 1) for x, y in section]
    triangles = []
    for a in range(m * layers):
        b = a // m * m + (a + 1) % m
        triangles += [(a, b, m + b), (a, m + b, m + a)]
    for i in range(n):
        over, under = (i, i + 1), ((m - i) % m, m - i - 1)
        end = [t for t in ((over[0], under[1], under[0]), (over[0], over[1], under[1])) if len(set(t)) == 3]
        triangles += [t[::-1] for t in end] + [tuple(m * layers + j for j in t) for t in end]
    return np.array(points), triangles


def write_stl(name, points, triangles):
    lines = ["solid body"]
    for corners in triangles:
        a, b, c = (points[i] for i in corners)
        normal = np.cross(b - a, c - a)
        lines += ["facet normal %g %g %g" % tuple(normal / np.linalg.norm(normal)), "outer loop"]
        lines += ["vertex %.17g %.17g %.17g" % tuple(p) for p in (a, b, c)]
        lines += ["endloop", "endfacet"]
    pathlib.Path(name).write_text("\n".join(lines + ["endsolid body", ""]))


def write_off(name, points, triangles):
    lines = ["OFF", f"{len(points)} {len(triangles)} 0"]
    lines += ["%.17g %.17g %.17g" % tuple(p) for p in points] + ["3 %d %d %d" % tuple(t) for t in triangles]
    pathlib.Path(name).write_text("\n".join(lines + [""]))
