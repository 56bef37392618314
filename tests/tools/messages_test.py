# SPDX-License-Identifier: GPL-3.0-or-later
"""What users stumble over, and that the message says what to do about it: one test a stumbling block."""
import os
import pathlib
import shutil

import h5py
import numpy as np

from tool_run import kuhn_cube, refuses, run, run_tests

ONE_CELL = """$MeshFormat
{version} 0 8
$EndMeshFormat
$Nodes
{n}
{nodes}$EndNodes
$Elements
1
1 {kind} 2 1 1 {corners}
$EndElements
"""
CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (.5, 0, 0), (.5, .5, 0), (0, .5, 0), (0, 0, .5), (0, .5, .5), (.5, 0, .5)]


def one_cell(name, version="2.2", order=1):
    n = 4 if order == 1 else 10
    nodes = "".join("%d %g %g %g\n" % (i + 1, *p) for i, p in enumerate(CORNERS[:n]))
    pathlib.Path(name).write_text(ONE_CELL.format(version=version, n=n, nodes=nodes, kind=4 if order == 1 else 11,
                                                  corners=" ".join(str(i + 1) for i in range(n))))
    return name


def square(name, size, is_closed):
    """A cube of this size about (0.5, 0.5, 0.5), or the cube without one of its twelve triangles, as STL."""
    quads = [((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
             ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
             ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))][0 if is_closed else 1:]
    text = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %r %r %r\n" % tuple(size * v for v in p) for p in t) +
                   "endloop\nendfacet\n" for t in triangles)
    pathlib.Path(name).write_text(f"solid body\n{text}endsolid body\n")
    return name


def test_native_outputs_have_native_names():
    kuhn_cube("a.hdf", 2)
    run("pamr-mark", "a.hdf", "-o", "b.hdf", "--all")
    for tool, arguments, name in (("pamr-mesh", ["--shape", "kuhn-cube", "--n", 2], "x.vtu"), ("pamr-mark", ["a.hdf", "--all"], "x.msh"),
                                  ("pamr-refine", ["b.hdf"], "x.vtu"), ("pamr-partition", ["a.hdf", "-p", 2], "x.csv"),
                                  ("pamr-mark", ["a.hdf", "--all"], "x.b8.ugrid"),
                                  ("pamr-quality", ["a.hdf", "--worst", 1], "x.vtu")):
        refuses(tool, *arguments, "--worst-out" if tool == "pamr-quality" else "-o", name,
                says=[name, "native mesh", ".hdf", "pamr-convert"], creates=name)


def test_what_was_changed_names_its_checksum():
    kuhn_cube("a.hdf", 2)
    run("pamr-mark", "a.hdf", "-o", "b.hdf", "--all")
    with h5py.File("b.hdf", "r+") as file:
        file["VTKHDF/CellData/refine"][0] = 0
    result = run("pamr-refine", "b.hdf", "-o", "c.hdf")
    assert "/VTKHDF/CellData/refine: the values do not agree with their checksum: they were changed" in result.err, result.err
    with h5py.File("b.hdf", "r+") as file:
        file["VTKHDF/Points"][0] = -0.01
    refuses("pamr-refine", "b.hdf", "-o", "d.hdf", says=["the file is damaged, or a script", "'VTKHDF/Points' of /PAMR/checksums"],
            creates="d.hdf")


def test_a_file_of_gmsh_is_told_apart_from_damage():
    refuses("pamr-refine", one_cell("part.msh"), "-o", "r.hdf", says=["found one of Gmsh: pamr-convert part.msh part.hdf"])
    shutil.copy("part.msh", "renamed.hdf")
    refuses("pamr-quality", "renamed.hdf", says=["found one of Gmsh"])
    pathlib.Path("part.su2").write_text("NDIME= 3")
    refuses("pamr-quality", "part.su2", says=["found one of SU2: pamr-convert part.su2 part.hdf"])


def test_missing_marks_name_who_writes_them():
    for options, beside in ((["--format", 3], "--output"), (["--force"], "--output"),
                            (["--floors", "--quality-control", "none"], "--quality-control removable")):
        refuses("pamr-refine", "b.hdf", "--dry-run", *options, says=[f"{options[0]}: expected {beside} beside it"])
    refuses("pamr-refine", kuhn_cube("a.hdf", 2), "-o", "r.hdf", says=["expected a cell field 'refine'", "pamr-mark writes it", "--marks FIELD"])


def test_marking_nothing_is_warned_of():
    kuhn_cube("a.hdf", 2)
    for arguments, says in ((["--all", "--max-cells", 10], "the mesh has 48 cells already, more than --max-cells 10"),
                            (["--all", "--max-cells", 48], "not one of the cells that are wanted fits"),
                            (["--crossing-sphere", "1000,0,0,1"], "no cell meets a criterion")):
        result = run("pamr-mark", "a.hdf", "-o", "b.hdf", "--force", *arguments)
        assert result.err.startswith("pamr-mark: warning: nothing is marked: ") and says in result.err, result.err
    result = run("pamr-refine", "b.hdf", "-o", "c.hdf")
    assert "warning: nothing is marked in the field 'refine': the output is the input mesh" in result.err, result.err
    assert run("pamr-mark", "a.hdf", "-o", "b.hdf", "--force", "--all").err == ""


def test_versions_of_the_format_are_written_as_such():
    with h5py.File(kuhn_cube("a.hdf", 2), "r+") as file:
        file["VTKHDF"].attrs["Version"] = np.array([3, 7])
    refuses("pamr-quality", "a.hdf", says=["expected 1.x or 2.x, found 3.7"])


def test_gates_say_the_near_name_and_short_numbers():
    kuhn_cube("a.hdf", 2)
    refuses("pamr-quality", "a.hdf", "--gate", "meanratio.min:min:0.2", says=["unknown number 'meanratio.min'; did you mean 'mean_ratio.min'?"])
    refuses("pamr-quality", "a.hdf", "--gate", "meanratio:min:0.2", says=["did you mean 'mean_ratio'?"])
    refuses("pamr-quality", "a.hdf", "--gate", "beauty:min:0.2", says=["the report has: aspect_ratio.max "])
    result = run("pamr-quality", "a.hdf", "--gate", "mean_ratio:min:0.9", code=1)
    assert result.err == "pamr-quality: error: a.hdf: gate failed: mean_ratio.min is 0.755953, expected at least 0.9\n", result.err


def test_values_that_are_not_finite_are_named():
    with h5py.File(kuhn_cube("a.hdf", 2), "r+") as file:
        values = np.ones(48)
        values[3] = np.nan
        file.create_dataset("VTKHDF/CellData/q", data=values)
    refuses("pamr-mark", "a.hdf", "-o", "b.hdf", "--field", "q", "--above", 1, says=["expected finite values, found another in cell 3"])


def test_unknown_options_name_the_near_one():
    kuhn_cube("a.hdf", 2)
    for tool, arguments, says in (("pamr-mesh", ["--shpae", "kuhn-cube", "-o", "x.hdf"], "unknown option --shpae; did you mean --shape?"),
                                  ("pamr-mark", ["a.hdf", "-o", "x.hdf", "--sphere", "0,0,0,5"], "unknown option --sphere; did you mean --crossing-sphere?"),
                                  ("pamr-mark", ["a.hdf", "--ouput", "x.hdf", "--all"], "unknown option --ouput; did you mean --output?"),
                                  ("pamr-diff", ["a.hdf", "a.hdf", "a.hdf"], "unexpected argument 'a.hdf'"),
                                  ("pamr-refine", ["a.hdf", "-o", "x.hdf", "--qqqqqq=3"], "unknown option --qqqqqq (see")):
        refuses(tool, *arguments, says=[says, f"(see {tool} --help)"], creates="x.hdf")


def test_a_file_of_another_tool_is_answered_with_that_tool():
    for name, says in (("a.hdf", "pamr-quality"), ("b.msh", "pamr-convert b.msh boundary.stl"), ("c.vtu", "the name of a mesh")):
        pathlib.Path(name).touch()
        refuses("pamr-surface", "info", name, says=[f"{name}: expected triangles", says])
    for name, says in (("a.hdf", "pamr-refine"), ("b.msh", "pamr-convert"), ("d.stl", "[[surface]]"), ("e.ply", "pamr-surface info")):
        refuses("pamr-mesh", name, "-o", "x.hdf", says=[f"{name}: expected a case file (TOML) or a solid", says], creates="x.hdf")


def test_an_output_without_a_name_is_refused():
    kuhn_cube("a.hdf", 2)
    refuses("pamr-convert", "a.hdf", "", says=["OUT: expected the name of a mesh to write, found an empty name"], creates="constant")


def test_options_of_a_format_that_is_not_written_are_refused():
    kuhn_cube("a.hdf", 2)
    refuses("pamr-convert", "a.hdf", "foam", "--text", says=["--text: expected an output that ends in .msh"], creates="foam")
    refuses("pamr-convert", "a.hdf", "a.vtu", "--gmsh-version", "2.2", says=["--gmsh-version: expected an output that ends in .msh"], creates="a.vtu")
    run("pamr-convert", "a.hdf", "a.msh", "--text", "--gmsh-version", "2.2")


def test_meshes_of_gmsh_that_cannot_be_read_come_with_the_command_that_mends_them():
    refuses("pamr-convert", one_cell("a.msh", order=2), "a.hdf", says=["1 tetrahedra of second order", "gmsh -order 1"])
    refuses("pamr-convert", one_cell("b.msh", version="4.0"), "b.hdf", says=["2.2 or 4.1", "-format msh41"])
    parts = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PartitionedEntities\n2\n0\n0 0 0 0\n$EndPartitionedEntities\n"
    pathlib.Path("c.msh").write_text(parts)
    refuses("pamr-convert", "c.msh", "c.hdf", says=["one that Gmsh has partitioned", "-unpartition"])


def test_boundaries_without_triangles_are_warned_of():
    result = run("pamr-convert", one_cell("a.msh"), "a.hdf")
    assert "4 boundary faces without tag are in the patch 'boundary'" in result.err, result.err


def test_surfaces_in_place_of_meshes_open_ones_and_other_units_are_told_apart():
    kuhn_cube("a.hdf", 2)
    square("body.stl", 1.0, is_closed=True)
    square("open.stl", 1.0, is_closed=False)
    square("small.stl", 0.001, is_closed=True)
    refuses("pamr-convert", "body.stl", "x.hdf", says=["found a surface: pamr-mesh meshes", "--surface"], creates="x.hdf")
    refuses("pamr-convert", "a.hdf", "x.hdf", "--surface", "open.stl", "--patch", "xmin",
            says=["found 3 edges with one triangle", "open = true"], creates="x.hdf")
    run("pamr-convert", "a.hdf", "a.msh", "--quiet")  # whose patches lie on no surfaces
    refuses("pamr-convert", "a.msh", "x.hdf", "--surface", "small.stl", "--patch", "xmin",
            says=["the surface is about 816 times smaller than the patch: other units?"], creates="x.hdf")
    assert not os.path.exists("x.hdf")


def test_lines_of_summaries_fit_into_160_columns():
    folder = "a folder with quite a long name/and another one in it that is longer still, as they are on servers"
    os.makedirs(folder)
    names = {name: os.path.join(folder, f"{name} of the case.hdf") for name in ("level0", "marked", "level1")}
    for words in (["pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", names["level0"]],
                  ["pamr-mark", names["level0"], "-o", names["marked"], "--patch", "sphere"],
                  ["pamr-refine", names["marked"], "-o", names["level1"]],
                  ["pamr-quality", names["level1"]], ["pamr-diff", names["level0"], names["level0"]],
                  ["pamr-convert", names["level1"], os.path.join(folder, "level1 of the case.msh")],
                  ["pamr-partition", names["level1"], "-o", os.path.join(folder, "parts of the case.hdf"), "--parts", "4"]):
        lines = run(*words, serial=True).out.splitlines()
        assert lines and all(len(line) <= 160 for line in lines), (words, lines)


if __name__ == "__main__":
    run_tests(globals())
