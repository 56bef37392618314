# SPDX-License-Identifier: GPL-3.0-or-later
"""Boundary faces that no group names come back without one, from every format that allows that, whatever was done in between."""
import itertools
import pathlib
import shutil
import warnings

import h5py
import numpy as np

from tool_run import bare_copy, kuhn_cube, prepare_alone, refuses, run, run_tests, same_bytes
from whole_meshio import meshio

prepare_alone("pamr-mark")
NODES = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
CELLS = np.array([[0, 1, 3, 7], [0, 5, 1, 7], [0, 3, 2, 7], [2, 6, 0, 7], [0, 4, 5, 7], [0, 6, 4, 7]])
FLOOR, SIDE = [[3, 0, 1], [0, 3, 2]], [[0, 1, 5], [0, 5, 4]]  # 4 of the 12 faces of the boundary
WITHOUT_TAG = {"a.msh": [], "b.msh": ["--gmsh-version", "2.2", "--text"], "c.mesh": [], "d.meshb": [], "e.cgns": [], "f.vtu": [], "g.hdf": []}
WITH_TAG = {"h.su2": [], "i.lb8.ugrid": [], "j_case": []}  # solvers want every face of the boundary


def gmsh_file(name, side="side", sheet=()):
    """A cube with the groups 4 "floor" and 7, whose name is given; the other faces have no triangle. `sheet`: inside, group 9."""
    elements = [f"2 2 {tag} {tag} " + " ".join(str(n + 1) for n in face)
                for tag, faces in ((4, FLOOR), (7, SIDE), (9, sheet)) for face in faces]
    elements += ["4 2 1 1 " + " ".join(str(n + 1) for n in cell) for cell in CELLS]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3", '2 4 "floor"', f'2 7 "{side}"', '3 1 "gas"', "$EndPhysicalNames",
             "$Nodes", "8", *(f"{i + 1} {x:g} {y:g} {z:g}" for i, (x, y, z) in enumerate(NODES)), "$EndNodes",
             "$Elements", str(len(elements)), *(f"{i + 1} {e}" for i, e in enumerate(elements)), "$EndElements", ""]
    pathlib.Path(name).write_text("\n".join(lines))
    return name


def patches_of(name):
    """Kind and faces of each patch of a native file."""
    with h5py.File(name) as file:
        names, kinds = (file[f"PAMR/patches/{of}"].asstr()[:].tolist() for of in ("names", "kinds"))
        neighbors = file["PAMR/cell_to_cell"][:]
    return {names[p]: (kinds[p], int((neighbors == -p - 1).sum())) for p in range(len(names))}


def with_kinds(source, to, **kinds):
    """A native file with other kinds of some patches, as a script may write it."""
    shutil.copy(source, to)
    with h5py.File(to, "r+") as file:
        patches = file["PAMR/patches"]
        names, now = (patches[of].asstr()[:].tolist() for of in ("names", "kinds"))
        del patches["kinds"], file["PAMR/checksums"]
        patches.create_dataset("kinds", data=[kinds.get(*pair) for pair in zip(names, now)], dtype=h5py.string_dtype())
    return to


def triangles_of(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sum(len(block.data) for block in meshio.read(name).cells if block.type == "triangle")


def refined(name, to):
    run("pamr-mark", name, "-o", "marked.hdf", "--all", "--force", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", to, "--force", "--quiet")
    return to


def named(patches, ending):
    """The patches as a format calls them that knows numbers alone."""
    return {{"floor": "ref_4", "side": "ref_7"}.get(name, name) if "mesh" in ending else name: faces for name, faces in patches.items()}


def test_they_come_back_without_a_tag_from_every_format_that_allows_it():
    run("pamr-convert", gmsh_file("part.msh"), "part.hdf", "--quiet")
    for source, n in ((("part.hdf"), 1), (refined("part.hdf", "fine.hdf"), 4)):
        expected = {"floor": ("", 2 * n), "side": ("", 2 * n), "boundary": ("untagged", 8 * n)}
        assert patches_of(source) == expected
        for name, options in WITHOUT_TAG.items():
            given = run("pamr-convert", source, name, *options, "--force", "--json", "-")
            assert "boundary" not in given.json.get("references", {}) and "'boundary'" not in given.err, (name, given.err)
            assert "became" not in given.err and given.json["untagged_faces"] == 8 * n, (name, given.err)
            back = run("pamr-convert", name, "back.hdf", "--force", "--json", "-", serial=True)
            assert patches_of("back.hdf") == named(expected, name), (name, patches_of("back.hdf"))
            assert back.json["untagged_faces"] == 8 * n, (name, back.json)
            told = f"{8 * n} boundary faces without tag are in the patch 'boundary'" in back.err
            assert told == (name != "g.hdf"), (name, back.err)  # a native file knows them by their kind
            if told and n == 1:
                refuses("pamr-convert", name, "strict.hdf", "--strict", says=[name, "8 faces without"], creates="strict.hdf")
            if "me" in name[-6:] or name.endswith(".msh"):
                assert triangles_of(name) == 4 * n, name
        for name, options in WITH_TAG.items():
            told = run("pamr-convert", source, name, *options, "--force").err
            assert told.count(f"{8 * n} boundary faces without tag became the patch 'boundary'") == 1, (name, told)
            run("pamr-convert", name, "back.hdf", "--force", "--quiet", serial=True)
            assert {p: faces for p, (_, faces) in patches_of("back.hdf").items()} == {p: faces for p, (_, faces) in expected.items()}, name


def test_a_group_of_the_user_that_is_called_boundary_keeps_its_name():
    run("pamr-convert", gmsh_file("own.msh", "boundary"), "own.hdf", "--quiet")
    expected = {"floor": ("", 2), "boundary": ("", 2), "boundary_2": ("untagged", 8)}
    assert patches_of("own.hdf") == expected
    for name, options in list(WITHOUT_TAG.items())[:2] + [("f.vtu", []), ("e.cgns", [])]:
        run("pamr-convert", "own.hdf", name, *options, "--quiet")
        told = run("pamr-convert", name, "back.hdf", "--force", serial=True).err
        assert patches_of("back.hdf") == expected, name
        assert "8 boundary faces without tag are in the patch 'boundary_2'" in told, told
    # all faces have a tag, one of them this name
    kuhn_cube("cube.hdf", 1)
    with h5py.File("cube.hdf", "r+") as file:
        names = file["PAMR/patches/names"].asstr()[:].tolist()
        del file["PAMR/patches/names"]
        file["PAMR/patches"].create_dataset("names", data=["boundary" if n == "xmin" else n for n in names], dtype=h5py.string_dtype())
        del file["PAMR/checksums"]
    run("pamr-convert", "cube.hdf", "cube.msh", "--quiet")
    back = run("pamr-convert", "cube.msh", "back.hdf", "--force", "--json", "-").json
    assert back["untagged_faces"] == 0 and patches_of("back.hdf")["boundary"] == ("", 2)


def test_a_patch_for_them_without_a_face_is_left_out_with_a_note():
    kuhn_cube("cube.hdf", 1)
    with h5py.File("cube.hdf", "r+") as file:
        patches = file["PAMR/patches"]
        names = [*patches["names"].asstr()[:], "rest"]
        for of, texts in (("names", names), ("kinds", [""] * 6 + ["untagged"]), ("surfaces", [""] * 7)):
            del patches[of]
            patches.create_dataset(of, data=texts, dtype=h5py.string_dtype())
        del file["PAMR/checksums"]
    for name, options in (WITHOUT_TAG | WITH_TAG).items():
        told = run("pamr-convert", "cube.hdf", name, *options).err
        is_kept = name in ("f.vtu", "g.hdf", "j_case")
        assert told.count("note: left out, which a native file (.hdf) keeps: the patch 'rest' for faces without a tag") == (not is_kept), (name, told)
        assert "without faces" not in told, (name, told)


def test_triangles_beside_no_neighbors_leave_the_rest_without_a_tag():
    """As a solver may write a native file, also where a patch of its own is called so."""
    run("pamr-convert", gmsh_file("part.msh"), "part.hdf", "--quiet")
    for old, new, rest in (("side", "side", "boundary"), ("side", "boundary", "boundary_2")):
        shutil.copy("part.hdf", "solver.hdf")
        with h5py.File("solver.hdf", "r+") as file:
            points, patches = file["VTKHDF/Points"][:], file["PAMR/patches"]
            number = {tuple(p): i for i, p in enumerate(points.tolist())}
            for of in list(patches):
                del patches[of]
            patches.create_dataset("names", data=["floor", new], dtype=h5py.string_dtype())
            rows = [[number[tuple(NODES[n])] for n in face] for face in FLOOR + SIDE]
            file["PAMR/boundary/triangles"], file["PAMR/boundary/patch"] = np.array(rows), np.array([0, 0, 1, 1], "i4")
            del file["PAMR/cell_to_cell"], file["PAMR/checksums"]
        told = run("pamr-convert", "solver.hdf", "back.hdf", "--force", "--json", "-")
        assert patches_of("back.hdf") == {"floor": ("", 2), new: ("", 2), rest: ("untagged", 8)}, patches_of("back.hdf")
        assert told.json["untagged_faces"] == 8, told.json
        refined("solver.hdf", "fine.hdf")
        assert patches_of("fine.hdf") == {"floor": ("", 8), new: ("", 8), rest: ("untagged", 32)}, patches_of("fine.hdf")


def test_a_mesh_without_any_tag_gets_none():
    kuhn_cube("cube.hdf", 1)
    bare_copy("cube.hdf", "bare.hdf")
    refuses("pamr-convert", "bare.hdf", "strict.msh", "--strict", says=["bare.hdf", "12 faces without"], creates="strict.msh")
    for name in ("bare.msh", "bare.mesh", "bare.cgns", "bare.vtu"):
        told = run("pamr-convert", "bare.hdf", name, "--quiet").err
        assert "12 boundary faces without tag are in the patch 'boundary'" in told, told
        run("pamr-convert", name, "back.hdf", "--force", "--quiet", serial=True)
        assert patches_of("back.hdf") == {"boundary": ("untagged", 12)}, (name, patches_of("back.hdf"))
        with h5py.File("back.hdf") as file:
            assert "mean_ratio" not in file["VTKHDF/CellData"], name
    # a kind makes them a patch like others
    run("pamr-convert", "bare.hdf", "named.msh", "--kind", "boundary=patch", "--quiet")
    assert triangles_of("named.msh") == 12 and triangles_of("bare.msh") == 0


def test_the_same_on_any_number_of_ranks_and_after_coarsening():
    run("pamr-convert", gmsh_file("part.msh"), "part.hdf", "--quiet")
    refined("part.hdf", "fine.hdf")
    for name in ("a.msh", "c.mesh", "e.cgns", "f.vtu"):
        run("pamr-convert", "fine.hdf", name, "--quiet")
        run("pamr-convert", "fine.hdf", f"serial-{name}", "--quiet", serial=True)
        assert same_bytes(name, f"serial-{name}"), name
    run("pamr-mark", "fine.hdf", "-o", "coarse.hdf", "--box", "9,9,9,9,9,9", "--coarsen-rest", "--quiet")
    run("pamr-refine", "coarse.hdf", "-o", "back.hdf", "--quiet")
    assert patches_of("back.hdf") == patches_of("part.hdf") and patches_of("back.hdf")["boundary"] == ("untagged", 8)


def test_native_files_of_older_formats_have_them_and_numbers_but_nothing_inside():
    run("pamr-convert", gmsh_file("part.msh"), "part.hdf", "--quiet")
    for number, written in ((1, 1), (2, 2), (3, 2)):
        run("pamr-convert", "part.hdf", "old.hdf", "--format", number, "--force", "--quiet", serial=True)
        refined("old.hdf", "fine.hdf")
        run("pamr-refine", "marked.hdf", "-o", "serial.hdf", "--force", "--quiet", serial=True)
        assert same_bytes("fine.hdf", "serial.hdf"), number
        with h5py.File("old.hdf") as old, h5py.File("fine.hdf") as fine:
            assert old["PAMR"].attrs["format"] == written, number
            numbers = [file["PAMR/patches/numbers"][:].tolist() for file in (old, fine)]
        assert numbers == [[4, 7, -1]] * 2, numbers
        assert patches_of("old.hdf") == patches_of("part.hdf")
        assert patches_of("fine.hdf") == {"floor": ("", 8), "side": ("", 8), "boundary": ("untagged", 32)}, patches_of("fine.hdf")
    run("pamr-convert", gmsh_file("sheet.msh", sheet=[[0, 3, 7]]), "sheet.hdf", "--quiet")
    for number in (1, 2, 3):
        refuses("pamr-convert", "sheet.hdf", "no.hdf", "--format", number, says=["expected 4"], creates="no.hdf")
    # of format 3 are files with a map of level 0
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.6", "-o", "ball.hdf", "--quiet", serial=True)
    run("pamr-convert", "ball.hdf", "rest.hdf", "--kind", "box=untagged", "--quiet", serial=True)
    refined("rest.hdf", "map.hdf")
    with h5py.File("map.hdf") as file:
        assert file["PAMR"].attrs["format"] == 3 and "level0" in file["PAMR"]
    kinds = {name: kind for name, (kind, _) in patches_of("map.hdf").items()}
    assert [name for name, kind in kinds.items() if kind == "untagged"] == ["box"], kinds
    told = run("pamr-convert", "map.hdf", "map.msh", serial=True).err
    back = run("pamr-convert", "map.msh", "back.hdf", "--force", "--json", "-", serial=True).json
    assert back["untagged_faces"] == patches_of("map.hdf")["box"][1] and "'box'" not in told, (back, told)


def test_there_is_one_patch_of_them_and_none_inside():
    run("pamr-convert", gmsh_file("part.msh", sheet=[[0, 3, 7]]), "part.hdf", "--quiet")
    run("pamr-convert", "part.hdf", "part.vtu", "--quiet")
    head, data = pathlib.Path("part.vtu").read_bytes().split(b"<AppendedData", 1)
    for patch, says in (("floor", ["at most one patch of kind 'untagged'", "'boundary'", "'floor'"]),
                        ("physical_9", ["at most one patch", "'physical_9'"])):
        with_kinds("part.hdf", "two.hdf", **{patch: "untagged"})
        pathlib.Path("two.vtu").write_bytes(head.replace(b'"patch ' + patch.encode(), b'"untagged patch ' + patch.encode()) + b"<AppendedData" + data)
        for name in ("two.hdf", "two.vtu"):
            refuses("pamr-convert", name, "no.msh", says=[name, *says], creates="no.msh")
        refuses("pamr-mark", "two.hdf", "-o", "no.hdf", "--all", says=["two.hdf", *says], creates="no.hdf")
    with_kinds("part.hdf", "inside.hdf", physical_9="untagged", boundary="wall")
    refuses("pamr-convert", "inside.hdf", "no.msh", says=["inside.hdf", "found 1 inside in 'physical_9'"], creates="no.msh")
    found = run("pamr-quality", "inside.hdf", "--json", "-", code=1)
    assert not found.json["valid"] and found.json["violations"] == [{"invariant": "untagged_outside", "count": 1, "where": 3}], found.json["violations"]
    assert "untagged_outside is broken 1 time, first at cell 3" in found.err, found.err
    found = run("pamr-quality", with_kinds("part.hdf", "two.hdf", floor="untagged"), "--json", "-", code=1)  # two patches are in no place
    assert found.json["violations"] == [{"invariant": "untagged_outside", "count": 1}] and found.err.endswith("untagged_outside is broken 1 time\n"), found.err


def test_a_kind_makes_the_patch_of_an_old_file_one_without_a_tag():
    run("pamr-convert", gmsh_file("part.msh"), "part.hdf", "--quiet")
    with_kinds("part.hdf", "old.hdf", boundary="")
    run("pamr-convert", "old.hdf", "old.msh", "--quiet")
    told = run("pamr-convert", "old.hdf", "new.msh", "--kind", "boundary=untagged").err
    assert triangles_of("old.msh") == 12 and triangles_of("new.msh") == 4 and "boundary" not in told, told
    run("pamr-convert", "old.hdf", "new.hdf", "--kind", "boundary=untagged", "--quiet")
    assert patches_of("new.hdf") == patches_of("part.hdf")
    refuses("pamr-convert", "old.hdf", "no.hdf", "--kind", "*=untagged", says=["at most one patch", "'boundary'", "'floor'"], creates="no.hdf")
    refuses("pamr-convert", "part.hdf", "no.hdf", "--kind", "side=untagged", says=["at most one patch", "'side'"], creates="no.hdf")


def test_a_solid_of_their_name_does_not_take_them():
    run("pamr-convert", gmsh_file("part.msh"), "part.hdf", "--quiet")
    faces = [face for cell in CELLS.tolist() for face in itertools.combinations(sorted(cell), 3)]
    outer = [face for face in faces if faces.count(face) == 1]
    floor = [face for face in outer if max(face) < 4]

    def outward(face):
        a, b, c = NODES[list(face)]
        return face if np.cross(b - a, c - a) @ (a - 0.5) > 0 else face[::-1]

    text = ""
    for name, triangles in (("floor", floor), ("boundary", [face for face in outer if face not in floor])):
        facets = ("".join("vertex {:g} {:g} {:g}\n".format(*NODES[n]) for n in outward(face)) for face in triangles)
        text += f"solid {name}\n" + "".join(f"facet normal 0 0 0\nouter loop\n{f}endloop\nendfacet\n" for f in facets) + f"endsolid {name}\n"
    pathlib.Path("body.stl").write_text(text)
    pathlib.Path("body.toml").write_text('[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "body.stl"\n')
    ties = run("pamr-convert", "part.msh", "on.hdf", "--surfaces", "body.toml", "--json", "-").json["ties"]
    assert list(ties) == ["floor"], ties
    # one line says why there is nothing on a surface, and how the user may put them there: as a patch or by their name
    pathlib.Path("rest.stl").write_text(text.replace("solid floor", "solid other"))
    pathlib.Path("rest.toml").write_text(pathlib.Path("body.toml").read_text().replace("body.stl", "rest.stl"))
    refuses("pamr-convert", "part.msh", "no.hdf", "--surfaces", "rest.toml", creates="no.hdf",
            says=["found none; for the faces without a tag, 'boundary': --tie boundary=body, or --kind boundary=patch where a part"])
    ties = run("pamr-convert", "part.msh", "as.hdf", "--surfaces", "rest.toml", "--kind", "boundary=patch", "--json", "-").json["ties"]
    assert list(ties) == ["boundary"], ties
    ties = run("pamr-convert", "part.msh", "all.hdf", "--surfaces", "body.toml", "--tie", "boundary=body", "--json", "-").json["ties"]
    assert sorted(ties) == ["boundary", "floor"], ties


def test_the_last_kind_of_a_patch_counts():
    run("pamr-convert", gmsh_file("part.msh"), "part.hdf", "--quiet")
    kinds = ("side=untagged", "side=patch", "boundary=untagged")  # the first alone would take the number of side
    run("pamr-convert", "part.hdf", "same.hdf", "--quiet", *(word for kind in kinds for word in ("--kind", kind)))
    with h5py.File("part.hdf") as before, h5py.File("same.hdf") as after:
        numbers = before["PAMR/patches/numbers"][:].tolist()
        assert numbers == after["PAMR/patches/numbers"][:].tolist() and max(numbers) > 0, numbers


run_tests(globals(), on_ranks=(test_the_same_on_any_number_of_ranks_and_after_coarsening,
                              test_triangles_beside_no_neighbors_leave_the_rest_without_a_tag,
                              test_native_files_of_older_formats_have_them_and_numbers_but_nothing_inside))
