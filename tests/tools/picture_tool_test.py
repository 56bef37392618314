# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-picture: the pictures have their size and show what they should, and wrong input is one clear message."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import h5py
import matplotlib.image
import numpy as np

from tool_run import BIN, FULL, LIMIT, SHARED, kuhn_cube, of_full_level, once, run, run_tests
from tet import FACE_TO_CORNER


@once
def cubes():
    """A cube with a field `x` on cells, one `height` on nodes and a vector `u`, and the cube with one corner refined."""
    folder = pathlib.Path(SHARED)
    coarse, fine = str(folder / "coarse.hdf"), str(folder / "fine.hdf")
    kuhn_cube(coarse, 6)
    with h5py.File(coarse, "r+") as file:
        grid = file["VTKHDF"]
        points = grid["Points"][:]
        centers = points[grid["Connectivity"][:].reshape(-1, 4)].mean(axis=1)
        for group in ("CellData", "PointData"):
            grid.require_group(group)
        grid["CellData/x"] = centers[:, 0]
        grid["CellData/x"].attrs["unit"] = "K"
        grid["CellData/u"] = np.column_stack([np.ones(len(centers)), np.zeros(len(centers)), np.zeros(len(centers))])
        grid["CellData/u"].attrs["unit"] = "m/s"
        grid["PointData/height"] = points[:, 2]
        grid["CellData/refine"] = (np.linalg.norm(centers, axis=1) < 0.5).astype("i4")
    run("pamr-refine", coarse, "-o", fine, "--quiet", serial=True)
    return coarse, fine


def pixels(name):
    """Rows of red, green and blue, 0 to 255."""
    return (matplotlib.image.imread(name)[:, :, :3] * 255).round().astype(int)


def picture(*arguments):
    assert run("pamr-picture", *arguments, "-o", "p.png", "--force").err == "", "VTK's warnings are nobody's"
    return pixels("p.png")


def near(image, color, within=12):
    """How many pixels have about this color."""
    return int((np.abs(image - np.array(color)).max(axis=2) <= within).sum())


def test_pictures_have_the_size_asked_for_and_show_the_mesh():
    coarse, fine = cubes()

    report = run("pamr-picture", coarse, fine, "-o", "p.png", "--size", "700x400", "--json", "-").json
    image = pixels("p.png")

    assert image.shape[:2] == (400, 700), image.shape
    assert report["width"] == 700 and report["meshes"][0]["cells"] == 6 * 6**3, report
    assert report["meshes"][1]["cells"] > report["meshes"][0]["cells"], report
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 100, "one color"
    # The left half has level 0 only, the right half also level 1 in its color.
    level_1 = (20, 121, 143)
    assert near(image[:360, :350], level_1, 40) == 0 and near(image[:360, 350:], level_1, 40) > 20


def test_a_cut_shows_the_field_where_it_is():
    coarse, _ = cubes()

    image = picture(coarse, "--cut", "y=0.5", "--field", "x", "--size", "600x600")

    # Viridis from violet at x = 0 on the left to yellow on the right; nothing else is inside.
    middle = image[300]
    row = middle[(middle.sum(axis=1) < 740).nonzero()[0]]
    assert row[5, 2] > row[5, 1], f"violet expected on the left: {row[5]}"
    yellow = near(image[:, 250:500], (230, 228, 25), 40)
    assert yellow > 500 and near(image[:, :200], (230, 228, 25), 40) == 0, yellow


def test_sections_at_the_side_of_the_domain_and_fields_on_nodes_are_drawn():
    coarse, _ = cubes()

    image = picture(coarse, "--cut", "y=0", "--field", "height", "--size", "600x600", "--isolines", "0.5",
                    "--streamlines", "u")

    # The isoline of height 0.5 is one dark horizontal line in the middle of the square, streamlines are white ones.
    dark = (image.sum(axis=2) < 140)[:, 150:400].sum(axis=1)
    lines = np.nonzero(dark > 200)[0]
    assert len(lines) and np.ptp(lines) <= 2, lines
    inside = image[lines[0] - 60:lines[0] - 10, 150:400]
    assert (inside.sum(axis=2) > 640).any(), "no streamline"


@of_full_level
def test_every_kind_of_file_is_drawn_and_patches_keep_their_names():
    coarse, _ = cubes()
    run("pamr-convert", coarse, "cube.msh", "--quiet", serial=True)
    run("pamr-convert", coarse, "cube.vtu", "--quiet", serial=True)
    tetrahedron = [[(0, 0, 0), (0, 1, 0), (1, 0, 0)], [(0, 0, 0), (1, 0, 0), (0, 0, 1)],
                   [(0, 0, 0), (0, 0, 1), (0, 1, 0)], [(1, 0, 0), (0, 1, 0), (0, 0, 1)]]
    facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % p for p in t) + "endloop\nendfacet\n"
                     for t in tetrahedron)
    pathlib.Path("body.stl").write_text(f"solid body\n{facets}endsolid body\n")
    names = ["xmax", "xmin", "ymax", "ymin", "zmax", "zmin"]

    report = run("pamr-picture", coarse, "cube.msh", "cube.vtu", "body.stl", "-o", "p.png", "--field", "patch", "--json",
                 "-").json
    image = pixels("p.png")

    assert all(sorted(mesh["patches"]) == names for mesh in report["meshes"][:3]), report
    assert all(mesh["boundary_triangles"] == 6 * 72 for mesh in report["meshes"][:3]), report
    assert report["meshes"][3]["boundary_triangles"] == 4 and report["meshes"][3]["cells"] == 0, report
    run("pamr-picture", coarse, "-o", "two.png", "--patch", "xmin", "--patch", "xmax", "--quiet")
    run("pamr-picture", coarse, "-o", "both.png", "--patch", "x*", "--quiet")
    assert pathlib.Path("two.png").read_bytes() == pathlib.Path("both.png").read_bytes()
    shutil.copy(coarse, "groups.hdf")
    with h5py.File("groups.hdf", "r+") as file:
        names = file["PAMR/patches/names"].asstr()[:].tolist()
        file["PAMR/patches/groups"] = ["7 5 sides 9 2 no" if name in ("xmin", "xmax") else "" for name in names]
    run("pamr-picture", "groups.hdf", "-o", "sides.png", "--patch", "sides", "--label", "coarse", "--quiet")
    run("pamr-picture", coarse, "-o", "both.png", "--patch", "x*", "--label", "coarse", "--quiet", "--force")
    assert pathlib.Path("sides.png").read_bytes() == pathlib.Path("both.png").read_bytes()
    panels = np.array_split(image[80:-50], 4, axis=1)
    assert all(len(np.unique(panel.reshape(-1, 3), axis=0)) > 20 for panel in panels)


def test_whole_cells_log_scales_views_and_mirrors_work_together():
    coarse, _ = cubes()

    image = picture(coarse, "--cut", "z=0.4", "--whole-cells", "--mirror", "xy", "--field", "u:0", "--range", "0.1,10",
                    "--log", "--edges", "--camera", "-1,-1,1", "--camera", "z", "--zoom", "1", "--zoom", "2", "--title",
                    "speed", "--label", "a cube", "--map", "magma", "--smooth", "1", "--size", "500x700")

    # u is 1 everywhere: the middle of a logarithmic scale from 0.1 to 10. The second panel is full of it.
    assert image.shape[:2] == (700, 500)
    middle = np.median(image[420:600, 120:300].reshape(-1, 3), axis=0)
    assert np.abs(middle - np.array([183, 55, 121])).max() < 60, middle


def test_every_format_of_the_tools_is_read():
    import mesh_files
    os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"
    kuhn_cube("cube.hdf", 2)
    others = ("cube.vtkhdf", "cube.msh", "cube.vtu", "cube.mesh", "cube.meshb", "cube.su2", "a.lb8.ugrid", "b.b8.ugrid")
    for name in ("cube.cgns", "case", *(others if FULL else ())):
        run("pamr-convert", "cube.hdf", name, "--quiet", serial=True)
        mesh = mesh_files.read(name)
        assert (len(mesh.cells), len(mesh.faces), mesh.file) == (48, 48, name), name
        assert len(mesh.patches) == 6, (name, mesh.patches)
    for name in ("cube.stl", "cube.obj", "cube.ply", "cube.off", "cube.vtp") if FULL else ():
        run("pamr-convert", "cube.hdf", name, "--quiet", serial=True)
        assert len(mesh_files.read(name).faces) == 48, name
    mfem = ("MFEM mesh v1.0\n\ndimension\n3\n\nelements\n1\n1 4 0 1 2 3\n\nboundary\n4\n1 2 0 2 1\n1 2 0 1 3\n2 2 0 3 2\n"
            "3 2 1 2 3\n\nvertices\n4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
    for name, text in (("one.mfem", mfem), ("one.mesh", mfem), ("bom.mesh", "\ufeff" + mfem)):
        pathlib.Path(name).write_text(text, encoding="utf-8")
        mesh = mesh_files.read(name)
        assert (len(mesh.cells), len(mesh.faces), len(mesh.patches)) == (1, 4, 3), (name, mesh.patches)
    pathlib.Path("bad.cgns").write_text("no mesh")
    os.mkdir("no case")
    for name in ("bad.cgns", "no case", "cube"):
        try:
            mesh_files.read(name)
            raise AssertionError(name)
        except mesh_files.Refused as wrong:
            assert name in str(wrong), wrong


def test_patches_have_the_names_that_pamr_convert_gives():
    import mesh_files
    kuhn_cube("cube.hdf", 1)
    with h5py.File("cube.hdf", "r+") as file:
        patches = file["PAMR/patches"]
        others = {"xmin": "boundary", "xmax": "boundary_2", "ymin": "physical_7"}
        names = [others.get(name, name) for name in patches["names"].asstr()[:]]
        kinds = ["untagged" if name == "ymax" else "" for name in names]
        for key, texts in (("names", names), ("kinds", kinds)):
            del patches[key]
            patches.create_dataset(key, data=texts, dtype=h5py.string_dtype())
        del file["PAMR/checksums"]
    for name in ("a.msh", "b.mesh", "c.vtu", "d.cgns"):
        run("pamr-convert", "cube.hdf", name, "--quiet", serial=True)
    # names of tags alone, triangles without one, and arrays of others
    text = pathlib.Path("c.vtu").read_bytes()
    pathlib.Path("e.vtu").write_bytes(text.replace(b'Name="untagged patch ymax"', b'Name="mine"'))
    pathlib.Path("f.vtu").write_bytes(text.replace(b'Name="patch"', b'Name="medit:ref"').replace(b'Name="patch ', b'Name="some '))
    pathlib.Path("g.vtu").write_bytes(text.replace(b'Name="patch"', b'Name="mine"'))
    run("pamr-convert", "cube.hdf", "h.lb8.ugrid", "--quiet", serial=True)
    kuhn_cube("named.hdf", 1)
    run("pamr-convert", "named.hdf", "i.b8.ugrid", "--kind", "xmin=wall", "--quiet", serial=True)
    # of one tetrahedron with tags of a group and of a surface: no group, one surface in two groups, some in none (SaveAll)
    for name, tags in (("j", ((0, 1), (0, 2), (0, 2), (0, 3))), ("k", ((1, 1), (2, 1), (1, 2), (2, 3), (2, 4))), ("l", ((1, 1), (1, 2), (0, 3), (0, 4)))):
        pathlib.Path(f"{name}.msh").write_text(one_tetrahedron(tags, twice=len(tags) == 5))
    shutil.copy("cube.hdf", "m.hdf")
    with h5py.File("m.hdf", "r+") as file:  # as solvers may write it: triangles, no neighbors
        neighbors, cells = file["PAMR/cell_to_cell"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        cell, slot = np.nonzero(neighbors < 0)
        file["PAMR/boundary/triangles"] = np.take_along_axis(cells[cell], FACE_TO_CORNER[slot], axis=1)
        file["PAMR/boundary/patch"] = (-neighbors[cell, slot] - 1).astype("i4")
        del file["PAMR/cell_to_cell"]
    os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"
    known = {"a.msh": ["boundary", "boundary_2", "boundary_3", "physical_7", "zmax", "zmin"], "i.b8.ugrid": sorted(kuhn_patches()),
             "j.msh": ["surface_1", "surface_2", "surface_3"], "k.msh": ["A", "A+B", "B"], "l.msh": ["A", "surface_3", "surface_4"]}
    for name in ("a.msh", "b.mesh", "c.vtu", "d.cgns", "e.vtu", "f.vtu", "g.vtu", "h.lb8.ugrid", "i.b8.ugrid", "j.msh", "k.msh", "l.msh", "m.hdf"):
        run("pamr-convert", name, "back.hdf", "--force", "--quiet", serial=True)
        found, expected = (faces_of_patches(mesh_files.read(file)) for file in (name, "back.hdf"))
        assert found == expected and sorted(found) == known.get(name, sorted(found)), (name, found, expected)
        if name == "c.vtu":
            assert "ymax" in found, found


def one_tetrahedron(tags, twice=False):
    """A file of Gmsh 2.2: the tags of each triangle; `twice`: the first two triangles are one."""
    faces = [(1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4)]
    faces = faces[:1] * twice + faces
    rows = [f"2 2 {group} {surface} {a} {b} {c}" for (group, surface), (a, b, c) in zip(tags, faces)] + ["4 2 3 9 1 2 3 4"]
    return ('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 "A"\n2 2 "B"\n3 3 "gas"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n'
            f"2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n{len(rows)}\n"
            + "".join(f"{i + 1} {row}\n" for i, row in enumerate(rows)) + "$EndElements\n")


def kuhn_patches():
    return [f"{axis}{side}" for axis in "xyz" for side in ("min", "max")]


def faces_of_patches(mesh):
    return dict(zip(mesh.patches, np.bincount(mesh.face_patch, minlength=len(mesh.patches)).tolist()))


def test_what_pamr_convert_refuses_or_warns_of_is_refused_or_warned_of_in_its_words():
    kuhn_cube("cube.hdf", 1)
    run("pamr-convert", "cube.hdf", "a.vtu", "--quiet", serial=True)
    text = pathlib.Path("a.vtu").read_bytes()
    pathlib.Path("two.vtu").write_bytes(text.replace(b'Name="patch xm', b'Name="untagged patch xm'))
    pathlib.Path("hexahedra.vtu").write_text(
        '<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="2"><Points><DataArray type="Float64" '
        'NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1</DataArray></Points><Cells><DataArray '
        'type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7 0 1 2</DataArray><DataArray type="Int64" Name="offsets" '
        'format="ascii">8 11</DataArray><DataArray type="UInt8" Name="types" format="ascii">12 5</DataArray></Cells></Piece></UnstructuredGrid>'
        "</VTKFile>")
    pathlib.Path("rest.msh").write_text(one_tetrahedron(((1, 1), (2, 2))))
    pathlib.Path("bad.msh").write_text(one_tetrahedron(((1, 1), (1, 2), (0, 3), (0, 4))).replace("4 2 3 9 1 2 3 4", "4 2 3 9 1 2 3 5"))
    for name in ("two.vtu", "hexahedra.vtu", "bad.msh"):
        error = run("pamr-convert", name, "x.hdf", serial=True, code=2).err
        assert run("pamr-picture", name, "-o", "p.png", code=2).err == f"pamr-picture: error: {error.replace(': error', '')}", name

    warning = run("pamr-convert", "rest.msh", "x.hdf", "--quiet", serial=True).err

    assert "without tag are in the patch 'boundary'" in warning, warning
    found = run("pamr-picture", "rest.msh", "-o", "p.png", "--size", "300x300").err
    assert found == warning.replace("pamr-convert: warning", "pamr-picture: warning: pamr-convert"), found


def test_surfaces_of_triangles_alone_are_drawn_from_files_of_meshes():
    import mesh_files
    text = one_tetrahedron(((1, 1), (1, 2), (2, 3), (2, 4)))
    pathlib.Path("skin.msh").write_text(text.replace("5 4 2 3 9 1 2 3 4\n", "").replace("$Elements\n5", "$Elements\n4"))
    os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"

    mesh = mesh_files.read("skin.msh")

    assert (len(mesh.cells), faces_of_patches(mesh)) == (0, {"A": 2, "B": 2}), mesh


def test_units_of_arrays_are_read():
    import mesh_files
    import values
    array = '<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="ascii">{}{}</DataArray>'
    unit = '<InformationKey name="UNITS_LABEL" location="vtkDataArray">{}</InformationKey>'
    fields = (("p", "Pa"), ("q", "W/m^2"), ("area", "m^2"), ("hits", ""))
    pathlib.Path("wall.vtu").write_text(
        '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfPoints="3" NumberOfCells="1"><Points>'
        + array.format("Float64", "Points", 3, "0 0 0 1 0 0 0 1 0", "") + "</Points><Cells>"
        + array.format("Int64", "connectivity", 1, "0 1 2", "") + array.format("Int64", "offsets", 1, "3", "")
        + array.format("UInt8", "types", 1, "5", "") + "</Cells><CellData>"
        + "".join(array.format("Float64", name, 1, "7", label and unit.format(label)) for name, label in fields)
        + "</CellData></Piece></UnstructuredGrid></VTKFile>")
    mesh = mesh_files.read("wall.vtu")
    for name, label in fields:
        found = values.values_of(mesh, name)
        assert (found.unit, found.numbers.tolist()) == (label, [7]), (name, found)


def test_whole_cells_at_a_side_of_the_domain_are_those_that_lie_there():
    import mesh_files
    import shapes
    from view import Plane
    mesh = mesh_files.read(cubes()[0])
    for normal, offset in (((1, 0, 0), 0.0), ((0, 1, 0), 0.0), ((0, 0, 1), 0.0), ((0, 0, -1), -1.0)):
        plane = shapes.within(mesh, Plane(np.array(normal, float), offset))
        faces = shapes.complete_cells(mesh, shapes.behind(mesh, plane), {})
        owners = np.unique(shapes.array(faces.GetCellData(), "owner"))
        heights = (mesh.points[mesh.cells] @ np.array(normal, float) - offset).min(axis=1)
        assert len(owners) >= 36 and np.abs(heights[owners]).max() < 1e-9, (normal, len(owners))


def test_cells_are_chosen_by_a_field():
    import mesh_files
    import panel
    from view import Plane
    mesh = mesh_files.read(cubes()[0])
    x = mesh.points[mesh.cells][:, :, 0].mean(axis=1)
    mesh.cell_fields["x"], mesh.node_fields["at"] = x, mesh.points[:, 0]
    mesh.cell_fields["gap"] = np.where(x < 0.5, np.nan, x)
    half = Plane(np.array([0.0, 0, 1]), 0.5)
    is_low = mesh.points[mesh.cells][:, :, 2].mean(axis=1) <= 0.5

    for condition, cut, expected in ((("x", True, 0.3), None, x < 0.3), (("x", False, 0.3), half, (x > 0.3) & is_low),
                                     (("at", False, 0.7), None, x > 0.7), (("gap", True, 0.7), None, (x >= 0.5) & (x < 0.7))):
        subject = panel.Subject(mesh, panel.Wish(cut=cut, condition=condition))
        drawn = [np.unique(panel.shapes.array(data.GetCellData(), "owner")) for data, _, _ in subject.pieces()]
        assert (subject.chosen == expected).all() and np.isin(np.concatenate(drawn), np.flatnonzero(expected)).all(), condition
    none = panel.Subject(mesh, panel.Wish(condition=("x", False, 2.0), patches=["xmin"]))
    assert not none.chosen.any() and none.pieces()[0][0].GetNumberOfCells() and not none.pieces()[1][0].GetNumberOfCells()


def test_few_whole_numbers_have_colors_of_their_own_and_a_legend():
    name = "regions.hdf"
    shutil.copy(cubes()[0], name)
    with h5py.File(name, "r+") as file:
        x = file["VTKHDF/CellData/x"][:]
        file["VTKHDF/CellData/region"] = np.select([x < 0.3, x < 0.6], [7, 2], 0).astype("i4")
        file["VTKHDF/CellData/many"] = np.arange(len(x))
        file["PAMR/regions/numbers"], file["PAMR/regions/names"] = np.array([7]), np.array([b"gas"])

    image = picture(name, "--cut", "y=0.5", "--field", "region", "--size", "600x600", "--json", "r.json")

    assert json.loads(pathlib.Path("r.json").read_text())["field"] == {"name": "region", "min": 0, "max": 7, "values": [0, 2, 7]}
    left, right = image[:560, :300], image[:560, 300:]  # below is the legend
    for color, where, elsewhere in (((90, 190, 150), left, right), ((240, 190, 90), right, left)):
        assert near(where, color) > 5000 and near(elsewhere, color) == 0, color
    for field, options in (("many", ()), ("region", ("--range", "0,7")), ("region", ("--map", "magma")), ("x", ())):
        picture(name, "--cut", "y=0.5", "--field", field, "--size", "300x300", "--json", "r.json", *options)
        assert "values" not in json.loads(pathlib.Path("r.json").read_text())["field"], (field, options)


def test_titles_of_scales_fit_into_their_column():
    import page
    for title, lines in (("q, W/m^2", 1), ("density of the gas, 1/m^3", 3), ("temperature_translational", 2), ("x", 1)):
        found = page.wrapped(title, page.BAR - 18)
        assert len(found) == lines and "".join(found).replace(" ", "") == title.replace(" ", ""), found


@of_full_level
def test_one_process_of_an_mpi_job_draws():
    coarse, _ = cubes()

    done = subprocess.run(["mpirun", "--oversubscribe", "-n", "2", str(BIN / "pamr-picture"), coarse, "-o", "p.png"],
                          capture_output=True, text=True, timeout=LIMIT)

    assert done.returncode == 0 and done.stdout.count("p.png") == 1, done


if __name__ == "__main__":
    cubes()
    run_tests(globals(), at_once=2)
