# SPDX-License-Identifier: GPL-3.0-or-later
"""Walls that are much too coarse for their curvature: the short form of qualification/validation/curved_walls.py."""
import lzma
import math
import pathlib
import re
import sys

import h5py
import numpy as np

from surface_models import icosphere, write_stl
from tool_run import of_full_level, run, run_tests, same_bytes
from whole_meshio import meshio

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "qualification/validation"))
import curved_walls  # noqa: E402
import other_bodies  # noqa: E402

DATA = pathlib.Path(__file__).resolve().parent / "data"


def call(tool, *words):
    return run(tool, *words, serial=tool in ("pamr-mesh", "pamr-mark", "pamr-quality")).out


def refined(name, size, levels):
    """What is measured at each level, the reports of the refinements, and the bar of shapes."""
    folder = pathlib.Path(".").resolve()
    case, mesh = curved_walls.make_level_0(call, name, size, "pamr", folder)
    rows, reports = [curved_walls.measure(call, case, mesh)], []
    bar = curved_walls.shape_bar(size, curved_walls.shape_of_splitting_all(call, mesh, folder, min(levels, 2)))
    for level in range(1, levels + 1):
        marks, n_cells = curved_walls.mark(call, case, mesh, folder)
        report, mesh = curved_walls.refine(call, marks, folder, level)
        assert report["cells_out"] == n_cells
        rows.append(curved_walls.measure(call, case, mesh))
        reports.append(report)
    return rows, reports, bar


def expect_wall_followed(name, size, levels, orders):
    rows, reports, bar = refined(name, size, levels)
    for row, report in zip(rows[1:], reports):
        assert row["inverted"] == 0 and row["valid"] and report["marked_not_split"] == 0
        assert row["off"] == 0 == report["off_surface_nodes"], f"{name}: {row['off']} nodes off their surface"
        assert row["worst distance"] <= 1e-12 and row["edge"] <= 1e-12
        assert report["families_kept"] == 0
    shapes = [row["smallest mean ratio"] for row in rows]
    assert min(shapes) >= bar, f"{name}: smallest mean ratios {shapes}, expected at least {bar}"
    assert [report["level0"]["coarse_edges"] > 0 for report in reports] == [True] + [False] * (levels - 1)
    for key, least in orders.items():
        found = curved_walls.order(rows[-2][key], rows[-1][key])
        assert found >= least, f"{name}: {key} falls with order {found}"
    return reports


def write_msh(name, nodes, groups, triangles, cells):
    """Gmsh's format. `triangles`: pairs of a group (from 1) and three nodes (from 0)."""
    elements = [f"2 2 {group} {group} {a + 1} {b + 1} {c + 1}" for group, (a, b, c) in triangles]
    elements += [f"4 2 9 9 {a + 1} {b + 1} {c + 1} {d + 1}" for a, b, c, d in cells]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", len(groups), *(f'2 {i} "{g}"' for i, g in enumerate(groups, 1)),
             "$EndPhysicalNames", "$Nodes", len(nodes), *(f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(nodes, 1)), "$EndNodes",
             "$Elements", len(elements), *(f"{i} {element}" for i, element in enumerate(elements, 1)), "$EndElements"]
    pathlib.Path(name).write_text("\n".join(map(str, lines)) + "\n")


def octahedron_of_gmsh():
    """A ball as four cells around the line between its poles: all edges on the sphere but that line."""
    nodes = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    write_msh("ball.msh", nodes, ("ball",), [(1, (a, (a + 1) % 4, pole)) for a in range(4) for pole in (4, 5)],
              [(a, (a + 1) % 4, 5, 4) for a in range(4)])
    pathlib.Path("ball.toml").write_text(curved_walls.wall_cases.sphere("ball", 1))


def smallest_mean_ratio(mesh):
    return run("pamr-quality", mesh, "--json", "-", "--quiet", serial=True).json["mean_ratio"]["min"]


def refine_at_ball(mesh, levels):
    for level in range(1, levels + 1):
        run("pamr-mark", mesh, "-o", "marked.hdf", "--patch", "ball", "--force", "--quiet", serial=True)
        mesh = f"{mesh.removesuffix('.hdf')}_{level}.hdf"
        run("pamr-refine", "marked.hdf", "-o", mesh, "--force", "--quiet", serial=True)
    return mesh


def test_an_import_splits_what_would_flatten_cells_at_a_curved_wall():
    octahedron_of_gmsh()
    arguments = ["pamr-convert", "ball.msh", "--surfaces", "ball.toml", "--json", "-"]
    told = run(*arguments, "as_is.hdf", "--no-repair")
    assert told.json["wall_ears"] == 4 and "split_edges" not in told.json
    assert "--repair splits 1 edge and 0 faces and keeps the shape of the boundary" in told.err
    reports = [run(*arguments, f"on{n}.hdf", ranks=n) for n in (1, 3)]

    for report in reports:
        counts = tuple(report.json[key] for key in ("wall_ears", "split_edges", "split_faces", "cells"))
        assert counts == (4, 1, 0, 8) and "--no-repair" in report.err
    assert same_bytes("on1.hdf", "on3.hdf")
    run(*arguments, "asked.hdf", "--repair")
    run("pamr-convert", "as_is.hdf", "later.hdf", "--repair", "--quiet")
    assert same_bytes("on1.hdf", "asked.hdf") and same_bytes("on1.hdf", "later.hdf")
    assert smallest_mean_ratio(refine_at_ball("as_is.hdf", 4)) < 0.15
    assert smallest_mean_ratio(refine_at_ball("on1.hdf", 4)) > 0.4
    run("pamr-convert", "on1_1.hdf", "again.hdf", "--repair", code=2, serial=True)
    run("pamr-convert", "ball.msh", "both.hdf", "--repair", "--no-repair", code=2, serial=True)
    strict = run(*arguments, "strict.hdf", "--strict")
    assert strict.json["wall_ears"] == 4 and "split_edges" not in strict.json


def spherical_hole(corners, faces):
    """A shell between a polyhedron with these corners on the unit sphere and others around it: prisms, cut into cells."""
    radii, n = (1.0, 1.6, 2.6, 4.2, 7.0), len(corners)
    nodes = [tuple(r * x for x in corner) for r in radii for corner in corners]
    cells = []
    for layer in range(len(radii) - 1):
        for face in faces:
            low = [i + layer * n for i in sorted(face)]
            high = [i + n for i in low]
            cells += [low + high[2:], low[:2] + high[1:], low[:1] + high]
    p = np.array(nodes)[cells]
    cells = [c if np.linalg.det(q[1:] - q[0]) > 0 else (*c[:2], c[3], c[2]) for c, q in zip(cells, p)]
    triangles = [(1, face) for face in faces] + [(2, tuple(i + (len(radii) - 1) * n for i in face)) for face in faces]
    write_msh("hole.msh", nodes, ("body", "outer"), triangles, cells)
    pathlib.Path("hole.toml").write_text("".join(curved_walls.wall_cases.sphere(g, r) for g, r in (("body", 1.0), ("outer", 7.0))))


def shapes_at_body(mesh, levels):
    """Smallest mean ratio before and after each of some refinements at the body."""
    shapes = [smallest_mean_ratio(mesh)]
    for level in range(levels):
        run("pamr-mark", mesh, "-o", "marked.hdf", "--patch", "*", "--force", "--quiet", serial=True)
        mesh = f"{mesh.removesuffix('.hdf')}_{level}.hdf"
        run("pamr-refine", "marked.hdf", "-o", mesh, "--force", "--quiet", serial=True)
        shapes.append(smallest_mean_ratio(mesh))
    return shapes


def test_an_import_names_coarse_walls_and_repair_splits_cells_there_where_it_helps():
    octahedron = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    spherical_hole(octahedron, [(x, y, z) for x in (0, 1) for y in (2, 3) for z in (4, 5)])
    arguments = ["pamr-convert", "hole.msh", "--surfaces", "hole.toml", "--json", "-"]
    told = run(*arguments, "as_is.hdf")
    assert "24 edges in curved walls are longer than 0.2 of the radius of curvature, the longest 1.41 of it near (-3.5, -3.5, 0)" in told.err
    assert told.json["coarse_walls"]["edges"] == 24 and told.json["cells"] == 96 and "split_cells" not in told.json
    for ranks in (1, 3):
        told = run(*arguments, f"on{ranks}.hdf", "--repair", ranks=ranks)
        assert told.json["split_cells"] == 32 and told.json["cells"] == 720, told.json
        assert "32 cells at these walls were split into eight, and the mesh is level 0 now: 96 cells became 720" in told.err
    assert same_bytes("on1.hdf", "on3.hdf")
    run("pamr-convert", "as_is.hdf", "later.hdf", "--repair", "--quiet")
    assert same_bytes("on1.hdf", "later.hdf")
    assert min(shapes_at_body("as_is.hdf", 3)) < 0.3 and min(shapes_at_body("on1.hdf", 2)) > 0.34

    tetrahedron = [tuple(x / 3 ** 0.5 for x in corner) for corner in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))]
    spherical_hole(tetrahedron, [(0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)])
    told = run(*arguments, "left.hdf", "--repair")
    assert told.json["cells"] == 48 and "cells at these walls were not split: the smallest mean ratio would be 0.0" in told.err


def test_a_mesh_refined_without_a_map_is_named_and_becomes_level_0():
    curved_walls.make_level_0(call, "ball-in-box", 2.0, "pamr", pathlib.Path(".").resolve())
    run("pamr-mark", "level0.hdf", "-o", "marked.hdf", "--all", "--quiet", serial=True)
    run("pamr-refine", "marked.hdf", "-o", "old.hdf", "--format", "2", "--quiet", serial=True)
    run("pamr-mark", "old.hdf", "-o", "marked.hdf", "--patch", "ball", "--force", "--quiet", serial=True)
    told = run("pamr-refine", "marked.hdf", "-o", "none.hdf", "--json", "-")
    assert "were refined without a map of level 0" in told.err and "--as-level-0" in told.err and told.json["level0"]["bent_cells"] == 0

    run("pamr-mark", "old.hdf", "-o", "marked.hdf", "--crossing-sphere", "1e9,0,0,1", "--coarsen-rest", "--force", "--quiet", serial=True)
    told = run("pamr-refine", "marked.hdf", "-o", "back.hdf", "--json", "-")
    with h5py.File("level0.hdf") as file:
        n = len(file["VTKHDF/Types"])  # which CGAL makes, by its version
    assert told.json["cells_out"] == n and "warning" not in told.err
    run("pamr-mark", "back.hdf", "-o", "marked.hdf", "--all", "--force", "--quiet", serial=True)
    assert run("pamr-refine", "marked.hdf", "-o", "anew.hdf", "--json", "-", serial=True).json["level0"]["bent_cells"] > 0

    told = run("pamr-convert", "old.hdf", "new.hdf", "--as-level-0", "--json", "-")
    assert told.json["refined_cells"] == told.json["cells"] == 8 * n and re.search(r"the longest 1\.[12]\d of it", told.err), told.err
    run("pamr-mark", "new.hdf", "-o", "marked.hdf", "--patch", "ball", "--force", "--quiet", serial=True)
    told = run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--json", "-")
    assert "without a map" not in told.err and told.json["level0"]["bent_cells"] > 0
    assert smallest_mean_ratio("fine.hdf") > 0.34 > 0.25 > smallest_mean_ratio("none.hdf")
    run("pamr-convert", "old.hdf", "old.vtu", "--as-level-0", code=2)
    with h5py.File("fine.hdf") as file:
        pathlib.Path("ball.toml").write_bytes(file["PAMR/surfaces"][()])
    run("pamr-convert", "fine.hdf", "tied.hdf", "--surfaces", "ball.toml", "--quiet", serial=True)  # new surfaces: the map goes, in whole
    run("pamr-partition", "fine.hdf", "-o", "parts.hdf", "-p", 3, "--weights", "uniform", "--quiet", serial=True)
    with h5py.File("tied.hdf") as tied, h5py.File("parts.hdf") as parts:
        for file, has_map in ((tied, False), (parts, True)):
            assert ("level0" in file["PAMR"]) == has_map == ("level0_cell" in file["VTKHDF/CellData"]) == ("level0_key" in file["VTKHDF/PointData"])


def test_triangles_with_two_edges_on_a_rim_are_split():
    other_bodies.by_cells(pathlib.Path("."), other_bodies.BODIES["disc-cylinder"](0.8))  # two on the floor, two on the lid
    arguments = ["pamr-convert", "body.msh", "--surfaces", "body.toml", "--json", "-"]
    left = run(*arguments, "left.hdf", "--no-repair", serial=True)
    assert left.json["rim_ears"] == 4 and "--repair splits 6 edges" in left.err, left.err

    for ranks in (1, 3):
        told = run(*arguments, f"on{ranks}.hdf", ranks=ranks)
        assert told.json["rim_ears"] == 4 and "4 boundary faces with two edges on the rim of a curved wall" in told.err, told.err
        assert (told.json["split_edges"], told.json["split_faces"], told.json["cells"]) == (6, 0, 44)
    assert same_bytes("on1.hdf", "on3.hdf")
    assert min(shapes_at_body("left.hdf", 3)) < 0.15 and min(shapes_at_body("on1.hdf", 3)[1:]) > 0.34


def test_shape_that_walls_cost_is_told():
    octahedron_of_gmsh()
    run("pamr-convert", "ball.msh", "level0.hdf", "--surfaces", "ball.toml", "--no-repair", "--quiet", serial=True)
    for level in range(1, 5):  # smallest mean ratios 0.857, 0.579, 0.378, 0.236, 0.148
        run("pamr-mark", f"level{level - 1}.hdf", "-o", "marked.hdf", "--all", "--force", "--quiet", serial=True)
        told = run("pamr-refine", "marked.hdf", "-o", f"level{level}.hdf", "--json", "-", serial=level < 4)
        n_lost = 64 if level == 4 else 0
        assert told.json["walls"]["cells_that_lost_shape"] == n_lost
        assert ("64 cells at walls have a mean ratio under 0.165" in told.err) == (n_lost > 0), told.err


def test_cells_of_second_order_have_the_edges_of_the_map():
    mesh = other_bodies.make(call, other_bodies.BODIES["hole-of-12"](None), pathlib.Path("."))
    for level in (1, 2):
        run("pamr-mark", mesh, "-o", "marked.hdf", "--all", "--force", "--quiet", serial=True)
        mesh = f"level{level}.hdf"
        run("pamr-refine", "marked.hdf", "-o", mesh, "--quiet", serial=True)

    told = run("pamr-convert", "level1.hdf", "curved.vtu", "--order", 2, "--json", "-")

    nodes = [curved_walls.points_of_file("level2.hdf"), meshio.read("curved.vtu").points]
    assert np.array_equal(*(p[np.lexsort(p.T)] for p in nodes)), "the nodes in the middles of edges are those of the next level"
    assert told.json["straightened_edges"] == 0 and told.json["curved_edges"] > 2 * 120, "inside as well as in the two walls"


def test_pamr_mesh_splits_it_by_itself():
    pathlib.Path("case.toml").write_text(curved_walls.wall_cases.ball(1.2, "pamr").case_file)

    report = run("pamr-mesh", "case.toml", "-o", "ball.hdf", "--json", "-", serial=True).json

    assert report["split_edges"] > 0 and report["min_mean_ratio"] > 0.3
    assert smallest_mean_ratio(refine_at_ball("ball.hdf", 2)) > 0.3


def test_walls_of_a_step_file_that_meet_in_a_sharp_edge_keep_shapes():
    """data/pipes: two pipes that meet, by OpenCASCADE, and Gmsh's mesh of edges of 0.8 radii of the smaller one."""
    for name in ("pipes.msh", "pipes.step"):
        pathlib.Path(name).write_bytes(lzma.decompress((DATA / f"{name}.xz").read_bytes()))
    run("pamr-convert", "pipes.msh", "level0.hdf", "--cad", "pipes.step", "--quiet", serial=True)
    walls = ("surface_1", "surface_2")  # without the flat ends

    mesh = "level0.hdf"
    for level, ranks in ((1, 1), (2, 3)):
        run("pamr-mark", mesh, "-o", "marked.hdf", *(word for wall in walls for word in ("--patch", wall)), "--force", "--quiet", serial=True)
        mesh = f"level{level}.hdf"
        told = run("pamr-refine", "marked.hdf", "-o", mesh, "--json", "-", ranks=ranks)
        assert smallest_mean_ratio(mesh) > 0.8 * 0.29 and told.json["off_surface_nodes"] == 0 == told.json["families_kept"]
        assert "folds" not in told.err, told.err
    run("pamr-refine", "marked.hdf", "-o", "alone.hdf", "--quiet", serial=True)
    assert same_bytes(mesh, "alone.hdf")


SECOND = {"area error": 1.8, "volume error": 1.7}


def test_a_ball_known_by_seven_nodes_is_followed():
    reports = expect_wall_followed("ball-in-box", 2.0, 3, SECOND)

    assert all(r["moved_nodes"] > 0 and r["cells_checked"] > 0 for r in reports)
    level0 = reports[0]["level0"]  # where only walls are bent, cells fold
    assert level0["min_jacobian_before"] < 0 and level0["min_jacobian"] > 0.25 and level0["bent_cells"] > 0


def follows(name, size, levels):
    """A test of its own for each body, so that several run at a time."""
    return lambda: expect_wall_followed(name, size, levels, SECOND | {"normals off by": 0.7})


# the torus of 40 nodes gets its order after level 2
for body in (("torus-in-box", 2.0, 3), ("ball", 1.2, 2), ("bored-box", 1.6, 2), ("ellipsoid", 1.0, 2), ("dish", 0.8, 2),
             ("thin-shell", 0.2, 1), ("cone-in-box", 2.0, 2), ("ball", 0.8, 2), ("bored-box", 0.8, 2), ("ball-in-box", 0.8, 2),
             ("torus-in-box", 0.8, 2), ("cone-in-box", 0.8, 1), ("ellipsoid", 0.8, 2)):
    test = follows(*body)
    name = f"test_{body[0]}_with_edges_of_{body[1]}_radii_keeps_shapes_and_area_and_volume_converge_at_second_order"
    globals()[name] = test if body[:2] == ("bored-box", 0.8) else of_full_level(test)


def test_the_same_bytes_on_any_ranks_when_a_coarse_ball_goes_to_a_triangulated_sphere():
    write_stl("ball.stl", *icosphere(2))
    pathlib.Path("ball.toml").write_text('[[surface]]\nname = "ball"\nkind = "triangulation"\nfile = "ball.stl"\n')
    curved_walls.make_level_0(call, "ball-in-box", 2.0, "pamr", pathlib.Path(".").resolve())
    run("pamr-convert", "level0.hdf", "ball.msh", "--quiet", serial=True)
    run("pamr-convert", "ball.msh", "mesh0.hdf", "--surfaces", "ball.toml", "--tolerance", 0.01, "--quiet", serial=True)
    n_on_ball = len(curved_walls.Walls("mesh0.hdf").nodes_of(["ball"]))
    assert 4 <= n_on_ball < 12, "a coarse ball: 7 nodes by CGAL 5.5, 6 by CGAL 6.0"

    for level in range(2):
        run("pamr-mark", f"mesh{level}.hdf", "-o", "marked.hdf", "--patch", "ball", "--force", "--quiet", serial=True)
        for ranks in (1, 2, 7):
            report = run("pamr-refine", "marked.hdf", "-o", f"on{ranks}.hdf", "--force", "--json", "-", "--quiet", ranks=ranks).json
        assert same_bytes("on1.hdf", "on2.hdf") and same_bytes("on1.hdf", "on7.hdf")
        assert report["off_surface_nodes"] == 0 == report["families_kept"]
        # all lie on the sphere, up to 1.7e-4 off the triangulated one
        assert report["level0"]["moved_nodes"] == (n_on_ball if level == 0 else 0)
        pathlib.Path("on1.hdf").rename(f"mesh{level + 1}.hdf")

    assert smallest_mean_ratio("mesh2.hdf") >= curved_walls.shape_bar(2.0, smallest_mean_ratio("mesh0.hdf"))
    p = curved_walls.Walls("mesh2.hdf")
    distance = max(abs(math.dist((0, 0, 0), x) - 1) for x in p.points[p.nodes_of(["ball"])])
    assert distance < 1.8e-2 / 20, f"{distance} from the true sphere; the facets of the file are 1.8e-2 from it"


run_tests(globals())
