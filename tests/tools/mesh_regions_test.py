# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-mesh of cases with several regions: cells, faces between regions and curves, refined and coarsened, and bad input."""
import math
import pathlib

import h5py
import numpy as np

from tool_run import prepare_alone, refuses, run, run_tests, same_bytes

prepare_alone("pamr-mark", "pamr-mesh", "pamr-quality")

IN_BOX = "+x0 & -x1 & +y0 & -y1 & +z0 & -z1"


def plane(name, axis, at):
    unit = [int(i == axis) for i in range(3)]
    return f'[[surface]]\nname = "{name}"\nkind = "plane"\npoint = {[at * u for u in unit]}\nnormal = {unit}\n'


def sphere(name, radius, center=(0, 0, 0)):
    return f'[[surface]]\nname = "{name}"\nkind = "sphere"\ncenter = {list(center)}\nradius = {radius}\n'


BOX = "".join(plane(f"{axis}{side}", "xyz".index(axis), 2 * side - 1) for axis in "xyz" for side in (0, 1))
ROD = '[[surface]]\nname = "rod"\nkind = "cylinder"\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 0.5\n'


def case(regions, sizes, surfaces, name="case.toml", bound=1):
    tables = "".join(f'[[mesh.region]]\nname = "{name}"\nsides = "{sides}"\n' for name, sides in regions)
    pathlib.Path(name).write_text(f'[mesh]\nshape = "surfaces"\nlength_unit = "1"\nbounds = [{[-bound] * 3}, {[bound] * 3}]\n'
                                  f"{tables}[mesh.sizes]\n{sizes}\n{surfaces}")
    return name


class Mesh:
    """Volumes of regions; of each patch the faces, outside once and inside from both sides, and the pairs of regions at them."""

    def __init__(self, name):
        with h5py.File(name) as file:
            self.points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
            neighbors, region = file["PAMR/cell_to_cell"][:], file["VTKHDF/CellData/region"][:]
            word = file["VTKHDF/CellData/inner_patch"][:] if "inner_patch" in file["VTKHDF/CellData"] else np.zeros(len(cells), int)
            self.regions = dict(zip((name.decode() for name in file["PAMR/regions/names"][:]), file["PAMR/regions/numbers"][:]))
            names = [name.decode() for name in file["PAMR/patches/names"][:]]
            self.surfaces = [name.decode() for name in file["PAMR/patches/surfaces"][:]]
        p = self.points[cells]
        volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
        assert (volume > 0).all()
        self.volume = {name: volume[region == number].sum() for name, number in self.regions.items()}
        self.outside, self.inside, self.beside = {}, {}, {name: set() for name in names}
        for slot in range(4):
            corners = cells[:, [k for k in range(4) if k != slot]]
            inner = (word >> 16 * slot & 0xffff) - 1
            assert (neighbors[inner >= 0, slot] >= 0).all()
            for number, name in enumerate(names):
                for faces, here in ((self.outside, neighbors[:, slot] == -1 - number), (self.inside, inner == number)):
                    faces[name] = np.concatenate([faces.get(name, np.empty((0, 3), int)), corners[here]])
                self.beside[name] |= {tuple(sorted(pair)) for pair in zip(region[inner == number], region[neighbors[inner == number, slot]])}

    def points_of(self, name):
        return self.points[np.unique(np.concatenate([self.outside[name], self.inside[name]]))]

    def area(self, faces):
        p = self.points[faces]
        return np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2

    def edges(self, name):
        faces = np.concatenate([self.outside[name], self.inside[name]])
        return {tuple(sorted((face[i], face[i - 1]))) for face in faces for i in range(3)}

    def curve(self, *names):
        """The nodes of the edges that patches share, and their length."""
        shared = np.array(sorted(set.intersection(*(self.edges(name) for name in names))))
        ends = self.points[shared]
        return self.points[np.unique(shared)], np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()


def make(*arguments):
    report = run("pamr-mesh", case(*arguments), "-o", "0.hdf", "--json", "-").json
    assert report["min_mean_ratio"] >= 0.2
    mesh = Mesh("0.hdf")
    for name, region in report["regions"].items():
        assert region["number"] == mesh.regions[name] and region["body_volume"] is None
        assert abs(region["volume"] - mesh.volume[name]) < 1e-12
    for name, patch in report["patches"].items():
        assert patch["faces"] == len(mesh.outside[name]) + len(mesh.inside[name]) // 2 > 0
    return mesh


def refine(level, *patches):
    """The next level of a mesh, all of it or at patches."""
    marks = [word for name in patches for word in ("--patch", name)] if patches else ["--all"]
    run("pamr-mark", f"{level}.hdf", "-o", "marked.hdf", *marks, "--force")
    report = run("pamr-refine", "marked.hdf", "-o", f"{level + 1}.hdf", "--force", "--json", "-").json
    assert report["off_surface_nodes"] == 0
    return Mesh(f"{level + 1}.hdf")


def require_valid(name):
    quality = run("pamr-quality", name, "--json", "-").json
    assert quality["valid"], quality
    return quality
