# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds what pamr-refine says of its map of level 0, before anything is split, against the map's table in the file.

    level0_map.py BIN_FOLDER [--cases NAME,...] [--levels N] [--ranks N]

The map is evaluated as docs/level0-map.md and docs/file-format-level0.md state it, by numpy, with nothing of PAMR's code:
- no Jacobian determinant of the quadratic part, and no mean ratio of it, at the points of a lattice is under the bound that was
  proved, and the bounds are not more than 3 % under the smallest of these; with walls it is at 20 points what was said;
- splitting all bent cells into eight gives the smallest mean ratios that were said of levels 0 to 3; what was said of all levels
  follows from these and from the Jacobian, and no level, down to N, has less; the mesh of the first level has that of level 1.
Exit code 1 where one of these does not hold. Walls may be spheres, cylinders and planes.
"""
import argparse
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import h5py
import numpy as np

import other_bodies
import wall_cases

EDGES = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])  # edge e lies opposite edge 5 - e
FACES = [[k for k in range(4) if k != f] for f in range(4)]


# Walls: signed distance and unit normal at points

class Sphere:
    def __init__(self, text):
        self.center, self.radius = np.array(text["center"], float), text["radius"]

    def distance(self, x):
        r = np.linalg.norm(x - self.center, axis=1)
        return r - self.radius, (x - self.center) / r[:, None]


class Cylinder:
    def __init__(self, text):
        self.point, axis = np.array(text["point"], float), np.array(text["axis"], float)
        self.axis, self.radius = axis / np.linalg.norm(axis), text["radius"]

    def distance(self, x):
        y = x - self.point
        y = y - (y @ self.axis)[:, None] * self.axis
        r = np.linalg.norm(y, axis=1)
        return r - self.radius, y / r[:, None]


class Plane:
    def __init__(self, text):
        normal = np.array(text["normal"], float)
        self.point, self.normal = np.array(text["point"], float), normal / np.linalg.norm(normal)

    def distance(self, x):
        return (x - self.point) @ self.normal, np.broadcast_to(self.normal, x.shape)


class FacePlanes:
    """Of each point its own plane: of the level-0 face without a surface that meets the wall there."""

    def __init__(self, points, normals):
        self.points, self.normals = points, normals / np.linalg.norm(normals, axis=1)[:, None]

    def distance(self, x):
        return ((x - self.points) * self.normals).sum(axis=1), self.normals


KINDS = {"sphere": Sphere, "cylinder": Cylinder, "plane": Plane}


def onto(walls, x):
    """Nearest common points, by Newton steps of least length."""
    for _ in range(1 if len(walls) == 1 else 12):
        pairs = [wall.distance(x) for wall in walls]
        normals, distances = np.stack([n for _, n in pairs], axis=1), np.stack([d for d, _ in pairs], axis=1)
        x = x - np.einsum("nik,nk->ni", np.linalg.pinv(normals), distances)
    return x


# The map

class Map:
    """The table of a file, its corners put so that cells are positive."""

    def __init__(self, path):
        with h5py.File(path) as file:
            table = {name: data[:] for name, data in file["PAMR/level0"].items()}
            patches = [name.decode() for name in file["PAMR/patches/surfaces"][:]]
            walls = {wall["name"]: KINDS[wall["kind"]](wall) for wall in tomllib.loads(file["PAMR/surfaces"][()].decode())["surface"]}
        self.walls = [walls.get(name) for name in patches]
        self.points, self.bulges = table["points"].reshape(-1, 4, 3), table["bulges"].reshape(-1, 6, 3)
        self.face_patches, self.edge_patches = table["face_patches"], table["edge_patches"].reshape(-1, 6, 2)
        self.is_bent = table["flags"][:, 2, None] >> np.arange(4) & 1 == 1
        self.beside, self.is_sharp = table["beside"].reshape(-1, 6, 3), table["flags"][:, 0, None] >> np.arange(6) & 1 == 1
        assert not table["flags"][:, 1].any(), "sharp edges inside a surface are not known here"
        edge = self.points[:, 1:] - self.points[:, :1]
        self.sign = np.sign(np.linalg.det(edge))
        self.volume = abs(np.linalg.det(edge)) / 6

    def quadratic(self, w):
        """Of every cell at weights, one place for all cells (4) or one each (R x 4)."""
        w = np.broadcast_to(w, (len(self.points), 4))
        bend = 4 * w[:, EDGES[:, 0]] * w[:, EDGES[:, 1]]
        return np.einsum("ri,rik->rk", w, self.points) + np.einsum("re,rek->rk", bend, self.bulges)

    def jacobian(self, w):
        """Derivatives by the weights of corners 1, 2, 3, at the cost of corner 0."""
        slope = np.zeros((6, 4))
        slope[np.arange(6), EDGES[:, 0]], slope[np.arange(6), EDGES[:, 1]] = 4 * w[EDGES[:, 1]], 4 * w[EDGES[:, 0]]
        by_weight = self.points + np.einsum("ei,rek->rik", slope, self.bulges)
        return by_weight[:, 1:] - by_weight[:, :1]

    def on_walls(self, patches, x, edge=None):
        """Points moved onto the surfaces of two patches (R x 2); of cells without patches as they are.

        Those of an edge beside a sharp face without a surface stay in the plane of that face.
        """
        result = x.copy()
        is_sharp = np.zeros(len(x), bool) if edge is None else self.is_sharp[:, edge]
        for pair in {tuple(p) for p in patches if p[0] >= 0}:
            walls = [w for w in dict.fromkeys(self.walls[p] for p in dict.fromkeys(pair)) if w is not None]
            for sharp in (False, True):
                here = (patches == pair).all(axis=1) & (is_sharp == sharp)
                planes = [FacePlanes(self.points[here, EDGES[edge, 0]], self.beside[here, edge])] if sharp and here.any() else []
                result[here] = onto(walls + planes, x[here])
        return result

    def to_bounds(self, w, f):
        """What the edges of face f between two patches want beyond the quadratic part at weights within the face (C of the page)."""
        wanted = np.zeros((len(self.points), 3))
        for e in range(6):
            a, b = EDGES[e]
            if f in (a, b) or w[a] == 0 or w[b] == 0 or w[a] + w[b] <= 0:
                continue
            patches = self.edge_patches[:, e]
            part = np.zeros(4)
            part[[a, b]] = w[[a, b]] / (w[a] + w[b])
            y = self.quadratic(part)
            is_end = patches[:, :1] != patches[:, 1:]
            wanted += np.where(is_end, (w[a] + w[b]) ** 2 * (self.on_walls(patches, y, e) - y), 0.0)
        return wanted

    def residual(self, w):
        """What walls add at weights, which may lie outside of the cells; faces and edges in walls with these corners count."""
        support = {i for i in range(4) if w[i] != 0}
        faces = [f for f in range(4) if set(FACES[f]) <= support]
        in_wall = [(FACES[f], np.stack([self.face_patches[:, f]] * 2, axis=1), 1.0, f, None) for f in faces]
        for e in range(6):
            if set(EDGES[e]) <= support:
                n_faces = sum((self.face_patches[:, f] >= 0).astype(float) for f in faces if set(EDGES[e]) <= set(FACES[f]))
                in_wall.append((list(EDGES[e]), self.edge_patches[:, e], 1 - n_faces, None, e))
        residual = np.zeros((len(self.points), 3))
        for corners, patches, factor, face, edge in in_wall:
            share = w[corners].sum()
            if share <= 0:
                continue
            part = np.zeros(4)
            part[corners] = w[corners] / share
            y = self.quadratic(part)
            from_ = y if face is None else y + self.to_bounds(part, face)
            residual += np.where(patches[:, 0] >= 0, factor * share**2, 0.0)[:, None] * (self.on_walls(patches, from_, edge) - y)
        return residual

    def place(self, w):
        """Where all cells put the node at these weights."""
        support = [i for i in range(4) if w[i] > 0]
        x = self.quadratic(w)
        mapped = x + self.residual(w)
        if len(support) in (2, 3):  # of a face or an edge in a wall: just onto the wall
            edge, from_ = EDGES.tolist().index(support) if len(support) == 2 else None, x
            own = None if edge is None else self.edge_patches[:, edge]
            if edge is None:
                face = 6 - sum(support)
                own, from_ = np.stack([self.face_patches[:, face]] * 2, axis=1), x + self.to_bounds(w, face)
            mapped = np.where(own[:, :1] >= 0, self.on_walls(own, from_, edge), mapped)
        straight = np.einsum("i,rik->rk", w, self.points)
        return np.where(self.is_bent[:, support].any(axis=1)[:, None], mapped, straight)

    def images(self, w, step=1e-5):
        """The tetrahedra that the Jacobian at weights makes of the reference tetrahedron, walls included."""
        rows = self.jacobian(w)
        unit = np.eye(4)
        if max(w) == 1:
            here = int(np.argmax(w))
            def ahead(i, n):
                return self.residual(w + n * step * (unit[i] - unit[here]))

            # nodes of level 0 that are off their wall make a step at the corner itself
            slopes = [(8 * ahead(i, 2) - 5 * ahead(i, 1) - 3 * ahead(i, 3)) / (2 * step) if i != here else np.zeros((len(rows), 3))
                      for i in range(4)]
            added = [slopes[i] - slopes[0] for i in (1, 2, 3)]
        else:
            def slopes_at(w):
                return np.stack([(self.residual(w + step * (unit[i] - unit[0])) - self.residual(w - step * (unit[i] - unit[0]))) /
                                 (2 * step) for i in (1, 2, 3)])

            ends = (self.edge_patches[..., 0] != self.edge_patches[..., 1]).any(axis=1)  # where walls end both steps lie inside
            added = np.where(ends[:, None], slopes_at(w + 1e-3 * (0.25 - w)), slopes_at(w))
        return np.concatenate([np.zeros_like(rows[:, :1]), rows + np.stack(added, axis=1)], axis=1)


def mean_ratio(p, sign=1.0):
    """Of tetrahedra (... x 4 x 3); negative where they are inverted."""
    edge = p[..., 1:, :] - p[..., :1, :]
    volume = np.linalg.det(edge) / 6 * sign
    squares = sum(((p[..., a, :] - p[..., b, :]) ** 2).sum(axis=-1) for a, b in EDGES)
    return np.sign(volume) * 12 * (3 * abs(volume)) ** (2 / 3) / squares


def lattice(n):
    return [w for w in itertools.product(range(n + 1), repeat=4) if sum(w) == n]


def smallest_of_jacobian(level0, n=16):
    """Smallest determinant over the straight cell's, and mean ratio, at the points of a lattice."""
    determinant, ratio = np.inf, np.inf
    for w in lattice(n):
        rows = level0.jacobian(np.array(w) / n)
        determinant = min(determinant, (np.linalg.det(rows) * level0.sign / (6 * level0.volume)).min())
        cells = np.concatenate([np.zeros_like(rows[:, :1]), rows], axis=1)
        ratio = min(ratio, mean_ratio(cells, level0.sign).min())
    return determinant, ratio


# Splitting into eight

RINGS = [(a, b, 5 - a, 5 - b) for a, b in ((1, 2), (0, 2), (0, 1))]  # the edges that diagonal d, from edge d to 5 - d, does not join


def inner_cells(d):
    ring = RINGS[d]
    return [(4 + d, 9 - d, 4 + ring[k], 4 + ring[(k + 1) % 4]) for k in range(4)]


CORNER_CELLS = [[i] + [4 + e for e in range(6) if i in EDGES[e]] for i in range(4)]


def ends_in_order(x, d):
    return sorted((tuple(x[4 + d]), tuple(x[9 - d])))


def choose_diagonals(x, ratios):
    """Of cells by their ten points (N x 10 x 3); `ratios`: of the four inner cells at each diagonal (N x 3 x 4)."""
    tie = 2.0**-40
    length = np.stack([((x[:, 4 + d] - x[:, 9 - d]) ** 2).sum(axis=1) for d in range(3)], axis=1)
    worst = np.sign(ratios.min(axis=2)) * abs(ratios.min(axis=2)) ** 3
    allowed = worst > 0
    allowed[~allowed.any(axis=1)] = True
    allowed &= length <= (1 + tie) * np.where(allowed, length, np.inf).min(axis=1)[:, None]
    tied = allowed.sum(axis=1) > 1
    best = np.where(allowed, worst, -np.inf).max(axis=1)
    allowed[tied] &= (worst >= (best - 3 * tie * abs(best))[:, None])[tied]
    chosen = allowed.argmax(axis=1)
    for n in np.nonzero(allowed.sum(axis=1) > 1)[0]:
        chosen[n] = min(np.nonzero(allowed[n])[0], key=lambda d: ends_in_order(x[n], d))
    return chosen


def smallest_by_level(level0, n_levels):
    """Of each bent cell the smallest mean ratio of itself and of all that splitting it into eight gives, level by level."""
    n = 2**n_levels
    number = np.full((n + 1,) * 3, -1)
    places = lattice(n)
    point = np.empty((len(level0.points), len(places), 3))
    for k, w in enumerate(places):
        number[w[:3]] = k
        point[:, k] = level0.place(np.array(w) / n)
    worst = np.full((1 + n_levels, len(level0.points)), np.inf)
    worst[0] = mean_ratio(level0.points, level0.sign)
    for row in range(len(level0.points)):
        cells = (n * np.eye(4, dtype=int))[None]
        for level in range(n_levels):
            middle = (cells[:, EDGES[:, 0]] + cells[:, EDGES[:, 1]]) // 2
            node = np.concatenate([cells, middle], axis=1)
            x = point[row, number[node[..., 0], node[..., 1], node[..., 2]]]

            def ratio(codes):
                sign = np.sign(np.linalg.det(node[:, codes].astype(float))) * level0.sign[row]
                return mean_ratio(x[:, codes], sign)

            of_inner = np.stack([np.stack([ratio(c) for c in inner_cells(d)], axis=1) for d in range(3)], axis=1)
            chosen = choose_diagonals(x, of_inner)
            worst[level + 1, row] = min(ratio(CORNER_CELLS).min(), of_inner[np.arange(len(x)), chosen].min())
            children = np.array([CORNER_CELLS + inner_cells(d) for d in range(3)])[chosen]
            cells = np.take_along_axis(node[:, None], children[..., None], axis=2).reshape(-1, 4, 4)
    return worst


def smallest_of_straight(cells, known, n_levels=8):
    """The smallest mean ratio that splitting straight cells into eight ever gives, if it is under one that is known.

    None has less than 3/4 of the cell's. Children at corners have its shape, and of the inner ones two times two the same.
    """
    for _ in range(n_levels):
        ratios = abs(mean_ratio(cells))
        known = min([known, *ratios])
        cells = cells[0.75 * ratios < known]
        if len(cells) == 0:
            break
        x = np.concatenate([cells, (cells[:, EDGES[:, 0]] + cells[:, EDGES[:, 1]]) / 2], axis=1)
        of_inner = np.stack([np.stack([abs(mean_ratio(x[:, c])) for c in inner_cells(d)], axis=1) for d in range(3)], axis=1)
        children = np.array([inner_cells(d)[:2] for d in range(3)])[choose_diagonals(x, of_inner)]
        cells = np.take_along_axis(x[:, None], children[..., None], axis=2).reshape(-1, 4, 3)
    return known


# Meshes

def by_pamr(name, size):
    def make(call, path):
        case = path.with_suffix(".toml")
        case.write_text(wall_cases.CASES[name](size, "pamr").case_file)
        call("pamr-mesh", case, "-o", path, "--force", "--quiet")

    return make


def by_cells(name):
    return lambda call, path: other_bodies.make(call, other_bodies.BODIES[name](None), path.parent)


CASES = {"hole of 12": by_cells("hole-of-12"), "hole of 42": by_cells("hole-of-42"), "bore of 8": by_cells("bore-of-8"),
         "bore of 6": by_cells("bore-of-6"), "bore of 9": by_cells("bore-of-9"), "ball in box 2.0": by_pamr("ball-in-box", 2.0),
         "ball in box 0.8": by_pamr("ball-in-box", 0.8), "bored box 1.6": by_pamr("bored-box", 1.6)}


def check(call, name, folder, n_levels):
    """A row of the table, and what does not hold."""
    level0, marked, level1 = (folder / f"{word}.hdf" for word in ("level0", "marked", "level1"))
    CASES[name](call, level0)
    call("pamr-mark", level0, "-o", marked, "--all", "--force", "--quiet")
    shapes = json.loads(call("pamr-refine", marked, "-o", level1, "--force", "--quiet", "--json", "-"))["level0"]["shapes"]
    table = Map(level1)
    determinant, ratio = smallest_of_jacobian(table)
    images = np.stack([table.images(np.array(w) / 3) for w in lattice(3)])
    with_walls = mean_ratio(images, table.sign).min()
    by_cell = smallest_by_level(table, n_levels)
    levels = by_cell.min(axis=1)
    of_all = min(levels[:4].min(), (by_cell[3] - np.maximum(0, by_cell[2] - by_cell[3])).min())
    of_all = smallest_of_straight(images.reshape(-1, 4, 3), of_all) if with_walls > 0 else with_walls
    with h5py.File(level1) as file:
        cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)[file["VTKHDF/CellData/level0_cell"][:] >= 0]
        in_file = mean_ratio(file["VTKHDF/Points"][:][cells]).min()

    faults = []

    def expect(holds, what):
        if not holds:
            faults.append(f"{name}: {what}")

    for key, sampled in (("determinant", determinant), ("mean_ratio", ratio)):
        said = shapes[key]["value"]
        expect(said <= sampled, f"{key} {said} was proved, found {sampled}")
        expect(said >= 0.97 * sampled, f"{key} {said} was proved, far under {sampled}")
    for level, (said, found) in enumerate(zip(shapes["split"], levels)):
        expect(abs(said - found) < 1e-9, f"level {level} of splitting into eight: {said} was said, found {found}")
    said, bound = shapes["sampled"]["value"], shapes["all_splits"]["value"]
    expect(abs(said - with_walls) < 1e-5, f"mean ratio {said} was said with walls, found {with_walls}")
    expect(abs(bound - of_all) < 1e-5, f"{bound} was said of all levels, found {of_all}")
    expect(min(levels) >= bound - 1e-9, f"{bound} was said of all levels, found {levels}")
    expect(abs(in_file - levels[1]) < 1e-9, f"the mesh of level 1 has {in_file}, the map gives {levels[1]}")
    row = [len(table.points), shapes["determinant"]["value"], determinant, shapes["mean_ratio"]["value"], ratio, with_walls, bound, *levels]
    return [name, *row], faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--levels", type=int, default=4)
    parser.add_argument("--ranks", type=int, default=1)
    options = parser.parse_args()
    launcher = ["mpirun", "-n", str(options.ranks)] if options.ranks > 1 else []

    def call(tool, *words):
        return subprocess.run([*launcher, options.bin / tool, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True).stdout

    faults = []
    head = ("mesh", "bent cells", "determinant: proved", "sampled", "mean ratio: proved", "sampled", "with walls", "all levels",
            *(f"level {level}" for level in range(options.levels + 1)))
    print(f"| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for name in options.cases.split(","):
        with tempfile.TemporaryDirectory() as folder:
            row, found = check(call, name, pathlib.Path(folder), options.levels)
        print(f"| {' | '.join(v if isinstance(v, str) else f'{v:,}' if isinstance(v, int) else f'{v:.4f}' for v in row)} |", flush=True)
        faults += found
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
