# SPDX-License-Identifier: GPL-3.0-or-later
"""Refines bodies at their curved walls, level by level, and tabulates what became of the walls.

    curved_walls.py BIN_FOLDER [--cases NAME,...] [--sizes H,...] [--mesher pamr|gmsh] [--repair] [--levels N] [--max-cells N]
                    [--layers N] [--ranks N] [--keep DIR]
    curved_walls.py BIN_FOLDER --others [NAME,...] [--sizes H,...] [--repair] [--seeds N] [--policy NAME] [--levels N]
                    [--shape-floor TAU] [--max-cells N] [--keep DIR]

A row a body and size: cells of the last level, the smallest mean ratio of each level, closure families that were kept, nodes that
are off their surface, errors of area and volume at the last level with their orders. Exit code 1 when a cell is inverted, a
flagged cell is not split, or a node on a sharp edge is off it.

With --others: bodies of other_bodies.py under random marks and marks at the wall, in memory by the Python package beside BIN_FOLDER, two rows a
body and size. h/R is that of the longest edge for how it is curved, the bound the smallest mean ratio at level 0 and after splitting
everything into eight, three times. Exit code 1 where a cell is inverted, other ranks give other bytes, coarsening does not give level 0
back, or, for h/R up to 1.05, a shape misses its bar, a node is off its surface or a family is kept.
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "tools/picture"))
from tet import FACE_TO_CORNER  # noqa: E402

import other_bodies
import wall_cases

HEAD = ("body", "h/R", "level", "cells", "smallest mean ratio, levels 0, 1, ...", "kept", "off", "area error", "order",
        "volume error", "order")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--cases", default=",".join([*wall_cases.CASES, "blunt-cone"]))
    parser.add_argument("--sizes", default="0.4,0.8,1.2,1.6,2.0", help="edges at the wall / smallest radius of curvature")
    parser.add_argument("--mesher", choices=("pamr", "gmsh"), default="pamr")
    parser.add_argument("--repair", action="store_true", help="split what would flatten cells at walls (pamr-convert)")
    parser.add_argument("--levels", type=int, default=4)
    parser.add_argument("--max-cells", type=int, default=600_000, help="no level with more")
    parser.add_argument("--layers", type=int, default=1, help="layers of cells that are split at the wall")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--others", nargs="?", const="all", help="bodies of other_bodies.py")
    parser.add_argument("--seeds", type=int, default=4, help="of --others: of random marks, a fifth of all cells at each level")
    parser.add_argument("--policy", choices=("removable", "isotropic", "short-edge", "none"), default="removable", help="of --others")
    parser.add_argument("--shape-floor", type=float, default=0.35, help="of --others")
    parser.add_argument("--keep", type=pathlib.Path, help="leave the meshes in this folder")
    return parser.parse_args()


def caller(options):
    """Runs a tool and gives back what it prints."""
    launcher = ["mpirun", "-n", str(options.ranks)] if options.ranks > 1 else []

    def call(tool, *words):
        command = [*launcher, str(options.bin / tool), *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip() or done.returncode}")
        return done.stdout

    return call


def make_level_0(call, name, size, mesher, folder, repair=False):
    mesh = folder / "level0.hdf"
    if name == "blunt-cone":
        call("pamr-mesh", "--shape", "blunt-cone", "-o", mesh, "--force", "--quiet")
        walls = ["forebody", "base", "sting"]
        with h5py.File(mesh) as file:
            normal = wall_cases.normals_of_file(file["PAMR/surfaces"][()].decode(), {wall: "body" for wall in walls})
        return wall_cases.Case(walls, normal=normal), mesh
    case = wall_cases.CASES[name](size, mesher)
    if case.geo:
        (folder / "body.geo").write_text(case.geo)
        (folder / "body.toml").write_text(case.surfaces)
        other_bodies.run_gmsh(folder, "gmsh.open('body.geo')")
        call("pamr-convert", folder / "body.msh", mesh, "--surfaces", folder / "body.toml", "--force", "--quiet",
             "--repair" if repair else "--no-repair")
    else:
        (folder / "case.toml").write_text(case.case_file)
        made = folder / "made.hdf" if repair else mesh
        call("pamr-mesh", folder / "case.toml", "-o", made, "--force", "--quiet")
        if repair:
            call("pamr-convert", made, mesh, "--repair", "--force", "--quiet")
    return case, mesh


def points_of_file(path):
    with h5py.File(path) as file:
        return file["VTKHDF/Points"][:]


class Walls:
    """Faces of the patches of a mesh."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.points = file["VTKHDF/Points"][:]
            cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
            neighbors = file["PAMR/cell_to_cell"][:]
            self.names = [n.decode() for n in file["PAMR/patches/names"][:]]
        cell, slot = np.nonzero(neighbors < 0)
        self.faces = cells[cell[:, None], FACE_TO_CORNER[slot]]
        self.patch = -1 - neighbors[cell, slot]

    def faces_of(self, name):
        return self.faces[self.patch == self.names.index(name)]

    def nodes_of(self, names):
        return np.unique(np.concatenate([self.faces_of(n).ravel() for n in names]))

    def normals_off(self, name, normal):
        """Largest angle in degrees between a face and the exact normal at its centroid, whatever its sense."""
        p = self.points[self.faces_of(name)]
        n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        n /= np.linalg.norm(n, axis=1)[:, None]
        exact = normal(p.mean(axis=1))
        return np.degrees(np.arcsin(np.clip(np.linalg.norm(np.cross(n, exact), axis=1), 0, 1))).max()

    def off_edges(self, sharp):
        """Largest distance of the nodes that two patches share from the sharp edge between them."""
        worst = 0.0
        for a, b, distance in sharp:
            shared = np.intersect1d(self.nodes_of([a]), self.nodes_of([b]))
            worst = max(worst, distance(self.points[shared]).max())
        return worst


def order(before, now):
    return math.log2(before / now) if before > 0 and now > 0 else math.nan


def shown(value):
    if isinstance(value, str):
        return value
    if isinstance(value, int):
        return f"{value:,}"
    return "-" if math.isnan(value) else f"{value:.2f}" if 0.1 <= abs(value) < 100 else f"{value:.1e}" if value else "0"


def measure(call, case, mesh):
    quality = json.loads(call("pamr-quality", mesh, "--json", "-", "--quiet"))
    walls = Walls(mesh)
    patches = [quality["patches"][n] for n in case.walls]
    row = {"cells": quality["cells"], "wall nodes": len(walls.nodes_of(case.walls)),
           "off": max(quality["ledger"]["nodes"], max(p["off_surface_nodes"] for p in patches)),
           "worst distance": max(p["worst_distance"] for p in patches), "smallest mean ratio": quality["mean_ratio"]["min"],
           "area error": math.nan, "volume error": math.nan, "normals off by": math.nan, "inverted": quality["inverted_cells"],
           "valid": quality["valid"], "edge": walls.off_edges(case.sharp)}
    if case.area:
        row["area error"] = max(abs(quality["patches"][n]["area"] / exact - 1) for n, exact in case.area.items())
        row["volume error"] = abs(quality["volume"] / case.volume - 1)
    if case.normal:
        row["normals off by"] = max(walls.normals_off(n, f) for n, f in case.normal.items())
    return row


def mark(call, case, mesh, folder, layers=1):
    """The file with the marks, and the cells that refining it will give."""
    marks = folder / "marks.hdf"
    flags = [word for name in case.walls for word in ("--patch", name)] + ["--layers", layers]
    report = json.loads(call("pamr-mark", mesh, "-o", marks, *flags, "--force", "--json", "-", "--quiet"))
    return marks, report["cells_after"]


def refine(call, marks, folder, level):
    fine = folder / f"level{level}.hdf"
    report = json.loads(call("pamr-refine", marks, "-o", fine, "--force", "--json", "-", "--quiet"))
    marks.unlink()
    return report, fine


def shape_of_splitting_all(call, mesh, folder, levels=2):
    """The smallest mean ratio of a mesh and of its descendants where every cell is split into eight."""
    smallest = []
    for level in range(levels + 1):
        smallest.append(json.loads(call("pamr-quality", mesh, "--json", "-", "--quiet"))["mean_ratio"]["min"])
        if level < levels:
            call("pamr-mark", mesh, "-o", folder / "all.hdf", "--all", "--force", "--quiet")
            mesh = folder / f"all{level + 1}.hdf"
            call("pamr-refine", folder / "all.hdf", "-o", mesh, "--force", "--quiet")
    return min(smallest)


def run(options, name, size, folder):
    """Prints the row of one body; true when nothing was broken."""
    call, sound, kept, level = caller(options), True, 0, 0
    case, mesh = make_level_0(call, name, size, options.mesher, folder, options.repair)
    rows = [measure(call, case, mesh)]
    for level in range(1, options.levels + 1):
        marks, n_cells = mark(call, case, mesh, folder, options.layers)
        if n_cells > options.max_cells:
            break
        report, fine = refine(call, marks, folder, level)
        if options.keep is None:
            mesh.unlink()
        mesh = fine
        rows.append(measure(call, case, mesh))
        kept += report["families_kept"]
        sound = sound and report["marked_not_split"] == 0
    sound = sound and all(row["inverted"] == 0 and row["valid"] and row["edge"] <= 1e-12 for row in rows)
    last, before = rows[-1], rows[-2] if len(rows) > 1 else {}
    cells = [name, size or "-", len(rows) - 1, last["cells"], ", ".join(f"{row['smallest mean ratio']:.3f}" for row in rows), kept,
             max(row["off"] for row in rows)]
    for key in ("area error", "volume error"):
        cells += [last[key], order(before.get(key, math.nan), last[key])]
    print("| " + " | ".join(shown(c) for c in cells) + " |", flush=True)
    return sound


def shape_bar(h, bound):
    """What the smallest mean ratio must reach at every level, by edges over the radius and what splitting everything gives."""
    return min(0.29, 0.95 * bound) if h <= 0.8 else min(0.24, 0.9 * bound)


def mean_ratios(mesh):
    p = mesh.points[mesh.cells]
    volume = np.linalg.det(p[:, 1:] - p[:, :1]) / 6
    edges = sum(((p[:, i] - p[:, j])**2).sum(axis=1) for i in range(4) for j in range(i))
    return np.sign(volume) * 12 * (3 * np.abs(volume))**(2 / 3) / edges


def curved_patches(mesh):
    """By number, those on a surface whose nodes lie in no plane."""
    faces, curved = mesh.boundary_faces(), []
    for p, name in enumerate(mesh.patches):
        x = mesh.points[np.unique(faces.nodes[faces.patches == p])]
        if name in mesh.surfaces and np.linalg.svd(x - x.mean(axis=0), compute_uv=False)[-1] > 1e-6 * np.ptp(x):
            curved.append(p)
    return curved


def largest_edge(mesh, fine):
    """Of the edges in curved walls, over their radius of curvature: eight times the distance of the new node over the length."""
    if "level0_key" not in fine.node_fields:
        return 0.0
    faces = mesh.boundary_faces()
    triangles = np.sort(mesh.node_numbers[faces.nodes[np.isin(faces.patches, curved_patches(mesh))]], axis=1)
    point = dict(zip(mesh.node_numbers.tolist(), mesh.points))
    edges = {tuple(edge) for edge in np.concatenate([triangles[:, k] for k in ([0, 1], [0, 2], [1, 2])]).tolist()}
    key = fine.node_fields["level0_key"]
    middles = np.flatnonzero((key[:, 1] >= 0) & (key[:, 2] < 0))
    ends = {tuple(sorted(key[i, :2].tolist())): i for i in middles}
    return max(8 * np.linalg.norm(fine.points[ends[a, b]] - (point[a] + point[b]) / 2) / np.linalg.norm(point[a] - point[b])
               for a, b in edges if (a, b) in ends)


def is_undone(pamr, mesh, first):
    """Whether coarsening gives level 0 back, bit for bit but for nodes that refining moved because they were off their surface."""
    for _ in range(16):
        if mesh.n_cells == first.n_cells:
            break
        mesh = pamr.adapt(mesh, np.full(len(mesh.cells), -1)).mesh
    stays = first.node_fields["off_surface"] == 0 if "off_surface" in first.node_fields else slice(None)
    return (all(np.array_equal(getattr(mesh, name), getattr(first, name)) for name in ("cells", "cell_to_cell", "levels"))
            and np.array_equal(mesh.points[stays], first.points[stays]) and "level0_key" not in mesh.node_fields)


def same_on_ranks(options, first, folder):
    """Whether 1 and 3 ranks write the same bytes after two levels of random marks."""
    rng = np.random.default_rng(0)
    for level in range(2):
        first.cell_fields["refine"] = (rng.random(first.n_cells) < 0.2).astype(np.int8)
        first.write(folder / "marked.hdf")
        for ranks in (1, 3):
            command = ["mpirun", "-n", str(ranks), str(options.bin / "pamr-refine"), "marked.hdf", "-o", f"on{ranks}.hdf", "--force", "--quiet"]
            subprocess.run(command, cwd=folder, env=dict(os.environ), check=True, capture_output=True)  # without what MPI adds here
        if (folder / "on1.hdf").read_bytes() != (folder / "on3.hdf").read_bytes():
            return False
        first = type(first).read(first.comm, folder / "on1.hdf")
    return True


def run_other(options, pamr, comm, name, size, folder):
    """Prints the rows of one body; true where nothing was broken."""
    call, how = caller(options), {"quality_control": options.policy, "shape_floor": options.shape_floor}
    first = pamr.Mesh.read(comm, other_bodies.make(call, other_bodies.BODIES[name](size), folder, options.repair))
    bound, mesh = mean_ratios(first).min(), first
    start, walls = bound, [-1 - p for p in curved_patches(first)]
    for level in range(3):
        if level and mesh.n_cells > options.max_cells / 2:
            break
        mesh = pamr.refine(mesh, np.ones(mesh.n_cells, bool)).mesh
        bound = min(bound, mean_ratios(mesh).min())
        h = h if level else largest_edge(first, mesh)
    sound = True
    for marks, seeds in (("random", range(options.seeds)), ("wall", [0])):
        began, faults, smallest, most = time.process_time(), np.zeros(3, int), [1.0] * options.levels, 0
        for seed in seeds:
            rng, mesh = np.random.default_rng(seed), first
            for level in range(options.levels):
                flags = rng.random(mesh.n_cells) < 0.2 if marks == "random" else np.isin(mesh.cell_to_cell, walls).any(axis=1)
                result = pamr.refine(mesh, flags, **how)
                mesh, said = result.mesh, result.report
                smallest[level] = min(smallest[level], mean_ratios(mesh).min())
                faults += [said["off_surface_nodes"], said["families_kept"], 0]
                if mesh.n_cells > options.max_cells:
                    break
            faults[2] += pamr.quality(mesh)["inverted_cells"]
            most = max(most, mesh.n_cells)
        smallest = [q for q in smallest if q < 1]
        seconds = time.process_time() - began
        holds = faults[2] == 0 and (h > 1.05 or (faults.sum() == 0 and min(smallest) >= shape_bar(h, bound)))
        holds = holds and (h > 0.8 or len(smallest) < 4 or smallest[-1] >= 0.95 * smallest[2])
        if options.policy == "removable" and marks == "random":
            holds = holds and is_undone(pamr, mesh, first) and same_on_ranks(options, first, folder)
        row = [name, round(h, 2), marks, f"{start:.3f}", f"{bound:.3f}", ", ".join(f"{q:.3f}" for q in smallest),
               ", ".join(map(str, faults)), f"{most:,}", f"{seconds:.0f}", "yes" if holds else "NO"]
        print("| " + " | ".join(map(str, row)) + " |", flush=True)
        sound = sound and holds
    return sound


def run_others(options):
    """True where nothing was broken."""
    sys.path.insert(0, str(options.bin.parent / "python"))
    import pamr  # of the same build
    from mpi4py import MPI
    head = ("body", "h/R", "marks", "level 0", "bound", "smallest mean ratio, levels 1, 2, ...", "off, kept, inverted", "cells, at most",
            "s", "holds")
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    sound = True
    for name in other_bodies.BODIES if options.others == "all" else options.others.split(","):
        for size in map(float, options.sizes.split(",")):
            with tempfile.TemporaryDirectory() as folder:
                try:
                    sound = run_other(options, pamr, MPI.COMM_SELF, name, size, pathlib.Path(folder)) and sound
                except (RuntimeError, pamr.Error) as error:
                    print(f"\n{name}, h/R = {size}: {error}", flush=True)
    return sound


def main():
    options = arguments()
    if options.others:
        return 0 if run_others(options) else 1
    sound = True
    print("| " + " | ".join(HEAD) + " |\n|" + "---|" * len(HEAD))
    for name in options.cases.split(","):
        for size in [0.0] if name == "blunt-cone" else [float(s) for s in options.sizes.split(",")]:
            with tempfile.TemporaryDirectory() as scratch:
                folder = pathlib.Path(scratch)
                if options.keep is not None:
                    folder = options.keep / f"{name}-{size}"
                    folder.mkdir(parents=True, exist_ok=True)
                try:
                    sound = run(options, name, size, folder) and sound
                except RuntimeError as error:
                    print(f"\n{name}, h/R = {size}: {error}", flush=True)
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
