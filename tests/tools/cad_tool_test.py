# SPDX-License-Identifier: GPL-3.0-or-later
"""A STEP file beside a mesh: pamr-convert --cad finds the faces, refinements stay on them, and what does not fit is said.
data/can.step is a closed can of radius 1 from z = 0 to 2: face 1 is the side, 2 and 3 are top and bottom."""
import pathlib
import shutil

import h5py
import numpy as np

from tool_run import kuhn_cube, refuses, run, run_tests, same_bytes

DATA = pathlib.Path(__file__).resolve().parent / "data"
CAN = """
[mesh]
shape = "surfaces"
length_unit = "mm"
region = "-side & -top & +bottom"
bounds = [[-1.2, -1.2, -0.2], [1.2, 1.2, 2.2]]
[mesh.sizes]
far = 0.5
[[surface]]
name = "side"
kind = "cylinder"
point = [0, 0, 0]
axis = [0, 0, 1]
radius = 1
[[surface]]
name = "top"
kind = "plane"
point = [0, 0, 2]
normal = [0, 0, 1]
[[surface]]
name = "bottom"
kind = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
"""


def can(name="can.msh"):
    """A mesh of the can for Gmsh, so without surfaces."""
    pathlib.Path("case.toml").write_text(CAN)
    run("pamr-mesh", "case.toml", "-o", "made.hdf", "--quiet", "--force", serial=True)
    run("pamr-convert", "made.hdf", name, "--text", "--gmsh-version", "2.2", "--quiet", "--force", serial=True)
    shutil.copy(DATA / "can.step", "can.step")
    return name


def merge_patches(mesh, old, new):
    """Gives the triangles of one patch of a .msh (2.2, text) to another."""
    lines = pathlib.Path(mesh).read_text().splitlines()
    number = {line.split('"')[1]: line.split()[1] for line in lines if line.startswith("2 ") and line.endswith('"')}
    for i in range(lines.index("$Elements") + 2, lines.index("$EndElements")):
        words = lines[i].split()
        if words[1] == "2" and words[3] == number[old]:
            words[3] = number[new]
            lines[i] = " ".join(words)
    pathlib.Path(mesh).write_text("\n".join(lines) + "\n")


def patch_nodes(mesh):
    with h5py.File(mesh) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        neighbors, names = file["PAMR/cell_to_cell"][:], [name.decode() for name in file["PAMR/patches/names"][:]]
    result = {}
    for number, name in enumerate(names):
        cell, slot = np.nonzero(neighbors == -(number + 1))
        result[name] = np.unique([cells[cell, (slot + k) % 4] for k in (1, 2, 3)])
    return points, result


def refine(mesh, out, **how):
    run("pamr-mark", mesh, "-o", "marked.hdf", "--all", "--force", "--quiet", **how)
    return run("pamr-refine", "marked.hdf", "-o", out, "--force", "--json", "-", **how).json


def test_patches_are_bound_to_the_faces_below_them_and_keep_edges():
    mesh = can()
    report = run("pamr-convert", mesh, "many.hdf", "--cad", "can.step", "--json", "-").json
    run("pamr-convert", mesh, "one.hdf", "--cad", "can.step", serial=True)
    assert {name: p["faces"] for name, p in report["cad"]["patches"].items()} == {"side": [1], "top": [2], "bottom": [3]}
    assert all(p["off"] == 0 for p in report["cad"]["patches"].values())
    assert abs(report["cad"]["volume"] - 2 * np.pi) < 1e-6 and report["cad"]["unit_of_file"] == "millimetre"
    assert same_bytes("many.hdf", "one.hdf")
    for level in (1, 2):
        assert refine("many.hdf", "many.hdf")["off_surface_nodes"] == 0
        refine("one.hdf", "one.hdf", serial=True)
        assert same_bytes("many.hdf", "one.hdf"), level
    points, nodes = patch_nodes("many.hdf")
    radius = np.hypot(points[:, 0], points[:, 1])
    assert np.abs(radius[nodes["side"]] - 1).max() < 1e-14
    assert (points[nodes["top"], 2] == 2).all() and (points[nodes["bottom"], 2] == 0).all()
    assert len(np.intersect1d(nodes["side"], nodes["top"])) > 40


def test_a_patch_of_several_faces_keeps_the_edges_inside_it():
    mesh = can()
    merge_patches(mesh, "side", "top")
    report = run("pamr-convert", mesh, "mesh.hdf", "--cad", "can.step", "--json", "-").json
    assert report["cad"]["patches"]["top"]["faces"] == [1, 2] and report["ties"]["top"]["edges_along_creases"] > 10

    def rim():
        points, nodes = patch_nodes("mesh.hdf")
        of_patch = points[nodes["top"]]
        radius = np.hypot(of_patch[:, 0], of_patch[:, 1])
        on_side, on_top = np.abs(radius - 1) < 1e-14, of_patch[:, 2] == 2
        assert (on_side | on_top).all()
        return (on_side & on_top).sum()

    before = rim()
    refine("mesh.hdf", "mesh.hdf")
    refine("mesh.hdf", "mesh.hdf")
    assert rim() == 4 * before


def test_faces_without_a_tag_get_patches_by_face():
    kuhn_cube("cube.hdf", 2)
    step = (DATA.parent.parent / "unit" / "geometry" / "data" / "cube.step").read_text()
    pathlib.Path("cube.step").write_text(step.replace("ADVANCED_FACE(''", "ADVANCED_FACE('inlet'", 1))
    run("pamr-convert", "cube.hdf", "cube.msh", "--text", "--gmsh-version", "2.2", "--quiet")
    lines = pathlib.Path("cube.msh").read_text().splitlines()
    start = lines.index("$Elements")
    elements = [line for line in lines[start + 2: lines.index("$EndElements")] if line.split()[1] == "4"]
    pathlib.Path("bare.msh").write_text("\n".join(lines[:start] + ["$Elements", str(len(elements)), *elements, "$EndElements"]) + "\n")
    report = run("pamr-convert", "bare.msh", "bare.hdf", "--cad", "cube.step", "--json", "-").json
    assert sorted(report["patches"]) == ["face_2", "face_3", "face_4", "face_5", "face_6", "inlet"], report["patches"]
    points, nodes = patch_nodes("bare.hdf")
    assert (points[nodes["inlet"], 0] == 0).all() and len(nodes["inlet"]) == 9
    run("pamr-convert", "bare.msh", "untagged.hdf")
    for pair in ("boundary=wall", "*=wall"):  # which face would be a wall?
        refuses("pamr-convert", "untagged.hdf", "no.hdf", "--cad", "cube.step", "--kind", pair, says=["--kind", "boundary", "--cad"],
                creates="no.hdf")
    run("pamr-convert", "bare.hdf", "walls.hdf", "--kind", "*=wall")


def test_what_cannot_be_tied_is_said():
    kuhn_cube("cube.hdf", 2)
    shutil.copy(DATA.parent.parent / "unit" / "geometry" / "data" / "cube.step", "cube.step")
    refuses("pamr-convert", "cube.hdf", "a.hdf", "--cad", "cube.step", "--unit", "m",
            says=["expected boundary faces of the mesh on faces of the shape", "--unit mm"], creates="a.hdf")
    refuses("pamr-convert", "cube.hdf", "a.hdf", "--cad", "cube.step", "--unit", "furlong", says=["--unit: expected mm"])
    refuses("pamr-convert", "cube.hdf", "a.hdf", "--cad", "cube.stl", says=["cube.stl"])
    pathlib.Path("bad.step").write_text(pathlib.Path("cube.step").read_text()[:3000])
    refuses("pamr-convert", "cube.hdf", "a.hdf", "--cad", "bad.step", says=["file 'bad.step': expected"], creates="a.hdf")
    shutil.copy(DATA / "can.step", "can.step")
    result = run("pamr-convert", "cube.hdf", "b.hdf", "--cad", "can.step")
    assert "patch 'xmin': none of its 8 faces lies on a face of can.step" in result.err, result.err


run_tests(globals())
