# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-mesh of cases with several regions: cells, faces between regions and curves, refined and coarsened, and bad input."""
import math
import pathlib

import h5py
import numpy as np

from tool_run import FULL, prepare_alone, refuses, run, run_tests, same_bytes

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


def refine(old, new, *criteria, **how):
    run("pamr-mark", old, "-o", "marked.hdf", *criteria, "--force")
    report = run("pamr-refine", "marked.hdf", "-o", new, "--force", "--json", "-", **how).json
    assert report["off_surface_nodes"] == 0
    return report


def require_valid(name, volume):
    quality = run("pamr-quality", name, "--json", "-").json
    assert quality["valid"] and abs(sum(region["volume"] for region in quality["regions"].values()) - volume) < 1e-12, quality


def test_a_ball_of_another_material_in_a_box_is_refined_from_both_sides_and_coarsened_again():
    mesh = make([("ball", "-ball"), ("box", IN_BOX + " & +ball")], "far = 0.6\nnear = { ball = 0.35 }", BOX + sphere("ball", 0.7))
    assert mesh.regions == {"ball": 1, "box": 2} and mesh.surfaces == ["x0", "x1", "y0", "y1", "z0", "z1", "ball"]
    if FULL:
        run("pamr-mesh", "case.toml", "-o", "one.hdf", serial=True)
        assert same_bytes("0.hdf", "one.hdf")
    cells, errors = [], []
    for level in range(4):
        mesh = Mesh(f"{level}.hdf")
        require_valid(f"{level}.hdf", 8)
        assert len(mesh.outside["ball"]) == 0 and mesh.beside["ball"] == {(1, 2)}
        assert np.abs(np.linalg.norm(mesh.points_of("ball"), axis=1) - 0.7).max() < 1e-15
        for side in ("x0", "x1", "y0", "y1", "z0", "z1"):
            assert abs(mesh.area(mesh.outside[side]) - 4) < 1e-12 and len(mesh.inside[side]) == 0
        errors.append(1 - mesh.volume["ball"] / (4 / 3 * math.pi * 0.7 ** 3))
        if level < 3:
            cells.append(refine(f"{level}.hdf", f"{level + 1}.hdf", "--patch", "ball")["cells_in"])
    assert all(3.6 < coarse / fine < 4.4 for coarse, fine in zip(errors, errors[1:])), errors
    run("pamr-refine", "marked.hdf", "-o", "one.hdf", "--force", serial=True)
    assert same_bytes("3.hdf", "one.hdf")
    for _ in range(6):  # what the closure of a coarser mesh needs stays for a call
        report = refine("3.hdf", "3.hdf", "--box", "9,9,9,9,9,9", "--coarsen-rest", serial=True)
        if report["cells_out"] == cells[0]:
            break
    assert report["cells_out"] == cells[0], (report, cells)
    back = Mesh("3.hdf")
    assert abs(1 - back.volume["ball"] / (4 / 3 * math.pi * 0.7 ** 3) - errors[0]) < 1e-12 and len(back.inside["ball"]) > 0


def test_three_regions_meet_in_a_circle_and_end_at_the_boundary():
    mesh = make([("lower", IN_BOX + " & -rod & -cut"), ("upper", IN_BOX + " & -rod & +cut"), ("box", IN_BOX + " & +rod")],
                "far = 0.6\nnear = { rod = 0.4 }", BOX + ROD + plane("cut", 2, 0.1))
    for level in range(2):
        require_valid(f"{level}.hdf", 8)
        assert mesh.beside["rod"] == {(1, 3), (2, 3)} and mesh.beside["cut"] == {(1, 2)}
        assert np.abs(np.hypot(*mesh.points_of("rod")[:, :2].T) - 0.5).max() < 1e-15
        assert (mesh.points_of("cut")[:, 2] == 0.1).all() and abs(mesh.area(mesh.outside["z0"]) - 4) < 1e-12
        for name, z in (("cut", 0.1), ("z0", -1), ("z1", 1)):
            ring, length = mesh.curve("rod", name)
            assert (ring[:, 2] == z).all() and np.abs(np.hypot(ring[:, 0], ring[:, 1]) - 0.5).max() < 1e-15
            assert 0.94 < length / math.pi < 1 and len(ring) >= 6 * 2 ** level
        if level == 0:
            refine("0.hdf", "1.hdf", "--patch", "rod", serial=True)
            mesh = Mesh("1.hdf")


def test_a_plane_divides_one_region_and_ends_in_a_line_on_another():
    mesh = make([("below", IN_BOX + " & -mid"), ("above", IN_BOX + " & +mid & -sheet"), ("above", IN_BOX + " & +mid & +sheet")],
                "far = 0.8", BOX + plane("mid", 2, 0.2) + plane("sheet", 0, 0.3))
    assert mesh.regions == {"below": 1, "above": 2}
    for level in range(2):
        require_valid(f"{level}.hdf", 8)
        assert abs(mesh.volume["below"] - 4.8) < 1e-12 and abs(mesh.volume["above"] - 3.2) < 1e-12
        assert mesh.beside["mid"] == {(1, 2)} and mesh.beside["sheet"] == {(2, 2)}
        assert (mesh.points_of("sheet")[:, 0] == 0.3).all()
        assert abs(mesh.area(mesh.inside["sheet"]) / 2 - 1.6) < 1e-12 and abs(mesh.area(mesh.inside["mid"]) / 2 - 4) < 1e-12
        line, length = mesh.curve("mid", "sheet")
        assert (line[:, 0] == 0.3).all() and (line[:, 2] == 0.2).all() and abs(length - 2) < 1e-12
        if level == 0:
            refine("0.hdf", "1.hdf", "--patch", "sheet", serial=True)
            mesh = Mesh("1.hdf")


def test_a_patch_lies_outside_and_between_regions():
    mesh = make([("ball", "-ball"), ("box", IN_BOX + " & +ball")], "far = 0.6\nnear = { ball = 0.35 }",
                BOX + sphere("ball", 0.7, (0.9, 0, 0)), "case.toml", 2)
    for level in range(2):
        assert run("pamr-quality", f"{level}.hdf", "--json", "-").json["valid"]
        assert len(mesh.outside["ball"]) > 10 and mesh.beside["ball"] == {(1, 2)} and abs(mesh.area(mesh.outside["x0"]) - 4) < 1e-12
        assert np.abs(np.linalg.norm(mesh.points_of("ball") - [0.9, 0, 0], axis=1) - 0.7).max() < 1e-15
        ring, _ = mesh.curve("ball", "x1")
        assert (ring[:, 0] == 1).all() and np.abs(np.hypot(ring[:, 1], ring[:, 2]) - math.sqrt(0.48)).max() < 1e-12
        if level == 0:
            refine("0.hdf", "1.hdf", "--patch", "ball", serial=True)
            mesh = Mesh("1.hdf")


def test_what_does_not_fit_is_said():
    ball, box, surfaces = ("ball", "-ball"), ("box", IN_BOX + " & +ball"), BOX + sphere("ball", 0.7)
    idle = sphere("idle", 5)
    for regions, more, edit, words in (
            ([ball, ("box", IN_BOX)], "", ("", ""), ["do not overlap", 'in "ball" (case.toml:7:9) and in "box" (case.toml:10:9)']),
            ([ball, ("ball", "-ball & +x0"), box], "", ("", ""), ['in "ball" (case.toml:7:9) and in "ball" (case.toml:10:9)']),
            ([("ball", "-bell"), box], "", ("", ""), ["case.toml:7:9", 'found "bell"']),
            ([ball, box], idle, ("", ""), ['"idle" in none']),
            ([ball, ("box", box[1] + " & -idle")], idle, ("", ""), ['no place where "idle" does']),
            ([ball, box, ("void", "-ball & +ball")], "", ("", ""), ['region "void" (case.toml:13:9), found none of it']),
            ([ball, box], "", ("[mesh]", '[mesh]\nregion = "-ball"'), ["mesh.region", ":6"]),
            ([ball, box], "", ("sides =", "side ="), [":7:1", "did you mean 'sides'?"]),
            ([ball, box], "", ('name = "ball"\nsides', "sides"), [":5:1", "expected name"]),
            ([ball, box], "", ('name = "ball"', 'name = "a\\u0007"'), [":6:8", "neither blank nor with control characters"]),
            ([ball, box], "", ('name = "ball"', 'name = "  "'), [":6:8", "neither blank"]),
            ([], "", ("[mesh]", "[mesh]\nregion = []"), [":2:10", "or tables [[mesh.region]]"]),
            ([], "", ("", ""), ["region", "or tables [[mesh.region]]", "none"])):
        case(regions, "far = 0.6", surfaces + more)
        text = pathlib.Path("case.toml").read_text()
        pathlib.Path("case.toml").write_text(text.replace(*edit, 1) if edit[0] else text)
        refuses("pamr-mesh", "case.toml", "-o", "out.hdf", says=["case.toml", *words], creates="out.hdf")


run_tests(globals())
