# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-surface from the command line: what it says of surfaces, mends, edits, writes, and refuses."""
import json
import math
import pathlib

import meshio
import numpy as np

from surface_models import can, icosphere, write_off, write_stl
import tool_run
from tool_run import RANKS, refuses, run_tests, same_bytes


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
    refuses("pamr-surface", says=["--help"])
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
    pathlib.Path("cut.stl").write_bytes(pathlib.Path("ball.stl").read_bytes()[:1000])
    refuses("pamr-surface", "repair", "cut.stl", "-o", "x.off", says=["cut.stl"], creates="x.off")
    pathlib.Path("quad.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    refuses("pamr-surface", "info", "quad.obj", says=["quad.obj:5", "four corners"])
    run("pamr-surface", "scale", "ball.stl", "-o", "old.off", "--factor", 1)
    refuses("pamr-surface", "scale", "ball.stl", "-o", "old.off", "--factor", 2, says=["--force"])


run_tests(globals())
