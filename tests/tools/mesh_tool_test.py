# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-mesh from the command line: meshes against the geometry written down anew here, repeat runs, and bad input."""
import math
import pathlib

import h5py
import numpy as np

from tool_run import RANKS, of_full_level, of_one_process, once, refuses, run, run_tests, same_bytes
from tet import EDGE_TO_CORNER, FACE_TO_CORNER



class Mesh:
    def __init__(self, name):
        with h5py.File(name) as file:
            self.points = file["VTKHDF/Points"][:]
            self.cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
            self.neighbors = file["PAMR/cell_to_cell"][:]
            self.names = [n.decode() for n in file["PAMR/patches/names"][:]]
            self.surfaces = [n.decode() for n in file["PAMR/patches/surfaces"][:]]
            self.length_unit = file["PAMR"].attrs["length_unit"].decode()
        cell, slot = np.nonzero(self.neighbors < 0)
        self.faces = self.cells[cell[:, None], FACE_TO_CORNER[slot]]
        self.patch = -1 - self.neighbors[cell, slot]

    def faces_of(self, name):
        return self.faces[self.patch == self.names.index(name)]

    def points_of(self, name):
        return self.points[np.unique(self.faces_of(name))]

    def mean_ratios(self):
        p = self.points[self.cells]
        volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
        assert (volume > 0).all()
        squares = sum(((p[:, a] - p[:, b]) ** 2).sum(axis=1) for a, b in EDGE_TO_CORNER)
        return 12 * (3 * volume) ** (2 / 3) / squares

    def patch_edges(self, name):
        """How many faces of the patch there are at each of its edges."""
        count = {}
        for face in self.faces_of(name):
            for i in range(3):
                edge = tuple(sorted((face[i], face[(i + 1) % 3])))
                count[edge] = count.get(edge, 0) + 1
        return count

    def border(self, a, b):
        """Nodes of the edges that two patches share."""
        shared = set(self.patch_edges(a)) & set(self.patch_edges(b))
        return self.points[sorted({n for edge in shared for n in edge})]


def make_anew(*arguments):
    report = run("pamr-mesh", *arguments, "-o", "made.hdf", "--force", "--json", "-").json
    mesh = Mesh("made.hdf")
    assert report["cells"] == len(mesh.cells) and report["nodes"] == len(mesh.points)
    assert report["min_mean_ratio"] == min(1, report["min_mean_ratio"]) >= 0.2
    assert abs(report["min_mean_ratio"] - mesh.mean_ratios().min()) < 1e-12
    assert {n: p["faces"] for n, p in report["patches"].items()} == {n: len(mesh.faces_of(n)) for n in mesh.names}
    return mesh


make = once(make_anew)


# The meridian of the blunt cone in millimeters, from the numbers that define it: radii and the cone's angle.
ANGLE = math.radians(70)
NOSE = (12.5 - 12.5 * math.sin(ANGLE), 12.5 * math.cos(ANGLE))
CONE_R = 23.75 + 1.25 * math.cos(ANGLE)
CONE_X = NOSE[0] + (CONE_R - NOSE[1]) / math.tan(ANGLE)
SHOULDER_X = CONE_X + 1.25 * math.sin(ANGLE)
BASE_X = SHOULDER_X + 1.25
STING_X = BASE_X + 2.08


def body_distance(p):
    """Distance from the body, millimeters, of points near it."""
    x, r = p[:, 0], np.hypot(p[:, 1], p[:, 2])
    nose = np.abs(np.hypot(x - 12.5, r) - 12.5)
    cone = np.abs((x - NOSE[0]) * math.sin(ANGLE) - (r - NOSE[1]) * math.cos(ANGLE))
    shoulder = np.abs(np.hypot(x - SHOULDER_X, r - 23.75) - 1.25)
    fillet = np.abs(np.hypot(x - STING_X, r - 8.33) - 2.08)
    return np.select([x < NOSE[0], x < CONE_X, r > 23.75, r > 8.33, x < STING_X],
                     [nose, cone, shoulder, np.abs(x - BASE_X), fillet], np.abs(r - 6.25))


def wall_radius(p):
    """The smaller radius of curvature of the wall, millimeters, at points near it; the flat base has none."""
    x, r = p[:, 0], np.hypot(p[:, 1], p[:, 2])
    return np.select([x <= NOSE[0], x < CONE_X, r > 23.75, r > 8.33, x < STING_X],
                     [12.5, r / math.cos(ANGLE), 1.25, np.inf, 2.08], 6.25)


def outer_distance(p):
    x, r = p[:, 0], np.hypot(p[:, 1], p[:, 2])
    return np.select([r < 30, x < 0], [np.abs(x + 30), np.abs(np.hypot(x, r - 30) - 30)], np.abs(r - 60))


@of_one_process
def test_blunt_cone_lies_on_its_surfaces():
    mesh = make("--shape", "blunt-cone")

    assert mesh.length_unit == "m"
    assert mesh.names == ["forebody", "base", "sting", "inflow", "outflow", "symmetry"]
    assert mesh.surfaces == ["body", "body", "body", "outer", "outflow", "symmetry"]
    assert 15000 <= len(mesh.cells) <= 30000
    tolerance = 1e-12 * 60
    for wall in ("forebody", "base", "sting"):
        assert body_distance(1e3 * mesh.points_of(wall)).max() < tolerance
    assert outer_distance(1e3 * mesh.points_of("inflow")).max() < tolerance
    assert (mesh.points_of("outflow")[:, 0] == 60e-3).all()
    assert (mesh.points_of("symmetry")[:, 1] == 0).all()
    assert (mesh.points[:, 1] >= 0).all()
    x, r = 1e3 * mesh.points_of("base")[:, 0], 1e3 * np.hypot(*mesh.points_of("base")[:, 1:].T)
    assert x.min() > BASE_X - tolerance and x.max() < STING_X + tolerance
    assert r.max() < 23.75 + tolerance and r.min() > 6.25 - tolerance


@of_one_process
def test_blunt_cone_patches_meet_on_feature_curves():
    mesh = make("--shape", "blunt-cone")

    for a, b, x, r in (("forebody", "base", BASE_X, 23.75), ("base", "sting", STING_X, 6.25),
                       ("sting", "outflow", 60, 6.25), ("inflow", "outflow", 60, 60)):
        ring = 1e3 * mesh.border(a, b)
        radius, angle = np.hypot(ring[:, 1], ring[:, 2]), np.sort(np.arctan2(ring[:, 1], -ring[:, 2]))
        assert np.abs(ring[:, 0] - x).max() < 1e-10 and np.abs(radius - r).max() < 1e-10
        assert angle[0] == 0 and abs(angle[-1] - math.pi) < 1e-15
    # A patch's border is closed and every edge of it belongs to two patches.
    border_edges = {}
    for name in mesh.names:
        counts = mesh.patch_edges(name)
        assert set(counts.values()) <= {1, 2}
        ends = [n for edge, count in counts.items() if count == 1 for n in edge]
        assert (np.unique(ends, return_counts=True)[1] % 2 == 0).all()
        for edge, count in counts.items():
            if count == 1:
                border_edges[edge] = border_edges.get(edge, 0) + 1
    assert set(border_edges.values()) == {2}


@of_one_process
def test_blunt_cone_wall_edges_are_short_against_the_radius_of_curvature():
    mesh = make("--shape", "blunt-cone")

    faces = np.concatenate([mesh.faces_of(n) for n in ("forebody", "base", "sting")])
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])), axis=0)
    a, b = 1e3 * mesh.points[edges[:, 0]], 1e3 * mesh.points[edges[:, 1]]
    length = np.linalg.norm(b - a, axis=1)
    for t in (0, 0.25, 0.5, 0.75, 1):
        assert (length <= 0.8 * wall_radius(a + t * (b - a))).all()
    # No dents: faces of the sting face the axis, out of the gas.
    p = mesh.points[mesh.faces_of("sting")]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    axial = p.mean(axis=1) * [0, 1, 1]
    cosine = -(normal * axial).sum(axis=1) / np.linalg.norm(normal, axis=1) / np.linalg.norm(axial, axis=1)
    assert cosine.min() > math.cos(math.radians(25))


@of_one_process
def test_sphere_in_box_lies_on_its_surfaces():
    mesh = make("--shape", "sphere-in-box")

    assert mesh.names == ["box", "sphere"] and mesh.surfaces == ["", "sphere"]
    assert 12000 <= len(mesh.cells) <= 18000
    assert np.abs(np.linalg.norm(mesh.points_of("sphere"), axis=1) - 1).max() < 4e-16 * 2
    assert (np.abs(mesh.points_of("box")).max(axis=1) == 2).all()
    flat = mesh.points[mesh.faces_of("box")]
    assert ((flat == flat[:, :1]) & (np.abs(flat) == 2)).all(axis=1).any(axis=1).all(), "a face lies across an edge"
    corners = {tuple(p) for p in mesh.points_of("box") if (np.abs(p) == 2).all()}
    assert len(corners) == 8
    assert all(count == 2 for n in mesh.names for count in mesh.patch_edges(n).values())


@of_one_process
@of_full_level
def test_charged_spheres_lie_on_their_surfaces():
    mesh = make("--shape", "charged-spheres", "--size", "1.3")

    assert mesh.names == mesh.surfaces == ["sphere", "plate", "symmetry_x", "symmetry_y", "end", "side", "lid"]
    assert 5000 <= len(mesh.cells) <= 10000 and mesh.length_unit == "1"
    assert np.abs(np.linalg.norm(mesh.points_of("sphere") - [2.25, 0, 2.5], axis=1) - 0.325).max() < 1e-15
    for name, axis, at in (("plate", 2, 0), ("symmetry_x", 0, 0), ("symmetry_y", 1, 0), ("end", 0, 9.75),
                           ("side", 1, 7.5), ("lid", 2, 10)):
        assert (mesh.points_of(name)[:, axis] == at).all()
    assert len(mesh.border("sphere", "symmetry_y")) > 8
    box = {tuple(p) for p in mesh.points if p[0] in (0, 9.75) and p[1] in (0, 7.5) and p[2] in (0, 10)}
    assert len(box) == 8
    for a, b, length in (("end", "side", 10), ("plate", "symmetry_x", 7.5), ("lid", "side", 9.75)):
        edge = mesh.border(a, b)
        assert abs((edge.max(axis=0) - edge.min(axis=0)).sum() - length) < 1e-14


def surfaces_case(region, bounds, sizes, *surfaces):
    """Writes a case file for shape "surfaces" and makes its mesh."""
    text = f'[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "{region}"\nbounds = {bounds}\n[mesh.sizes]\n{sizes}\n'
    for name, kind, keys in surfaces:
        text += f'[[surface]]\nname = "{name}"\nkind = "{kind}"\n{keys}\n'
    pathlib.Path("surfaces.toml").write_text(text)
    return make_anew("surfaces.toml")


def sphere(name, radius):
    return name, "sphere", f"center = [0, 0, 0]\nradius = {radius}"


def plane(name, axis, at):
    unit = [int(i == axis) for i in range(3)]
    return name, "plane", f"point = {[at * u for u in unit]}\nnormal = {unit}"


def is_closed(mesh, name):
    return set(mesh.patch_edges(name).values()) == {2}


def area(mesh, name):
    p = mesh.points[mesh.faces_of(name)]
    return np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2


@of_one_process
def test_box_with_a_cylindrical_hole_has_sharp_edges():
    mesh = surfaces_case("+x0 & -x1 & +y0 & -y1 & +z0 & -z1 & +hole", [[-1, -1, -0.5], [1, 1, 0.5]],
                         "far = 0.3\nnear = { hole = 0.2 }",
                         ("hole", "cylinder", "point = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 0.4"),
                         *(plane(f"{n}{side}", axis, at * (2 * side - 1))
                           for n, axis, at in (("x", 0, 1), ("y", 1, 1), ("z", 2, 0.5)) for side in (0, 1)))

    assert mesh.names == mesh.surfaces == ["hole", "x0", "x1", "y0", "y1", "z0", "z1"]
    assert np.abs(np.hypot(*mesh.points_of("hole")[:, :2].T) - 0.4).max() < 1e-15
    for z, at in (("z0", -0.5), ("z1", 0.5)):
        rim = mesh.border("hole", z)
        assert (rim[:, 2] == at).all() and np.abs(np.hypot(rim[:, 0], rim[:, 1]) - 0.4).max() < 1e-15
        polygon = len(rim) * 0.08 * math.sin(2 * math.pi / len(rim))  # of a regular one; the rim's has less area
        assert 4 - math.pi * 0.16 < area(mesh, z) < 4 - 0.97 * polygon
    for side in ("x0", "x1", "y0", "y1"):
        assert abs(area(mesh, side) - 2) < 1e-14
    assert 0.97 < area(mesh, "hole") / (0.8 * math.pi) < 1


@of_one_process
def test_thin_shell_and_torus_have_no_edges():
    shell = surfaces_case("+inner & -outer", [[-1.1] * 3, [1.1] * 3], "far = 0.15", sphere("inner", 1),
                          sphere("outer", 1.1))
    torus = surfaces_case("-ring", [[-1.4, -1.4, -0.4], [1.4, 1.4, 0.4]], "far = 0.25",
                          ("ring", "torus",
                           "center = [0, 0, 0]\naxis = [0, 0, 1]\nmajor_radius = 1\nminor_radius = 0.4"))

    for name, radius in (("inner", 1), ("outer", 1.1)):
        assert is_closed(shell, name)
        assert np.abs(np.linalg.norm(shell.points_of(name), axis=1) - radius).max() < 1e-15
        assert 0.97 < area(shell, name) / (4 * math.pi * radius ** 2) < 1
    p = torus.points_of("ring")
    assert is_closed(torus, "ring") and 0.96 < area(torus, "ring") / (1.6 * math.pi ** 2) < 1
    assert np.abs(np.hypot(np.hypot(p[:, 0], p[:, 1]) - 1, p[:, 2]) - 0.4).max() < 1e-15
    edges = len(torus.patch_edges("ring"))
    assert len(p) - edges + len(torus.faces_of("ring")) == 0, "a torus has Euler characteristic 0"


@of_one_process
def test_a_thin_shell_is_made_finer_than_asked_for_where_it_has_to_be():
    for size in (0.8, 2.0):
        shell = surfaces_case("-outer & +inner", [[-1] * 3, [1] * 3], f"far = {size}", sphere("outer", 1), sphere("inner", 0.9))
        for name, radius in (("inner", 0.9), ("outer", 1)):
            wall = shell.points_of(name)
            assert is_closed(shell, name) and np.abs(np.linalg.norm(wall, axis=1) - radius).max() < 1e-15
            assert len(wall) - len(shell.patch_edges(name)) + len(shell.faces_of(name)) == 2
        assert len(shell.cells) < 6000, "edges in the gap are at most 1.5 times as long as it is wide"


@of_one_process
def test_unit_ball_gets_as_coarse_as_asked_for():
    cells, nodes = [], []
    for size in (0.4, 0.8, 1.2, 1.6, 2.0):
        ball = surfaces_case("-ball", [[-1] * 3, [1] * 3], f"far = {size}", sphere("ball", 1))
        wall = ball.points_of("ball")
        assert is_closed(ball, "ball") and np.abs(np.linalg.norm(wall, axis=1) - 1).max() < 1e-15
        assert len(wall) - len(ball.patch_edges("ball")) + len(ball.faces_of("ball")) == 2
        cells.append(len(ball.cells))
        nodes.append(len(wall))

    assert nodes == sorted(nodes, reverse=True) and cells[0] > 400
    assert (nodes[-1], cells[-1]) == (6, 8), "the last one is an octahedron, its axis split"


@of_one_process
def test_unions_and_curves_of_two_quadrics():
    mesh = surfaces_case("(-ball | (-rod & -front)) & +middle", [[0, -1, -1], [2, 1, 1]], "far = 0.3",
                         sphere("ball", 1), ("rod", "cylinder", "point = [0, 0, 0.1]\naxis = [1, 0, 0]\nradius = 0.5"),
                         plane("front", 0, 2), plane("middle", 0, 0))

    ring = mesh.border("ball", "rod")
    assert len(ring) > 8
    assert np.abs(np.linalg.norm(ring, axis=1) - 1).max() < 1e-12
    assert np.abs(np.hypot(ring[:, 1], ring[:, 2] - 0.1) - 0.5).max() < 1e-12
    assert len(mesh.border("ball", "middle")) > 8 and len(mesh.border("rod", "front")) > 6
    assert not len(mesh.border("ball", "front")) and not len(mesh.border("rod", "middle"))


def shape_on_its_surfaces(shape, unit, geometry, sizes, names, center=(0, 0, 0)):
    pathlib.Path(f"{shape}.toml").write_text(f'[mesh]\nshape = "{shape}"\nlength_unit = "{unit}"\n'
                                             f"[mesh.geometry]\n{geometry}\n[mesh.sizes]\n{sizes}\n")
    mesh = make_anew(f"{shape}.toml")
    assert mesh.names == mesh.surfaces == names
    distance = np.linalg.norm(mesh.points_of("sphere") - center, axis=1)
    assert np.abs(distance - float(geometry.split()[2])).max() < 1e-15
    return mesh


@of_one_process
def test_a_ball_in_a_pipe_between_planes():
    """Beginning with the circles of the pipe's ends, refinement piles up nodes in places of one of the planes."""
    planes = "".join(f'[[surface]]\nname = "z{z}"\nkind = "plane"\npoint = [0, 0, {z}]\nnormal = [0, 0, 1]\n' for z in (0, 3))
    pathlib.Path("pipe.toml").write_text(
        '[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "-z3 & +z0 & -pipe & +ball"\nbounds = [[-1.1, -1.1, -0.1], [1.1, 1.1, 3.1]]\n'
        '[mesh.sizes]\nfar = 0.5\n[[surface]]\nname = "pipe"\nkind = "cylinder"\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 1\n'
        '[[surface]]\nname = "ball"\nkind = "sphere"\ncenter = [0, 0, 1.5]\nradius = 0.4\n' + planes)
    report = run("pamr-mesh", "pipe.toml", "-o", "pipe.hdf", "--json", "-").json
    assert sorted(report["patches"]) == ["ball", "pipe", "z0", "z3"] and report["min_mean_ratio"] > 0.3
    assert abs(report["volume"] / (3 - 4 / 3 * 0.4 ** 3) / math.pi - 1) < 0.08, report["volume"]


@of_one_process
def test_charged_sphere_lies_on_its_surfaces():
    shape_on_its_surfaces("charged-sphere", "1", "radius = 0.5\nouter_radius = 3", "far = 1",
                          ["sphere", "outer", "symmetry_x", "symmetry_y", "symmetry_z"])


@of_one_process
@of_full_level
def test_sphere_pair_lies_on_its_surfaces():
    shape_on_its_surfaces("sphere-pair", "1", "radius = 1\ndistance = 3\nhalf_length = 5\nwidth = 4\ntop = 4", "far = 1.5",
                          ["sphere", "symmetry_z", "symmetry_x", "symmetry_y", "end", "side", "lid"], center=[1.5, 0, 0])


@of_one_process
@of_full_level
def test_supersonic_sphere_lies_on_its_surfaces():
    mesh = shape_on_its_surfaces("supersonic-sphere", "m", "radius = 0.5\nparts = 16", "far = 0.8",
                                 ["sphere", "inflow", "outflow", "side", "symmetry_1", "symmetry_2"])
    off_axis = mesh.points[np.hypot(mesh.points[:, 1], mesh.points[:, 2]) > 1e-9]
    angle = np.arctan2(off_axis[:, 2], off_axis[:, 1])
    assert abs(angle.min()) < 1e-12 and abs(angle.max() - math.pi / 8) < 1e-12


@of_one_process
@of_full_level
def test_size_makes_meshes_finer():
    coarse = make("--shape", "sphere-in-box", "--size", "0.5")
    fine = make("--shape", "sphere-in-box", "--size", "0.4")

    assert 1.4 < len(fine.cells) / len(coarse.cells) < 2.8


CASES = {"cone.toml": """[mesh]
shape = "blunt-cone"
length_unit = "m"
seed = 3
[mesh.sizes]
far = 0.012
[gas]
name = 'N2'
""", "ball.toml": """[mesh]
shape = "surfaces"
length_unit = "1"
region = "-ball"
bounds = [[-1, -1, -1], [1, 1, 1]]
[mesh.sizes]
far = 0.8
[[surface]]
name = "ball"
kind = "sphere"
center = [0, 0, 0]
radius = 1
"""}


def same_bytes_of(*arguments):
    def test():
        if arguments[0] in CASES:
            pathlib.Path(arguments[0]).write_text(CASES[arguments[0]])
        run("pamr-mesh", *arguments, "-o", "many.hdf", "--quiet")
        run("pamr-mesh", *arguments, "-o", "one.hdf", "--quiet", serial=True)

        assert same_bytes("many.hdf", "one.hdf")
    return test


# A test of its own for each shape, so that several run at a time; where there is one rank, the script on several compares with it.
if RANKS > 1:
    for shape, words in (("blunt_cone", ["cone.toml"]), ("ball", ["ball.toml"]), ("kuhn_cube", ["--shape", "kuhn-cube", "--n", "3"]),
                         ("sphere_in_box", ["--shape", "sphere-in-box", "--size", "0.5"]),
                         ("charged_spheres", ["--shape", "charged-spheres", "--size", "2"])):
        test = same_bytes_of(*words)
        globals()[f"test_the_same_bytes_of_{shape}_on_every_run_and_any_number_of_ranks"] = \
            test if shape in ("ball", "kuhn_cube") else of_full_level(test)


def test_kuhn_cube():
    mesh = make("--shape", "kuhn-cube", "--n", "4")

    assert len(mesh.cells) == 384 and len(mesh.points) == 125
    assert mesh.names == ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"]
    assert [len(mesh.faces_of(n)) for n in mesh.names] == [32] * 6


@of_one_process
def test_neighbors_in_the_file_are_neighbors_in_space():
    mesh = make("--shape", "sphere-in-box")

    inner = np.nonzero(mesh.neighbors >= 0)
    distance = np.abs(mesh.neighbors[inner] - inner[0])
    assert np.median(distance) < 0.01 * len(mesh.cells)


@of_one_process
def test_bad_usage_is_refused():
    for arguments, words in ((["--shape", "cube"], ["kuhn-cube", '"cube"']), ([], ["neither"]),
                             (["--shape", "kuhn-cube"], ["--n"]), (["--shape", "kuhn-cube", "--n", "-1"], ["--n"]),
                             (["--shape", "sphere-in-box", "--n", "3"], ["--n"]),
                             (["--shape", "sphere-in-box", "--unit", "mm"], ["--unit"]),
                             (["--shape", "sphere-in-box", "--size", "7"], ["0.6", "7"]),
                             (["--shape", "sphere-in-box", "--size", "0.02"], ["4 million cells"]),
                             (["--shape", "blunt-cone", "--size", "nan"], ["nan"]),
                             (["--shape", "charged-spheres", "--size", "nan"], ["nan"]),
                             (["missing.toml"], ["missing.toml"])):
        refuses("pamr-mesh", *arguments, "-o", "out.hdf", says=words, creates="out.hdf")


@of_one_process
def test_bad_case_files_are_refused_with_their_line():
    head = '[mesh]\nshape = "blunt-cone"\n'
    cases = (("[mesh", ["TOML", ":1"]), ("", ["[mesh]"]), ("mesh = 3\n", ["table", ":1"]),
             ("[mesh]\nlength_unit = 'm'\n", ["shape"]), ('[mesh]\nshape = "cone"\n', [":2:9", '"cone"']),
             (head, ["length_unit", "none"]), (head + 'length_unit = "mm"\n', [":3", '"mm"']),
             (head + 'length_unit = "m"\nsede = 1\n', [":4", "'sede'"]),
             (head + 'length_unit = "m"\nseed = -1\n', [":4", "-1"]),
             (head + 'length_unit = "m"\nsizes = 1\n', [":4", "table"]),
             (head + 'length_unit = "m"\n[mesh.sizes]\nshoulde = 1e-3\n', [":5", "'shoulde'", "shoulder"]),
             (head + 'length_unit = "m"\n[mesh.sizes]\nshoulder = 2e-3\n', [":5", "0.002"]),
             (head + 'length_unit = "m"\n[mesh.sizes]\nfar = nan\n', [":5", "nan"]),
             (head + 'length_unit = "m"\n[mesh.sizes]\nfar = "1"\n', [":5", '"1"']),
             (head + 'length_unit = "m"\n[mesh.geometry]\nouter_radius = 0.04\n', [":5", "0.045", "0.04"]),
             (head + 'length_unit = "m"\n[mesh.geometry]\noutflow = 0.01\n', [":5", "0.02", "0.01"]),
             (head + 'length_unit = "m"\nregion = "+a"\n', [":4", "'region'"]))
    ball = '[[surface]]\nname = "ball"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'
    head = '[mesh]\nshape = "surfaces"\nlength_unit = "1"\n'
    good = 'region = "-ball"\nbounds = [[-1, -1, -1], [1, 1, 1]]\n[mesh.sizes]\nfar = 0.5\n'
    cases += ((head + good, ["[[surface]]"]), (head + ball, ["region", "none"]),
              (head + good + ball.replace("sphere", "sfere"), [":10:8", '"sfere"']),
              (head + good + ball.replace("= 1", "= 0"), [":12:10", "radius"]),
              (head + good.replace("-ball", "-bell") + ball, [":4:10", '"bell"']),
              (head + good.replace("-ball", "-ball &") + ball, [":4", "its end"]),
              (head + good.replace("-ball", "+ball") + ball, ["bounds", "in it"]),
              (head + good.replace("[[-1, -1, -1], [1, 1, 1]]", "[[10, 10, 10], [12, 12, 12]]") + ball, ["bounds", "found none of it"]),
              (head + good.replace("[1, 1, 1]", "[1, 1, -1]") + ball, [":5", "-1"]),
              (head + good.replace("far = 0.5", "near = { ball = 1 }") + ball, ["far"]),
              (head + good + "near = { bell = 0.5 }\n" + ball, [":8", '"bell"']),
              (head + good + ball + ball.replace('"ball"', '"other"'), [":4", '"other"']),
              (head + good.replace("-ball", "-ball & -idle") + ball +
               ball.replace('"ball"', '"idle"').replace("radius = 1", "radius = 2"), ["no face", '"idle"']),
              ('[mesh]\nshape = "sphere-pair"\nlength_unit = "1"\n[mesh.geometry]\nradius = 3\n', ["distance", "4.5"]),
              ('[mesh]\nshape = "sphere-pair"\nlength_unit = "1"\n[mesh.geometry]\nheight = 3\n', [":5", "'height'"]),
              ('[mesh]\nshape = "supersonic-sphere"\nlength_unit = "m"\n[mesh.geometry]\nparts = 4.5\n', ["4.5"]),
              ('[mesh]\nshape = "supersonic-sphere"\nlength_unit = "m"\n[mesh.sizes]\nfar = 0.3\nsphere = 0.05\ngrowth = 0.2\n',
               ["0.6 radii", "0.003", "radius 0.005", "0.05"]),
              ('[mesh]\nshape = "supersonic-sphere"\nlength_unit = "m"\n[mesh.sizes]\nfar = 1e-3\nsphere = 2e-3\n',
               ["largest edge length", "0.002", "0.001"]))
    for text, words in cases:
        pathlib.Path("bad.toml").write_text(text)
        refuses("pamr-mesh", "bad.toml", "-o", "out.hdf", says=["bad.toml"] + words, creates="out.hdf")


def test_existing_output_stays():
    pathlib.Path("out.hdf").write_text("mine")

    run("pamr-mesh", "--shape", "kuhn-cube", "--n", "2", "-o", "out.hdf", code=2)

    assert pathlib.Path("out.hdf").read_text() == "mine"


run_tests(globals())
