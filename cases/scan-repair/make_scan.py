# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a damaged scan of a ring (a torus of radii 1 and 0.4 about z), as a binary STL.

    python3 make_scan.py scan.stl [--points 240] [--noise 0.01] [--seed 1]

The ring has 2 * points * points / 2.5 triangles, turned so that no line of them follows an axis. Its points are moved along
the normal by a random part of the mean edge (normal distribution, `noise` its width); then come the defects that scanners
and the programs behind them leave: holes, triangles turned over, triangles twice, a fin on an edge, crumbs beside the body,
a point that was pulled through its neighbors, and edges that do not meet to the last bit.
"""
import argparse
import pathlib
import struct

import numpy as np

MAJOR, MINOR = 1.0, 0.4
VOLUME, AREA = 2 * np.pi ** 2 * MAJOR * MINOR ** 2, 4 * np.pi ** 2 * MAJOR * MINOR
HOLES = [(0.3, 1.0, 0.09), (1.9, 4.0, 0.12), (3.4, 2.2, 0.05), (5.0, 5.6, 0.15)]  # angles of their centers, radius


def on_ring(u, v, r=MINOR):
    return np.stack([(MAJOR + r * np.cos(v)) * np.cos(u), (MAJOR + r * np.cos(v)) * np.sin(u), r * np.sin(v)], axis=-1)


def distance_from_ring(points):
    """Signed distance from the ring, positive outside."""
    return np.hypot(np.hypot(points[:, 0], points[:, 1]) - MAJOR, points[:, 2]) - MINOR


def ring(n):
    m = int(n / 2.5)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    u, v = 2 * np.pi * (i + 0.37 * j / m) / n, 2 * np.pi * (j + 0.5 * (i % 2)) / m
    at = lambda a, b: (a % n) * m + b % m
    up = np.where(i % 2 == 0, 0, 1)  # every other row is shifted by half an edge
    one = np.stack([at(i, j), at(i + 1, j - 1 + up), at(i + 1, j + up)], axis=1)
    other = np.stack([at(i, j), at(i + 1, j + up), at(i, j + 1)], axis=1)
    return u, v, np.concatenate([one, other])


def make(n, noise, seed):
    random = np.random.default_rng(seed)
    u, v, triangles = ring(n)
    edge = np.sqrt(4 / np.sqrt(3) * AREA / len(triangles))
    points = on_ring(u, v, MINOR + random.normal(0, noise * edge, len(u)))
    middle = points[triangles].mean(axis=1)
    keep = np.ones(len(triangles), dtype=bool)
    for a, b, radius in HOLES:
        keep &= np.linalg.norm(middle - on_ring(np.array(a), np.array(b)), axis=1) > radius
    triangles = triangles[keep]
    pulled = triangles[len(triangles) // 3, 0]
    normal = on_ring(u, v, 1 + MINOR) - on_ring(u, v, MINOR)
    along = np.cross(normal[pulled], [0, 0, 1])
    points[pulled] += 3.5 * edge * along / np.linalg.norm(along)
    turned = random.choice(len(triangles), 60, replace=False)
    triangles[turned] = triangles[turned][:, ::-1]
    corners = points[triangles]
    twice = corners[random.choice(len(corners), 40, replace=False)]
    a, b = corners[1000, 0], corners[1000, 1]
    fin = [np.stack([a, b, 1.1 * (a + b) / 2 + [0, 0, 0.05]])]
    crumbs = [np.array([1.6, 0.1 * k, 0.3]) + 0.01 * random.normal(size=(3, 3)) for k in range(5)]
    corners = np.concatenate([corners, twice, fin, crumbs])
    return corners + 1e-8 * random.normal(size=corners.shape)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--points", type=int, default=240)
    parser.add_argument("--noise", type=float, default=0.01)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    corners = make(options.points, options.noise, options.seed).astype(np.float32)
    with open(options.file, "wb") as out:
        out.write(b"a damaged scan of a ring".ljust(80) + struct.pack("<I", len(corners)))
        rows = np.zeros(len(corners), dtype=[("f", "<f4", 12), ("n", "<u2")])
        rows["f"][:, 3:] = corners.reshape(-1, 9)
        out.write(rows.tobytes())
    print(f"{len(corners)} triangles -> {options.file}")


if __name__ == "__main__":
    main()
