# SPDX-License-Identifier: GPL-3.0-or-later
"""Boundary faces that no group names come back without one, from every format that allows that, whatever was done in between."""
import pathlib
import warnings

import h5py
import numpy as np

from tool_run import bare_copy, kuhn_cube, prepare_alone, run, run_tests, same_bytes
from whole_meshio import meshio

prepare_alone("pamr-mark")
NODES = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
CELLS = np.array([[0, 1, 3, 7], [0, 5, 1, 7], [0, 3, 2, 7], [2, 6, 0, 7], [0, 4, 5, 7], [0, 6, 4, 7]])
FLOOR, SIDE = [[3, 0, 1], [0, 3, 2]], [[0, 1, 5], [0, 5, 4]]  # 4 of the 12 faces of the boundary
WITHOUT_TAG = {"a.msh": [], "b.msh": ["--gmsh-version", "2.2", "--text"], "c.mesh": [], "d.meshb": [], "e.cgns": [], "f.vtu": [], "g.hdf": []}
WITH_TAG = {"h.su2": [], "i.lb8.ugrid": [], "j_case": []}  # solvers want every face of the boundary


def gmsh_file(name, side="side"):
    """A cube with the groups 4 "floor" and 7, whose name is given; the other faces have no triangle."""
    elements = [f"2 2 {tag} {tag} " + " ".join(str(n + 1) for n in face)
                for tag, faces in ((4, FLOOR), (7, SIDE)) for face in faces]
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


def triangles_of(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sum(len(block.data) for block in meshio.read(name).cells if block.type == "triangle")


def refined(name, to):
    run("pamr-mark", name, "-o", "marked.hdf", "--all", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", to, "--quiet")
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
            back = run("pamr-convert", name, "back.hdf", "--force", "--json", "-", serial=True)
            assert patches_of("back.hdf") == named(expected, name), (name, patches_of("back.hdf"))
            carries = name[-4:] in (".vtu", ".hdf")  # these say which triangles have no tag
            assert carries or back.json["untagged_faces"] == 8 * n, (name, back.json)
            if "me" in name[-6:] or name.endswith(".msh"):
                assert triangles_of(name) == 4 * n, name
        for name, options in WITH_TAG.items():
            run("pamr-convert", source, name, *options, "--force", "--quiet")
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
        assert name == "f.vtu" or "8 boundary faces without tag are in the patch 'boundary_2'" in told, told
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


def test_a_mesh_without_any_tag_gets_none():
    kuhn_cube("cube.hdf", 1)
    bare_copy("cube.hdf", "bare.hdf")
    for name in ("bare.msh", "bare.mesh", "bare.cgns", "bare.vtu"):
        run("pamr-convert", "bare.hdf", name, "--quiet")
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


run_tests(globals(), on_ranks=(test_the_same_on_any_number_of_ranks_and_after_coarsening,))
