#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the ellipsoid of this case as a binary STL, as a scanner or a modeler would deliver it.

    python3 make_body.py ellipsoid.stl [--levels 4]

Semi-axes 0.8, 0.5 and 0.4, the longest turned by 30 degrees out of the x axis towards z, center (0, 0, 1.3); about
20 * 4^levels triangles with their corners on the ellipsoid.
"""
import argparse
import math
import struct

AXES, TURN, CENTER = (0.8, 0.5, 0.4), math.radians(30), (0.0, 0.0, 1.3)


def unit(p):
    size = math.sqrt(sum(x * x for x in p))
    return tuple(x / size for x in p)


def icosphere(levels):
    t = (1 + 5 ** 0.5) / 2
    points = [unit(p) for p in ((-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t),
                                (0, 1, -t), (t, 0, -1), (t, 0, 1), (-t, 0, -1), (-t, 0, 1))]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
                 (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middle, finer = {}, []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(points)
                points.append(unit(tuple(x + y for x, y in zip(points[a], points[b]))))
            return middle[key]

        for a, b, c in triangles:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return points, triangles


def placed(p):
    """A point of the unit sphere on the ellipsoid; first turned, so that no edge of the triangles lies in y = 0."""
    s, c = math.sin(0.4), math.cos(0.4)
    p = (p[0], c * p[1] - s * p[2], s * p[1] + c * p[2])
    s, c = math.sin(0.7), math.cos(0.7)
    p = (c * p[0] - s * p[1], s * p[0] + c * p[1], p[2])
    x, y, z = (a * v for a, v in zip(AXES, p))
    s, c = math.sin(TURN), math.cos(TURN)
    return (CENTER[0] + c * x - s * z, CENTER[1] + y, CENTER[2] + s * x + c * z)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output")
    parser.add_argument("--levels", type=int, default=4)
    o = parser.parse_args()
    points, triangles = icosphere(o.levels)
    points = [placed(p) for p in points]
    with open(o.output, "wb") as file:
        file.write(b"ellipsoid".ljust(80))
        file.write(struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *(x for corner in triangle for x in points[corner]), 0))
    print(f"{len(triangles)} triangles -> {o.output}")


if __name__ == "__main__":
    main()
