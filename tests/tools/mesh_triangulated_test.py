# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated bodies as the boundary of a mesh: pamr-mesh makes it, pamr-refine rounds what is round in it."""
import pathlib

import h5py
import numpy as np

from surface_models import bored_cube, can, icosphere, wing, write_off, write_stl
from tool_run import FULL, RANKS, of_full_level, prepare_alone, refuses, run, run_tests, same_bytes
from tet import FACE_TO_CORNER

prepare_alone("pamr-mark", "pamr-quality")



def body_toml(file, keys=""):
    return f'[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "{file}"\n{keys}'


def case(name, region, bounds, sizes, surfaces):
    pathlib.Path(name).write_text(f'[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "{region}"\nbounds = {bounds}\n'
                                  f"[mesh.sizes]\n{sizes}\n{surfaces}")
    return name


def patches(name):
    """Points of each patch."""
    with h5py.File(name) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        cell, slot = np.nonzero(file["PAMR/cell_to_cell"][:] < 0)
        patch = -1 - file["PAMR/cell_to_cell"][:][cell, slot]
        names = [n.decode() for n in file["PAMR/patches/names"][:]]
    faces = cells[cell[:, None], FACE_TO_CORNER[slot]]
    return points, {n: np.unique(faces[patch == i]) for i, n in enumerate(names)}


def refine(name, levels, *marks):
    """Names of the meshes of all levels."""
    names = [name]
    for level in range(1, levels + 1):
        run("pamr-mark", names[-1], "-o", "marked.hdf", *marks, "--force", "--quiet")
        names.append(name.replace(".hdf", f"{level}.hdf"))
        report = run("pamr-refine", "marked.hdf", "-o", names[-1], "--force", "--json", "-").json
        assert report["inverted_cells"] == 0 and report["off_surface_nodes"] == 0
    return names


def write_solids(name, solids):
    """A text STL of several solids: name and triangles of each."""
    lines = []
    for solid, triangles in solids:
        corners = ["".join("vertex {!r} {!r} {!r}\n".format(*p) for p in triangle) for triangle in triangles]
        lines += [f"solid {solid}", *(f"facet normal 0 0 0\nouter loop\n{c}endloop\nendfacet" for c in corners), f"endsolid {solid}"]
    pathlib.Path(name).write_text("\n".join(lines) + "\n")


def quarter_sides(axis, value):
    """A side of a cube of side 1 about 0 as four squares, each of two triangles seen from outside."""
    def point(*uv):
        at = [value] * 3
        for k, x in zip((k for k in range(3) if k != axis), uv):
            at[k] = x
        return tuple(at)

    for u, v in ((-.5, -.5), (-.5, 0), (0, -.5), (0, 0)):
        a, b, c, d = point(u, v), point(u + .5, v), point(u + .5, v + .5), point(u, v + .5)
        both = [(a, b, c), (a, c, d)]
        yield [t[::-1] for t in both] if (value > 0) != (axis != 1) else both


def test_named_solids_of_an_stl_file_are_patches_whose_borders_stay():
    sides = {name: list(quarter_sides(axis, value)) for name, axis, value in (
        ("west", 0, -.5), ("east", 0, .5), ("south", 1, -.5), ("north", 1, .5), ("floor", 2, -.5), ("lid", 2, .5))}
    west = sides["west"]
    rest = sum(west[1:], []) + sum((t for name in list(sides)[1:] for t in sides[name]), [])
    write_solids("six.stl", [(name, sum(squares, [])) for name, squares in sides.items()])
    write_solids("two.stl", [("in let", west[0]), ("wall", rest)])
    for name, expected in ("six", sorted(sides)), ("two", ["in let", "wall"]):
        told = run("pamr-mesh", case(f"{name}.toml", "-body", [[-1] * 3, [1] * 3], "far = 0.4", body_toml(f"{name}.stl")), "-o", f"{name}.hdf", serial=True)
        assert sorted(patches(f"{name}.hdf")[1]) == expected and "left out" not in told.err, told.err
    for mesh in refine("two.hdf", 1, "--patch", "in let"):
        at, nodes = patches(mesh)
        border = at[np.intersect1d(nodes["in let"], nodes["wall"])]
        assert (at[nodes["in let"]][:, 0] == -.5).all() and (at[nodes["in let"]][:, 1:] <= 0).all()
        assert ((border[:, 1:] == 0) | (border[:, 1:] == -.5)).any(axis=1).all() and len(border) >= 8, border


def test_names_that_two_files_have_and_bodies_apart_are_noted():
    surfaces = ""
    for surface, x in (("a", 0), ("b", 3)):
        sides = [quarters for axis in range(3) for value in (-.5, .5) for quarters in quarter_sides(axis, value)]
        moved = [[tuple((p[0] + x, *p[1:]) for p in triangle) for triangle in quarter] for quarter in sides]
        write_solids(f"{surface}.stl", [("top", sum(moved[-4:], [])), ("rest", sum(moved[:-4], []))])
        surfaces += body_toml(f"{surface}.stl").replace('"body"', f'"{surface}"') + "\n"
    told = run("pamr-mesh", case("two.toml", "-a | -b", [[-1] * 3, [4, 1, 1]], "far = 0.5", surfaces), "-o", "two.hdf").err
    assert sorted(patches("two.hdf")[1]) == ["b_rest", "b_top", "rest", "top"]
    for part in ("top", "rest"):
        assert told.count(f'note: two.toml: surface "b": "{part}" of its file is the patch \'b_{part}\'') == 1, told
    assert told.count("note: two.toml: the mesh is in 2 pieces that no face joins") == 1, told
    told = run("pamr-mesh", case("one.toml", "-a", [[-1] * 3, [1] * 3], "far = 0.5", body_toml("a.stl").replace('"body"', '"a"')), "-o", "one.hdf").err
    assert "note: one.toml" not in told, told


def ball_of_two_solids(name, solids, n=12):
    """A ball of radius 1: the first solid is all above z = 0.5, which is a row of edges."""
    rows = [np.pi * k / 6 for k in range(1, 6)]
    rings = [[(np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)) for p in np.arange(n) * 2 * np.pi / n] for t in rows]
    rings = [[(0., 0., 1.)] * n, *(list(map(lambda q: tuple(map(float, q)), ring)) for ring in rings), [(0., 0., -1.)] * n]
    both = [], []
    for k, (upper, lower) in enumerate(zip(rings, rings[1:])):
        for i in range(n):
            a, b, c, d = upper[i], lower[i], lower[(i + 1) % n], upper[(i + 1) % n]
            both[k >= 2].extend(t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3)
    write_solids(name, zip(solids, both))


def border_between(name):
    """Heights of the nodes that all patches of a mesh have in common."""
    at, nodes = patches(name)
    return at[np.intersect1d(*nodes.values())][:, 2]


def test_a_mesh_of_another_program_gets_the_named_solids_of_its_body():
    ball_of_two_solids("ball.stl", ("cap", "rest"))
    run("pamr-mesh", case("ball.toml", "-body", [[-1] * 3, [1] * 3], "far = 0.5", body_toml("ball.stl")), "-o", "made.hdf", serial=True)
    run("pamr-convert", "made.hdf", "made.msh", "--quiet")
    pathlib.Path("body.toml").write_text("# mine\n" + body_toml("ball.stl"))

    told = run("pamr-convert", "made.msh", "named.hdf", "--surfaces", "body.toml", "--json", "-")
    assert {p: tie["surface"] for p, tie in told.json["ties"].items()} == {"cap": "body", "rest": "body"}, told.json["ties"]
    assert "left out" not in told.err and "across" not in told.err, told.err
    ball_of_two_solids("other.stl", ("head", "rest of it"))
    pathlib.Path("other.toml").write_text(body_toml("other.stl"))
    other = run("pamr-convert", "made.msh", "other.hdf", "--surfaces", "other.toml", "--tie", "cap=body", "--tie", "rest=body")
    assert "the names of 2 solids" in other.err, other.err
    off = {}
    for mesh in ("made", "named", "other"):
        fine = refine(f"{mesh}.hdf", 1, "--patch", "cap")[-1]
        assert len(border_between(fine)) > 1.5 * len(border_between("made.hdf"))
        off[mesh] = np.abs(border_between(fine) - 0.5).max()
    assert off["named"] < 1.001 * off["made"] + 1e-12 and off["named"] < off["other"] / 5, off

    run("pamr-convert", "made.hdf", "plain.hdf", "--quiet")
    same = run("pamr-convert", "plain.hdf", "again.hdf", "--surfaces", "body.toml", "--json", "-").json["ties"]
    assert same == told.json["ties"]
    pathlib.Path("two.toml").write_text(body_toml("ball.stl") + body_toml("ball.stl").replace('"body"', '"twin"'))
    refuses("pamr-convert", "made.msh", "no.hdf", "--surfaces", "two.toml", says=["patch 'cap'", '"body" and "twin"', "--tie"], creates="no.hdf")
    # one part of two has a patch: its border stays
    ball_of_two_solids("part.stl", ("cap", "ocean"))
    told = run("pamr-convert", "made.msh", "part.hdf", "--surface", "part.stl", "--patch", "cap")
    assert 'left out: the name "ocean"' in told.err, told.err
    with h5py.File("part.hdf") as file:
        assert "border_edges" in file["PAMR/surfaces"].asstr()[()]


@of_full_level
def test_nodes_on_a_coarse_sphere_are_nearer_to_the_ball_than_its_triangles():
    points, triangles = icosphere(2)
    write_stl("ball.stl", points, triangles)
    run("pamr-mesh", case("ball.toml", "-body", [[-1] * 3, [1] * 3], "far = 0.5", body_toml("ball.stl")), "-o", "ball.hdf", serial=True)
    facets = max(1 - np.linalg.norm(points[list(t)].mean(axis=0)) for t in triangles)

    for name in refine("ball.hdf", 3, "--patch", "body"):
        at, nodes = patches(name)
        assert list(nodes) == ["body"]
        assert np.abs(np.linalg.norm(at[nodes["body"]], axis=1) - 1).max() < facets / 50


def test_edges_of_a_machined_part_stay_sharp_and_its_planes_planar():
    write_stl("part.stl", *bored_cube(24))
    run("pamr-mesh", case("part.toml", "-body", [[-1] * 3, [1] * 3], "far = 0.5", body_toml("part.stl")), "-o", "part.hdf", serial=True)

    for name in refine("part.hdf", 2 if FULL else 1, "--all"):
        at, nodes = patches(name)
        assert sorted(nodes) == [f"body_{i}" for i in range(1, 8)]
        planes = {n: next(((axis, side) for axis in range(3) for side in (-1, 1) if (at[k][:, axis] == side).all()), None)
                  for n, k in nodes.items()}
        bore = next(n for n, plane in planes.items() if plane is None)
        assert len(set(planes.values())) == 7, "six planes, to the last bit, and the bore"
        assert np.abs(np.hypot(*at[nodes[bore]][:, :2].T) - 0.5).max() < 2e-4, "its facets are 4e-3 away"
        rims = [np.intersect1d(nodes[bore], nodes[n]) for n, plane in planes.items() if plane in ((2, -1), (2, 1))]
        assert all(len(r) >= 8 and np.abs(np.hypot(*at[r][:, :2].T) - 0.5).max() < 1e-8 for r in rims)
        corner = [k for k in range(len(at)) if (np.abs(at[k]) == 1).all()]
        assert len(corner) == 8
    volume = run("pamr-quality", name, "--json", "-", "--quiet").json["volume"]
    assert abs(volume - (8 - np.pi / 2)) < (0.02 if FULL else 0.08)


@of_full_level
def test_a_body_can_stand_in_a_box_with_other_bodies():
    write_off("part.off", *bored_cube(16))
    planes = "".join(f'[[surface]]\nname = "{n}{s}"\nkind = "plane"\npoint = {[3 * (2 * s - 1) * (i == k) for i in range(3)]}\n'
                     f"normal = {[int(i == k) for i in range(3)]}\n" for k, n in enumerate("xyz") for s in (0, 1))
    ball = '[[surface]]\nname = "ball"\nkind = "sphere"\ncenter = [2, 2, 2]\nradius = 0.5\n'
    text = case("box.toml", "+x0 & -x1 & +y0 & -y1 & +z0 & -z1 & +body & +ball", [[-3] * 3, [3] * 3],
                "far = 1\nnear = { body = 0.5, ball = 0.3 }", body_toml("part.off") + planes + ball)
    report = run("pamr-mesh", text, "-o", "box.hdf", "--json", "-").json
    run("pamr-mesh", text, "-o", "again.hdf", "--quiet", serial=RANKS > 1)

    assert set(report["patches"]) == {"x0", "x1", "y0", "y1", "z0", "z1", "ball", *(f"body_{i}" for i in range(1, 8))}
    assert same_bytes("box.hdf", "again.hdf")
    refine("box.hdf", 1, "--patch", "body_7")


def test_a_plane_cuts_a_ball_in_half():
    write_stl("ball.stl", *icosphere(2))
    cut = '[[surface]]\nname = "cut"\nkind = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n'
    exact = '[[surface]]\nname = "body"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'
    for body, near in ((body_toml("ball.stl"), 2e-4), (exact, 1e-15)):
        case("half.toml", "-body & +cut", [[-1, -1, 0], [1, 1, 1]], "far = 0.4", body + cut)
        run("pamr-mesh", "half.toml", "-o", "half.hdf", "--force", "--quiet", serial=True)
        for name in refine("half.hdf", 1, "--patch", "body"):
            at, nodes = patches(name)
            assert (at[nodes["cut"]][:, 2] == 0).all()
            assert np.abs(np.linalg.norm(at[nodes["body"]], axis=1) - 1).max() < near
            rim = np.intersect1d(nodes["body"], nodes["cut"])
            assert len(rim) > 12 and np.abs(np.linalg.norm(at[rim], axis=1) - 1).max() < near


def plane(name, point, normal):
    return f'[[surface]]\nname = "{name}"\nkind = "plane"\npoint = {point}\nnormal = {normal}\n'


@of_full_level
def test_a_plane_cuts_a_body_across_its_sharp_edges():
    write_stl("part.stl", *bored_cube(16))
    case("part.toml", "-body & +cut", [[-1] * 3, [1] * 3], "far = 0.5", body_toml("part.stl") + plane("cut", [0, 0, 0], [0, 1, 0]))
    run("pamr-mesh", "part.toml", "-o", "part.hdf", serial=True)

    for name in refine("part.hdf", 2, "--patch", "cut"):
        at, nodes = patches(name)
        assert len(nodes) == 7 and (at[nodes["cut"]][:, 1] == 0).all()
        planes = {n: next(((axis, side) for axis in range(3) for side in (-1, 1) if (at[k][:, axis] == side).all()), None)
                  for n, k in nodes.items() if n != "cut"}
        bore = next(n for n, side in planes.items() if side is None)
        assert set(planes.values()) == {(0, -1), (0, 1), (1, 1), (2, -1), (2, 1), None}, "the side y = -1 is gone"
        corners = {tuple(at[k]) for k in nodes["cut"] if sum(k in of for of in nodes.values()) == 3}
        assert corners == {(x, 0, z) for x in (-1, -0.5, 0.5, 1) for z in (-1, 1)}, "four edges and both rims, two times each"
        rims = [np.intersect1d(nodes[bore], nodes[n]) for n, side in planes.items() if side in ((2, -1), (2, 1))]
        assert all(len(r) >= 5 and np.abs(np.hypot(*at[r][:, :2].T) - 0.5).max() < 1e-4 for r in rims)
        assert all(len(np.intersect1d(nodes["cut"], nodes[n])) >= 5 for n, side in planes.items() if side != (1, 1))
    volume = run("pamr-quality", name, "--json", "-", "--quiet").json["volume"]
    assert abs(volume - (4 - np.pi / 4)) < 0.03, "level 0: 0.032; cells of the bore far from the cut stay coarse"


def test_a_body_stands_in_the_ground_and_a_ball_cuts_its_corner():
    block = np.array([[x, y, z] for z in (-1, 1) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))], dtype=float)
    sides = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)]
    for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)):
        sides += [(i, j, 4 + j), (i, 4 + j, 4 + i)]
    write_stl("block.stl", block, sides)
    ball = '[[surface]]\nname = "ball"\nkind = "sphere"\ncenter = [1, 1, 1]\nradius = 0.375\n'
    walls = "".join(plane(f"{n}{s}", [2 * s * (i == k) for i in range(3)], [int(i == k) for i in range(3)])
                    for k, n in enumerate("xyz") for s in (-1, 1) if (n, s) != ("z", -1))
    # a third of the block is over the ground: triangles of two sides have their middles under it
    text = case("ground.toml", "+x-1 & -x1 & +y-1 & -y1 & -z1 & +ground & +body & +ball", [[-2, -2, 0.4], [2, 2, 2]],
                "far = 0.7\nnear = { body = 0.4, ball = 0.25 }",
                body_toml("block.stl") + ball + walls + plane("ground", [0, 0, 0.4], [0, 0, 1]))
    run("pamr-mesh", text, "-o", "ground.hdf")
    if FULL:
        run("pamr-mesh", text, "-o", "again.hdf", "--quiet", serial=RANKS > 1)
        assert same_bytes("ground.hdf", "again.hdf")

    missing = []
    for name in refine("ground.hdf", 2 if FULL else 1, "--all"):
        at, nodes = patches(name)
        body = [n for n in nodes if n.startswith("body")]
        assert len(body) == 5 and (at[nodes["ground"]][:, 2] == 0.4).all()
        assert np.abs(np.linalg.norm(at[nodes["ball"]] - 1, axis=1) - 0.375).max() < 1e-14
        assert all(any((at[nodes[n]][:, axis] == side).all() for axis in range(3) for side in (-1, 1)) for n in body)
        assert {(1, 1, 0.4), (-1, 1, 0.4), (1, -1, 0.4), (-1, -1, 0.4)} <= {tuple(p) for p in at[nodes["ground"]]}
        corners = {tuple(at[k].round(14)) for k in nodes["ball"] if sum(k in nodes[n] for n in body) == 2}
        assert corners == {(0.625, 1, 1), (1, 0.625, 1), (1, 1, 0.625)}
        volume = run("pamr-quality", name, "--json", "-", "--quiet").json["volume"]
        missing.append(abs(volume - (4 * 4 * 1.6 - 4 * 0.6 - 7 / 6 * np.pi * 0.375 ** 3)))
    assert all(fine < coarse / 3 for coarse, fine in zip(missing, missing[1:])), missing


@of_full_level
def test_a_mirror_cuts_a_wing_across_the_edge_that_ends_in_its_skin():
    write_stl("wing.stl", *wing(16))
    ball = '[[surface]]\nname = "far"\nkind = "sphere"\ncenter = [0.5, 0, 0]\nradius = 3\n'
    case("wing.toml", "+body & +root & -far", [[-3, -3, 0], [4, 3, 3]], "far = 1\nnear = { body = 0.2 }",
         body_toml("wing.stl") + plane("root", [0, 0, 0.05], [0, 0, 1]) + ball)
    run("pamr-mesh", "wing.toml", "-o", "wing.hdf", serial=True)

    for name, least in zip(refine("wing.hdf", 1, "--patch", "body_1"), (5, 10)):
        at, nodes = patches(name)
        assert sorted(nodes) == ["body_1", "body_3", "far", "root"] and (at[nodes["root"]][:, 2] == 0.05).all()
        behind = at[nodes["body_1"]][np.abs(at[nodes["body_1"]][:, 0] - 1) < 1e-12]
        assert len(behind) > least and np.abs(behind[:, 1]).max() < 1e-12 and behind[:, 2].min() == 0.05
        assert at[nodes["body_1"]][:, 0].max() < 1 + 1e-12
        assert (1, 0) in {tuple(p) for p in at[np.intersect1d(nodes["root"], nodes["body_1"])][:, :2].round(14)}


def test_cuts_along_sharp_edges_are_refused():
    write_stl("part.stl", *bored_cube(16))
    for cut, words in ((plane("cut", [0, 0, 0], [1, -1, 0]), ["lies in another surface"]),
                       (plane("cut", [0, 0, -1], [0, 0, 1]), ["lies in another surface"])):
        case("cut.toml", "-body & +cut", [[-1] * 3, [1] * 3], "far = 0.4", body_toml("part.stl") + cut)
        refuses("pamr-mesh", "cut.toml", "-o", "no.hdf", says=["cut.toml", '"body"', *words], creates="no.hdf")
    write_stl("can.stl", *can(24))
    case("cut.toml", "-body & +cut", [[-1] * 3, [1] * 3], "far = 0.4", body_toml("can.stl") + plane("cut", [0, 0.9995, 0], [0, -1, 0]))
    refuses("pamr-mesh", "cut.toml", "-o", "no.hdf", says=["cut.toml", "5 degrees"], creates="no.hdf")


def test_a_body_that_is_thinner_than_its_edges_is_warned_of_by_place():
    corners = np.array([[x, y, z] for z in (-.125, .125) for x, y in ((.6, .6), (-.6, .6), (-.6, -.6), (.6, -.6))])
    sides = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)]
    for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)):
        sides += [(i, j, 4 + j), (i, 4 + j, 4 + i)]
    write_stl("plate.stl", corners, sides)
    bounds = [[-1, -1, -1], [1, 1, 1]]
    warned = run("pamr-mesh", case("plate.toml", "-body", bounds, "far = 0.4", body_toml("plate.stl")), "-o", "plate.hdf", serial=True)
    assert "the body is 0.25 thick near [" in warned.err.lower() and "[mesh.sizes] far" in warned.err, warned.err
    if FULL:
        out = run("pamr-mesh", case("plate.toml", "-body", bounds, "far = 0.3", body_toml("plate.stl")), "-o", "fine.hdf", serial=True)
        assert "thick" not in out.err, out.err


def test_a_surface_that_cuts_through_itself_is_told():
    one, triangles = icosphere(1)
    n = len(one)
    points = np.vstack([one, one + [1.1, 0.1, 0.05]])
    write_off("pair.off", points, triangles + [tuple(i + n for i in t) for t in triangles])
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", "ball.hdf", "--quiet", serial=True)
    pathlib.Path("pair.toml").write_text(body_toml("pair.off"))

    told = run("pamr-convert", "ball.hdf", "out.hdf", "--surfaces", "pair.toml", "--tie", "sphere=body", "--tolerance", "9")

    assert 'surface "body" cuts through itself' in told.err and "pairs of triangles" in told.err


def test_bad_bodies_are_refused():
    points, triangles = icosphere(1)
    for name, text, words in (("empty", [], ["(empty)"]), ("open", triangles[1:], ["(open)"]),
                              ("thick", triangles + [triangles[0]], ["non-manifold"]),
                              ("turned", [triangles[0][::-1]] + triangles[1:], ["orientation"])):
        write_off(f"{name}.off", points, text)
        case("bad.toml", "-body", [[-1] * 3, [1] * 3], "far = 0.5", body_toml(f"{name}.off"))
        refuses("pamr-mesh", "bad.toml", "-o", "out.hdf", says=["bad.toml:8", f"{name}.off", *words], creates="out.hdf")
    write_off("part.off", *bored_cube(16))
    for keys, words in (("near = [1, 0, 0]", ["near"]), ("creases = [[[0, 0, 0], [1, 0, 0]]]", ["segment 1 of polyline 1"]),
                        ("creases = [[1, 2]]", ["polylines", "1"]), ("feature_angle = 200", ["feature_angle", "200"]),
                        ("shortest_crease = -1", ["shortest_crease", "-1"])):
        case("bad.toml", "-body", [[-1] * 3, [1] * 3], "far = 0.5", body_toml("part.off", keys + "\n"))
        refuses("pamr-mesh", "bad.toml", "-o", "out.hdf", says=["bad.toml", *words], creates="out.hdf")


run_tests(globals())
