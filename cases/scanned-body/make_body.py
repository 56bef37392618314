# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a body as a scanner and its software would deliver it, as a binary STL.

    python3 make_body.py body.stl [--levels 5] [--noise 0.002] [--seed 1]

The body is star-shaped about the origin: a bumpy ball, cut flat by two planes, with a groove around its back whose sharp edge
fades out into the smooth surface at both ends. Its triangles are as even as a remeshed scan, about 20 * 4^levels; points off
the sharp edges are moved in or out by a random part of the mean edge length (normal distribution, `noise` its width).
"""
import argparse
import pathlib
import struct

import numpy as np

PLANES = [(np.array([1.0, 0, 0]), 0.72), (np.array([0.0, -0.6, 0.8]), 0.8)]  # outer normal, distance


def icosphere(levels):
    t = (1 + 5 ** 0.5) / 2
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t), (t, 0, -1),
              (t, 0, 1), (-t, 0, -1), (-t, 0, 1)]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
                 (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
                 (8, 6, 7), (9, 8, 1)]
    points = [np.array(p) / np.linalg.norm(p) for p in points]
    for _ in range(levels):
        middle, finer = {}, []
        for corner in triangles:
            for a, b in ((corner[0], corner[1]), (corner[1], corner[2]), (corner[2], corner[0])):
                if (min(a, b), max(a, b)) not in middle:
                    middle[min(a, b), max(a, b)] = len(points)
                    p = points[a] + points[b]
                    points.append(p / np.linalg.norm(p))
            a, b, c = corner
            ab, bc, ca = (middle[min(p), max(p)] for p in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return np.array(points), triangles


def turned(points):
    """Away from the axes, so that no edge of the even triangles follows an edge of the body by chance."""
    a, b = 0.3, 0.5
    x = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    return points @ (x @ y).T


def smooth_radius(d):
    return 1 + 0.06 * np.sin(3 * d[..., 0] + 1) * np.cos(2 * d[..., 1]) + 0.04 * np.sin(4 * d[..., 2] - d[..., 0])


def groove(d):
    """Signed height over the edge of the groove, and how deep it is there: nothing where x is over -0.2."""
    return d[..., 2] - 0.1 * d[..., 1], 1.3 * np.clip((-0.2 - d[..., 0]) / 0.4, 0, 1) ** 2


def body_radius(d):
    height, depth = groove(d)
    wide = np.clip(1 - np.maximum(height, 0) / 0.5, 0, 1)  # the groove ends smoothly above
    radius = smooth_radius(d) - depth * np.maximum(height, 0) * wide ** 2
    for normal, distance in PLANES:
        along = d @ normal
        radius = np.minimum(radius, np.where(along > 1e-9, distance / np.maximum(along, 1e-9), np.inf))
    return radius


def switches(d):
    """Functions that change sign where the body has a sharp edge."""
    height, depth = groove(d)
    result = [np.where(depth > 0, height, np.sign(height) * 10)]
    for normal, distance in PLANES:
        result.append(body_radius_without(d, normal) * (d @ normal) - distance)
    return result


def body_radius_without(d, normal):
    height, depth = groove(d)
    wide = np.clip(1 - np.maximum(height, 0) / 0.5, 0, 1)
    radius = smooth_radius(d) - depth * np.maximum(height, 0) * wide ** 2
    for other, distance in PLANES:
        if other is not normal:
            along = d @ other
            radius = np.minimum(radius, np.where(along > 1e-9, distance / np.maximum(along, 1e-9), np.inf))
    return radius


def crossing(a, b, f):
    """The direction between a and b where f is zero."""
    fa = f(a)
    for _ in range(60):
        m = a + b
        m /= np.linalg.norm(m)
        if (f(m) < 0) == (fa < 0):
            a = m
        else:
            b = m
    return m


def align(points, triangles, f, fixed):
    """Moves points near the zero line of f onto it, then splits what still crosses it. `fixed` grows by the points on it."""
    points = [p for p in points]
    value = [float(f(p)) for p in points]
    edges = {(min(a, b), max(a, b)) for t in triangles for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
    best = {}
    for a, b in edges:
        if value[a] * value[b] >= 0:
            continue
        m = crossing(points[a], points[b], f)
        length = np.linalg.norm(points[a] - points[b])
        for n in (a, b):
            part = np.linalg.norm(m - points[n]) / length
            if part < 0.35 and n not in fixed and part < best.get(n, (1, None))[0]:
                best[n] = (part, m)
    for n, (_, m) in best.items():
        points[n], value[n] = m, 0.0
        fixed.add(n)
    on, result = {}, []
    for t in triangles:
        crossed = [(a, b) for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])) if value[a] * value[b] < 0]
        for a, b in crossed:
            key = (min(a, b), max(a, b))
            if key not in on:
                on[key] = len(points)
                points.append(crossing(points[key[0]], points[key[1]], f))
                value.append(0.0)
                fixed.add(on[key])
        if not crossed:
            result.append(t)
            continue
        corner = [n for n in t]
        while not (value[corner[0]] * value[corner[1]] < 0 and (len(crossed) == 1 or value[corner[0]] * value[corner[2]] < 0)):
            corner = corner[1:] + corner[:1]
        a, b, c = corner
        ab = on[min(a, b), max(a, b)]
        if len(crossed) == 1:
            result += [(a, ab, c), (ab, b, c)]
        else:
            ca = on[min(c, a), max(c, a)]
            result += [(a, ab, ca), (ab, b, c), (ab, c, ca)]
    return points, result


def make(levels, noise, seed):
    points, triangles = icosphere(levels)
    points = [p for p in turned(points)]
    fixed = set()
    for i in range(1 + len(PLANES)):
        points, triangles = align(points, triangles, lambda d, i=i: switches(d)[i], fixed)
    d = np.array(points)
    radius = body_radius(d)
    edge = np.sqrt(4 * np.pi / len(triangles) * 2.3)
    move = np.random.default_rng(seed).normal(0, noise * edge, len(d))
    flat = np.zeros(len(d), dtype=bool)
    for normal, distance in PLANES:
        flat |= np.abs(radius * (d @ normal) - distance) < 1e-9
    move[sorted(fixed)] = 0
    move[flat] = 0
    return d * (radius + move)[:, None], triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--levels", type=int, default=5)
    parser.add_argument("--noise", type=float, default=0.002)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    points, triangles = make(options.levels, options.noise, options.seed)
    with open(options.file, "wb") as out:
        out.write(b"a body as from a scanner".ljust(80) + struct.pack("<I", len(triangles)))
        for t in triangles:
            a, b, c = (points[i].astype(np.float32) for i in t)
            normal = np.cross(b - a, c - a)
            out.write(struct.pack("<12fH", *(normal / max(np.linalg.norm(normal), 1e-30)), *a, *b, *c, 0))
    print(f"{len(points)} points, {len(triangles)} triangles -> {options.file}")


if __name__ == "__main__":
    main()
