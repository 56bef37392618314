# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-convert: faces inside with a group are patches; --interfaces writes those between regions that have none."""
import pathlib
import shutil
import subprocess
import warnings

import h5py
import numpy as np

from tool_run import FULL, add_cell_field, kuhn_cube, refuses, run, run_tests, same_bytes
from whole_meshio import meshio

N = 4  # cubes along an edge; the layers of regions end at whole numbers of them


def layered_cube(name="layers.hdf"):
    """Regions 3, 5 and 9 below x = 1/4, below 1/2, above it; the first two have names."""
    kuhn_cube(name, N)
    with h5py.File(name) as file:
        points = file["VTKHDF/Points"][:]
        x = points[file["VTKHDF/Connectivity"][:].reshape(-1, 4)].mean(axis=1)[:, 0]
    add_cell_field(name, "region", np.where(x < 0.25, 3, np.where(x < 0.5, 5, 9)).astype(np.int32))
    return name


def read(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return meshio.read(name)


def triangles_by_group(name):
    """Corners in space of the triangles of each group, by number."""
    mesh = read(name)
    key = "gmsh:physical" if name.endswith(".msh") else "medit:ref"
    result = {}
    for block, tags in zip(mesh.cells, mesh.cell_data[key]):
        if block.type == "triangle":
            for tag in set(tags.tolist()):
                result.setdefault(tag, []).extend(mesh.points[block.data[tags == tag]].tolist())
    return {tag: np.array(corners) for tag, corners in result.items()}


def check_interface(triangles, x, n):
    """In the plane at x, seen from below it, n of them, which cover it."""
    assert triangles.shape == (n, 3, 3) and np.all(triangles[:, :, 0] == x), triangles.shape
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    assert np.all(normal[:, 0] > 0) and abs(normal[:, 0].sum() / 2 - 1) < 1e-12
    assert len({tuple(sorted(map(tuple, t))) for t in triangles.tolist()}) == n


def test_interfaces_are_written_and_read_back():
    layered_cube()
    run("pamr-mark", "layers.hdf", "-o", "marked.hdf", "--all", "--quiet", serial=True)
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    for source, name, options in (("layers.hdf", "a.msh", ["--gmsh-version", "2.2"]), ("fine.hdf", "b.msh", ["--text"]),
                                  ("fine.hdf", "c.mesh", []), ("layers.hdf", "d.meshb", [])):
        n = (8 if source == "fine.hdf" else 2) * N * N
        report = run("pamr-convert", source, name, "--interfaces", *options, "--json", "-").json
        assert report["interfaces"] == ["region_3_region_5", "region_5_region_9"]
        if name != "d.meshb":  # which meshio does not read
            groups = triangles_by_group(name)
            numbers = (7, 8) if name.endswith(".msh") else [report["references"][g] for g in report["interfaces"]]
            check_interface(groups[numbers[0]], 0.25, n)
            check_interface(groups[numbers[1]], 0.5, n)
            assert len(groups) == 8 and sum(map(len, groups.values())) == 8 * n
        run("pamr-convert", source, "one_" + name, "--interfaces", *options, serial=True)
        assert same_bytes(name, "one_" + name)
        back = run("pamr-convert", name, "back.hdf", "--force", "--json", "-", serial=True)
        assert sum(back.json["inner_faces"].values()) == 2 * n and "warning" not in back.err
        assert len(back.json["patches"]) == 8
    assert read("a.msh").field_data["region_5_region_9"].tolist() == [8, 2]
    run("pamr-convert", "a.msh", "strict.hdf", "--strict", serial=True)


MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 1 1
$EndNodes
$Elements
9
1 2 2 {outside} 1 1 3 2
2 2 2 {outside} 1 1 2 4
3 2 2 {outside} 1 1 4 3
4 2 2 {outside} 1 2 3 5
5 2 2 {outside} 1 3 4 5
6 2 2 {outside} 1 2 5 4
7 2 2 {inside} 2 2 3 4
8 4 2 {first} 1 1 2 3 4
9 4 2 {second} 2 2 3 4 5
$EndElements
"""


def test_volumes_without_groups_are_regions():
    pathlib.Path("bare.msh").write_text(MSH.format(outside=0, inside=0, first=0, second=0))
    report = run("pamr-convert", "bare.msh", "bare.hdf", "--json", "-").json
    assert report["patches"] == ["surface_2", "surface_1"] and report["inner_faces"] == {"surface_2": 1}
    with h5py.File("bare.hdf") as file:
        assert sorted(file["VTKHDF/CellData/region"][:].tolist()) == [1, 2]


def test_faces_inside_are_patches_and_stay_so():
    """A baffle within one region, an interface, and a group that is both on the boundary and inside."""
    for name, inside, second, patches in (("baffle", 2, 4, ["physical_1", "physical_2"]), ("between", 2, 6, ["physical_1", "physical_2"]),
                                          ("same", 1, 6, ["physical_1"])):
        pathlib.Path(f"{name}.msh").write_text(MSH.format(outside=1, inside=inside, first=4, second=second))
        report = run("pamr-convert", f"{name}.msh", f"{name}.hdf", "--json", "-").json
        assert report["patches"] == patches and report["inner_faces"] == {f"physical_{inside}": 1}, report
        run("pamr-convert", f"{name}.msh", "alone.hdf", "--force", "--quiet", serial=True)
        assert same_bytes(f"{name}.hdf", "alone.hdf")
        run("pamr-mark", f"{name}.hdf", "-o", "marked.hdf", "--patch", patches[-1], "--force", "--quiet", serial=True)
        run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--force", "--quiet")
        run("pamr-refine", "marked.hdf", "-o", "fine1.hdf", "--force", "--quiet", serial=True)
        assert same_bytes("fine.hdf", "fine1.hdf")
        for out in ("fine.msh", "fine.mesh", "fine.vtu", "fine.cgns", "fine_foam"):
            run("pamr-convert", "fine.hdf", out, "--force", "--quiet", serial=name != "between" and not FULL)
            back = run("pamr-convert", out, "back.hdf", "--force", "--json", "-", serial=True).json
            assert len(back["patches"]) == len(patches) and list(back["inner_faces"].values()) == [4], (out, back)
        if name != "same" and shutil.which("cgnscheck"):  # a condition is for boundary elements
            said = subprocess.run(["cgnscheck", "-v", "fine.cgns"], capture_output=True, text=True).stdout
            assert "checking complete" in said and "ERROR" not in said and "not boundary" not in said, said
        back = run("pamr-quality", "fine.hdf", "--json", "-", serial=True).json
        assert [p["faces"] for p in back["patches"].values()] == ([28] if name == "same" else [24, 4])
        run("pamr-convert", "fine.hdf", "su2.su2", "--force")
        refuses("pamr-convert", f"{name}.hdf", "old.hdf", "--format", "2", says=["expected 4"], creates="old.hdf")


def test_what_formats_without_a_place_leave_out_is_told():
    pathlib.Path("baffle.msh").write_text(MSH.format(outside=1, inside=2, first=4, second=4))
    run("pamr-convert", "baffle.msh", "baffle.hdf", "--quiet")
    for out in ("baffle.su2", "baffle.b8.ugrid"):
        err = run("pamr-convert", "baffle.hdf", out, "--force").err
        assert "1 face inside of 'physical_2' is left out" in err, (out, err)


def test_fields_and_regions_without_a_place_are_told():
    add_cell_field(kuhn_cube("all.hdf", 1), "T", np.arange(6.0))
    add_cell_field("all.hdf", "region", np.arange(6) // 3)
    temperature = "1 field is left out: 'T' on cells: files of"
    both = "2 fields are left out: 'T' on cells, 'region' on cells: files of"
    for out, words in (("all.msh", temperature), ("all.meshb", temperature), ("foam", temperature), ("all.su2", both),
                       ("all.lb8.ugrid", both), ("all.vtu", ""), ("all.cgns", ""), ("all.stl", "")):
        err = run("pamr-convert", "all.hdf", out, serial=out != "all.su2" and not FULL).err
        assert words in err if words else "warning" not in err, (out, err)
    told = run("pamr-convert", "all.hdf", "with.meshb", "--sol-out", "with.sol").err
    assert "field is left out" not in told and "note: files of Medit have no names of fields: in order, with.sol has 'T'" in told, told
    assert "note: the fields of with.sol were left out (--sol-in of pamr-convert reads them)" in run("pamr-convert", "with.meshb", "x.hdf").err
    assert "the fields" not in run("pamr-convert", "with.meshb", "y.hdf", "--sol-in", "with.sol", "--sol-fields", "T").err
    run("pamr-convert", "all.hdf", "with.mesh", "--sol-out", "with.solb", "--quiet")
    noted = run("pamr-convert", "with.mesh", "z.hdf").err
    assert all(f"note: the fields of with.{ending} were left out" in noted for ending in ("sol", "solb")), noted
    pathlib.Path("with.sol").unlink()
    assert run("pamr-convert", "with.mesh", "z.hdf", "--force").err.count("note: the fields of with.") == 1
    shutil.copy("all.hdf", "more.hdf")
    add_cell_field("more.hdf", "p", np.arange(6.0))
    add_cell_field("more.hdf", "four", np.ones((6, 4)))  # Medit has none of four components
    for names, words in ((["--sol-fields", "p"], "2 fields are left out: 'T' on cells, 'four' on cells: files of Medit"),
                         ([], "1 field is left out: 'four' on cells: files of Medit")):
        told = run("pamr-convert", "more.hdf", "with.meshb", "--sol-out", "with.sol", *names, "--force").err
        assert words in told and f"with.sol has {'' if names else chr(39) + 'T' + chr(39) + ' and '}'p'" in told, told
    run("pamr-mark", "all.hdf", "-o", "marked.hdf", "--crossing-sphere", "0,0,0,0.5", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    told = run("pamr-convert", "fine.hdf", "fine.msh").err
    assert temperature in told and "pamr-convert: note: left out, which a native file (.hdf) keeps: levels and families of" in told, told


def test_what_only_a_native_file_keeps_is_noted():
    note = "pamr-convert: note: left out, which a native file (.hdf) keeps: "
    pathlib.Path("numbers.msh").write_text(MSH.format(outside=11, inside=12, first=4, second=4).replace(
        "$Nodes", '$PhysicalNames\n1\n2 11 "wall"\n$EndPhysicalNames\n$Nodes', 1))
    run("pamr-convert", "numbers.msh", "numbers.hdf", "--quiet", "--unit", "mm")
    for out, words in (("numbers.su2", "numbers of 1 patch and the unit of lengths (mm)"), ("back.msh", "the unit of lengths (mm)"),
                       ("again.hdf", None)):
        err = run("pamr-convert", "numbers.hdf", out).err
        assert (note + words in err) if words else err == "", (out, err)
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", "ball.hdf", "--quiet", serial=True)
    assert note + "surfaces of 1 patch" in run("pamr-convert", "ball.hdf", "ball.vtu").err
    assert note not in run("pamr-convert", "ball.hdf", "ball.stl").err


def test_what_lies_beside_the_mesh_of_a_case_is_noted():
    kuhn_cube("cube.hdf", 1)
    run("pamr-convert", "cube.hdf", "case", "--quiet")
    for folder in ("case/0", "case/10", "case/0.orig", "case/constant/solid"):
        pathlib.Path(folder).mkdir()
        (pathlib.Path(folder) / "U").write_text("")
    shutil.copytree("case/constant/polyMesh", "case/constant/solid/polyMesh")
    told = run("pamr-convert", "case", "part.hdf", "--strict").err
    assert "pamr-convert: note: 2 times with fields were left out (pamr.openfoam.read_fields of Python reads them): 0, 10" in told, told
    assert "pamr-convert: note: 1 region of the case has a mesh of its own, which was left out: solid" in told, told
    shutil.rmtree("case/constant/polyMesh")
    refuses("pamr-convert", "case", "none.hdf", says=["regions alone", "solid"], creates="none.hdf")


def test_options_that_would_do_nothing_are_refused():
    kuhn_cube("cube.hdf", 1)
    pathlib.Path("plane.toml").write_text('[[surface]]\nname = "xmin"\nkind = "plane"\npoint = [0, 0, 0]\nnormal = [1, 0, 0]\n')
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--patch", "xmin", says=["--patch: expected --surface beside it"], creates="n.hdf")
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--repair", "--strict", says=["--repair or --strict"], creates="n.hdf")
    refuses("pamr-convert", "cube.msh", "n.hdf", "--as-level-0", says=["--as-level-0: expected a native mesh"], creates="n.hdf")
    refuses("pamr-convert", "cube.hdf", "cube.msh", "--tolerance", "1e-3", says=["--tolerance: expected --surface, --surfaces, --cad"], creates="cube.msh")
    for option in (["--kind", "xmin=wall"], ["--surfaces", "plane.toml"]):
        refuses("pamr-convert", "cube.hdf", "cube.stl", *option, says=[f"{option[0]}: expected a mesh to write, found a boundary"], creates="cube.stl")
    run("pamr-convert", "cube.hdf", "plain.msh", "--quiet", serial=True)
    run("pamr-convert", "plain.msh", "cube.vtu", "--surfaces", "plane.toml", "--tolerance", "1e-3", "--kind", "xmin=wall")


def test_what_has_no_interfaces():
    kuhn_cube("cube.hdf", 2)
    assert "nothing to write" in run("pamr-convert", "cube.hdf", "cube.msh", "--interfaces").err
    refuses("pamr-convert", "cube.hdf", "cube.su2", "--interfaces", says=["--interfaces: expected", ".msh"],
            creates="cube.su2")


run_tests(globals())
