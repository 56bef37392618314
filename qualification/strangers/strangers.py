#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strangers' meshes through import, marking and three refinements, checked by others than PAMR.

Usage: strangers.py BIN_FOLDER [--only NAME]... [--table FILE.md] [--jobs N]

Each shape is meshed by Gmsh, by netgen where its Python module is installed, or cell by cell, and taken through the pipeline twice: with its curved walls described, and with nothing
described. Each result is held to what must be true:

- the last mesh is the same, byte for byte, from 1 and from 3 ranks;
- from the arrays alone: cells positive, no face without partner but those of the patches, no two nodes in one place;
- OpenFOAM's checkMesh finds no fault of topology or sign, where it is installed;
- flat faces of the shape are flat to rounding;
- nodes on described walls lie on them as OpenCASCADE finds the nearest point, but for those that the tool counts as off;
- the volume comes nearer to that of the closed form at described walls (a fifth of the error at level 0, or better), and
  stays as it was without description; so do the areas of the walls;
- regions keep their volumes and the area between them, which is that of the patch inside where the file has one;
- at every level the smallest mean ratio is 0.8 of min(0.29, 0.95 U), where U is what splitting every cell into eight gives.
"""
import argparse
import concurrent.futures
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import gmsh
import numpy as np

sys.path[:0] = [str(pathlib.Path(__file__).parent), str(pathlib.Path(__file__).parents[1] / "validation")]
from curved_walls import shape_of_splitting_all
from mesh_arrays import Mesh, check_mesh
from make_mesh import Model
from other_meshes import MAKERS
from shapes import SHAPES

LEVELS, MAX_CELLS = 3, 60_000
ROUNDING = 1e-13  # of the largest coordinate
NAMES = [*SHAPES, *MAKERS]


class Fault(Exception):
    """Something that must be true is not."""


class Journey:
    """One mesh, described or not, through the pipeline in a folder of its own."""

    def __init__(self, tools, folder, model, described):
        self.tools, self.folder, self.model, self.described = tools, folder, model, described
        self.walls = model.made.walls if described else {}
        self.row = {"described": described}

    def tool(self, name, *arguments, ranks=1, code=0):
        launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
        done = subprocess.run([*launcher, str(self.tools / name), *map(str, arguments)], cwd=self.folder,
                              capture_output=True, text=True, timeout=600)
        self.said = done.stderr
        if done.returncode != code:
            raise Fault(f"{name} {' '.join(map(str, arguments))} ended with {done.returncode}: {' '.join(done.stderr.split())[:300]}")
        return done.stdout

    def report(self, name, *arguments, ranks=1):
        return json.loads(self.tool(name, *arguments, "--json", "-", "--quiet", ranks=ranks))

    def run(self):
        options = []
        if self.walls:
            (self.folder / "walls.toml").write_text("".join(w.toml().format(name=name) for name, w in self.walls.items()))
            options = ["--surfaces", "walls.toml"]
        made = self.model.made
        self.tool("pamr-convert", self.folder.parent / "shape.msh", "level0.hdf", "--force", *options, code=2 if made.refused else 0)
        if made.says not in self.said:
            raise Fault(f"pamr-convert does not say {made.says} but: {' '.join(self.said.split())[:300]}")
        if made.refused:
            return self.row | {"faults": [], "refused": made.says}
        for ranks in (1, 3):
            mesh = "level0.hdf"
            for level in range(1, LEVELS + 1):
                patches = [x for name in self.refined_patches() for x in ("--patch", name)]
                self.tool("pamr-mark", mesh, "-o", "marked.hdf", *patches, "--max-cells", MAX_CELLS, "--force", ranks=ranks)
                mesh = f"level{level}_{ranks}.hdf"
                self.tool("pamr-refine", "marked.hdf", "-o", mesh, "--force", ranks=ranks)
        return self.check()

    def refined_patches(self):
        names = list(self.model.entities)
        return [n for n in names if n not in self.model.flat] or names[:1]

    def check(self):
        last, other = (self.folder / f"level{LEVELS}_{ranks}.hdf" for ranks in (1, 3))
        faults = [] if last.read_bytes() == other.read_bytes() else ["other bytes from 3 ranks"]
        first, fine = Mesh(self.folder / "level0.hdf"), Mesh(last)
        faults += fine.faults()
        quality = self.report("pamr-quality", last.name)
        if not quality["valid"] or quality["inverted_cells"] != 0:
            faults.append("pamr-quality says that the mesh is not valid")
        self.row.update(cells=len(fine.cells), level0=self.report("pamr-quality", "level0.hdf")["mean_ratio"]["min"],
                        smallest=quality["mean_ratio"]["min"], off=quality["ledger"]["nodes"])
        faults += self.check_shapes() + self.check_patches(first, fine, quality) + self.check_volume(first, fine)
        faults += self.check_areas(first, fine) + self.check_regions(first, fine)
        if shutil.which("checkMesh"):
            self.tool("pamr-convert", last.name, "foam", "--force")
            faults += check_mesh(self.folder / "foam")
        self.row["faults"] = faults
        return self.row

    def check_shapes(self):
        smallest = [self.report("pamr-quality", f"level{level}_1.hdf")["mean_ratio"]["min"] for level in range(1, LEVELS + 1)]
        bar = 0.8 * min(0.29, 0.95 * shape_of_splitting_all(self.tool, "level0.hdf", pathlib.Path(".")))
        if min(smallest) >= bar:
            return []
        return [f"smallest mean ratios {', '.join(f'{q:.3f}' for q in smallest)}, expected at least {bar:.3f}"]

    def check_patches(self, first, fine, quality):
        faults, size = [], abs(fine.points).max()
        self.row.update(off_plane=0.0, off_shape=0.0)
        for patch in self.model.entities:
            if patch in self.model.flat:
                self.row["off_plane"] = max(self.row["off_plane"], fine.off_plane(patch) / size)
                if fine.off_plane(patch) > max(4 * first.off_plane(patch), ROUNDING * size):
                    faults.append(f"{patch} is bent by {fine.off_plane(patch):.1e}")
            elif patch in self.walls:
                distance = np.sort(self.model.distance(patch, fine.nodes_of(patch)))
                counted = quality["patches"][patch]["off_surface_nodes"]
                on_it = distance[:len(distance) - counted] if counted else distance
                self.row["off_shape"] = max(self.row["off_shape"], on_it.max(initial=0) / size)
                if on_it.max(initial=0) > max(1e-11 * size, getattr(self.walls[patch], "known_to", 0)):
                    faults.append(f"nodes of {patch} lie {on_it.max():.1e} off the shape, uncounted")
        return faults

    def rounding(self, mesh):
        """Of a volume: what the last place of the coordinates makes of it; of an area, a size further."""
        return 4 * np.finfo(float).eps * abs(mesh.points).max() * sum(mesh.area(patch) for patch in mesh.triangles)

    def check_volume(self, first, fine):
        at_first, at_last = first.volumes().sum(), fine.volumes().sum()
        error = [float(abs(v - self.model.volume) / self.model.volume) for v in (at_first, at_last)]
        self.row["volume_error"] = error
        if set(self.model.entities) <= {*self.model.flat, *self.walls} and self.walls:
            if error[1] > max(error[0] / 5, 1e-12) and self.row["cells"] < MAX_CELLS / 2:
                return [f"volume: relative error {error[0]:.1e} at level 0, {error[1]:.1e} at level {LEVELS}"]
        elif not self.walls and abs(at_last - at_first) > max(1e-10 * self.model.volume, self.rounding(first)) and self.row["cells"] > 0:
            return [f"volume changes by {abs(at_last - at_first) / self.model.volume:.1e} though nothing is described"]
        return []


    def check_areas(self, first, fine):
        """Areas of walls come nearer to the shape's, others stay."""
        worst, faults, extent = [0.0, 0.0], [], np.ptp(first.points, axis=0).max()
        for patch in self.model.entities:
            true = self.model.area(patch)
            before, after = first.area(patch), fine.area(patch)
            if patch in self.walls and true is not None:
                error = [abs(a - true) / true for a in (before, after)]
                worst = [max(pair) for pair in zip(worst, error)]
                if error[1] > max(0.7 * error[0], 1e-12):
                    faults.append(f"area of {patch}: relative error {error[0]:.1e} at level 0, {error[1]:.1e} at level {LEVELS}")
            elif not self.walls and abs(after - before) > max(1e-10 * before, self.rounding(first) / extent):
                faults.append(f"area of {patch} changes by {abs(after - before) / before:.1e} though nothing is described")
        self.row["area_error"] = worst
        return faults

    def check_regions(self, first, fine):
        """The volume of each region and the area between them stay, but for regions at described walls."""
        faults, before, after = [], first.regions(), fine.regions()
        if list(before) != list(after):
            return [f"regions {list(before)} become {list(after)}"]
        if not self.walls:
            faults += [f"the volume of region {r} changes" for r in before
                       if abs(after[r] - before[r]) > max(1e-10 * before[r], self.rounding(first))]
        areas = [mesh.area_between_regions() for mesh in (first, fine)]
        if abs(areas[1] - areas[0]) > 1e-10 * areas[0]:
            faults.append(f"the area between regions changes from {areas[0]:.10g} to {areas[1]:.10g}")
        if name := self.model.made.inner_patch:
            for mesh, area in zip(("level0.hdf", f"level{LEVELS}_3.hdf"), areas):
                found = self.report("pamr-quality", mesh)["patches"].get(name, {"area": 0})["area"]
                if abs(found - area) > 1e-10 * area:
                    faults.append(f"{name} has the area {found:.10g} in {mesh}, between the regions there is {area:.10g}")
        return faults


def journeys(tools, name, folder):
    """Both of one shape, in a process of its own: Gmsh may end its process."""
    gmsh.initialize()
    model = MAKERS[name](folder / "shape.msh") if name in MAKERS else Model(*SHAPES[name], str(folder / "shape.msh"))
    rows = []
    for described in (True, False) if model.made.walls else (False,):
        place = folder / ("described" if described else "bare")
        place.mkdir()
        try:
            rows.append(Journey(tools, place, model, described).run())
        except Fault as fault:
            rows.append({"described": described, "faults": [str(fault)]})
    return rows


def run_shape(tools, name):
    with tempfile.TemporaryDirectory(prefix="strangers-") as folder:
        command = [sys.executable, "-B", __file__, str(tools), "--shape", name, "--folder", folder]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            return [{"described": False, "faults": ["the script ended: " + (done.stderr or done.stdout).strip()[-400:]]}]
        return json.loads(done.stdout.splitlines()[-1])


def table_of(results):
    lines = ["| shape | described | cells | smallest mean ratio: level 0, last | nodes off | off planes / size | off the shape / size | error of the volume: level 0, last | error of walls' areas |",
             "|---|---|---|---|---|---|---|---|---|"]
    for name, rows in results.items():
        for row in rows:
            if "cells" not in row:
                text = f"refused: {row['refused']}" if "refused" in row else "; ".join(row["faults"])
                lines.append(f"| {name.replace('_', ' ')} | {'yes' if row['described'] else 'no'} | {text} | | | | | | |")
                continue
            before, after = row["volume_error"]
            areas = "{:.1e}, {:.1e}".format(*row["area_error"]) if any(row["area_error"]) else ""
            lines.append(f"| {name.replace('_', ' ')} | {'yes' if row['described'] else 'no'} | {row['cells']:,} | {row['level0']:.3f}, "
                         f"{row['smallest']:.3f} | {row['off']} | {row['off_plane']:.0e} | "
                         f"{row['off_shape']:.0e} | {before:.1e}, {after:.1e} | {areas} |")
    return "\n".join(lines) + "\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("tools", type=pathlib.Path)
    arguments.add_argument("--only", action="append", choices=sorted(NAMES), metavar="NAME")
    arguments.add_argument("--table", type=pathlib.Path)
    arguments.add_argument("--jobs", type=int, default=2)
    arguments.add_argument("--shape", help=argparse.SUPPRESS)
    arguments.add_argument("--folder", type=pathlib.Path, help=argparse.SUPPRESS)
    chosen = arguments.parse_args()
    tools = chosen.tools.resolve()
    if chosen.shape:
        print(json.dumps(journeys(tools, chosen.shape, chosen.folder)))
        return 0
    names = chosen.only or NAMES
    n_faults, results = 0, {}
    with concurrent.futures.ThreadPoolExecutor(chosen.jobs) as pool:
        for name, rows in zip(names, pool.map(lambda name: run_shape(tools, name), names)):
            results[name] = rows
            for row in rows:
                n_faults += len(row["faults"])
                print(f"{name}{' described' if row['described'] else ''}: {'; '.join(row['faults']) or 'ok'}", flush=True)
    if chosen.table:
        chosen.table.write_text(table_of(results))
    print(f"{len(results)} shapes, {sum(map(len, results.values()))} journeys, {n_faults} faults")
    return 1 if n_faults else 0


if __name__ == "__main__":
    sys.exit(main())
