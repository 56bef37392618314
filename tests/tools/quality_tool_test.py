# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-quality from the command line: the report, the same bytes on any number of ranks, gates, and bad meshes."""
import csv
import json
import math
import pathlib

import h5py
import numpy as np

from tool_run import bare_copy, kuhn_cube, prepare_alone, refuses, run, run_tests, same_bytes
from tet import EDGE_TO_CORNER, FACE_TO_CORNER

prepare_alone("pamr-mesh", "pamr-mark", "pamr-refine")

METRICS = ("radius_ratio", "mean_ratio", "aspect_ratio", "min_dihedral", "max_dihedral", "edge_ratio")


def shaken(name, n):
    """A cube whose inner nodes are moved: every cell differs, and the boundary stays on its planes."""
    bare_copy(kuhn_cube("regular.hdf", n), name)
    with h5py.File(name, "r+") as file:
        points = file["VTKHDF/Points"][:]
        inner = ((points > 0) & (points < 1)).all(axis=1)
        points[inner] += np.random.default_rng(5).uniform(-0.1 / n, 0.1 / n, (inner.sum(), 3))
        file["VTKHDF/Points"][...] = points
    return name


def test_report_has_its_keys_and_does_not_depend_on_ranks():
    shaken("a.hdf", 5)
    report = run("pamr-quality", "a.hdf", "--json", "-").json
    run("pamr-quality", "a.hdf", "--json", "many.json")
    run("pamr-quality", "a.hdf", "--json", "one.json", serial=True)

    assert same_bytes("one.json", "many.json")
    assert (report["cells"], report["nodes"], report["inverted_cells"]) == (750, 216, 0)
    assert report["conforming"] is True and report["neighbors_consistent"] is True and report["valid"] is True
    assert math.isclose(report["volume"], 1, rel_tol=1e-14)
    for name in METRICS:
        metric = report[name]
        assert metric["min"] < metric["mean"] < metric["max"]
        counts, edges = metric["histogram"]["counts"], metric["histogram"]["edges"]
        assert len(counts) == 50 and len(edges) == 51 and sum(counts) == 750 and sorted(edges) == edges
    assert len(report["fingerprint"]) == 16
    assert 0.75 * report["mean_ratio"]["min"] < report["uniform_shape_bound"] <= report["mean_ratio"]["min"]
    assert f"{report['uniform_shape_bound']:.4f}" in run("pamr-quality", "a.hdf").out


def test_boundary_triangles_have_shapes():
    report = run("pamr-quality", shaken("a.hdf", 4), "--json", "-", "--quiet").json
    assert sum(patch["faces"] for patch in report["patches"].values()) == 6 * 32
    for name, patch in report["patches"].items():
        triangles = patch["triangles"]
        # All are halves of squares.
        for metric, value in (("mean_ratio", math.sqrt(3) / 2), ("min_angle", 45), ("max_angle", 90),
                              ("aspect_ratio", (1 + math.sqrt(2)) / math.sqrt(3))):
            for which in ("min", "mean", "max"):
                assert math.isclose(triangles[metric][which], value, rel_tol=1e-12), (name, metric, triangles[metric], value)
            assert sum(triangles[metric]["histogram"]["counts"]) == patch["faces"]
        assert triangles["worst_distance"] <= 1e-15


def test_values_agree_with_numpy():
    shaken("a.hdf", 4)
    report = run("pamr-quality", "a.hdf", "--json", "-").json
    with h5py.File("a.hdf") as file:
        p = file["VTKHDF/Points"][:][file["VTKHDF/Connectivity"][:].reshape(-1, 4)]
    edges = p[:, EDGE_TO_CORNER[:, 0]] - p[:, EDGE_TO_CORNER[:, 1]]
    length = np.linalg.norm(edges, axis=2)
    volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
    area = sum(np.linalg.norm(np.cross(p[:, b] - p[:, a], p[:, c] - p[:, a]), axis=1) / 2
               for a, b, c in FACE_TO_CORNER)
    inner = 3 * volume / area
    mean_ratio = 12 * np.cbrt(3 * volume) ** 2 / (length**2).sum(axis=1)
    aspect_ratio = length.max(axis=1) / (2 * math.sqrt(6) * inner)
    system = p[:, 1:] - p[:, :1]
    center = np.linalg.solve(2 * system, (system**2).sum(axis=2)[..., None])[..., 0]
    radius_ratio = 3 * inner / np.linalg.norm(center, axis=1)
    for name, value in (("mean_ratio", mean_ratio), ("aspect_ratio", aspect_ratio), ("radius_ratio", radius_ratio),
                        ("edge_ratio", length.max(axis=1) / length.min(axis=1))):
        for key, number in (("min", value.min()), ("mean", value.mean()), ("max", value.max())):
            assert math.isclose(report[name][key], number, rel_tol=1e-12), (name, key)


def test_patches_are_measured():
    patches = run("pamr-quality", kuhn_cube("a.hdf", 4), "--json", "-").json["patches"]
    assert list(patches) == sorted(["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"])
    for patch in patches.values():
        assert patch["faces"] == 32 and patch["area"] == 1
        assert patch["worst_distance"] == 0 and patch["off_surface_nodes"] == 0


def test_one_mesh_has_a_line_for_each_patch():
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.6", "-o", "ball.hdf", "--quiet")
    for name, n in ((kuhn_cube("a.hdf", 4), 6), (kuhn_cube("one.hdf", 1), 6), ("ball.hdf", 2)):
        done = run("pamr-quality", name, "--json", "a.json")
        report = json.loads(pathlib.Path("a.json").read_text())
        lines = [line for line in done.out.splitlines() if line.startswith("patch ")]
        assert len(lines) == len(report["patches"]) == n
        for line in lines:
            patch = report["patches"][line.split()[1].rstrip(":")]
            assert f": {patch['faces']} faces, area {patch['area']:.8g}, {patch['off_surface_nodes']} node" in line, line
            assert line.endswith(f"min {patch['min_mean_ratio']:.4f}"), line
            assert report["mean_ratio"]["min"] <= patch["min_mean_ratio"] <= report["mean_ratio"]["max"]
        if n == 6:  # all cells of cubes that are cut in six have one shape
            assert all(patch["min_mean_ratio"] == report["mean_ratio"]["min"] for patch in report["patches"].values())


def test_gates_decide_the_exit_code():
    kuhn_cube("a.hdf", 3)
    gates = ("mean_ratio:min:0.75", "mean_ratio.mean:max:0.76", "cells:min:162", "inverted_cells:max:0",
             "patches.xmin.worst_distance:max:1e-12", "min_dihedral:min:44.9", "conforming:min:1")
    run("pamr-quality", "a.hdf", *(word for gate in gates for word in ("--gate", gate)))
    failed = run("pamr-quality", "a.hdf", "--gate", "mean_ratio:min:0.8", "--gate", "cells:max:100", "--quiet",
                 "--json", "a.json", code=1)
    assert len(failed.err.splitlines()) == 2 and "mean_ratio.min" in failed.err and "cells" in failed.err
    assert json.loads(pathlib.Path("a.json").read_text())["cells"] == 162
    refuses("pamr-quality", "a.hdf", "--gate", "roundness:min:0", "--json", "b.json", says=["roundness"],
            creates="b.json")
    refuses("pamr-quality", "a.hdf", "--gate", "mean_ratio:0.5", says=["NAME:min:V"])
    refuses("pamr-quality", "a.hdf", "--gate", "patches.wing.area:min:0", says=["wing"])


def test_several_meshes_are_compared():
    kuhn_cube("a.hdf", 2), kuhn_cube("b.hdf", 3)
    result = run("pamr-quality", "a.hdf", "b.hdf", "--csv", "levels.csv", "--json", "all.json")
    assert len(result.out.splitlines()) == 3
    rows = list(csv.DictReader(open("levels.csv", newline="")))
    assert [row["file"] for row in rows] == ["a.hdf", "b.hdf"]
    assert [int(row["cells"]) for row in rows] == [48, 162]
    assert float(rows[1]["patches.zmax.area"]) == 1
    meshes = json.loads(pathlib.Path("all.json").read_text())["meshes"]
    assert [mesh["cells"] for mesh in meshes] == [48, 162]


def test_levels_of_a_run_show_how_a_wall_converges():
    names = ["level0.hdf"]
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", names[0], "--quiet")
    for level in (1, 2):
        run("pamr-mark", names[-1], "-o", "marked.hdf", "--patch", "sphere", "--force", "--quiet")
        names.append(f"level{level}.hdf")
        run("pamr-refine", "marked.hdf", "-o", names[-1], "--quiet")
    result = run("pamr-quality", *names, "--json", "levels.json")
    lines = result.out.splitlines()
    assert len(lines) == 8 and lines[4].split()[:2] == ["patch", "mesh"]
    assert [line.split()[:2] for line in lines[5:]] == [["sphere", name] for name in names]
    spheres = [mesh["patches"]["sphere"] for mesh in json.loads(pathlib.Path("levels.json").read_text())["meshes"]]
    errors = [4 * math.pi - sphere["area"] for sphere in spheres]
    for coarse, fine in ((0, 1), (1, 2)):
        assert 3.5 < errors[coarse] / errors[fine] < 4.5, "areas converge at second order"
        for key in ("mean_normal_deviation", "worst_normal_deviation"):
            assert 1.7 < spheres[coarse][key] / spheres[fine][key], "normals at first order"
    with h5py.File(names[0]) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        patches = [n.decode() for n in file["PAMR/patches/names"][:]]
        cell, slot = np.nonzero(file["PAMR/cell_to_cell"][:] == -1 - patches.index("sphere"))
    p = points[cells[cell[:, None], FACE_TO_CORNER[slot]]]
    normal, middle = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p.mean(axis=1)
    doubled = np.linalg.norm(normal, axis=1)
    cosine = np.abs((normal * middle).sum(axis=1)) / doubled / np.linalg.norm(middle, axis=1)
    angle = np.degrees(np.arccos(np.minimum(cosine, 1)))
    assert math.isclose(spheres[0]["worst_normal_deviation"], angle.max(), rel_tol=1e-6)
    assert math.isclose(spheres[0]["mean_normal_deviation"], (angle * doubled).sum() / doubled.sum(), rel_tol=1e-6)


def test_worst_cells_become_a_mesh():
    shaken("a.hdf", 4)
    run("pamr-quality", "a.hdf", "--worst", "7", "--worst-out", "worst.hdf")
    run("pamr-quality", "a.hdf", "--worst", "7", "--worst-out", "twin.hdf", serial=True)
    assert same_bytes("worst.hdf", "twin.hdf")
    whole = run("pamr-quality", "a.hdf", "--json", "-").json
    with h5py.File("worst.hdf") as file:
        assert file["VTKHDF/NumberOfCells"][0] == 7
        assert math.isclose(file["VTKHDF/CellData/mean_ratio"][:].min(), whole["mean_ratio"]["min"], rel_tol=1e-14)
    refuses("pamr-quality", "a.hdf", "--worst", "7", says=["--worst-out"])


def test_invalid_meshes_are_reported_not_refused():
    bare_copy(kuhn_cube("a.hdf", 2), "bad.hdf")
    with h5py.File("bad.hdf", "r+") as file:
        cell = file["VTKHDF/Connectivity"][20:24]
        file["VTKHDF/Connectivity"][20:24] = cell[[1, 0, 2, 3]]
    result = run("pamr-quality", "bad.hdf", "--json", "report.json", code=1)
    report = json.loads(pathlib.Path("report.json").read_text())
    assert report["inverted_cells"] == 1 and report["valid"] is False
    where = {violation["invariant"]: violation["where"] for violation in report["violations"]}
    assert where["orientation_positive"] == 5
    assert report["conforming"] is True
    assert "orientation_positive is broken 1 time, first at cell 5" in result.err


def test_bad_input_is_refused():
    kuhn_cube("a.hdf", 3)
    pathlib.Path("short.hdf").write_bytes(pathlib.Path("a.hdf").read_bytes()[:9000])
    refuses("pamr-quality", "missing.hdf", says=["missing.hdf"])
    refuses("pamr-quality", "short.hdf", says=["short.hdf"])
    for name in ("-", "a.hdf"):
        refuses("pamr-quality", "a.hdf", "--csv", name, says=["--csv", f"ends in .csv, found '{name}'"], creates="-")
    refuses("pamr-quality", "a.hdf", "--csv", "no folder/a.csv", says=["no folder"])
    refuses("pamr-quality", says=["MESH"])
    pathlib.Path("old.csv").write_text("mine")
    refuses("pamr-quality", "a.hdf", "--csv", "old.csv", says=["--force"])
    assert pathlib.Path("old.csv").read_text() == "mine"


run_tests(globals())
