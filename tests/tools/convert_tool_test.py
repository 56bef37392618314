# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-convert: Gmsh's formats in and out, VTK's out; meshio is the independent reader."""
import pathlib

import h5py
import numpy as np

from surface_models import bored_cube, can, icosphere, write_stl
from tool_run import kuhn_cube, of_full_level, prepare_alone, refuses, run, run_tests, same_bytes
from whole_meshio import meshio
from tet import FACE_TO_CORNER

prepare_alone("pamr-mesh", "pamr-mark", "pamr-quality")
FORMATS = [("2.2", True), ("2.2", False), ("4.1", True), ("4.1", False)]


def to_gmsh(source, target, version, text, **how):
    run("pamr-convert", source, target, "--gmsh-version", version, *(["--text"] if text else []), "--quiet", **how)
    return target


def fingerprint(mesh):
    return run("pamr-quality", mesh, "--json", "-", "--quiet").json["fingerprint"]


def test_a_mesh_comes_back_from_every_format():
    kuhn_cube("cube.hdf", 3)
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--box", "0,0,0,0.4,0.4,1", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    with h5py.File("fine.hdf") as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
    run("pamr-convert", "fine.hdf", "plain.vtu", "--quiet")
    for version, text in FORMATS:
        name = f"fine{version}{text}.msh"
        to_gmsh("fine.hdf", name, version, text)
        read = meshio.read(name)
        assert np.array_equal(read.points, points), "coordinates have changed"
        assert np.array_equal(read.cells_dict["tetra"], cells)
        assert set(read.field_data) == {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}
        for patch, (tag, _) in read.field_data.items():
            on_patch = read.cells_dict["triangle"][read.cell_data_dict["gmsh:physical"]["triangle"] == tag]
            axis, side = "xyz".index(patch[0]), 0.0 if patch.endswith("min") else 1.0
            assert len(on_patch) > 0 and np.all(points[on_patch][:, :, axis] == side), patch
        back = run("pamr-convert", name, "back.hdf", "--force", "--json", "-").json
        assert back["cells"] == len(cells) and back["nodes"] == len(points) and back["untagged_faces"] == 0
        assert sorted(back["patches"]) == sorted(read.field_data)
        with h5py.File("back.hdf") as file:
            again = file["VTKHDF/Points"][:]
        assert sorted(map(tuple, again)) == sorted(map(tuple, points)), "coordinates have changed on the way back"
        areas = [run("pamr-quality", m, "--json", "-", "--quiet").json["patches"] for m in ("fine.hdf", "back.hdf")]
        assert {k: (v["faces"], round(v["area"], 12)) for k, v in areas[0].items()} == \
               {k: (v["faces"], round(v["area"], 12)) for k, v in areas[1].items()}


def test_files_do_not_depend_on_the_number_of_ranks():
    kuhn_cube("cube.hdf", 4)
    for version, text in FORMATS:
        to_gmsh("cube.hdf", "one.msh", version, text, serial=True)
        to_gmsh("cube.hdf", "many.msh", version, text)
        assert same_bytes("one.msh", "many.msh"), (version, text)
        run("pamr-convert", "one.msh", "one.hdf", "--quiet", serial=True)
        run("pamr-convert", "many.msh", "many.hdf", "--quiet")
        assert same_bytes("one.hdf", "many.hdf"), (version, text)
        for name in ("one.msh", "many.msh", "one.hdf", "many.hdf"):
            pathlib.Path(name).unlink()
    for name, how in (("one.vtu", {"serial": True}), ("many.vtu", {})):
        run("pamr-convert", "cube.hdf", name, "--quiet", **how)
    assert same_bytes("one.vtu", "many.vtu")


def test_the_boundary_is_a_surface_in_every_format():
    kuhn_cube("cube.hdf", 2)
    with h5py.File("cube.hdf") as file:
        nodes = set(map(tuple, file["VTKHDF/Points"][:]))
    for ending in ("stl", "obj", "ply", "off", "vtp"):
        run("pamr-convert", "cube.hdf", f"all.{ending}", "--quiet")
        run("pamr-convert", "cube.hdf", f"one.{ending}", "--quiet", serial=True)
        assert same_bytes(f"all.{ending}", f"one.{ending}"), ending
        run("pamr-convert", "cube.hdf", f"part.{ending}", "--quiet", "--patch", "xmin", "--patch", "zmax")
        if ending == "vtp":  # meshio does not read it
            text = pathlib.Path("part.vtp").read_text()
            assert 'NumberOfPolys="16"' in text and 'Name="patch"' in text and 'Name="cell"' in text
            continue
        for name, n_triangles, area, volume in ((f"all.{ending}", 48, 6, 1), (f"part.{ending}", 16, 2, None)):
            read = meshio.read(name)
            triangles, points = read.cells_dict["triangle"], read.points
            a, b, c = (points[triangles[:, k]] for k in range(3))
            assert len(triangles) == n_triangles and set(map(tuple, points)) <= nodes
            assert np.isclose(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, area, rtol=1e-14)
            assert volume is None or np.isclose(np.einsum("ij,ij->", a, np.cross(b, c)) / 6, volume, rtol=1e-14)
    run("pamr-convert", "cube.hdf", "several.stl", "--quiet", "--patch", "x*", "--patch", "[yz]min")
    run("pamr-convert", "cube.hdf", "named.stl", "--quiet", *(w for p in ("xmin", "xmax", "ymin", "zmin") for w in ("--patch", p)))
    assert same_bytes("several.stl", "named.stl")
    refuses("pamr-convert", "cube.hdf", "x.stl", "--patch", "nose", says=["nose", "xmin"], creates="x.stl")
    refuses("pamr-convert", "cube.hdf", "x.stl", "--patch", "n*", says=["n*", "xmin"], creates="x.stl")
    refuses("pamr-convert", "cube.hdf", "x.stl", "--surface", "all.stl", says=["--surface", "x.stl"], creates="x.stl")
    refuses("pamr-convert", "cube.hdf", "all.stl", says=["--force"])


def test_vtu_holds_the_mesh_and_its_fields():
    kuhn_cube("cube.hdf", 2)
    with h5py.File("cube.hdf", "r+") as file:
        n = file["VTKHDF/Types"].shape[0]
        file["VTKHDF"].require_group("CellData")["weight"] = np.arange(n) * 0.5
        file["VTKHDF"].require_group("PointData")["flow"] = file["VTKHDF/Points"][:] * 2
    run("pamr-convert", "cube.hdf", "cube.vtu", "--quiet")
    read = meshio.read("cube.vtu")
    with h5py.File("cube.hdf") as file:
        assert np.array_equal(read.points, file["VTKHDF/Points"][:])
        assert np.array_equal(read.cells_dict["tetra"], file["VTKHDF/Connectivity"][:].reshape(-1, 4))
    assert np.array_equal(read.cell_data["weight"][0], np.arange(n) * 0.5)
    assert np.array_equal(read.point_data["flow"], 2 * read.points)


def test_vtu_has_the_boundary_with_patches_level_and_shape():
    kuhn_cube("cube.hdf", 2)
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--box", "0,0,0,0.5,0.5,0.5", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    run("pamr-convert", "fine.hdf", "fine.vtu", "--quiet")
    run("pamr-convert", "fine.hdf", "again.vtu", "--quiet", serial=True)
    assert same_bytes("fine.vtu", "again.vtu")
    read = meshio.read("fine.vtu")
    with h5py.File("fine.hdf") as file:
        names = [name.decode() for name in file["PAMR/patches/names"][:]]
        neighbors, level = file["PAMR/cell_to_cell"][:], file["PAMR/lineage"][:] >> 12 & 0xFF
        shown = file["VTKHDF/CellData/level"]
        assert shown.dtype == np.uint8 and np.array_equal(shown[:], level) and level.max() == 1
    numbers = {key[6:]: int(value[0]) for key, value in read.field_data.items()}
    assert numbers == {name: i for i, name in enumerate(names)}, numbers
    triangles, patch = read.cells_dict["triangle"], read.cell_data_dict["patch"]["triangle"]
    assert len(triangles) == (neighbors < 0).sum() and (read.cell_data_dict["patch"]["tetra"] == -1).all()
    corners = read.points[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    for name, number in numbers.items():  # one side of the unit cube each, seen from outside
        axis, sign = "xyz".index(name[0]), 1 if name.endswith("max") else -1
        total = areas[patch == number].sum(axis=0)
        assert np.allclose(total, sign * np.eye(3)[axis]), (name, total)
    assert np.array_equal(read.cell_data_dict["level"]["tetra"], level)
    owner = np.nonzero(neighbors < 0)[0]
    assert np.array_equal(read.cell_data_dict["level"]["triangle"], level[owner])
    quality = run("pamr-quality", "fine.hdf", "--json", "-", serial=True).json["mean_ratio"]
    ratio = read.cell_data_dict["mean_ratio"]["tetra"]
    assert ratio.min() == np.float32(quality["min"]) and ratio.max() == np.float32(quality["max"])
    assert ratio.dtype == np.float32 and read.cell_data_dict["level"]["tetra"].dtype == np.uint8


def test_the_level_for_viewers_follows_the_lineage_and_fields_of_that_name_stay():
    kuhn_cube("cube.hdf", 2)
    with h5py.File("cube.hdf", "r+") as file:
        file["VTKHDF/CellData/level"][:] = 7  # not what the lineage says: not read
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--all", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    with h5py.File("fine.hdf", "r+") as file:
        assert (file["VTKHDF/CellData/level"][:] == 1).all()
        del file["VTKHDF/CellData/level"]
        file["VTKHDF/CellData/level"] = np.full(8 * 48, 2.5)  # somebody's own field
    run("pamr-convert", "fine.hdf", "own.hdf", "--quiet")
    run("pamr-convert", "own.hdf", "own.vtu", "--quiet")
    with h5py.File("own.hdf") as file:
        assert (file["VTKHDF/CellData/level"][:] == 2.5).all()
    assert (meshio.read("own.vtu").cell_data_dict["level"]["tetra"] == 2.5).all()


def two_cells(version="2.2", nodes=None, elements=None):
    """Two tetrahedra with a common face, all outer faces tagged."""
    nodes = nodes or ["10 0 0 0", "20 1 0 0", "30 0 1 0", "40 0 0 1", "50 1 1 1"]
    elements = elements or ["1 4 2 7 1 10 20 30 40", "2 4 2 7 1 20 30 40 50", "3 2 2 1 1 10 20 30",
                            "4 2 2 1 1 10 20 40", "5 2 2 1 1 10 30 40", "6 2 2 2 2 20 30 50", "7 2 2 2 2 20 40 50",
                            "8 2 2 2 2 30 40 50", "9 15 2 0 1 10", "10 1 2 0 1 10 20"]
    return "\n".join([f"$MeshFormat\n{version} 0 8\n$EndMeshFormat", "$PhysicalNames", "3", '2 1 "near"',
                      '2 2 "far side"', '3 7 "gas"', "$EndPhysicalNames", "$Nodes", str(len(nodes)), *nodes, "$EndNodes",
                      "$Elements", str(len(elements)), *elements, "$EndElements", ""])


def write(name, text):
    pathlib.Path(name).write_text(text)
    return name


def test_groups_become_patches_and_regions():
    result = run("pamr-convert", write("two.msh", two_cells()), "two.hdf", "--json", "-").json
    assert result["patches"] == ["near", "far side"] and result["cells"] == 2 and result["nodes"] == 5
    with h5py.File("two.hdf") as file:
        assert list(file["VTKHDF/CellData/region"][:]) == [7, 7]
    assert regions_of("two.hdf")[0] == {7: "gas"} and result["regions"] == {"7": "gas"}


def cube_of_two_regions():
    """A refined cube whose cells left and right of x = 1/2 are regions 9 "gas" and 4 "sölid body"; 1 is named but empty."""
    kuhn_cube("cube.hdf", 2)
    with h5py.File("cube.hdf", "r+") as file:
        middle = file["VTKHDF/Points"][:][file["VTKHDF/Connectivity"][:].reshape(-1, 4)].mean(axis=1)
        file["VTKHDF"].require_group("CellData")["region"] = np.where(middle[:, 0] < 0.5, 9, 4).astype(np.int32)
        file["PAMR/regions/numbers"] = [1, 4, 9]
        file["PAMR/regions/names"] = ["nothing", "sölid body", "gas"]
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--box", "0,0,0,0.4,0.4,1", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    return "fine.hdf"


def regions_of(file):
    """Numbers and names of the regions of a native file, and the number and volume of the cells of each."""
    with h5py.File(file) as f:
        points, cells = f["VTKHDF/Points"][:], f["VTKHDF/Connectivity"][:].reshape(-1, 4)
        region = f["VTKHDF/CellData/region"][:]
        names = dict(zip(f["PAMR/regions/numbers"][:].tolist(), (n.decode() for n in f["PAMR/regions/names"][:])))
    p = points[cells]
    volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
    return names, {int(r): (int((region == r).sum()), round(volume[region == r].sum(), 12)) for r in np.unique(region)}


def test_regions_keep_their_names_through_refinement_and_back_to_gmsh():
    names, parts = regions_of(cube_of_two_regions())
    assert names == {1: "nothing", 4: "sölid body", 9: "gas"} and [v for _, v in parts.values()] == [0.5, 0.5]
    assert parts[9][0] > parts[4][0] >= 24
    for version, text in FORMATS:
        read = meshio.read(to_gmsh("fine.hdf", f"fine{version}{text}.msh", version, text))
        volumes = {name: int(tag) for name, (tag, dimension) in read.field_data.items() if dimension == 3}
        assert volumes == {"nothing": 1, "sölid body": 4, "gas": 9}
        tags = read.cell_data_dict["gmsh:physical"]["tetra"]
        assert {int(t): int((tags == t).sum()) for t in np.unique(tags)} == {t: n for t, (n, _) in parts.items()}
        report = run("pamr-convert", f"fine{version}{text}.msh", "back.hdf", "--force", "--json", "-").json
        assert report["regions"] == {"1": "nothing", "4": "sölid body", "9": "gas"}
        assert regions_of("back.hdf") == (names, parts)
    run("pamr-convert", "fine.hdf", "again.hdf", "--quiet", serial=True)
    assert same_bytes("fine.hdf", "again.hdf")
    run("pamr-convert", "fine.hdf", "fine.vtu", "--quiet")
    with h5py.File("fine.hdf") as file:
        assert np.array_equal(meshio.read("fine.vtu").cell_data["region"][0], file["VTKHDF/CellData/region"][:])


def test_regions_become_zones_of_an_openfoam_case():
    cube_of_two_regions()
    run("pamr-convert", "fine.hdf", "case", "--quiet")
    run("pamr-convert", "fine.hdf", "again", "--quiet", serial=True)
    zones = pathlib.Path("case/constant/polyMesh/cellZones")
    assert same_bytes(zones, "again/constant/polyMesh/cellZones")
    words = zones.read_text().split("}\n", 1)[1].split()
    assert words[0] == "2" and words.count("cellZone;") == 2
    with h5py.File("fine.hdf") as file:
        region = file["VTKHDF/CellData/region"][:]
    for number, word in ((4, "s__lid_body"), (9, "gas")):
        here = words.index(word)
        n = int(words[here + 6])
        assert words[here + 5 : here + 8 : 2] == ["List<label>", "("] and words[here + 8 + n] == ")"
        assert [int(w) for w in words[here + 8 : here + 8 + n]] == np.flatnonzero(region == number).tolist()


def test_a_face_between_two_regions_with_a_patch_on_each_side_keeps_one():
    """Solvers with interfaces want such surfaces in the file."""
    between = two_cells().replace("2 4 2 7 1 20 30 40 50", "2 4 2 8 1 20 30 40 50").replace(
        "$Elements\n10", "$Elements\n12").replace("9 15 2", "11 2 2 3 3 40 20 30\n12 2 2 4 4 20 30 40\n9 15 2")
    told = run("pamr-convert", write("between.msh", between), "between.hdf", "--json", "-")
    assert told.json["inner_faces"] == {"physical_3": 1}
    assert told.json["patches"] == ["near", "far side", "physical_3"] and told.json["untagged_faces"] == 0
    assert "1 triangle is in the group 'physical_3' and in 'physical_4': it stays in 'physical_3'" in told.err, told.err
    with h5py.File("between.hdf") as file:
        assert sorted(file["VTKHDF/CellData/region"][:]) == [7, 8]
    run("pamr-convert", "between.msh", "again.hdf", "--quiet", serial=True)
    assert same_bytes("between.hdf", "again.hdf")
    refuses("pamr-convert", "between.msh", "strict.hdf", "--strict", says=["in 'physical_3' and in 'physical_4'"], creates="strict.hdf")


def two_cells_in_two_groups():
    """The cells are in the groups 9 and 7, three of the triangles in 2 and 1: format 2.2 has these twice, 4.1 lists the groups."""
    names = '$PhysicalNames\n4\n2 1 "near"\n2 2 "far side"\n3 7 "gas"\n3 9 "hot"\n$EndPhysicalNames\n'
    cells, near = ["10 20 30 40", "20 30 40 50"], ["10 20 30", "10 20 40", "10 30 40"]
    far = ["20 30 50", "20 40 50", "30 40 50"]
    of_2 = [(f"2 2 {group} 1", face) for face in near for group in (2, 1)] + [("2 2 2 2", face) for face in far]
    of_2 += [(f"4 2 {group} 1", cell) for group in (9, 7) for cell in cells]
    yield two_cells(elements=[f"{i + 1} {kind} {nodes}" for i, (kind, nodes) in enumerate(of_2)]).replace(
        two_cells().split("$EndMeshFormat\n")[1].split("$Nodes")[0], names)
    yield "\n".join(["$MeshFormat\n4.1 0 8\n$EndMeshFormat", names + "$Entities\n0 0 2 1\n1 0 0 0 1 1 1 2 2 1 0", "2 0 0 0 1 1 1 1 2 0",
                     "1 0 0 0 1 1 1 2 9 7 0\n$EndEntities", "$Nodes\n1 5 10 50\n3 1 0 5\n10\n20\n30\n40\n50",
                     "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n3 8 1 8", "2 1 2 3", *(f"1 {t}" for t in near),
                     "2 2 2 3", *(f"1 {t}" for t in far), "3 1 4 2", *(f"1 {c}" for c in cells), "$EndElements", ""])


def test_entities_in_two_groups_are_in_both():
    for version, text in zip(("22", "41"), two_cells_in_two_groups()):
        told = run("pamr-convert", write(f"groups{version}.msh", text), f"groups{version}.hdf", "--strict", "--quiet", "--json", "-")
        assert told.err == "" and told.json["patches"] == ["far side", "near+far side"], told.json
        with h5py.File(f"groups{version}.hdf") as file:
            assert list(file["VTKHDF/CellData/region"][:]) == [1, 1]
            assert file["PAMR/patches/groups"].asstr()[:].tolist() == ["", "1 4 near 2 8 far side"]
            assert file["PAMR/regions/names"].asstr()[:].tolist() == ["gas+hot", "gas", "hot"]
            assert file["PAMR/regions/groups"].asstr()[:].tolist() == ["7 3 gas 9 3 hot", "", ""]
    assert same_bytes("groups22.hdf", "groups41.hdf")
    run("pamr-convert", "groups22.msh", "serial.hdf", "--quiet", serial=True)
    assert same_bytes("groups22.hdf", "serial.hdf")
    for name, n_marked in (("near", 1), ("far side", 2), ("near+far side", 1), ("n*r", 1), ("far*", 2)):
        run("pamr-mark", "groups22.hdf", "-o", "marked.hdf", "--patch", name, "--force", "--quiet", serial=True)
        with h5py.File("marked.hdf") as file:
            assert file["VTKHDF/CellData/refine"][:].sum() == n_marked, name
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    for version, names in (("2.2", ["--text"]), ("2.2", []), ("4.1", ["--text"]), ("4.1", [])):
        run("pamr-convert", "groups22.hdf", "back.msh", "--gmsh-version", version, *names, "--force", "--quiet")
        run("pamr-convert", "back.msh", "back.hdf", "--force", "--quiet")
        assert same_bytes("groups22.hdf", "back.hdf"), (version, names)
        run("pamr-convert", "fine.hdf", "fine.msh", "--gmsh-version", version, *names, "--force", "--quiet")
        report = run("pamr-convert", "fine.msh", "fine2.hdf", "--force", "--json", "-").json
        assert report["patches"] == ["far side", "near+far side"] and report["regions"] == {"1": "gas+hot", "7": "gas", "9": "hot"}, report
        known = b'$PhysicalNames\n4\n2 2 "far side"\n2 1 "near"\n3 7 "gas"\n3 9 "hot"\n$EndPhysicalNames'
        assert known in pathlib.Path("back.msh").read_bytes(), version


def test_elements_in_some_of_three_groups_keep_them_all():
    """Of three groups of one entity: faces in each pair, in all, in one; `a+b` is the name of a group, too."""
    sets = [("1", ["10 20 30"]), ("12", ["10 20 40"]), ("23", ["10 30 40"]), ("123", ["20 30 50"]), ("13", ["20 40 50"]), ("4", ["30 40 50"])]
    of = [(f"2 2 {group} 1", face) for groups, faces in sets for face in faces for group in groups]
    names = '$PhysicalNames\n4\n2 1 "a"\n2 2 "b"\n2 3 "c"\n2 4 "a+b"\n$EndPhysicalNames\n'
    text = two_cells(elements=[f"{i + 1} {kind} {nodes}" for i, (kind, nodes) in enumerate(of + [
        ("4 2 7 1", "10 20 30 40"), ("4 2 7 1", "20 30 40 50")])])
    text = text.replace(two_cells().split("$EndMeshFormat\n")[1].split("$Nodes")[0], names)
    told = run("pamr-convert", write("three.msh", text), "three.hdf", "--json", "-")
    assert told.json["patches"] == ["a", "a+b", "a+b+", "a+b+c", "a+c", "b+c"], told.json["patches"]
    run("pamr-convert", "three.hdf", "three2.msh", "--quiet")
    run("pamr-convert", "three2.msh", "again.hdf", "--quiet", serial=True)
    assert same_bytes("three.hdf", "again.hdf")


def test_nodes_twice_in_one_group_are_refused():
    twice = write("twice.msh", two_cells().replace("$Elements\n10\n", "$Elements\n11\n11 4 2 7 1 20 30 40 50\n"))
    refuses("pamr-convert", twice, "twice.hdf", says=["at most two cells"], creates="twice.hdf")


def test_inverted_cells_are_turned_over_unless_they_are_folded():
    turned = two_cells().replace("1 4 2 7 1 10 20 30 40", "1 4 2 7 1 20 10 30 40")
    done = run("pamr-convert", write("turned.msh", turned), "out.hdf", "--json", "-")
    assert done.json["turned_cells"] == 1 and "1 inverted cell was turned over" in done.err, done.err
    refuses("pamr-convert", "turned.msh", "strict.hdf", "--strict", says=["1 inverted"], creates="strict.hdf")
    points, cells = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1]], [[0, 1, 2, 3], [4, 2, 1, 3]]
    meshio.write("folded.msh", meshio.Mesh(np.array(points, float), [("tetra", np.array(cells))]), file_format="gmsh22", binary=False)
    refuses("pamr-convert", "folded.msh", "folded.hdf", says=["1 faces with two on one side"], creates="folded.hdf")


def two_boxes(shift, name):
    """Two unit cubes side by side, of nodes of their own; the second one is shifted."""
    kuhn_cube("cube.hdf", 2)
    with h5py.File("cube.hdf") as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
    points = np.concatenate([points, points + np.array(shift)])
    form = {"file_format": "gmsh22", "binary": False} if name.endswith("msh") else {}
    meshio.write(name, meshio.Mesh(points, [("tetra", np.concatenate([cells, cells + 27]))]), **form)
    return name


def test_torn_meshes_are_told_and_welded_whatever_the_format():
    for name in ("torn.msh", "torn.vtu", "torn.mesh", "torn.su2"):
        told = run("pamr-convert", two_boxes((1, 0, 0), name), "torn.hdf", "--force", "--json", "-")
        assert (told.json["pieces"], told.json["coincident_nodes"], told.json["coincident_faces"], told.json["overlaps"]) == (2, 9, 16, 0)
        assert "16 boundary faces lie on others" in told.err and "in 2 pieces" in told.err and "--weld joins" in told.err, told.err
        refuses("pamr-convert", name, "strict.hdf", "--strict", says=["torn"], creates="strict.hdf")
        told = run("pamr-convert", name, "whole.hdf", "--weld", "--force", "--json", "-")
        assert told.json["welded_nodes"] == 9 and told.json["pieces"] == 1 and told.json["coincident_faces"] == 0, told.json
        assert "9 nodes were joined" in told.err and "pieces" not in told.err
        run("pamr-convert", "torn.hdf", "later.hdf", "--weld", "--force", "--quiet")
        counts = [[run("pamr-quality", mesh, "--json", "-", "--quiet").json[key] for key in ("nodes", "pieces", "coincident_faces", "volume")]
                  for mesh in ("torn.hdf", "whole.hdf", "later.hdf")]
        assert counts == [[54, 2, 16, 2], [45, 1, 0, 2], [45, 1, 0, 2]], counts
    told = run("pamr-convert", two_boxes((0.4, 0.1, 0.3), "inside.vtu"), "inside.hdf", "--json", "-")
    assert told.json["overlaps"] > 0 and "the mesh overlaps itself" in told.err and "--weld" not in told.err
    refuses("pamr-convert", "inside.vtu", "strict.hdf", "--strict", says=["96 faces without"], creates="strict.hdf")
    run("pamr-convert", "inside.hdf", "inside.msh", "--kind", "boundary=patch", "--quiet")
    refuses("pamr-convert", "inside.msh", "strict.hdf", "--strict", says=["overlaps itself"], creates="strict.hdf")
    kuhn_cube("whole.hdf", 2)
    run("pamr-mark", "whole.hdf", "-o", "marked.hdf", "--all", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    refuses("pamr-convert", "fine.hdf", "welded.hdf", "--weld", says=["--weld: expected a mesh of level 0"], creates="welded.hdf")


def test_a_file_with_the_other_order_of_corners_is_turned_over():
    lines = two_cells().splitlines()
    cells = [i for i, line in enumerate(lines) if line.split()[1:2] == ["4"] and len(line.split()) == 9]
    for i in cells:
        words = lines[i].split()
        lines[i] = " ".join(words[:5] + [words[6], words[5]] + words[7:])
    out = run("pamr-convert", write("other.msh", "\n".join(lines) + "\n"), "out.hdf", "--json", "-")
    assert len(cells) == 2 and out.json["turned_cells"] == 2 and "2 inverted cells were turned over" in out.err
    assert run("pamr-quality", "out.hdf", "--json", "-").json["valid"]
    refuses("pamr-convert", "other.msh", "strict.hdf", "--strict", says=["2 inverted"], creates="strict.hdf")


def test_what_is_no_good_mesh_is_refused_by_name():
    good = two_cells()
    cases = {
        "nothing": ("", ["$MeshFormat"]),
        "version": (good.replace("2.2 0 8", "4.0 0 8"), ["line 2", "2.2 or 4.1"]),
        "number": (good.replace("20 1 0 0", "20 1 x 0"), ["line 13", '"x"']),
        "nan": (good.replace("20 1 0 0", "20 1 nan 0"), ["line 13", "finite"]),
        "twice": (good.replace("20 1 0 0", "10 1 0 0"), ["10 twice"]),
        "missing": (good.replace("1 4 2 7 1 10 20 30 40", "1 4 2 7 1 10 20 30 45"), ["node number 45"]),
        "negative": (good.replace("1 4 2 7 1 10 20 30 40", "1 4 2 7 1 10 20 30 -4"), ["node number -4"]),
        "flat": (good.replace("40 0 0 1", "40 1 1 0"), ["1 flat"]),
        "second order": (good.replace("1 4 2 7 1 10 20 30 40", "1 11 2 7 1 10 20 30 40 10 20 30 40 50 10"),
                         ["1 tetrahedra of second order"]),
        "hexahedra": (good.replace("1 4 2 7 1 10 20 30 40", "1 5 2 7 1 10 20 30 40 50 10 20 30"), ["1 hexahedra"]),
        "apart": (good.replace("3 2 2 1 1 10 20 30", "3 2 2 1 1 10 20 50"), ["1 apart from the cells"]),
        "two tags": (good.replace("4 2 2 1 1 10 20 40", "4 2 2 2 2 10 20 30"), ["1 faces in two surfaces"]),
        "many": (good.replace("$Nodes\n5", "$Nodes\n5000000000"), ["5000000000"]),
        "few": (good.replace("$Nodes\n5", "$Nodes\n6"), ["expected"]),
        "cut": (good[:300], ["the end of the file"]),
        "no cells": ("\n".join(line for line in good.split("\n") if " 4 2 7 " not in line).replace("\n10\n1 4", "\n8\n1 4")
                     .replace("$Elements\n10", "$Elements\n8"), ["tetrahedra, found 6 triangles alone", "Physical Volume"]),
        "periodic": (good + "$Periodic\n1\n2 1 2\nten\n10 20\n$EndPeriodic\n", ["pairs of linked nodes", "ten"]),
        "scattered": (good.replace("50", "5000000"), ["without wide gaps"]),
    }
    for name, (text, says) in cases.items():
        refuses("pamr-convert", write(f"{name}.msh", text), "out.hdf", says=[f"{name}.msh", *says], creates="out.hdf")


def test_strict_refuses_what_is_otherwise_told():
    lonely = two_cells(nodes=["10 0 0 0", "20 1 0 0", "30 0 1 0", "40 0 0 1", "50 1 1 1", "60 5 5 5"])
    assert run("pamr-convert", write("lonely.msh", lonely), "out.hdf", "--json", "-").json["dropped_nodes"] == 1
    refuses("pamr-convert", "lonely.msh", "strict.hdf", "--strict", says=["1 others"], creates="strict.hdf")
    untagged = two_cells().replace("8 2 2 2 2 30 40 50", "8 15 2 0 1 10")
    result = run("pamr-convert", write("untagged.msh", untagged), "untagged.hdf", "--json", "-").json
    assert result["untagged_faces"] == 1 and result["patches"] == ["near", "far side", "boundary"]
    refuses("pamr-convert", "untagged.msh", "strict.hdf", "--strict", says=["1 faces without"], creates="strict.hdf")


def test_older_versions_of_the_format_are_read_as_netgen_writes_them():
    old = two_cells(version="2.000000")
    old = old[:old.index("$PhysicalNames")] + old[old.index("$Nodes"):]
    assert run("pamr-convert", write("old.msh", old), "old.hdf", "--json", "-").json["patches"] == ["physical_1", "physical_2"]


def test_a_boundary_that_touches_itself_in_an_edge_is_refused_with_a_word():
    nodes = ["1 0 0 0", "2 0 0 1", "3 1 0 0", "4 0 1 0", "5 -1 0 0", "6 0 -1 0"]
    faces = [(*f, row) for row, (a, b) in enumerate(((3, 4), (5, 6))) for f in ((1, a, b), (1, a, 2), (1, b, 2), (a, b, 2))]
    elements = ["1 4 2 7 1 1 3 4 2", "2 4 2 7 1 1 5 6 2"]
    elements += [f"{i} 2 2 {row + 1} 1 {a} {b} {c}" for i, (a, b, c, row) in enumerate(faces, 3)]
    refuses("pamr-convert", write("edge.msh", two_cells(nodes=nodes, elements=elements)), "no.hdf",
            says=["boundary_manifold", "touches itself in an edge"], creates="no.hdf")


def test_a_mesh_without_any_triangle_gets_one_patch_and_a_warning():
    elements = ["1 4 2 7 1 10 20 30 40", "2 4 2 7 1 20 30 40 50"]
    told = run("pamr-convert", write("bare.msh", two_cells(elements=elements)), "bare.hdf", "--json", "-")
    assert told.json["patches"] == ["boundary"] and told.json["untagged_faces"] == 6
    assert "6 boundary faces without tag are in the patch 'boundary'" in told.err


SURFACES = '[[surface]]\nname = "near"\nkind = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n'


def test_patches_are_tied_to_surfaces_where_their_nodes_lie():
    kuhn_cube("cube.hdf", 2)
    write("floor.toml", SURFACES)
    result = run("pamr-convert", "cube.hdf", "tied.hdf", "--surfaces", "floor.toml", "--tie", "zmin=near", "--json",
                 "-").json
    assert result["ties"] == {"zmin": {"surface": "near", "worst_distance": 0}}
    refuses("pamr-convert", "cube.hdf", "no.hdf", "--surfaces", "floor.toml", says=["floor.toml:2:8", '"near"', "a patch that lies on it"],
            creates="no.hdf")
    refuses("pamr-convert", "cube.hdf", "no.hdf", "--surfaces", "floor.toml", "--tie", "zmax=near",
            says=["patch 'zmax'", "as far as 1"], creates="no.hdf")
    refuses("pamr-convert", "cube.hdf", "no.hdf", "--surfaces", "floor.toml", "--tie", "roof=near", says=["'roof'"],
            creates="no.hdf")
    refuses("pamr-convert", "cube.hdf", "no.hdf", "--surfaces", "floor.toml", "--tie", "zmin", says=["PATCH=SURFACE"],
            creates="no.hdf")


def test_a_patch_is_tied_to_the_file_of_a_body():
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", "made.hdf", "--quiet")
    run("pamr-convert", "made.hdf", "plain.msh", "--quiet")
    pathlib.Path("parts").mkdir()
    write_stl("parts/ball.stl", *icosphere(2))
    told = run("pamr-convert", "plain.msh", "tied.hdf", "--surface", "parts/ball.stl", "--patch", "sphere", "--json", "-")
    assert 1e-5 < told.json["ties"]["sphere"]["worst_distance"] < 2e-4, "the ball and the smooth surface of its triangles"
    assert "next refinement" in told.err
    with h5py.File("tied.hdf") as file:
        assert b"parts" not in file["PAMR/surfaces"][()], "no folder names in the file"
    run("pamr-mark", "tied.hdf", "-o", "marked.hdf", "--patch", "sphere", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    before, after = (run("pamr-quality", m, "--json", "-", "--quiet").json for m in ("tied.hdf", "fine.hdf"))
    assert before["ledger"]["nodes"] == before["patches"]["sphere"]["off_surface_nodes"] > 0
    assert after["ledger"]["nodes"] == after["patches"]["sphere"]["off_surface_nodes"] == 0

    arguments = ["pamr-convert", "plain.msh", "no.hdf", "--surface", "parts/ball.stl"]
    refuses(*arguments, says=["--patch NAME for each --surface FILE", "0 and 1"], creates="no.hdf")
    refuses(*arguments, "--patch", "moon", says=["'moon'", "box, sphere"], creates="no.hdf")
    refuses(*arguments, "--patch", "sphere", "--tolerance", "1e-6", says=["'sphere'", "within 1e-06"], creates="no.hdf")
    refuses(*arguments, "--patch", "box", says=["'box'", "--tolerance"], creates="no.hdf")


def as_one_patch(source, target):
    """A Gmsh file (2.2, text) with all its triangles in one surface, "wall"."""
    lines = pathlib.Path(source).read_text().split("\n")
    names, elements = lines.index("$PhysicalNames"), lines.index("$Elements")
    for i in range(elements + 2, len(lines) - 2):
        words = lines[i].split()
        if words[1] == "2":
            lines[i] = " ".join(words[:3] + ["1", "1"] + words[5:])
    lines[names + 1 : lines.index("$EndPhysicalNames")] = ["1", '2 1 "wall"']
    return write(target, "\n".join(lines))


def sharp_edges(name, degrees):
    """Points, and the ends of the edges at which two faces of the boundary meet at more than this angle."""
    with h5py.File(name) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        cell, slot = np.nonzero(file["PAMR/cell_to_cell"][:] < 0)
    faces = cells[cell[:, None], FACE_TO_CORNER[slot]]
    normal = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    face = np.tile(np.arange(len(faces)), 3)[order].reshape(-1, 2)
    cosine = (normal[face[:, 0]] * normal[face[:, 1]]).sum(axis=1)
    return points, edges[order[::2]][cosine < np.cos(np.radians(degrees))], np.unique(faces)


@of_full_level
def test_edges_inside_one_patch_stay_sharp():
    write_stl("part.stl", *bored_cube(16))
    write("part.toml", '[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "-body"\nbounds = [[-1, -1, -1], [1, 1, 1]]\n'
          '[mesh.sizes]\nfar = 0.7\n[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "part.stl"\n')
    run("pamr-mesh", "part.toml", "-o", "made.hdf", "--quiet")
    run("pamr-convert", "made.hdf", "made.msh", "--gmsh-version", "2.2", "--text", "--quiet")
    told = run("pamr-convert", as_one_patch("made.msh", "one.msh"), "level0.hdf", "--surface", "part.stl", "--patch", "wall",
               "--json", "-").json
    n_edges = told["ties"]["wall"]["edges_along_creases"]
    assert n_edges > 50 and told["ties"]["wall"]["edges_across_creases"] == 0

    # The pieces between the edges may be patches of their own: all lie on one surface, the same edges stay sharp.
    pieces = run("pamr-convert", "made.msh", "pieces.hdf", "--surface", "part.stl", "--patch", "body_*", "--json", "-").json["ties"]
    assert len(pieces) == 7 and {p["surface"] for p in pieces.values()} == {"part"}
    run("pamr-mark", "pieces.hdf", "-o", "marked.hdf", "--patch", "body_*", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "finer.hdf", "--quiet")
    by_pieces = sharp_edges("finer.hdf", 50)
    pathlib.Path("marked.hdf").unlink()

    marks = [["--patch", "wall"]] + [["--box", "0.8,0.8,-1,1,1,0", "--box", "0.2,0.2,0.8,0.5,0.5,1"]] * 3
    for level, criterion in enumerate(marks, 1):
        run("pamr-mark", f"level{level - 1}.hdf", "-o", "marked.hdf", *criterion, "--force", "--quiet")
        report = run("pamr-refine", "marked.hdf", "-o", f"level{level}.hdf", "--json", "-").json
        assert report["inverted_cells"] == 0 and report["off_surface_nodes"] == 0
        points, edges, wall = sharp_edges(f"level{level}.hdf", 50)
        assert len(edges) == 2 * n_edges if level == 1 else len(edges) > 2 * n_edges
        assert level > 1 or len(by_pieces[1]) == len(edges)
        p = points[np.unique(edges)]
        on_edge = (np.abs(np.abs(p) - 1) < 1e-3).sum(axis=1) >= 2
        assert ((np.abs(p[on_edge]) == 1).sum(axis=1) >= 2).all(), "straight edges, to the last bit"
        rim = p[~on_edge]
        assert (np.abs(rim[:, 2]) == 1).all() and np.abs(np.hypot(*rim[:, :2].T) - 0.5).max() < 1e-6, "both rims"
        flat = points[wall][np.hypot(*points[wall][:, :2].T) > 0.6]
        assert (np.abs(flat) == 1).any(axis=1).all(), "planes, to the last bit"


def test_nodes_on_the_chords_of_a_round_edge_go_to_the_edge():
    write_stl("can.stl", *can(12))
    write("can.toml", '[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "-body"\nbounds = [[-1, -1, -1], [1, 1, 1]]\n'
          '[mesh.sizes]\nfar = 0.5\n[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "can.stl"\n')
    run("pamr-mesh", "can.toml", "-o", "made.hdf", "--quiet")
    run("pamr-mark", "made.hdf", "-o", "all.hdf", "--all", "--quiet")
    run("pamr-refine", "all.hdf", "-o", "chords.hdf", "--no-project", "--quiet")
    run("pamr-convert", "chords.hdf", "chords.msh", "--gmsh-version", "2.2", "--text", "--quiet")
    tie = ["--surface", "can.stl", "--patch", "wall", "--quiet"]
    run("pamr-convert", as_one_patch("chords.msh", "one.msh"), "level0.hdf", *tie)
    run("pamr-mark", "level0.hdf", "-o", "marked.hdf", "--patch", "wall", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "level1.hdf", "--quiet")

    def rims(name):
        points, edges, _ = sharp_edges(name, 50)
        nodes = points[np.unique(edges)]
        assert (np.abs(nodes[:, 2]) == 1).all()
        return np.abs(np.hypot(*nodes[:, :2].T) - 1).max()
    assert rims("level0.hdf") > 0.01, "nodes in the middle of chords, in the planes of the ends"
    assert rims("level1.hdf") < 1e-4


def test_edges_of_the_mesh_across_sharp_ones_are_told():
    kuhn_cube("cube.hdf", 4)
    write_stl("box.stl", *bored_cube(8))
    with h5py.File("cube.hdf", "r+") as file:  # all of its outside is one patch on a cube of side 2 with a bore
        file["VTKHDF/Points"][:] = 2 * file["VTKHDF/Points"][:] - 1
        file["PAMR/cell_to_cell"][:] = np.maximum(file["PAMR/cell_to_cell"][:], -1)
        del file["PAMR/patches"], file["PAMR/surfaces"], file["PAMR/checksums"]
        file["PAMR/patches/names"] = ["wall"]
    told = run("pamr-convert", "cube.hdf", "tied.hdf", "--surface", "box.stl", "--patch", "wall", "--json", "-", "--tolerance", "1")
    assert told.json["ties"]["wall"]["edges_along_creases"] == 12 * 4, "the edges of the cube"
    assert told.json["ties"]["wall"]["edges_across_creases"] > 0 and "run across sharp edges" in told.err


def test_creases_are_given_on_the_command_line():
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", "made.hdf", "--quiet")
    points, triangles = icosphere(2)
    write_stl("ball.stl", points, triangles)
    edge = ",".join("%.17g" % x for corner in triangles[0][:2] for x in points[corner])
    arguments = ["pamr-convert", "made.hdf", "tied.hdf", "--force", "--surface", "ball.stl", "--patch", "sphere"]
    run(*arguments, "--feature-angle", "30.5", "--crease", edge, "--crease", edge, "--quiet")
    with h5py.File("tied.hdf") as file:
        text = file["PAMR/surfaces"][()].decode()
    assert "feature_angle = 30.5\n" in text and text.count("[[[") == 1 and "], [[" in text
    refuses(*arguments, "--crease", "0,0,0,1,0,0", says=["segment 1 of polyline 1"])
    refuses(*arguments, "--crease", "0,0,0,1", says=["--crease", "4 numbers"])
    refuses("pamr-convert", "made.hdf", "no.hdf", "--crease", edge, says=["one --surface", "found 0"], creates="no.hdf")
    refuses("pamr-convert", "made.hdf", "no.hdf", "--feature-angle", "30", says=["--feature-angle", "--surface"], creates="no.hdf")


def test_surfaces_that_a_mesh_has_are_kept():
    kuhn_cube("cube.hdf", 2)
    write("floor.toml", SURFACES)
    write("roof.toml", SURFACES.replace("near", "top").replace("[0, 0, 0]", "[0, 0, 1]"))
    run("pamr-convert", "cube.hdf", "one.hdf", "--surfaces", "floor.toml", "--tie", "zmin=near", "--quiet")
    result = run("pamr-convert", "one.hdf", "two.hdf", "--surfaces", "roof.toml", "--tie", "zmax=top", "--json", "-").json
    assert set(result["ties"]) == {"zmax"}
    patches = run("pamr-quality", "two.hdf", "--json", "-", "--quiet").json["patches"]
    assert patches["zmin"]["surface"] == "near" and patches["zmax"]["surface"] == "top"
    refuses("pamr-convert", "one.hdf", "no.hdf", "--surfaces", "floor.toml", "--tie", "zmax=near",
            says=['"near"', "twice"], creates="no.hdf")


def foam_list(path):
    """The entries of a list of an OpenFOAM file, without its head."""
    lines = pathlib.Path(path).read_text().split("}\n", 1)[1].split()
    assert lines[1] == "(" and lines[-1] == ")"
    return int(lines[0]), lines[2:-1]


def test_openfoam_case_has_its_faces_in_upper_triangular_order():
    kuhn_cube("cube.hdf", 3)
    run("pamr-convert", "cube.hdf", "case", "--quiet")
    run("pamr-convert", "cube.hdf", "again", "--quiet", serial=True)
    folder = pathlib.Path("case/constant/polyMesh")
    assert sorted(f.name for f in folder.iterdir()) == ["boundary", "faces", "neighbour", "owner", "points"]
    for file in folder.iterdir():
        assert same_bytes(file, pathlib.Path("again/constant/polyMesh") / file.name), file.name
    points = np.array([float(w.strip("()")) for w in foam_list(folder / "points")[1]]).reshape(-1, 3)
    n, words = foam_list(folder / "faces")
    assert all(w.startswith("3(") for w in words[::3])
    faces = np.array([int(w.removeprefix("3(").strip("()")) for w in words]).reshape(-1, 3)
    owner, neighbor = (np.array([int(w) for w in foam_list(folder / f)[1]]) for f in ("owner", "neighbour"))
    with h5py.File("cube.hdf") as file:
        assert np.array_equal(points, file["VTKHDF/Points"][:])
        cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
    assert n == len(faces) == len(owner) == len(neighbor) + 6 * 18
    inner = owner[: len(neighbor)]
    assert (inner < neighbor).all()
    order = np.lexsort((neighbor, inner))
    assert (order == np.arange(len(order))).all(), "by owner, then by neighbor"
    middle = points[cells].mean(axis=1)
    p = points[faces]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    assert ((p.mean(axis=1) - middle[owner]) * normal).sum(axis=1).min() > 0, "normals point out of the owner"
    assert all(set(f) < set(cells[c]) for f, c in zip(faces, owner)) and all(set(f) < set(cells[c]) for f, c in zip(faces, neighbor))
    boundary = (folder / "boundary").read_text().split()
    assert [boundary[i + 1] for i, w in enumerate(boundary) if w == "nFaces"] == ["18;"] * 6
    assert [boundary[i + 1] for i, w in enumerate(boundary) if w == "startFace"] == [f"{len(neighbor) + 18 * k};" for k in range(6)]
    x = points[faces[len(neighbor): len(neighbor) + 18]][:, :, 0]
    assert (x == 0).all(), "the first patch is xmin"


def test_an_openfoam_case_is_replaced_only_when_asked():
    kuhn_cube("cube.hdf", 1)
    old = pathlib.Path("case/constant/polyMesh/points")
    old.parent.mkdir(parents=True)
    old.write_text("mine")
    write("case/system", "stays")
    refuses("pamr-convert", "cube.hdf", "case", says=["case", "--force"])
    assert old.read_text() == "mine"
    run("pamr-convert", "cube.hdf", "case", "--force", "--quiet")
    assert old.read_text() != "mine" and pathlib.Path("case/system").read_text() == "stays"
    assert [f.name for f in pathlib.Path("case/constant").iterdir()] == ["polyMesh"]
    refuses("pamr-convert", "cube.hdf", "missing/case", says=["missing"], creates="missing")


def test_endings_are_checked_before_anything_is_read():
    kuhn_cube("cube.hdf", 1)
    refuses("pamr-convert", "cube.hdf", "cube.step", says=[".hdf, .vtkhdf, .msh, .vtu, .mesh", ".cgns, .stl"], creates="cube.step")
    refuses("pamr-convert", "cube.hdf", "cube.hdf", says=["cube.hdf"])


run_tests(globals(), on_ranks=(test_files_do_not_depend_on_the_number_of_ranks, test_the_boundary_is_a_surface_in_every_format,
                               test_vtu_has_the_boundary_with_patches_level_and_shape, test_regions_become_zones_of_an_openfoam_case,
                               test_openfoam_case_has_its_faces_in_upper_triangular_order,
                               test_patches_are_tied_to_surfaces_where_their_nodes_lie, test_groups_become_patches_and_regions))
