# SPDX-License-Identifier: GPL-3.0-or-later
"""As assess.hpp, for codes that speak Python: whether a code has done the work that it was given."""

import itertools

import numpy as np

FRONT_START, FRONT_SHIFT, FRONT_RADIUS = 0.4, 0.01, 0.3  # the sphere that moves along x
HOLE_RADIUS, HOLE_BOX = 1.0, 2.0  # a ball about the origin is cut out of a box
ON_WALL = (
    1 + 1e-6
)  # times the radius: the nodes of the wall of the hole are nearer, those of a facet are inside the ball
MAX_CELLS_FOR_FACES = 3_000_000  # of larger meshes the faces are not looked at
FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))
SLAB = 1 << 18


def volumes(p):
    return np.abs(np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0])) / 6


def mean_ratios(p):
    """12 (3V)^(2/3) / sum of squared edges, 1 for a regular tetrahedron."""
    squares = sum(((p[:, b] - p[:, a]) ** 2).sum(axis=1) for a, b in itertools.combinations(range(4), 2))
    return 12 * (3 * volumes(p)) ** (2 / 3) / squares


def longest_edges(p):
    return np.sqrt(
        np.max([((p[:, b] - p[:, a]) ** 2).sum(axis=1) for a, b in itertools.combinations(range(4), 2)], axis=0)
    )


def slabs(corners):
    for begin in range(0, len(corners), SLAB):
        yield corners[begin : begin + SLAB]


def keys_of(points):
    """A number for each point (... x 3), the same for the same coordinates only."""
    bits = (np.ascontiguousarray(points, dtype=float) + 0.0).view(np.uint64)  # -0 becomes 0
    key = np.full(points.shape[:-1], 0x9E3779B97F4A7C15, dtype=np.uint64)
    shift = np.uint64(33)
    for axis in range(3):
        key ^= bits[..., axis]
        for factor in (0xFF51AFD7ED558CCD, 0xC4CEB9FE1A85EC53):
            key = (key ^ (key >> shift)) * np.uint64(factor)
        key ^= key >> shift
    return key


def domain_of(mesh_name):
    return "cube" if mesh_name.startswith("kuhn:") else "hole" if "hole" in mesh_name else None


def is_outer(faces, domain):
    """Whether faces (n x 3 x 3) lie on the boundary."""
    outer = np.zeros(len(faces), dtype=bool)
    for side in (0.0, 1.0) if domain == "cube" else (-HOLE_BOX, HOLE_BOX):
        outer |= (np.abs(faces - side) < 1e-9).all(axis=1).any(axis=1)
    if domain == "hole":
        outer |= (np.linalg.norm(faces, axis=2) <= ON_WALL * HOLE_RADIUS).all(axis=1)
    return outer


def open_faces(corners, domain):
    """Faces of one cell that are not of the boundary; those of more than two cells count too. A face with all nodes on
    a curved wall may be an inner one."""
    keys, outer = [], []
    for p in slabs(corners):
        node_keys = keys_of(p)
        for face in FACES:
            keys.append(node_keys[:, face].sum(axis=1, dtype=np.uint64))
            outer.append(is_outer(p[:, face], domain))
    _, first, count = np.unique(np.concatenate(keys), return_index=True, return_counts=True)
    return int((~((count == 2) | (count == 1) & np.concatenate(outer)[first])).sum())


def assess_wall(corners):
    """Nodes of the wall of the hole, those off it, and the farthest distance."""
    radius, keys = [], []
    for p in slabs(corners):
        r = np.linalg.norm(p, axis=2)
        near = r <= ON_WALL * HOLE_RADIUS
        radius.append(r[near])
        keys.append(keys_of(p[near]))
    _, first = np.unique(np.concatenate(keys), return_index=True)
    off = np.abs(np.concatenate(radius)[first] - HOLE_RADIUS)
    return {"wall_nodes": len(off), "off": int((off > 1e-9).sum()), "farthest": float(off.max(initial=0))}


def assess(corners, domain, cells_before):
    """Facts about a mesh from the corners of its cells (n x 4 x 3), and the keys of its cells, sorted, for the
    next call; `cells_before`: those of the mesh before, or None."""
    ratios = np.sort(np.concatenate([mean_ratios(p) for p in slabs(corners)]))
    cells = np.sort(np.concatenate([keys_of(p).sum(axis=1, dtype=np.uint64) for p in slabs(corners)]))
    values = {
        "volume": float(sum(volumes(p).sum() for p in slabs(corners))),
        "worst": float(ratios[0]),
        "low": float(ratios[len(ratios) // 1000]),
        "mean": float(ratios.mean()),
        "split": -1,
        "open": -1,
        "wall_nodes": -1,
        "off": -1,
        "farthest": 0.0,
    }
    if cells_before is not None:
        values["split"] = int((~np.isin(cells_before, cells, assume_unique=True)).sum())
    if domain and len(corners) <= MAX_CELLS_FOR_FACES:
        values["open"] = open_faces(corners, domain)
    if domain == "hole":
        values.update(assess_wall(corners))
    return values, cells
