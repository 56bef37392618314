# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls that are much too coarse for their curvature: the short form of tests/validation/curved_walls.py."""
import math
import pathlib
import sys

from surface_models import icosphere, write_stl
from tool_run import run, run_tests, same_bytes

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "validation"))
import curved_walls  # noqa: E402


def call(tool, *words):
    return run(tool, *words, serial=tool in ("pamr-mesh", "pamr-mark", "pamr-quality")).out


def refined(name, size, levels):
    """What is measured at each level, and the reports of the refinements."""
    folder = pathlib.Path(".").resolve()
    case, mesh = curved_walls.make_level_0(call, name, size, "pamr", folder)
    rows, reports = [curved_walls.measure(call, case, mesh)], []
    for level in range(1, levels + 1):
        report, mesh = curved_walls.refine(call, case, mesh, folder, level)
        rows.append(curved_walls.measure(call, case, mesh))
        reports.append(report)
    return rows, reports


def expect_wall_followed(name, size, levels, orders):
    rows, reports = refined(name, size, levels)
    for row, report in zip(rows[1:], reports):
        assert row["inverted"] == 0 and row["valid"] and report["marked_not_split"] == 0
        assert row["off"] == 0 == report["off_surface_nodes"], f"{name}: {row['off']} nodes off their surface"
        assert row["worst distance"] <= 1e-12 and row["edge"] <= 1e-12
    for key, least in orders.items():
        found = curved_walls.order(rows[-2][key], rows[-1][key])
        assert found >= least, f"{name}: {key} falls with order {found}"
    return reports


SECOND = {"area error": 1.8, "volume error": 1.7}


def test_a_ball_known_by_seven_nodes_is_followed_by_untangling():
    reports = expect_wall_followed("ball-in-box", 2.0, 3, SECOND)

    assert sum(r["untangling_rounds"] for r in reports) > 0
    assert all(r["moved_nodes"] > 0 and r["cells_checked"] > 0 for r in reports)


def test_area_and_volume_converge_at_second_order_and_normals_at_first():
    for name, size in (("ball", 1.2), ("bored-box", 1.6), ("torus-in-box", 2.0), ("ellipsoid", 1.0), ("dish", 0.8),
                       ("thin-shell", 0.2)):
        levels = 1 if name == "thin-shell" else 2
        expect_wall_followed(name, size, levels, SECOND | {"normals off by": 0.7})
    expect_wall_followed("cone-in-box", 2.0, 2, SECOND)


def test_the_same_bytes_on_any_ranks_when_a_coarse_ball_goes_to_a_triangulated_sphere():
    write_stl("ball.stl", *icosphere(2))
    pathlib.Path("ball.toml").write_text('[[surface]]\nname = "ball"\nkind = "triangulation"\nfile = "ball.stl"\n')
    curved_walls.make_level_0(call, "ball-in-box", 2.0, "pamr", pathlib.Path(".").resolve())
    run("pamr-convert", "level0.hdf", "ball.msh", "--quiet", serial=True)
    run("pamr-convert", "ball.msh", "mesh0.hdf", "--surfaces", "ball.toml", "--tolerance", 0.01, "--quiet", serial=True)

    rounds = 0
    for level in range(2):
        run("pamr-mark", f"mesh{level}.hdf", "-o", "marked.hdf", "--patch", "ball", "--force", "--quiet", serial=True)
        for ranks in (1, 2, 7):
            report = run("pamr-refine", "marked.hdf", "-o", f"on{ranks}.hdf", "--force", "--json", "-", "--quiet", ranks=ranks).json
        assert same_bytes("on1.hdf", "on2.hdf") and same_bytes("on1.hdf", "on7.hdf")
        assert report["off_surface_nodes"] == 0
        rounds += report["untangling_rounds"]
        pathlib.Path("on1.hdf").rename(f"mesh{level + 1}.hdf")

    assert rounds > 0
    p = curved_walls.Walls("mesh2.hdf")
    distance = max(abs(math.dist((0, 0, 0), x) - 1) for x in p.points[p.nodes_of(["ball"])])
    assert distance < 1.8e-2 / 20, f"{distance} from the true sphere; the facets of the file are 1.8e-2 from it"


run_tests(globals())
