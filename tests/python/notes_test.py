# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes and warnings of Python: in the words of the tools, once a call, on rank 0, under the filters of
``warnings``."""
import pathlib
import shutil
import subprocess
import sys
import types
import warnings

import numpy as np

import pamr
from collective import CELLS, COMM, FLOOR, POINTS, in_folder, run_tests

CONVERT = pathlib.Path(pamr.__file__).resolve().parents[2] / "bin" / "pamr-convert"
KEPT = "left out, which a native file (.hdf) keeps: "
NATIVE = (".hdf", ".vtkhdf")
NAMED = {".su2": "SU2", ".lb8.ugrid": "UGRID", ".b8.ugrid": "UGRID", "": "OpenFOAM"}  # have no face without a patch
NUMBERED = (".msh", ".mesh", ".meshb", ".lb8.ugrid", ".b8.ugrid")
SURFACES = (".stl", ".obj", ".ply", ".off", ".vtp")
WRITTEN = [ending for _, endings, _, is_written in pamr._core.formats() for ending in endings if is_written]


def on_first(array):
    return np.asarray(array) if COMM.rank == 0 else np.asarray(array)[:0]


def said(call):
    """What a call says on rank 0, as categories and texts; other ranks have nothing to say."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call()
    assert COMM.rank == 0 or not caught, [str(one.message) for one in caught]
    assert all(one.filename == __file__ for one in caught), [one.filename for one in caught]  # the line of the user
    return COMM.bcast([(one.category.__name__, str(one.message)) for one in caught])


def notes(call):
    return [text for category, text in said(call) if category == "Note"]


def cube(unit="", name="floor"):
    """Six cells with a patch of number 7 and the rest of the boundary."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pamr.Mesh.from_arrays(COMM, on_first(POINTS), on_first(CELLS), (on_first(FLOOR), on_first([7, 7])), {7: name},
                                     length_unit=unit)


def named_faces(n, ending=""):
    return [f"{n} boundary faces without tag became the patch 'boundary', because files of {NAMED[ending]} want every face of the boundary in one"
            ] if ending in NAMED else []


def refined(mesh):
    return pamr.refine(mesh, np.ones(len(mesh.cells), int)).mesh


def on_plane(mesh):
    mesh.associate({"floor": pamr.Plane((0, 0, 0), (0, 0, 1))})
    return mesh


@in_folder
def test_what_only_native_files_keep_is_a_note_in_every_format():
    levels, surface, unit = "levels and families of 48 refined cells", "surfaces of 1 patch", "the unit of lengths (mm)"
    number = "numbers of 1 patch"
    for mesh, before, behind in ((cube(name="floor_7"), [], []), (cube(), [number], []), (refined(cube()), [levels, number], []),
                                 (on_plane(cube()), [surface, number], []), (cube("mm"), [number], [unit]),
                                 (refined(on_plane(cube("mm"))), [levels, surface, number], [unit])):
        for ending in WRITTEN:
            lost = [what for what in before + behind if what != number or ending not in NUMBERED]
            if ending in NATIVE + SURFACES:
                lost = []
            found = notes(lambda: mesh.write(f"mesh{ending}"))
            words = " and ".join([", ".join(lost[:-1]), lost[-1]] if len(lost) > 1 else lost)
            assert found == named_faces(40 if levels in before else 10, ending) + ([KEPT + words] if lost else []), (ending, found)


@in_folder
def test_notes_and_warnings_have_the_words_of_the_tool():
    mesh = refined(on_plane(cube("mm")))
    mesh.cell_fields.set("T", np.zeros(len(mesh.cells)), "K")
    mesh.write("mesh.hdf")
    for ending in WRITTEN:
        found = said(lambda: mesh.write(f"python{ending}"))
        if COMM.rank == 0:
            done = subprocess.run([CONVERT, "mesh.hdf", f"tool{ending}", "--force"], capture_output=True, text=True)
            lines = [line.removeprefix("pamr-convert: ") for line in done.stderr.splitlines()]
            assert done.returncode == 0 and sorted(lines) == sorted(
                ("note: " if category == "Note" else "warning: ") + text for category, text in found), (ending, lines, found)
        COMM.barrier()


@in_folder
def test_what_lies_beside_the_mesh_of_a_case_is_a_note():
    def put(*names):
        if COMM.rank == 0:
            for name in names:
                pathlib.Path("case", name).mkdir()
                pathlib.Path("case", name, "U").write_text("")
        COMM.barrier()
    cube().write("case")
    times = "file 'case': {} left out (pamr.openfoam.read_fields of Python reads them): "
    assert notes(lambda: pamr.Mesh.read(COMM, "case")) == []
    put("0")
    assert notes(lambda: pamr.Mesh.read(COMM, "case")) == [times.format("1 time with fields was") + "0"]
    put("10", "0.orig", "1e-05")
    assert notes(lambda: pamr.Mesh.read(COMM, "case", strict=True)) == [times.format("3 times with fields were") + "0, 1e-05, 10"]
    put("constant/solid", "constant/fluid")
    if COMM.rank == 0:
        for region in ("solid", "fluid"):
            shutil.copytree("case/constant/polyMesh", f"case/constant/{region}/polyMesh")
    COMM.barrier()
    assert notes(lambda: pamr.Mesh.read(COMM, "case")) == [
        times.format("3 times with fields were") + "0, 1e-05, 10",
        "file 'case': 2 regions of the case have each a mesh of its own, which was left out: fluid, solid"]
    put(*map(str, range(20, 30)))  # of many the first ones
    assert notes(lambda: pamr.Mesh.read(COMM, "case"))[0].endswith("13 times with fields were left out (pamr.openfoam.read_fields of Python reads them): "
                                                                   "0, 1e-05, 10, 20, 21, 22, 23, 24, 25, 26, ...")


@in_folder
def test_cases_of_openfoam_say_what_they_do_not_keep():
    mesh = refined(on_plane(cube("mm")))
    mesh.cell_fields["T"] = np.zeros(len(mesh.cells))  # write_fields takes it along
    number = "levels and families of 48 refined cells, surfaces of 1 patch"
    named = [("Note", text) for text in named_faces(40)]
    assert said(lambda: pamr.openfoam.write_mesh(mesh, "case")) == named + [
        ("Note", KEPT + number + ", numbers of 1 patch and the unit of lengths (mm)")]
    assert said(lambda: pamr.openfoam.write_mesh(mesh, "case", scale=0.001)) == named + [("Note", KEPT + number + " and numbers of 1 patch")]

    def put(name, kind, folder=False):
        if COMM.rank == 0:
            path = pathlib.Path("case/0", name)
            path.parent.mkdir(exist_ok=True)
            head = f"FoamFile\n{{\n version 2.0;\n format ascii;\n class {kind};\n object {name};\n}}\n" if kind else ""
            path.mkdir() if folder else path.write_text(head + "dimensions [0 0 0 1 0 0 0];\ninternalField uniform 1;\nboundaryField\n{\n}\n")
        COMM.barrier()
    put("p", "volScalarField")
    assert said(lambda: pamr.openfoam.read_fields(mesh, "case", "0")) == []
    put("uniform", "", folder=True)  # of the time itself
    assert said(lambda: pamr.openfoam.read_fields(mesh, "case", "0")) == []
    for name, kind in (("phi", "surfaceScalarField"), ("D", "pointVectorField"), ("R", "volSphericalTensorField"), ("Q", "volScalarField::Internal"),
                       ("film", "areaScalarField"), ("n", "volLabelField"), ("remark", "")):
        put(name, kind)
    put("lagrangian", "", folder=True)
    fields = []
    words = ("case 'case', time 0: left out, as no field on cells: D (pointVectorField), Q (volScalarField::Internal), R (volSphericalTensorField), "
             "film (areaScalarField), lagrangian (a folder), n (volLabelField), phi (surfaceScalarField), remark (no field)")
    assert said(lambda: fields.append(pamr.openfoam.read_fields(mesh, "case", "0"))) == [("Note", words)]
    assert fields[0].names == ["p"] and fields[0].not_carried == ["D", "Q", "R", "film", "lagrangian", "n", "phi", "remark"]
    assert said(lambda: pamr.openfoam.read_fields(mesh, "case", "0", ["p"])) == []


@in_folder
def test_filters_turn_notes_off_and_make_errors_of_them_on_every_rank():
    mesh = refined(cube("mm"))
    mesh.cell_fields["T"] = np.zeros(len(mesh.cells))
    assert [category for category, _ in said(lambda: mesh.write("mesh.msh"))] == ["UserWarning", "Note"]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", pamr.Note)
        mesh.write("mesh.msh")
    assert [str(one.message)[:7] for one in caught] == (["1 field"] if COMM.rank == 0 else [])
    for category, out in ((pamr.Note, "note.msh"), (UserWarning, "warning.msh")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            warnings.simplefilter("error", category)
            try:
                mesh.write(out)
                raised = None
            except UserWarning as warning:
                raised = type(warning), str(warning)
        assert COMM.allgather(raised) == COMM.size * [raised] and raised is not None, raised
        assert issubclass(raised[0], category) and raised[1].startswith(KEPT if category is pamr.Note else "1 field is left out"), raised
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            assert pamr.Mesh.read(COMM, out).n_cells == 48  # what was written is whole
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda *_: {}["nothing"]  # of the user's, and wrong
        try:
            mesh.write("mesh.msh")
            message = ""
        except pamr.Error as error:
            message = str(error)
    assert COMM.allgather(message) == COMM.size * ["KeyError: 'nothing'"], message


@in_folder
def test_what_is_odd_about_surfaces_is_said():
    coarse = on_plane(cube())
    if not hasattr(pamr._core, "associate"):
        return
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]  # outwards

    def box(low, high, name):
        at = np.array([[(low, high)[(i >> k) & 1][k] for k in range(3)] for i in range(8)], float)
        facets = [at[list(corners)] for a, b, c, d in quads for corners in ((a, b, c), (a, c, d))]
        vertices = ["".join("vertex {} {} {}\n".format(*p) for p in facet) for facet in facets]
        return f"solid {name}\n" + "".join(f"facet normal 0 0 0\nouter loop\n{v}endloop\nendfacet\n" for v in vertices) + f"endsolid {name}\n"
    if COMM.rank == 0:
        ground = box((-1, -1, -1), (2, 2, 0), "a")
        pathlib.Path("floor.stl").write_text(ground)
        pathlib.Path("cut.stl").write_text((ground + box((1.5, 1.5, -3), (4, 4, -0.5), "a")).replace("endsolid a\nsolid a\n", ""))
        pathlib.Path("two.stl").write_text(ground + box((5, 5, 5), (6, 6, 6), "b"))
    COMM.barrier()
    for name, words in (("floor", []), ("cut", ["cuts through itself"]), ("two", ["the names of 2 solids"])):
        mesh = cube()
        found = said(lambda: mesh.associate({"floor": pamr.File(f"{name}.stl")}))
        assert [category for category, _ in found] == ["UserWarning"] * len(words) and all(w in t for w, (_, t) in zip(words, found)), (name, found)
    mesh = cube()
    assert said(lambda: mesh.associate({"floor": pamr.Plane((0, 0, 1e-8), (0, 0, 1))})) == [
        ("UserWarning", "patch 'floor': nodes up to 1e-08 off surface \"floor\": the next refinement at them brings them there")]
    assert said(lambda: coarse.associate({"floor": pamr.Sphere((0.5, 0.5, 0.5), np.sqrt(0.75))}))[-1][0] == "Note"


def test_flags_that_are_not_followed_are_said():
    mesh = cube()
    down, up = -np.ones(len(mesh.cells), int), np.ones(len(mesh.cells), int)
    words = "nothing was coarsened: of 6 cells that may be coarsened 6 know no parent (they are of level 0, of broken families or of files without their history)"
    assert said(lambda: pamr.adapt(mesh, down)) == [("UserWarning", words)]
    assert said(lambda: pamr.adapt(mesh, up)) == [] and said(lambda: pamr.refine(mesh, up)) == []
    fine = refined(mesh)
    assert said(lambda: pamr.adapt(fine, -np.ones(len(fine.cells), int))) == []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        linked = pamr.Mesh.from_arrays(COMM, on_first(POINTS), on_first(CELLS), (on_first(FLOOR), on_first([7, 7])), {7: ("floor", "periodic")})
    for call in (pamr.refine, pamr.adapt):
        found = said(lambda: call(linked, np.ones(len(linked.cells), int)))
        assert [category for category, _ in found] == ["UserWarning"] and "'floor' is periodic, but the links are not kept" in found[0][1], found


def test_what_from_dolfinx_leaves_out_is_said():
    """With stand-ins for dolfinx, which need not be installed."""
    space = types.SimpleNamespace
    cells = on_first(CELLS).copy()
    cells[:1] = cells[:1, [1, 0, 2, 3]]  # which is nothing in dolfinx
    points, floor = on_first(POINTS), on_first(FLOOR)
    index_map = space(size_local=len(points), local_to_global=lambda nodes: nodes)
    mesh = space(comm=COMM, geometry=space(x=points, index_map=lambda: index_map),
                 topology=space(dim=3, create_connectivity=lambda *_: None, index_map=lambda _: space(size_local=len(cells))))
    tags = space(indices=np.arange(len(floor)), values=on_first([1, 1]))
    pamr.dolfinx_versions = sys.modules["pamr.dolfinx_versions"] = space(dofmap=lambda _: cells.reshape(-1, 4),
                                                                         facet_nodes=lambda _, facets: floor[facets].reshape(-1, 3))
    try:
        assert said(lambda: pamr.from_dolfinx(mesh)) == []
        found = said(lambda: pamr.from_dolfinx(mesh, tags, {1: "floor", 9: "far"}))
    finally:
        del pamr.dolfinx_versions, sys.modules["pamr.dolfinx_versions"]
    assert found == [("UserWarning", f"from_dolfinx: {text}") for text in (
        "1 named group has no element: 'far' (triangles)", "10 boundary faces without tag are in the patch 'boundary'")], found


run_tests(globals())
