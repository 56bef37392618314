# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-surface from the command line: what it says of surfaces, mends, edits, writes, and refuses."""
import json
import math
import pathlib

import numpy as np

from surface_models import can, icosphere, write_off, write_stl
import tool_run
from tool_run import RANKS, refuses, run_tests, same_bytes
from whole_meshio import meshio


def run(tool, *arguments, **options):
    """One process does the work of pamr-surface whatever their number, which one test shows."""
    return tool_run.run(tool, *arguments, **{"ranks": 1} | options)


def ball(name="ball.stl", levels=3):
    points, triangles = icosphere(levels)
    (write_stl if name.endswith(".stl") else write_off)(name, points, triangles)
    return name


def volume_of(points, triangles):
    a, b, c = (np.asarray(points)[np.asarray(triangles)[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def damaged(name):
    """A ball with two holes, two turned and two doubled triangles, and a crumb beside it."""
    points, triangles = icosphere(4)
    triangles = [t for t in triangles if points[t[0]][2] < 0.97]
    del triangles[77]
    for i in (5, 300):
        triangles[i] = triangles[i][::-1]
    triangles += triangles[20:22]
    n = len(points)
    points = np.concatenate([points, [(2, 0, 0), (2.1, 0, 0), (2, 0.1, 0)]])
    write_off(name, points, triangles + [(n, n + 1, n + 2)])
    return name


def test_info_knows_a_sound_body():
    report = run("pamr-surface", "info", ball(), "--json", "-").json
    assert report["body"] and report["closed"] and report["valid"] and report["faults"] == []
    assert report["triangles"] == 1280 and report["points"] == 642 and report["n_shells"] == 1
    assert abs(report["volume"] - volume_of(*icosphere(3))) < 1e-5 and report["self_intersections"]["count"] == 0
    assert 1e-3 < report["deviation"]["worst"] < 1e-2
    assert "1280 triangles" in run("pamr-surface", "info", "ball.stl").out


def test_info_says_what_is_wrong_and_where():
    result = run("pamr-surface", "info", damaged("bad.off"), "--json", "info.json", code=1)
    report = json.loads(pathlib.Path("info.json").read_text())
    assert report["turned_edges"]["count"] == 6 and report["duplicate_triangles"]["count"] == 2
    assert report["n_loops"] == 3 and report["non_manifold_edges"]["count"] == 6 and not report["body"]
    assert report["self_intersections"] is None
    for word in ("open edges in 3 holes", "triangles twice", "opposite orientation", "at ["):
        assert word in result.err, result.err


def test_repair_makes_a_body_and_counts_its_steps():
    report = run("pamr-surface", "repair", damaged("bad.off"), "-o", "good.ply", "--close-holes", 0.8, "--json", "-").json
    assert report["turned_triangles"] == 2 and report["duplicate_triangles"] == 2 and report["dropped_shells"] == 1
    assert report["holes"]["closed"] == 2 and report["left"]["body"]
    run("pamr-surface", "repair", "bad.off", "-o", "ranks.ply", "--close-holes", 0.8, ranks=RANKS)
    assert same_bytes("good.ply", "ranks.ply")
    run("pamr-surface", "info", "bad.off", "--json", "ranks.json", code=1, ranks=RANKS)
    again = run("pamr-surface", "repair", "good.ply", "-o", "same.ply", "--json", "-").json
    assert again["steps"] == [] and same_bytes("good.ply", "same.ply")
    assert abs(run("pamr-surface", "info", "good.ply", "--json", "-").json["volume"] - 4 * math.pi / 3) < 0.03


def test_repair_says_what_is_left():
    result = run("pamr-surface", "repair", damaged("bad.off"), "-o", "open.ply", "--close-holes", 0.2, code=1)
    assert "left: " in result.err and "1 hole" in result.err and "wide at" in result.err
    run("pamr-surface", "repair", "bad.off", "-o", "end.ply", "--close-holes", 0.2, "--open")


def test_a_repaired_body_is_what_pamr_mesh_takes():
    run("pamr-surface", "repair", damaged("bad.off"), "-o", "body.ply", "--close-holes", 0.8)
    pathlib.Path("case.toml").write_text(
        '[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "-body"\nbounds = [[-2, -2, -2], [2, 2, 2]]\n'
        '[mesh.sizes]\nfar = 0.5\n[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "body.ply"\n')
    run("pamr-mesh", "case.toml", "-o", "body.hdf")
    assert run("pamr-quality", "body.hdf", "--json", "-").json["valid"]


def boxes(name, *boxes_of):
    """Boxes from LOW to HIGH, those with a third entry seen from inside."""
    points, triangles = [], []
    for low, high, *turned in boxes_of:
        n = len(points)
        points += [(x, y, z) for z in (low[2], high[2]) for x, y in ((high[0], high[1]), (low[0], high[1]), (low[0], low[1]), (high[0], low[1]))]
        sides = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)]
        for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)):
            sides += [(i, j, 4 + j), (i, 4 + j, 4 + i)]
        triangles += [tuple(n + i for i in (t[::-1] if turned else t)) for t in sides]
    write_off(name, points, triangles)
    return name


UNIT, INNER = ((0, 0, 0), (1, 1, 1)), ((.25, .25, .25), (.75, .75, .75))


def mesh_case(surface, far=0.6):
    pathlib.Path("case.toml").write_text(
        '[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "-body"\nbounds = [[-1, -1, -1], [4, 2, 2]]\n'
        f'[mesh.sizes]\nfar = {far}\n[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "{surface}"\n')
    return "case.toml"


def test_a_box_in_a_box_is_no_body_until_the_inner_one_is_a_cavity():
    result = run("pamr-surface", "info", boxes("nest.off", UNIT, INNER), "--json", "info.json", code=1)
    report = json.loads(pathlib.Path("info.json").read_text())
    assert not report["body"] and report["valid"] and [s["inside_of"] for s in report["shells"]] == [0, 1]
    assert "1 shell seen from the wrong side" in result.err and "[0.75, 0.75, 0.25]" in result.err, result.err
    refuses("pamr-mesh", mesh_case("nest.off"), "-o", "no.hdf", creates="no.hdf",
            says=['surface "body"', "lies inside of another and faces outwards", "[0.75, 0.75, 0.25]", "pamr-surface repair"])
    out = run("pamr-surface", "repair", "nest.off", "-o", "hollow.off")
    assert "shells inside of others turned inwards: 1" in out.out and "outwards" not in out.out, out.out
    assert run("pamr-surface", "info", "hollow.off", "--json", "-").json["body"]
    run("pamr-mesh", mesh_case("hollow.off"), "-o", "hollow.hdf")
    assert abs(run("pamr-quality", "hollow.hdf", "--json", "-").json["volume"] - 0.875) < 1e-12


def test_bodies_that_touch_or_cut_are_left_alone_and_refused_by_name_and_place():
    for name, other in (("outside", ((1, .25, .25), (1.5, .75, .75))), ("inside", ((.5, .25, .25), (1, .75, .75))),
                        ("edge", ((1, 1, .25), (1.5, 1.5, .75))), ("across", ((.75, .25, .25), (1.25, .75, .75)))):
        boxes(f"{name}.off", UNIT, other)
        result = run("pamr-surface", "repair", f"{name}.off", "-o", f"{name}2.off", "--json", f"{name}.json", code=1)
        report = json.loads(pathlib.Path(f"{name}.json").read_text())
        assert report["turned_shells"] == 0 and abs(report["left"]["volume"] - 1.125) < 1e-14, name
        assert "1 pair of shells that touch or cut each other" in result.err, result.err
        refuses("pamr-mesh", mesh_case(f"{name}2.off"), "-o", "no.hdf", creates="no.hdf",
                says=['surface "body"', "touches or cuts", "12 triangles at [1, 1, 0]", "near ["])
    boxes("two.off", UNIT, ((2, 0, 0), (3, 1, 1), "turned"))
    refuses("pamr-mesh", mesh_case("two.off"), "-o", "no.hdf", says=['surface "body"', "faces inwards and lies in no other", "[2, 1, 0]"])


def test_quads_and_text_of_cad_programs_are_read():
    pathlib.Path("box.obj").write_text("".join(f"v {x} {y} {z}\n" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
                                       + "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
    report = run("pamr-surface", "info", "box.obj", "--json", "-").json
    assert report["body"] and report["triangles"] == 12 and report["volume"] == 1
    write_stl("ball.stl", *icosphere(1))
    text = pathlib.Path("ball.stl").read_text()
    pathlib.Path("two.stl").write_text(text.replace("solid body", "solid hull").replace("endsolid hull", "endsolid hull\nsolid lid\nendsolid"))
    assert 'left out: the names of 2 solids ("hull", "lid")' in run("pamr-surface", "info", "two.stl").err
    write_off("ball.off", *icosphere(2))
    run("pamr-surface", "scale", "ball.off", "-o", "ball.stl", "--factor", "1", "--binary", "--force")
    with open("ball.stl", "ab") as file:
        file.write(b"made by X")
    says = ": left out: 9 bytes behind the 320 triangles that the file announces"
    for command in (("info",), ("repair", "-o", "mended.off"), ("decimate", "--error", "0.1", "-o", "few.off")):
        assert "ball.stl" + says in run("pamr-surface", command[0], "ball.stl", *command[1:]).err, command
    assert 'surface "body"' + says in run("pamr-mesh", mesh_case("ball.stl"), "-o", "ball.hdf").err
    assert says in run("pamr-convert", "ball.hdf", "tied.hdf", "--surface", "ball.stl", "--patch", "body").err
    with open("ball.stl", "r+b") as file:
        for facet in (0, 7, 319):  # in either byte of the two
            file.seek(84 + 50 * facet + 48 + facet % 2)
            file.write(b"\x80")
    attributes = says.replace("left out: ", "left out: attribute bytes, which may be colors, of 3 faces, ")
    assert "ball.stl" + attributes in run("pamr-surface", "info", "ball.stl").err


def test_what_files_have_beside_their_shape_is_counted():
    write_off("ball.off", *icosphere(2))
    run("pamr-surface", "scale", "ball.off", "-o", "ball.obj", "--factor", "1", "--force")
    with open("ball.obj", "a") as file:
        file.write("vn 0 0 1\nvn 0 1 0\nvt 0 0\ng lid\ng hull\n")
    says = ': left out: the names of 2 groups ("lid", "hull"), which are one surface, 2 normals, 1 texture coordinate\n'
    assert run("pamr-surface", "info", "ball.obj").err.count(says) == 1
    assert run("pamr-mesh", mesh_case("ball.obj"), "-o", "ball.hdf", "--force").err.count('surface "body"' + says) == 1
    assert run("pamr-convert", "ball.hdf", "tied.hdf", "--force", "--surface", "ball.obj", "--patch", "body").err.count(says) == 1


def test_decimate_keeps_error_number_and_edges():
    points, triangles = can(64)
    write_off("can.off", points, triangles)
    run("pamr-surface", "subdivide", "can.off", "-o", "fine.off", "--steps", 2)
    report = run("pamr-surface", "decimate", "fine.off", "-o", "few.off", "--error", 0.01, "--json", "-").json
    assert max(report["distance"][side]["at_most"] for side in ("from_old", "to_old")) <= 0.01
    assert report["triangles"] < 400
    after = run("pamr-surface", "info", "few.off", "--json", "-").json
    assert after["body"] and after["box"]["high"][2] == 1
    report = run("pamr-surface", "decimate", ball("ball.off", 4), "-o", "ball.obj", "--triangles", 1000, "--json", "-").json
    assert 998 <= report["triangles"] <= 1000


def test_edits_keep_a_body():
    ball("ball.off")
    for command in (["smooth", "--steps", 3], ["subdivide", "--scheme", "butterfly"], ["remesh", "--size", 0.2],
                    ["scale", "--unit", "mm"], ["scale", "--factor", 3], ["translate", "--by=1,-2,0.5"]):
        run("pamr-surface", command[0], "ball.off", "-o", "out.ply", "--force", *command[1:])
        assert run("pamr-surface", "info", "out.ply", "--json", "-").json["body"], command
    low = run("pamr-surface", "info", "out.ply", "--json", "-").json["box"]["low"]
    assert np.allclose(low, [0, -3, -0.5], atol=0.02)


def test_every_format_keeps_the_coordinates_to_the_bit():
    ball("ball.off")
    for name in ("a.obj", "b.ply", "c.off", "d.stl"):
        run("pamr-surface", "scale", "ball.off", "-o", name, "--factor", 1)
    old = meshio.read("ball.off")
    for name in ("a.obj", "c.off"):
        assert np.array_equal(meshio.read(name).points, old.points), name
    assert np.array_equal(meshio.read("b.ply").points, old.points)
    run("pamr-surface", "scale", "d.stl", "-o", "back.stl", "--factor", 1)
    assert same_bytes("d.stl", "back.stl")
    run("pamr-surface", "scale", "ball.off", "-o", "e.stl", "--factor", 1, "--binary")
    assert pathlib.Path("e.stl").stat().st_size == 84 + 50 * 1280
    assert len(meshio.read("e.stl").cells_dict["triangle"]) == 1280


def test_bad_input_is_one_clear_message():
    damaged("bad.off")
    refuses("pamr-surface", "decimate", "bad.off", "-o", "x.off", "--triangles", 10, says=["bad.off", "pamr-surface repair"],
            creates="x.off")
    ball()
    refuses("pamr-surface", says=["--help", "expected a command (info, repair, decimate", "found none"])
    refuses("pamr-surface", "body.stl", says=["found 'body.stl'; did you mean `pamr-surface info body.stl`?"])
    refuses("pamr-surface", "repiar", "body.stl", says=["found 'repiar'; did you mean `pamr-surface repair`?"])
    refuses("pamr-surface", "--qiet", "info", "body.stl", says=["did you mean --quiet?"])
    refuses("pamr-surface", "shrink", "ball.stl", says=["--help"])
    refuses("pamr-surface", "info", "none.stl", says=["none.stl"])
    refuses("pamr-surface", "info", "bad.off", "--error", 1, says=["--error"])
    refuses("pamr-surface", "decimate", "ball.stl", "-o", "x.off", says=["--error E or --triangles N"], creates="x.off")
    refuses("pamr-surface", "repair", "ball.stl", "-o", "x.step", says=[".stl, .obj, .ply or .off"], creates="x.step")
    refuses("pamr-surface", "repair", "ball.stl", "-o", "ball.stl", "--force", says=["ball.stl"])
    refuses("pamr-surface", "scale", "ball.stl", "-o", "x.off", "--unit", "furlong", says=["furlong", "mm"], creates="x.off")
    refuses("pamr-surface", "scale", "ball.stl", "-o", "x.off", says=["--factor F or --unit U"], creates="x.off")
    refuses("pamr-surface", "translate", "ball.stl", "-o", "x.off", "--by", "1,2", says=["X,Y,Z"], creates="x.off")
    refuses("pamr-surface", "remesh", "ball.stl", "-o", "x.off", "--size", "-1", says=["--size"], creates="x.off")
    refuses("pamr-surface", "remesh", "ball.stl", "-o", "x.off", "--size", "1e-6", says=["fewer than 1e+08 triangles"], creates="x.off")
    for command, option, value, says in (("scale", "--factor", "1e300", "below 1e30"), ("translate", "--by", "1e300,0,0", "below 1e30"),
                                         ("scale", "--factor", "1e-323", "keep the points apart"),
                                         ("translate", "--by", "1e20,0,0", "keep the points apart")):
        refuses("pamr-surface", command, "ball.stl", "-o", "x.off", option, value, says=[says], creates="x.off")
    pathlib.Path("cut.stl").write_bytes(pathlib.Path("ball.stl").read_bytes()[:1000])
    refuses("pamr-surface", "repair", "cut.stl", "-o", "x.off", says=["cut.stl"], creates="x.off")
    pathlib.Path("line.obj").write_text("v 0 0 0\nv 1 0 0\nf 1 2\n")
    refuses("pamr-surface", "info", "line.obj", says=["line.obj:3", "point of a face"])
    run("pamr-surface", "scale", "ball.stl", "-o", "old.off", "--factor", 1)
    refuses("pamr-surface", "scale", "ball.stl", "-o", "old.off", "--factor", 2, says=["--force"])


run_tests(globals())
