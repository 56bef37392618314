# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-convert: Medit's, SU2's and AFLR3's formats in and out, CGNS out, checked by meshio, Gmsh, VTK, cgnscheck and the layout itself."""
import pathlib
import shutil
import struct
import subprocess
import warnings

import h5py
import numpy as np

from tool_run import kuhn_cube, prepare_alone, refuses, run, run_tests, same_bytes
from whole_meshio import meshio

prepare_alone("pamr-mark", "pamr-refine", "pamr-quality")
FORMATS = ["mesh", "meshb", "su2", "lb8.ugrid", "b8.ugrid"]
PATCHES = ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"]


def refined_cube(name="fine.hdf"):
    """A cube with closure cells, a field on nodes and one on cells."""
    kuhn_cube("cube.hdf", 3)
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--box", "0,0,0,0.4,0.4,1", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", name, "--quiet")
    with h5py.File(name, "r+") as file:
        points = file["VTKHDF/Points"][:]
        cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        file["VTKHDF"].require_group("PointData")["v"] = 2 * points
        file["VTKHDF/PointData/t"] = points[:, 0] + 0.1
        file["VTKHDF"].require_group("CellData")["q"] = points[cells].mean(axis=1)[:, 1]
    return points, cells


def patches_of(name):
    report = run("pamr-quality", name, "--json", "-", "--quiet").json["patches"]
    return {k: (v["faces"], round(v["area"], 12)) for k, v in report.items()}


def face_table(points, triangles, tags):
    """Faces by their corners in space, with their tag."""
    return {tuple(sorted(map(tuple, points[face]))): tag for face, tag in zip(triangles, tags)}


def expected_faces(points, triangles):
    on_plane = lambda face, k, x: np.all(points[face][:, k] == x)
    return [next(name for name in PATCHES if on_plane(face, "xyz".index(name[0]), float(name.endswith("max"))))
            for face in triangles]


def volumes(points, cells):
    p = points[cells]
    return np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6


def outward(points, cells, triangles):
    """1 for triangles seen counter-clockwise from outside of a convex body, -1 for the others."""
    p = points[triangles]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    return np.sign(np.einsum("ij,ij->i", normal, p.mean(axis=1) - points.mean(axis=0)))


def test_a_mesh_comes_back_from_every_format():
    points, cells = refined_cube()
    for ending in FORMATS:
        report = run("pamr-convert", "fine.hdf", f"out.{ending}", "--force", "--json", "-", "--quiet").json
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            read = meshio.read(f"out.{ending}")
        assert np.array_equal(read.points, points), (ending, "coordinates have changed")
        assert np.array_equal(read.cells_dict["tetra"], cells), ending
        triangles = read.cells_dict["triangle"]
        assert set(outward(points, cells, triangles)) == {-1.0 if "ugrid" in ending else 1.0}, ending
        key = {"mesh": "medit:ref", "meshb": "medit:ref", "su2": "su2:tag"}.get(ending, "ugrid:ref")
        tags = read.cell_data_dict[key]["triangle"]
        names = expected_faces(points, triangles)
        pairs = set(zip(names, tags))
        assert len(pairs) == 6, (ending, pairs)
        if "mesh" in ending:
            assert dict(pairs) == report["references"], (ending, pairs)
        back = run("pamr-convert", f"out.{ending}", f"back.{ending}.hdf", "--quiet", "--json", "-").json
        assert back["cells"] == len(cells) and back["nodes"] == len(points) and back["untagged_faces"] == 0
        found, wanted = patches_of(f"back.{ending}.hdf"), patches_of("fine.hdf")
        if "mesh" in ending:  # numbers alone
            wanted = {f"ref_{report['references'][k]}": v for k, v in wanted.items()}
        assert found == wanted, (ending, found, wanted)
        with h5py.File(f"back.{ending}.hdf") as file:
            assert sorted(map(tuple, file["VTKHDF/Points"][:])) == sorted(map(tuple, points)), ending
            again = file["VTKHDF/Points"][:][file["VTKHDF/Connectivity"][:].reshape(-1, 4)]
        assert sorted(map(sorted, again.tolist())) == sorted(map(sorted, points[cells].tolist())), ending
        # what comes back goes out again with the same numbers and names
        run("pamr-convert", f"back.{ending}.hdf", f"again.{ending}", "--quiet", "--force")
        run("pamr-convert", f"again.{ending}", f"third.{ending}.hdf", "--quiet")
        assert patches_of(f"third.{ending}.hdf") == found, ending


def test_files_do_not_depend_on_the_number_of_ranks():
    refined_cube()
    for ending in FORMATS + ["cgns"]:
        extra = {n: (["--sol-out", f"{n}.sol" + ("b" if ending == "meshb" else "")] if "mesh" in ending else [])
                 for n in ("one", "many")}
        run("pamr-convert", "fine.hdf", f"one.{ending}", "--quiet", "--force", *extra["one"], serial=True)
        run("pamr-convert", "fine.hdf", f"many.{ending}", "--quiet", "--force", *extra["many"])
        assert same_bytes(f"one.{ending}", f"many.{ending}"), ending
        if extra["one"]:
            assert same_bytes(extra["one"][1], extra["many"][1]), ending
        if ending == "cgns":
            continue
        with_fields = {n: (["--sol-in", e[1]] if e else []) for n, e in extra.items()}
        run("pamr-convert", f"one.{ending}", f"one.{ending}.hdf", "--quiet", *with_fields["one"], serial=True)
        run("pamr-convert", f"many.{ending}", f"many.{ending}.hdf", "--quiet", *with_fields["many"])
        assert same_bytes(f"one.{ending}.hdf", f"many.{ending}.hdf"), ending
    assert same_bytes("one.mapbc", "many.mapbc")


def test_fields_travel_with_medit_meshes():
    points, cells = refined_cube()
    for mesh, solution in (("a.mesh", "a.sol"), ("b.meshb", "b.solb")):
        run("pamr-convert", "fine.hdf", mesh, "--sol-out", solution, "--quiet")
        run("pamr-convert", mesh, f"{mesh}.hdf", "--sol-in", solution, "--sol-fields", "t,v,q", "--quiet")
        with h5py.File(f"{mesh}.hdf") as file:
            p = file["VTKHDF/Points"][:]
            c = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
            assert np.array_equal(file["VTKHDF/PointData/v"][:], 2 * p)
            assert np.array_equal(file["VTKHDF/PointData/t"][:], p[:, 0] + 0.1)
            assert np.array_equal(file["VTKHDF/CellData/q"][:], p[c].mean(axis=1)[:, 1])
    lines = pathlib.Path("a.sol").read_text().split()
    assert lines[:4] == ["MeshVersionFormatted", "2", "Dimension", "3"]
    at = lines.index("SolAtVertices")
    assert lines[at + 1:at + 5] == [str(len(points)), "2", "1", "2"], "a scalar, then a vector"
    assert float(lines[at + 5]) == points[0, 0] + 0.1
    # one field, as Mmg wants its metric
    run("pamr-convert", "fine.hdf", "m.mesh", "--sol-out", "m.sol", "--sol-fields", "t", "--quiet")
    words = pathlib.Path("m.sol").read_text().split()
    assert words[words.index("SolAtVertices") + 2:][:2] == ["1", "1"] and "SolAtTetrahedra" not in words
    run("pamr-convert", "m.mesh", "m.hdf", "--sol-in", "m.sol", "--quiet")
    with h5py.File("m.hdf") as file:
        assert list(file["VTKHDF/PointData"]) == ["sol_1"]
    refuses("pamr-convert", "fine.hdf", "n.mesh", "--sol-out", "n.sol", "--sol-fields", "nothing", says=["'nothing'"])
    refuses("pamr-convert", "fine.hdf", "n.su2", "--sol-out", "n.sol", says=["--sol-out", ".mesh"], creates="n.su2")
    refuses("pamr-convert", "fine.hdf", "n.mesh", "--sol-out", "n.sol", "--sol-fields", "t,t", says=["found 't' twice"], creates="n.sol")
    refuses("pamr-convert", "a.mesh", "n.hdf", "--sol-in", "a.sol", "--sol-fields", "t", says=["1 fields", "found 3"])
    run("pamr-convert", "cube.hdf", "cube.mesh", "--quiet")
    refuses("pamr-convert", "cube.mesh", "n.hdf", "--sol-in", "a.sol", says=["a.sol", "vertices of the mesh"],
            creates="n.hdf")


def test_gmsh_reads_what_is_written_and_writes_what_is_read():
    try:
        import gmsh
    except ImportError:
        print("without Gmsh (Debian: python3-gmsh)")
        return
    points, cells = refined_cube()
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    run("pamr-convert", "fine.hdf", "to.mesh", "--quiet")
    gmsh.open("to.mesh")
    kinds, _, nodes = gmsh.model.mesh.getElements(3)
    assert list(kinds) == [4] and len(nodes[0]) == 4 * len(cells)
    _, where, _ = gmsh.model.mesh.getNodes()
    assert sorted(map(tuple, np.array(where).reshape(-1, 3))) == sorted(map(tuple, points))
    gmsh.clear()
    box = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    for k, (_, face) in enumerate(gmsh.model.getEntities(2)):
        gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, [face], k + 1), f"side{k + 1}")
    gmsh.model.setPhysicalName(3, gmsh.model.addPhysicalGroup(3, [box], 9), "inside")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
    gmsh.option.setNumber("Mesh.SaveAll", 0)
    gmsh.model.mesh.generate(3)
    n_cells = len(gmsh.model.mesh.getElements(3)[2][0]) // 4
    for ending in ("mesh", "su2"):
        gmsh.write(f"from.{ending}")
    gmsh.finalize()
    for ending in ("mesh", "su2"):
        report = run("pamr-convert", f"from.{ending}", f"from.{ending}.hdf", "--json", "-", "--quiet").json
        assert report["cells"] == n_cells and report["untagged_faces"] == 0, (ending, report)
        areas = {k: v["area"] for k, v in run("pamr-quality", f"from.{ending}.hdf", "--json", "-", "--quiet")
                 .json["patches"].items()}
        assert len(areas) == 6 and all(abs(a - 1) < 1e-12 for a in areas.values()), (ending, areas)
        assert sorted(areas) == [f"{'side' if ending == 'su2' else 'ref_'}{k}" for k in range(1, 7)], areas


def test_names_that_a_format_cannot_have_are_others_with_a_word():
    kuhn_cube("cube.hdf", 1)
    names = ['the "big" wall', "w" * 200, "with blank", "a/b", "é" * 70, "plain"]

    def named(target, those):
        shutil.copyfile("cube.hdf", target)
        with h5py.File(target, "r+") as file:
            del file["PAMR/patches/names"], file["PAMR/checksums"].attrs["PAMR/patches/names"]
            file["PAMR/patches/names"] = np.array([name.encode() for name in those])
        return target
    named("names.hdf", names)
    in_gmsh = ["the 'big' wall", "w" * 127, "with blank", "a/b", "é" * 63, "plain"]
    for version, text in (("4.1", ()), ("4.1", ("--text",)), ("2.2", ()), ("2.2", ("--text",))):
        out = run("pamr-convert", "names.hdf", "names.msh", "--gmsh-version", version, *text, "--force", "--quiet")
        assert "Gmsh: patch 'the \"big\" wall' is written as 'the 'big' wall', and 2 other names are changed, too" in out.err, out.err
        run("pamr-convert", "names.msh", "back.hdf", "--force", "--quiet", serial=True)
        with h5py.File("back.hdf") as file:
            assert [name.decode() for name in file["PAMR/patches/names"]] == in_gmsh
        try:
            import gmsh
        except ImportError:
            continue
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open("names.msh")
        assert [gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups(2)] == in_gmsh
        gmsh.finalize()
    for output, changed in (("names.su2", "with_blank"), ("names.cgns", "a_b"), ("foam", "with_blank")):
        err = run("pamr-convert", "names.hdf", output, "--quiet").err
        assert ": patch '" in err and "changed" in err, err
    with h5py.File("names.hdf", "r+") as file:
        n = len(file["VTKHDF/Points"])
        file["VTKHDF/PointData/stress"], file["VTKHDF/PointData/stress_1"] = np.zeros((n, 6)), np.ones(n)
    assert "component of a field 'stress_1' is written as 'stress_1_2'" in run("pamr-convert", "names.hdf", "fields.cgns", "--quiet").err
    for output, those, back in (("twice.msh", ['a "b"', "a 'b'"], ["a 'b'_2", "a 'b'"]),
                                ("long.msh", ["w" * 128, "w" * 129], ["w" * 127, "w" * 125 + "_2"]),
                                ("twice.su2", ["a b", "a_b"], ["a_b_2", "a_b"]), ("twice", ["a_b", "a b"], ["a_b", "a_b_2"]),
                                ("twice.cgns", ["a/b", "GridElements"], ["a_b", "GridElements_2"]),
                                ("outer.cgns", [" a", "a "], ["_a", "a_"]), ("outer.lb8.ugrid", [" a", " a b "], ["_a", "_a b_"])):
        err = run("pamr-convert", named("twice.hdf", those + ["p", "q", "r", "s"]), output, "--quiet").err
        assert err.count("warning") == 1 and "is written as" in err, err
        run("pamr-convert", output, "back.hdf", "--force", "--quiet", serial=True)
        with h5py.File("back.hdf") as file:
            assert sorted(name.decode() for name in file["PAMR/patches/names"]) == sorted(back + ["p", "q", "r", "s"])


def cube_of_three_regions(name):
    """Regions 4, 5 and 6, cell by cell; the number of cells."""
    kuhn_cube(name, 2)
    with h5py.File(name, "r+") as file:
        n = len(file["VTKHDF/Types"])
        file["VTKHDF"].require_group("CellData")["region"] = np.arange(n, dtype=np.int32) % 3 + 4
    return n


def test_regions_are_references_of_tetrahedra():
    n = cube_of_three_regions("cube.hdf")
    for name in ("r.mesh", "r.meshb"):
        run("pamr-convert", "cube.hdf", name, "--quiet")
        assert np.array_equal(meshio.read(name).cell_data_dict["medit:ref"]["tetra"], np.arange(n) % 3 + 4)
        run("pamr-convert", name, f"{name}.hdf", "--quiet")
        with h5py.File(f"{name}.hdf") as file:
            assert sorted(file["VTKHDF/CellData/region"][:]) == sorted(np.arange(n) % 3 + 4)


def test_regions_of_gmsh_are_entities_of_their_own():
    """Gmsh gives the groups of an entity to all of its elements."""
    n = cube_of_three_regions("cube.hdf")
    for order in ("1", "2"):
        run("pamr-convert", "cube.hdf", "r.msh", "--gmsh-version", "2.2", "--text", "--order", order, "--quiet", "--force", serial=True)
        rows = [line.split() for line in pathlib.Path("r.msh").read_text().partition("$Elements")[2].splitlines()]
        tags = [tuple(map(int, row[3:5])) for row in rows if len(row) > 4 and row[1] in ("4", "11")]
        assert len(tags) == n and len(set(tags)) == 3 == len({entity for _, entity in tags}) and {group for group, _ in tags} == {4, 5, 6}, set(tags)


def test_blanks_behind_the_names_of_sections_of_gmsh():
    kuhn_cube("cube.hdf", 1)
    run("pamr-convert", "cube.hdf", "bare.msh", "--text", "--quiet", serial=True)
    lines = pathlib.Path("bare.msh").read_text().splitlines()
    lines[3:3] = ["$Comments", "$ a word", "$EndComments", "$Unknown", "1", "$EndUnknown"]
    pathlib.Path("blanks.msh").write_text("".join(line + (" \t\n" if line.startswith("$") else "\n") for line in lines))
    for name in ("bare", "blanks"):
        run("pamr-convert", f"{name}.msh", f"{name}.hdf", "--quiet")
    assert same_bytes("bare.hdf", "blanks.hdf")


def test_numbers_that_no_reader_takes_are_refused():
    points, cells = refined_cube()
    with h5py.File("fine.hdf", "r+") as file:
        file["VTKHDF/PointData/t"][3] = np.nan
        file["VTKHDF/CellData/region"] = np.full(len(cells), 10 ** 10)
    refuses("pamr-convert", "fine.hdf", "n.mesh", "--sol-out", "n.sol", says=["finite values", "'t'"], creates="n.sol")
    assert run("pamr-convert", "fine.hdf", "fine.vtu", "--quiet").err == ""
    for name, says in (("n.msh", "numbers below 2^31, found 10000000000"), ("n.mesh", "10000000000")):
        refuses("pamr-convert", "fine.hdf", name, says=[says], creates=name)
    text = "MeshVersionFormatted 2\nDimension\n3\nVertices\n4\n0 0 0 0\n{} 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 {}\nEnd\n"
    for name, x, region, says in (("far", 1e31, 1, "coordinates below 1e30, found 1e+31, 0, 0"), ("many", 1, 10 ** 10, "32 bits, found 10000000000")):
        pathlib.Path(f"{name}.mesh").write_text(text.format(x, region))
        refuses("pamr-convert", f"{name}.mesh", "n.hdf", says=[f"file '{name}.mesh'", says], creates="n.hdf")
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--scale", "1e31", says=["--scale", "below 1e30"], creates="n.hdf")
    with h5py.File("cube.hdf", "r+") as file:
        file["VTKHDF/Points"][3] = (0, 0, 1e31)
    assert "below 1e30" in run("pamr-quality", "cube.hdf", code=2).err
    kuhn_cube("small.hdf", 2)  # whose shapes would underflow
    with h5py.File("small.hdf", "r+") as file:
        file["VTKHDF/Points"][:] *= 1e-42
        del file["PAMR/checksums"].attrs["VTKHDF/Points"]
    refuses("pamr-quality", "small.hdf", says=["small.hdf", "larger than 1e-30", "1e-42"])


def test_kinds_and_units_are_given_on_the_command_line():
    kuhn_cube("cube.hdf", 2)
    run("pamr-convert", "cube.hdf", "cube.su2", "--quiet")
    run("pamr-convert", "cube.su2", "k.hdf", "--kind", "xmin=wall", "--kind", "ymin=symmetry", "--kind",
        "zmax=farfield", "--scale", "0.001", "--unit", "m", "--quiet")
    with h5py.File("k.hdf") as file:
        assert file["PAMR"].attrs["length_unit"] in (b"m", "m") and file["VTKHDF/Points"][:].max() == 0.001
    run("pamr-convert", "k.hdf", "k.lb8.ugrid", "--quiet")
    conditions = [line.split() for line in pathlib.Path("k.mapbc").read_text().splitlines()]
    assert conditions[0] == ["6"] and {c[2]: int(c[1]) for c in conditions[1:]} == {
        "xmin": 4000, "xmax": 0, "ymin": 6662, "ymax": 0, "zmin": 0, "zmax": 5000}
    run("pamr-convert", "k.lb8.ugrid", "u.hdf", "--quiet")
    assert set(patches_of("u.hdf")) == set(PATCHES)
    run("pamr-convert", "u.hdf", "case", "--quiet")
    boundary = pathlib.Path("case/constant/polyMesh/boundary").read_text()
    assert boundary.split("xmin")[1].split("type")[1].split(";")[0].strip() == "wall", "kinds come back from .mapbc"
    assert boundary.split("ymin")[1].split("type")[1].split(";")[0].strip() == "symmetry"
    run("pamr-convert", "k.hdf", "c.cgns", "--quiet")
    with h5py.File("c.cgns") as file:
        kind = lambda patch: bytes(file[f"Base/Zone1/ZoneBC/{patch}/ data"][:]).decode()
        assert [kind(p) for p in ("xmin", "ymin", "zmax", "xmax")] == [
            "BCWall", "BCSymmetryPlane", "BCFarfield", "UserDefined"]
    run("pamr-convert", "cube.hdf", "kinds.hdf", "--kind", "*m*=wall", "--kind", "[yz]max=outflow", "--quiet")
    with h5py.File("kinds.hdf") as file:
        names, kinds = ([bytes(text).decode() for text in file[f"PAMR/patches/{key}"][:]] for key in ("names", "kinds"))
    assert dict(zip(names, kinds)) == {p: "outflow" if p in ("ymax", "zmax") else "wall" for p in PATCHES}
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--kind", "w*=wall", says=["xmin", 'found "w*"'], creates="n.hdf")
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--kind", "wall", says=["PATCH=KIND"], creates="n.hdf")
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--kind", "xmin=wal", says=["symmetry", "'xmin=wal'"])
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--kind", "lid=wall", says=["xmin", 'found "lid"'])
    refuses("pamr-convert", "cube.hdf", "n.hdf", "--scale", "-1", says=["above 0"])
    refuses("pamr-convert", "k.hdf", "n.hdf", "--unit", "mm", says=["--scale", "m,"])
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.6", "-o", "s.hdf", "--quiet", serial=True)
    run("pamr-convert", "s.hdf", "twice.hdf", "--scale", "2", "--quiet")
    wall = run("pamr-quality", "twice.hdf", "--json", "-").json["patches"]["sphere"]
    before = run("pamr-quality", "s.hdf", "--json", "-").json["patches"]["sphere"]
    assert wall["surface"] == before["surface"] and wall["off_surface_nodes"] == 0 and wall["area"] == 4 * before["area"]
    assert "surfaces of 1 patch" in run("pamr-convert", "s.hdf", "s.mesh", "--scale", "2").err
    with h5py.File("s.hdf") as file:
        assert np.array_equal(meshio.read("s.mesh").points, 2 * file["VTKHDF/Points"][:])


def test_cgns_has_the_tree_that_the_standard_asks_for():
    points, cells = refined_cube()
    run("pamr-convert", "fine.hdf", "c.cgns", "--quiet")
    with h5py.File("c.cgns") as file:
        def check(group):
            for key in ("name", "label", "type", "flags"):
                assert key in group.attrs or group.name == "/", (group.name, key)
            if group.name != "/":
                assert group.attrs["name"].decode() == group.name.rsplit("/", 1)[1]
            for key in group:
                if isinstance(group[key], h5py.Group):
                    check(group[key])
        check(file)
        zone = file["Base/Zone1"]
        assert zone[" data"][:].ravel().tolist() == [len(points), len(cells), 0]
        x = np.stack([zone[f"GridCoordinates/Coordinate{a}/ data"][:] for a in "XYZ"], axis=1)
        assert np.array_equal(x, points)
        assert np.array_equal(zone["GridElements/ElementConnectivity/ data"][:].reshape(-1, 4) - 1, cells)
        assert zone["GridElements/ data"][:].tolist() == [10, 0]
        first = len(cells) + 1
        for patch in PATCHES:
            faces = zone[f"{patch}/ElementConnectivity/ data"][:].reshape(-1, 3) - 1
            assert zone[f"{patch}/ElementRange/ data"][:].tolist() == [first, first + len(faces) - 1]
            assert zone[f"ZoneBC/{patch}/PointRange/ data"][:].ravel().tolist() == [first, first + len(faces) - 1]
            assert set(expected_faces(points, faces)) == {patch} and set(outward(points, cells, faces)) == {1.0}
            first += len(faces)
        assert np.array_equal(zone["NodeFields/vY/ data"][:], 2 * points[:, 1])
        assert np.array_equal(zone["CellFields/q/ data"][:], points[cells].mean(axis=1)[:, 1])
    assert sorted(map(tuple, meshio.read("c.cgns").points)) == sorted(map(tuple, points))
    if shutil.which("cgnscheck"):  # the library of CGNS (Debian: cgns-convert)
        said = subprocess.run(["cgnscheck", "c.cgns"], capture_output=True, text=True, timeout=300)
        said = said.stdout + said.stderr
        assert "ERROR" not in said and "vertices in grid" in said or "checking" in said, said
    try:
        from vtkmodules.vtkIOCGNSReader import vtkCGNSReader
    except ImportError:
        print("VTK without CGNS")
        return
    reader = vtkCGNSReader()
    reader.SetFileName("c.cgns")
    reader.UpdateInformation()
    reader.EnableAllBases()
    reader.EnableAllPointArrays()
    reader.EnableAllCellArrays()
    reader.Update()
    found = []
    iterator = reader.GetOutput().NewIterator()
    while not iterator.IsDoneWithTraversal():
        found.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    counts = [g.GetNumberOfCells() for g in found]
    assert len(cells) in counts, counts


def one_cell_su2(**change):
    parts = {"head": "NDIME= 3\n", "cells": "NELEM= 1\n10 0 1 2 3 0\n",
             "nodes": "NPOIN= 4\n0 0 0 0\n1 0 0 1\n0 1 0 2\n0 0 1 3\n",
             "markers": "NMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 4\n5 0 1 2\n5 0 1 3\n5 1 2 3\n5 0 2 3\n"} | change
    pathlib.Path("bad.su2").write_text("".join(parts.values()))
    return "bad.su2"


def test_bad_su2_files_are_refused_with_the_place():
    run("pamr-convert", one_cell_su2(), "good.hdf", "--quiet")
    for change, says in [
            ({"head": ""}, ["NDIME"]), ({"head": "NDIME= 2\n"}, ["line 1", "3 dimensions", "2"]),
            ({"head": "NZONE= 2\nNDIME= 3\n"}, ["line 1", "one zone"]), ({"head": "hello\n"}, ["NDIME"]), ({"head": "NDIME= 3\nhello\n"}, ["line 2", "keyword"]),
            ({"cells": ""}, ["NELEM"]), ({"cells": "NELEM= 2\n10 0 1 2 3\n"}, ["line "]),
            ({"cells": "NELEM= 1\n12 0 1 2 3 0 1 2 3\n"}, ["1 hexahedra"]),
            ({"cells": "NELEM= 2\n10 0 1 2 3\n13 0 1 2 3 0 1\n"}, ["1 prisms"]),
            ({"cells": "NELEM= 1\n11 0 1 2 3\n"}, ["line 3", "element type"]),
            ({"cells": "NELEM= 1\n10 0 1 2\n"}, ["line 3", "end of the line"]),
            ({"cells": "NELEM= 1\n10 0 1 2 9\n"}, ["node number 9"]),
            ({"cells": "NELEM= 1\n5 0 1 2\n"}, ["line 3", "a triangle"]),
            ({"cells": "NELEM= 99999999999\n10 0 1 2 3\n"}, ["fits the file"]),
            ({"cells": "NELEM= -1\n"}, ["fits the file", "-1"]),
            ({"nodes": "NPOIN= 4\n0 0 0\n1 0 nan\n0 1 0\n0 0 1\n"}, ["line 6", "nan"]),
            ({"nodes": "NPOIN= 4\n0 0 0\n1 0\n0 1 0\n0 0 1\n"}, ["line 6", "z"]),
            ({"nodes": "NPOIN= 3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"}, ["line 8", "keyword"]),
            ({"markers": "NMARK= 2\nMARKER_TAG= w\nMARKER_ELEMS= 1\n5 0 1 2\n"}, ["2 markers"]),
            ({"markers": "NMARK= 1\nMARKER_ELEMS= 1\n5 0 1 2\n"}, ["MARKER_TAG"]),
            ({"markers": "MARKER_TAG= w\nMARKER_ELEMS= 1\n10 0 1 2 3\n"}, ["triangles in a marker"]),
            ({"markers": "MARKER_TAG= w\nMARKER_ELEMS= 1\n9 0 1 2 3\n"}, ["1 quadrangles"]),
            ({"markers": "NPERIODIC= 3\n"}, ["periodic", "3"])]:
        refuses("pamr-convert", one_cell_su2(**change), "n.hdf", says=["bad.su2", *says], creates="n.hdf")


def one_cell_medit(**change):
    parts = {"head": "MeshVersionFormatted 2\nDimension 3\n", "nodes": "Vertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n",
             "faces": "Triangles 4\n1 2 3 1\n1 2 4 1\n2 3 4 1\n1 3 4 2\n", "cells": "Tetrahedra\n1\n1 2 3 4 5\n",
             "end": "End\n"} | change
    pathlib.Path("bad.mesh").write_text("".join(parts.values()))
    return "bad.mesh"


def test_files_whose_cells_all_have_the_other_order_of_corners_are_turned_over():
    for name in (one_cell_su2(cells="NELEM= 1\n10 0 1 3 2\n"), one_cell_medit(cells="Tetrahedra\n1\n1 2 4 3 5\n")):
        assert "1 inverted cell was turned over" in run("pamr-convert", name, "turned.hdf", "--force").err


def test_bad_medit_files_are_refused_with_the_place():
    run("pamr-convert", one_cell_medit(), "good.hdf", "--quiet")
    for change, says in [
            ({"head": "MeshVersionFormatted 5\nDimension 3\n"}, ["line 1", "version 1 to 4"]),
            ({"head": "MeshVersionFormatted 2\nDimension 2\n"}, ["3 dimensions"]), ({"head": ""}, ["line 1", "Medit"]),
            ({"nodes": "Vertices\n4\n0 0 0 0 1 0 0 0\n0 1 0 0 0 0 1 0\n\n\n"}, ["line 5", "a line for each row"]),
            ({"nodes": "Vertices\n4\n0 0 0 0\n1 0 inf 0\n0 1 0 0\n0 0 1 0\n"}, ["line 6", "inf"]),
            ({"nodes": "Vertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"}, ["line "]),
            ({"nodes": "Vertices\n3\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"}, ["line 8", "a keyword"]),
            ({"nodes": ""}, ["nodes, found none"]), ({"cells": ""}, ["tetrahedra, found 4 triangles alone"]),
            ({"cells": "Tetrahedra\n1\n1 2 3 5 5\n"}, ["node number 5"]),
            ({"cells": "Tetrahedra\n1\n1 2 3 3 5\n"}, []),
            ({"cells": "Tetrahedra\n1\n1 2 3 4 5\nHexahedra\n1\n1 2 3 4 1 2 3 4 0\n"}, ["1 hexahedra"]),
            ({"cells": "Tetrahedra\n1\n1 2 3 4 5\nPrisms 2\n1 2 3 4 1 2 0\n1 2 3 4 1 2 0\n"}, ["2 prisms"]),
            ({"cells": "TetrahedraP2 1\n1 2 3 4 1 2 3 4 1 2 0\n"}, ["1 tetrahedra of second order"]),
            ({"cells": "Tetrahedra 1\n1 2 3 4 5\nTetrahedra 1\n1 2 3 4 5\n"}, ["Tetrahedra once"]),
            ({"cells": "Tetrahedra -1\n"}, ["-1"]), ({"cells": "Tetrahedra 1234567890123\n1 2 3 4 5\n"}, ["fits the file"]),
            ({"faces": "Triangles 1\n1 2 3.5 1\n"}, ["3.5"]), ({"faces": "Triangles 2\n1 2 3 1\n1 2 3 2\n"}, ["two surfaces"]),
            ({"faces": "SolAtVertices 1\n1 1\n0\n"}, [".sol"]), ({"faces": "PeriodicVertices 1\n1 2\n"}, ["periodic"])]:
        refuses("pamr-convert", one_cell_medit(**change), "n.hdf", says=["bad.mesh", *says], creates="n.hdf")


def test_bad_binary_files_are_refused_with_the_place():
    kuhn_cube("cube.hdf", 1)
    for name in ("g.meshb", "g.lb8.ugrid"):
        run("pamr-convert", "cube.hdf", name, "--quiet")
    medit, ugrid = pathlib.Path("g.meshb").read_bytes(), pathlib.Path("g.lb8.ugrid").read_bytes()

    def bad(name, data, *says):
        pathlib.Path(name).write_bytes(data)
        refuses("pamr-convert", name, "n.hdf", says=[name, *says], creates="n.hdf")

    put = lambda data, at, value: data[:at] + struct.pack("<i", value) + data[at + 4:]
    bad("b.meshb", medit[:100], "byte")
    bad("b.meshb", put(medit, 4, 7), "version")
    bad("b.meshb", put(medit, 8, 4), "Dimension")
    bad("b.meshb", put(medit, 16, 2), "3 dimensions")
    bad("b.meshb", put(medit, 24, 5), "byte", "later place")
    bad("b.meshb", put(medit, 24, 2 ** 30), "byte")
    bad("b.meshb", put(medit, 28, 2 ** 30), "fits the file")
    bad("b.meshb", put(medit, 28, -2), "-2")
    bad("b.lb8.ugrid", ugrid[:-1], "as its head says")
    bad("b.lb8.ugrid", ugrid[:20], "head")
    bad("b.b8.ugrid", ugrid, "bytes")
    bad("b.lb8.ugrid", put(ugrid, 24, 1), "as its head says")
    bad("b.lb8.ugrid", put(ugrid, 24, 1) + bytes(32), "1 hexahedra")
    bad("b.lb8.ugrid", put(ugrid, 20, 2) + bytes(48), "2 prisms")
    bad("b.lb8.ugrid", put(ugrid, 0, -1), "not negative")
    bad("b.lb8.ugrid", ugrid[:28] + struct.pack("<d", float("nan")) + ugrid[36:], "finite")
    pathlib.Path("b.ugrid").write_bytes(ugrid)
    refuses("pamr-convert", "b.ugrid", "n.hdf", says=[".lb8.ugrid", ".b8.ugrid"])
    for text, says in (("x\n", "number of surfaces"), ("1\n1 \n", "condition"),
                       ("2\n1 4000 a\n1 4000 b\n", "once")):
        pathlib.Path("g.mapbc").write_text(text)
        refuses("pamr-convert", "g.lb8.ugrid", "n.hdf", says=["g.mapbc", says], creates="n.hdf")
    pathlib.Path("g.mapbc").write_text("3\n1 4000 a\n2 5000 a\n3 0 a_2\n")
    said = run("pamr-convert", "g.lb8.ugrid", "n.hdf", "--json", "-")
    assert "two patches have the name 'a': the later one is called 'a_3'" in said.err and {"a", "a_2", "a_3"} < set(said.json["patches"]), said.err


def test_conditions_of_mapbc_come_back():
    kuhn_cube("cube.hdf", 2)
    run("pamr-convert", "cube.hdf", "m.lb8.ugrid", "--quiet")
    numbers = [line.split()[0] for line in pathlib.Path("m.mapbc").read_text().splitlines()[1:]]
    given = dict(zip(PATCHES, ("4010", "3000", "6662", "-1", "5026", "7100")))
    text = "6\n" + "".join(f"{n} {c} {p}\n" for n, (p, c) in zip(numbers, given.items()))
    pathlib.Path("m.mapbc").write_text(text)
    for to in ("m.hdf", "fine.hdf", "back.lb8.ugrid", "b.hdf", "again.b8.ugrid"):  # there and back through both formats
        made = {"fine.hdf": ("pamr-refine", "marked.hdf", "-o")}.get(to, ("pamr-convert", {"m.hdf": "m.lb8.ugrid", "back.lb8.ugrid": "fine.hdf",
                "b.hdf": "back.lb8.ugrid"}.get(to, "b.hdf")))
        if to == "fine.hdf":
            run("pamr-mark", "m.hdf", "-o", "marked.hdf", "--all")
        assert run(*made, to, "--quiet").err == "", to  # of levels a note says that they are left out
    assert pathlib.Path("back.mapbc").read_text() == text == pathlib.Path("again.mapbc").read_text()
    with h5py.File("m.hdf") as file:
        assert list(file["PAMR/patches/conditions"][:]) == [int(c) for c in given.values()]
        assert file["PAMR/patches/kinds"].asstr()[:].tolist() == ["wall", "symmetry", "symmetry", "", "outflow", ""]
    run("pamr-convert", "m.hdf", "k.lb8.ugrid", "--kind", "xmin=outflow", "--kind", "zmax=wall", "--kind", "xmax=symmetry")
    assert [line.split()[1] for line in pathlib.Path("k.mapbc").read_text().splitlines()[1:]] == ["7012", "3000", "6662", "-1", "5026", "4000"]
    for name in ("m.msh", "m.cgns", "m.su2"):
        assert "the boundary conditions (.mapbc) of 6 patches are left out" in run("pamr-convert", "m.hdf", name).err, name
    pathlib.Path("m.mapbc").write_text(f"1\n{numbers[0]} 4000 xmin\n")
    assert "condition (.mapbc) of 1 patch is left out: files of Gmsh" in run("pamr-convert", "m.lb8.ugrid", "m.msh", "--force").err


def test_a_compressed_cgns_file_of_many_cells_is_sound():
    """The process that reads it first may take the time and memory of its contents, which are far larger than the file."""
    kuhn_cube("cube.hdf", 60)
    run("pamr-convert", "cube.hdf", "plain.cgns", "--quiet")

    def pack(source, target):
        target.attrs.update(source.attrs)
        for name, node in source.items():
            if isinstance(node, h5py.Group):
                pack(node, target.create_group(name, track_order=True))
            elif node.size > 1000:
                target.create_dataset(name, data=node[:], chunks=True, shuffle=True, compression=1)
            else:
                target[name] = node[:]

    with h5py.File("plain.cgns") as source, h5py.File("small.cgns", "w", track_order=True) as target:
        pack(source, target)
    assert 4 * pathlib.Path("small.cgns").stat().st_size < pathlib.Path("plain.cgns").stat().st_size
    run("pamr-convert", "plain.cgns", "a.hdf", "--quiet")
    run("pamr-convert", "small.cgns", "b.hdf", "--quiet")
    assert same_bytes("a.hdf", "b.hdf")


def test_cgns_families_of_several_groups_make_parts_in_all_of_them():
    """As Gmsh writes them: a family for each entity, with the names of its groups within."""
    kuhn_cube("cube.hdf", 1)
    run("pamr-convert", "cube.hdf", "c.cgns", "--quiet")

    def node(parent, title, label, values=None):
        group = parent.create_group(title)
        data = np.frombuffer(values.encode(), np.int8) if isinstance(values, str) else values
        if data is not None:
            group.create_dataset(" data", data=data)
        for key, text, size in (("name", title, 33), ("label", label, 33), ("type", "MT" if data is None else "C1" if isinstance(values, str) else "I4", 3)):
            group.attrs.create(key, np.array(text.encode(), f"S{size}"))
        return group

    with h5py.File("c.cgns", "r+") as file:
        base, zone = file["Base"], file["Base/Zone1"]
        spans = {patch: zone[patch]["ElementRange/ data"][:] for patch in PATCHES}
        del zone["ZoneBC"]
        conditions = node(zone, "ZoneBC", "ZoneBC_t")
        cells = {"V_1": np.array([1, 3]), "V_2": np.array([4, 6])}
        groups = {"xmin": ["wall"], "xmax": ["wall", "in let"], "ymin": ["in let", "wall"], "ymax": ["A", "B"], "zmin": ["A", "B"],
                  "V_1": ["all", "left"], "V_2": ["all"]}
        for name, span in list(spans.items())[:5] + list(cells.items()):
            condition = node(conditions, name, "BC_t", "FamilySpecified")
            node(condition, "PointRange", "IndexRange_t", span.astype(np.int32).reshape(2, 1))
            node(condition, "GridLocation", "GridLocation_t", "CellCenter")
            node(condition, "FamilyName", "FamilyName_t", f"F_{name}")
            family = node(base, f"F_{name}", "Family_t")
            for group in groups[name]:
                node(family, group, "FamilyName_t", group if name not in ("ymax", "zmin") else f"/Base/{group}")  # a tree of families
            if name == "zmin":
                node(family, "FamilyBC", "FamilyBC_t", "BCWall")
        node(node(base, "F_other", "Family_t"), "all+left", "FamilyName_t", "all+left")
    run("pamr-convert", "c.cgns", "back.hdf", "--quiet")
    found = patches_of("back.hdf")
    assert found["wall"] == (2, 1.0) and sum(n for name, (n, _) in found.items() if "in let" in name) == 4, found
    assert {"F_ymax", "F_zmin"} < set(found) and len(found) == 5, found
    run("pamr-convert", "back.hdf", "back.msh", "--gmsh-version", "2.2", "--text", "--quiet", serial=True)
    names, _, elements = pathlib.Path("back.msh").read_text().partition("$PhysicalNames")[2].partition("$Elements")
    number = {line.split('"')[1]: line.split()[1] for line in names.splitlines() if '"' in line}
    rows = [line.split() for line in elements.splitlines()]
    count = {name: sum(len(row) > 4 and row[1] == kind and row[3] == number[name] for row in rows)
             for name, kind in (("wall", "2"), ("in let", "2"), ("all", "4"), ("left", "4"))}
    assert count == {"wall": 6, "in let": 4, "all": 6, "left": 3} and "all+left" not in number, (count, number)
    run("pamr-convert", "back.msh", "again.hdf", "--quiet")
    assert patches_of("again.hdf") == found


def test_cgns_elements_with_equal_numbers_are_refused():
    kuhn_cube("cube.hdf", 1)
    run("pamr-convert", "cube.hdf", "c.cgns", "--quiet")
    with h5py.File("c.cgns", "r+") as file:
        file["Base/Zone1/xmax/ElementRange/ data"][:] = file["Base/Zone1/xmin/ElementRange/ data"][:]
    refuses("pamr-convert", "c.cgns", "n.hdf", says=["c.cgns", "expected cells, and triangles, with different numbers, found two with number 7"],
            creates="n.hdf")


def test_places_beyond_two_gigabytes_are_read():
    """A binary Medit file whose parts lie behind a hole of 3 GB (a sparse file): positions of 64 bits."""
    kuhn_cube("cube.hdf", 1)
    run("pamr-convert", "cube.hdf", "small.meshb", "--quiet")
    small = pathlib.Path("small.meshb").read_bytes()
    hole = 3 * 2 ** 30
    data = [struct.pack("<iii", 1, 3, 3), struct.pack("<qi", 24, 3), struct.pack("<iqi", 13, hole, 0)]
    behind, at, place = b"", 20, hole
    while True:
        key, after = struct.unpack("<ii", small[at:at + 8])
        if key == 54:
            break
        body = small[at + 8:after]
        place += 12 + len(body)
        behind += struct.pack("<iq", key, place) + body
        at = after
    behind += struct.pack("<iq", 54, 0)
    with open("large.meshb", "wb") as file:
        file.write(b"".join(data))
        file.seek(hole)
        file.write(behind)
    run("pamr-convert", "small.meshb", "a.hdf", "--quiet")
    run("pamr-convert", "large.meshb", "b.hdf", "--quiet")
    assert same_bytes("a.hdf", "b.hdf")


run_tests(globals(), on_ranks=(test_files_do_not_depend_on_the_number_of_ranks, test_bad_medit_files_are_refused_with_the_place,
                               test_places_beyond_two_gigabytes_are_read))
