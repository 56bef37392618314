# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of other programs: dialects of their formats, files that are something else, and one way in for files and arrays: the
same mesh, the same words."""
import gzip
import itertools
import pathlib
import re
import shutil
import subprocess
import warnings
from collections import Counter

import numpy as np

import pamr
from collective import CELLS, COMM, POINTS, error_of, in_folder, run_tests

CONVERT = pathlib.Path(pamr.__file__).resolve().parents[2] / "bin" / "pamr-convert"
HEAD = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
NAMES = '$PhysicalNames\n2\n2 1 "wall"\n3 7 "gas"\n$EndPhysicalNames\n'
NODES = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
ELEMENTS = "$Elements\n5\n1 2 2 1 1 1 2 3\n2 2 2 1 1 1 2 4\n3 2 2 2 2 1 3 4\n4 2 2 2 2 2 3 4\n5 4 2 7 1 1 2 3 4\n$EndElements\n"
MSH = HEAD + NAMES + NODES + ELEMENTS
MEDIT = ("MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
         "Triangles 4\n1 2 3 1\n1 2 4 1\n1 3 4 2\n2 3 4 2\nTetrahedra\n1\n1 2 3 4 7\nEnd\n")
SU2 = ("NDIME= 3\nNELEM= 1\n10 0 1 2 3 0\nNPOIN= 4\n0 0 0 0\n1 0 0 1\n0 1 0 2\n0 0 1 3\nNMARK= 2\nMARKER_TAG= wall\nMARKER_ELEMS= 2\n"
       "5 0 1 2\n5 0 1 3\nMARKER_TAG= physical_2\nMARKER_ELEMS= 2\n5 0 2 3\n5 1 2 3\n")
MFEM = ("MFEM mesh v1.0\n\n# a comment\ndimension\n3\n\nelements\n1\n7 4 0 1 2 3\n\nboundary\n4\n1 2 0 1 2\n1 2 0 1 3\n2 2 0 2 3\n2 2 1 2 3\n\n"
        "vertices\n4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
VTK = ("# vtk DataFile Version 3.0\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n"
       "CELLS 5 21\n4 0 1 2 3\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\nCELL_TYPES 5\n10\n5\n5\n5\n5\n"
       "CELL_DATA 5\nSCALARS medit:ref int 1\nLOOKUP_TABLE default\n7 1 1 2 2\nPOINT_DATA 4\nVECTORS a%20v float\n"
       "0 0 0 1 0 0 0 2 0 0 0 3\n")
BOM = "\ufeff"


def write(name, text):
    if COMM.rank == 0:
        pathlib.Path(name).write_bytes(text if isinstance(text, bytes) else text.encode())
    COMM.barrier()
    return name


def told_by(call):
    """What a call returns, and its warnings on rank 0."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        result = call()
    return result, COMM.bcast([str(w.message) for w in told])


def read(name, text):
    mesh, told = told_by(lambda: pamr.Mesh.read(COMM, write(name, text)))
    assert all(line.startswith(f"file '{name}': ") for line in told), told
    return mesh, [line.split("': ", 1)[1] for line in told]


def faces_of(mesh):
    counts = COMM.allreduce(np.bincount(mesh.boundary_faces().patches, minlength=len(mesh.patches)))
    return dict(zip(mesh.patches, counts.tolist()))


def volume(mesh):
    return COMM.allreduce(float(mesh.volumes().sum()))


@in_folder
def test_dialects_of_formats_are_read():
    parametric = HEAD + NAMES + ("$ParametricNodes\n4\n1 0 0 0 0 1\n2 1 0 0 1 1 0.5\n3 0 1 0 2 1 .5 .5\n4 0 0 1 3 1\n"
                                 "$EndParametricNodes\n") + ELEMENTS
    old_names = '$PhysicalNames\n2\n1 "wall"\n7 "gas"\n$EndPhysicalNames\n'
    wall, refs = {"wall": 2, "physical_2": 2}, {"ref_1": 2, "ref_2": 2}
    for name, text, faces in [
            ("plain.msh", MSH, wall), ("bom.msh", BOM + MSH, wall), ("crlf.msh", MSH.replace("\n", "\r\n"), wall),
            ("comments.msh", "\n$Comments\nmade by X\n$EndComments\n" + MSH, wall), ("parametric.msh", parametric, wall),
            ("names.msh", HEAD + old_names + NODES + ELEMENTS, wall),
            ("fortran.msh", MSH.replace("2 1 0 0", "2 1.0D+00 0.d0 0.1000-300"), wall),
            ("dimension.mesh", MEDIT.replace("Dimension 3", "Dimension3"), {"ref_1": 2, "ref_2": 2}),
            ("alike.mesh", MEDIT.replace(" 0\n", " 5\n").replace("0 0 1 5\n", "0 0 1 5\n"), {"ref_1": 2, "ref_2": 2}),
            ("version.mesh", MEDIT.replace("Formatted 2", "Formatted2"), {"ref_1": 2, "ref_2": 2}),
            ("bom.mesh", BOM + MEDIT, {"ref_1": 2, "ref_2": 2}),
            ("fortran.mesh", MEDIT.replace("\n1 0 0 0\n", "\n1.0D0 0.D+00 0.0d-1 0\n"), {"ref_1": 2, "ref_2": 2}),
            ("title.su2", "*** a mesh ***\nof my wing, eps = 1e-3\n" + SU2, wall), ("bom.su2", BOM + SU2, wall),
            ("fortran.su2", SU2.replace("1 0 0 1", "1.0D+00 0.0Q0 -0.1-300 1"), wall),
            ("mfem.mesh", MFEM, {"patch_1": 2, "patch_2": 2}), ("bom.mfem", BOM + MFEM, {"patch_1": 2, "patch_2": 2}),
            ("nodes.mfem", MFEM.replace("vertices\n4\n3\n", "vertices\n4\n\nnodes\nFiniteElementSpace\nFiniteElementCollection: "
                                        "H1_3D_P1\nVDim: 3\nOrdering: 1\n\n"), {"patch_1": 2, "patch_2": 2}),
            ("meshio.vtk", VTK.replace("medit:ref int 1", "medit:ref vtktypeuint8 1"), refs),
            ("metadata.vtk", VTK.replace("CELLS 5", "METADATA\nINFORMATION 1\nNAME x LOCATION y\nDATA 1 2\n\nCELLS 5"), refs),
            ("named.vtk", VTK.replace("POINTS", "FIELD FieldData 1\npatch%20in%20let 1 1 int\n2\nPOINTS"), {"ref_1": 2, "in let": 2}),
            ("blank.vtk", "\n \n" + VTK, refs), ("plain.vtk", VTK, refs)]:
        mesh, told = read(name, text)
        assert mesh.n_cells == 1 and faces_of(mesh) == faces and told == [], (name, faces_of(mesh), told)
        assert np.isclose(volume(mesh), 1 / 6, rtol=1e-12), name
        if not name.endswith(".su2"):
            assert COMM.allreduce(mesh.cell_fields["region"].tolist()) == [7], name
    assert mesh.node_fields["a v"].shape[1:] == (3,)
    for array, name in (("gmsh:physical", "physical_"), ("gmsh:geometrical", "surface_"), ("ugrid:ref", "surface_"),
                        ("CellEntityIds", "patch_"), ("netgen:index", "patch_")):
        assert faces_of(read("array.vtk", VTK.replace("medit:ref", array))[0]) == {f"{name}1": 2, f"{name}2": 2}, array
    named, _ = read("names.mfem", MFEM.replace("v1.0", "v1.3").replace(
        "vertices\n", 'attribute_sets\n1\n"gas" 1 7\n\nbdr_attribute_sets\n2\n"near wall" 1 1\n"both" 2 1 2\n\nvertices\n'))
    assert named.patches == ["near wall", "patch_2"] and named.regions == {7: "gas"}


@in_folder
def test_what_files_have_beside_a_mesh_is_told():
    beside = "left out was what a mesh has no place for: "
    values = '${0}\n1\n"T"\n1\n0.0\n3\n0\n1\n1\n1 2.5\n$End{0}\n'
    sets = ('bdr_attribute_sets\n3\n"near" 1 1\n"again" 1 1\n"both" 2 1 2\n\nvertices\n')
    field = "FIELD FieldData 2\nTIME 1 1 double\n3.5\nwho 1 1 string\nme\nPOINTS"
    send = "MARKER_TAG= SEND_RECEIVE\nMARKER_ELEMS= 2\nSEND_TO= 1\n1 0 0\n1 1 0\n"
    lines = VTK.replace("CELLS 5 21", "CELLS 7 26").replace("CELL_TYPES 5\n", "2 0 1\n1 0\nCELL_TYPES 7\n3\n1\n")
    lines = lines.replace("3 1 2 3\n2 0 1\n1 0", "3 1 2 3\n2 0 1\n1 0").replace("7\n3\n1\n10\n5\n5\n5\n5", "7\n10\n5\n5\n5\n5\n3\n1")
    lines = lines.replace("CELL_DATA 5", "CELL_DATA 7").replace("7 1 1 2 2", "7 1 1 2 2 4 4")
    for name, text, words in [
            ("nodes.msh", MSH + values.format("NodeData") * 2, [beside + "$NodeData (2)"]),
            ("cells.msh", MSH + values.format("ElementData") + values.format("ElementNodeData"),
             [beside + "$ElementData (1), $ElementNodeData (1)"]),
            ("other.msh", MSH + "$Mine\n1\n$EndMine\n", [beside + "$Mine (1)"]),
            ("edges.mesh", MEDIT.replace("End", "Edges\n2\n1 2 5\n2 3 5\nCorners 1\n1\nEnd"), [beside + "Corners (1), Edges (2)"]),
            ("ridges.mesh", MEDIT.replace("Triangles 4", "Ridges\n1\n1\nRequiredVertices\n2\n1\n2\nTriangles 4"),
             [beside + "RequiredVertices (2), Ridges (1)"]),
            ("normals.mesh", MEDIT.replace("End", "Normals\n1\n0 0 1\nNormalAtVertices\n1\n1 1\nEnd"),
             [beside + "NormalAtVertices (1), Normals (1)"]),
            ("sets.mfem", MFEM.replace("v1.0", "v1.3").replace("vertices\n", sets),
             ["the set 'both' of 2 attributes was left out", "the set 'again' was left out: attribute 1 is 'near'"]),
            ("cells.mfem", MFEM.replace("v1.0", "v1.3").replace("vertices\n", 'attribute_sets\n2\n"all" 2 7 8\n"none" 0\n\nvertices\n'),
             ["the set 'all' of 2 attributes was left out", "the set 'none' of 0 attributes was left out"]),
            ("far.mfem", MFEM.replace("v1.0", "v1.3").replace("vertices\n", 'bdr_attribute_sets\n1\n"far" 1 9\n\nvertices\n'),
             ["1 named group has no element: 'far' (triangles)"]),
            ("after.mfem", MFEM + "mfem_mesh_end\nFiniteElementSpace\n", [beside + "data behind mfem_mesh_end (1)"]),
            ("field.vtk", VTK.replace("POINTS", field, 1),
             [f"the array '{array}' was left out: it is neither on points nor on cells" for array in ("TIME", "who")]),
            ("lines.vtk", lines, ["2 points and lines were left out"]),
            ("references.mesh", MEDIT.replace("4\n0 0 0 0\n1 0 0 0\n", "4\n0 0 0 3\n1 0 0 -4\n"), [beside + "references of vertices (2)"]),
            ("angle.mesh", MEDIT.replace("End", "AngleOfCornerBound\n10\nMine 1\nb 2\nEnd"),
             [beside + "AngleOfCornerBound (1), Mine (1), b (1)"]),
            ("after.mesh", MEDIT + "Tetrahedra\n1\n1 2 3 4 8\n", [beside + "data behind End (1)"]),
            ("angles.su2", SU2 + "AOA= 2.5\nAOS= 0\n", [beside + "AOA (1), AOS (1)"]),
            ("lines.su2", SU2.replace("MARKER_ELEMS= 2\n5 0 1 2\n", "MARKER_ELEMS= 5\n3 0 1\n5 0 1 2\n1 0\n3 1 2\n", 1),
             [beside + "lines (2), points (1)"]),
            ("send.su2", SU2.replace("NMARK= 2", "NMARK= 3") + send,
             [beside + "SEND_RECEIVE markers, which join parts of a mesh (1), points (2)"]),
            ("boxes.su2", SU2 + "FFD_NBOX= 1\nFFD_LEVEL= 0\n0 1 2\nFFD_LEVEL= 1\n", [beside + "FFD_LEVEL (2), FFD_NBOX (1)"]),
            ("table.vtk", VTK + "SCALARS s float 1\nLOOKUP_TABLE hot\n1 2 3 4\nLOOKUP_TABLE hot 2\n0 0 0 1 1 1 1 1\n",
             ["the table 'hot' of 2 colors was left out (LOOKUP_TABLE)"]),
            ("names.vtk", VTK + "METADATA\nCOMPONENT_NAMES\nx\ny\nz\n\n", ["the names of components of 1 array were left out"]),
            ("level.vtk", VTK + "CELL_DATA 5\nSCALARS level unsigned_char 1\nLOOKUP_TABLE default\n1 1 1 1 1\n",
             ["the array 'level' was left out: one of that name and type says how often cells were refined"])]:
        mesh, told = read(name, text)
        assert mesh.n_cells == 1 and told == words, (name, told)
        first = words[0].split(":")[0].replace("1 named group has no element", "elements in every named group")
        assert first in error_of(lambda: pamr.Mesh.read(COMM, name, strict=True)), name
    packed = np.array([1, 2], "<i4").tobytes() + np.array([3, 20, 3, 4], "<i4").tobytes()  # as Medit's own library ends a file
    for tail, n in ((np.array([54, 0], "<i4").tobytes(), 0), (np.array([54, 0, 6, 0], "<i4").tobytes() + packed, 1)):
        told_by(lambda: pamr.Mesh.kuhn_cube(COMM, 1).write("end.meshb"))
        if COMM.rank == 0:
            with open("end.meshb", "r+b") as file:
                data = file.read()
                at = data.rindex(np.array([54], "<i4").tobytes())
                file.truncate(at)
                file.seek(at)
                file.write(tail)
        COMM.barrier()
        _, told = told_by(lambda: pamr.Mesh.read(COMM, "end.meshb"))
        assert len(told) == n and ("data behind End (1)" in "".join(told)) == bool(n), told


@in_folder
def test_what_cases_of_openfoam_have_beside_a_mesh_is_told():
    def add(case, name):
        if COMM.rank == 0:
            (case / name).mkdir() if name == "sets" else (case / name).write_text("FoamFile\n{\n}\n0()\n")

    def retype(case, name):
        if COMM.rank == 0:
            text = (case / "boundary").read_text()
            (case / "boundary").write_text(re.sub(r"type +patch;", f"type {name};", text, count=1))
    def enter(case, name):
        if COMM.rank == 0:
            text = (case / "boundary").read_text()
            (case / "boundary").write_text(text.replace("nFaces", f"{name} a; nFaces"))

    def move(case, name):
        if COMM.rank == 0:
            shutil.copytree(case, case.parents[1] / "0.5" / "polyMesh")

    def flip(case, name):
        if COMM.rank == 0:
            (case / "faceZones").write_text("FoamFile\n{\n}\n2\n(\nsheet\n{\ntype faceZone;\nfaceLabels List<label> 2(0 1);\n"
                                            "flipMap List<bool> 2(0 1);\n}\nbare\n{\nfaceLabels 0();\n}\n)\n")
    for change, name, words in [(enter, "physicalType", "no place for: physicalType of patches (6)"),
                                (move, "moved", "the mesh of constant was read: 1 time has one of its own: 0.5"),
                                (flip, "flipMap", ["left out was which way the faces of the zone 'sheet' look: 1 of them is turned (flipMap)",
                                                   "1 named group has no element: 'bare' (triangles)"]),
                                (add, "pointZones", "polyMesh has: pointZones"), (add, "sets", "polyMesh has: sets"),
                                (add, "cellLevel", "polyMesh has: cellLevel"), (retype, "empty", "the type 'empty' of the patch 'xmin'"),
                                (retype, "wedge", "the type 'wedge' of the patch 'xmin'"),
                                (retype, "mappedWall", "the type 'mappedWall' of the patch 'xmin'")]:
        pamr.Mesh.kuhn_cube(COMM, 1).write(f"case_{name}")
        change(pathlib.Path(f"case_{name}/constant/polyMesh"), name)
        COMM.barrier()
        mesh, told = told_by(lambda: pamr.Mesh.read(COMM, f"case_{name}"))
        words = [words] if isinstance(words, str) else words
        assert mesh.n_cells == 6 and len(told) == len(words) and all(w in t for w, t in zip(words, told)), (name, told)


@in_folder
def test_groups_of_patches_of_openfoam_come_back():
    pamr.Mesh.kuhn_cube(COMM, 1).write("case")
    if COMM.rank == 0:
        boundary = pathlib.Path("case/constant/polyMesh/boundary")
        text = boundary.read_text()
        for name, entry in (("xmin", "type wall; inGroups 2(wall sides);"), ("xmax", "type patch; inGroups (sides caps);"),
                            ("ymin", "type patch; inGroups List<word> 1(caps);"), ("ymax", "type wall; inGroups 1(wall);")):
            text = re.sub(rf"(\b{name}\n +{{\n +)type +patch;", rf"\g<1>{entry}", text)
        boundary.write_text(text)
    COMM.barrier()
    groups = {"xmin": {-1: "xmin", -2: "sides"}, "xmax": {-3: "xmax", -2: "sides", -4: "caps"}, "ymin": {-5: "ymin", -4: "caps"}}
    mesh, told = told_by(lambda: pamr.Mesh.read(COMM, "case"))
    assert told == [] and mesh.patch_groups == groups, (told, mesh.patch_groups)
    for name in ("fine.hdf", "other", "twice"):  # in native files and in cases
        pamr.refine(mesh, np.zeros(len(mesh.cells), int)).mesh.write(name)
        mesh, told = told_by(lambda: pamr.Mesh.read(COMM, name))
        assert told == [] and mesh.patch_groups == groups, (name, told, mesh.patch_groups)
    told_by(lambda: mesh.write("groups.msh"))
    joint = {name: {*of.values()} for name, of in pamr.Mesh.read(COMM, "groups.msh").patch_groups.items()}
    assert sorted(map(sorted, joint.values())) == [["caps", "sides", "xmax"], ["caps", "ymin"], ["sides", "xmin"]], joint
    pamr.Mesh.read(COMM, "groups.msh").write("joint")  # patches A+B are in these groups and in none of their own names
    assert {name: {*of.values()} for name, of in pamr.Mesh.read(COMM, "joint").patch_groups.items()} == joint


@in_folder
def test_what_lies_beside_a_ugrid_file_is_told():
    mesh = pamr.Mesh.kuhn_cube(COMM, 1)
    for name, more, lines, words in [
            ("tail.lb8.ugrid", b"x" * 12, None, ["left out was what a mesh has no place for: bytes behind the last array (12)"]),
            ("idle.b8.ugrid", b"", "8\n1 4000 a\n2 3000 b\n3 0 c\n4 0 d\n5 0 e\n6 0 f\n9 5000 far\n7 0 g\n",
             ["2 lines of idle.mapbc are left out: the mesh has no such surface, the first is 7 'g'"]),
            ("more.lb8.ugrid", b"", "6\n1 4000 a\n2 3000 b\n3 0 c\n4 0 d\n5 0 e\n6 0 f\n9 5000 far\n\n",
             ["1 line of more.mapbc is left out: behind the 6 that it announces"]),
            ("less.lb8.ugrid", b"", "4\n1 4000 a\n2 3000 b\n3 0 c\n6 0 f\n",
             ["2 surfaces have no line in less.mapbc, the first is 4: no condition is known there"])]:
        mesh.write(name)
        if COMM.rank == 0:
            with open(name, "ab") as file:
                file.write(more)
            if lines:
                pathlib.Path(name.split(".")[0] + ".mapbc").write_text(lines)
        COMM.barrier()
        back, told = told_by(lambda: pamr.Mesh.read(COMM, name))
        assert back.n_cells == 6 and [line.split("': ", 1)[1] for line in told] == words, told
        assert words[0] in error_of(lambda: pamr.Mesh.read(COMM, name, strict=True))


@in_folder
def test_what_others_put_into_a_native_file_is_told():
    def change(name, how):
        pamr.Mesh.kuhn_cube(COMM, 1).write(name)
        if COMM.rank == 0:
            import h5py
            with h5py.File(name, "r+") as file:
                how(file)
        COMM.barrier()
        return told_by(lambda: pamr.Mesh.read(COMM, name))[1]

    def steps(file):
        file.create_group("VTKHDF/Steps").attrs["NSteps"] = 3
        del file["VTKHDF/CellData/level"]
        file["VTKHDF/CellData/T"] = np.arange(18.0)

    def level(file):
        del file["PAMR"]
        file["VTKHDF/CellData/level"][:] = 1
    for name, how, words in [
            ("plain.hdf", lambda file: file.create_group("VTKHDF/FieldData"), ""),  # VTK makes that of nothing, too
            ("group.hdf", lambda file: file.create_group("Mine/deep"), "1 object is left out that the format does not know: /Mine"),
            ("sets.hdf", lambda file: [file.create_dataset(where, data=[1]) for where in ("VTKHDF/FieldData/t", "PAMR/extra", "PAMR/patches/x")],
             "3 objects are left out that the format does not know: /VTKHDF/FieldData, /PAMR/extra, /PAMR/patches/x"),
            ("texts.hdf", lambda file: [file.create_dataset(f"VTKHDF/{where}", data=np.array([b"x", b"yz"])) for where in ("CellData/a", "PointData/b")],
             "2 objects are left out that the format does not know: /VTKHDF/PointData/b, /VTKHDF/CellData/a"),
            ("link.hdf", lambda file: file.__setitem__("gone", __import__("h5py").SoftLink("/none")), "does not know: /gone"),
            ("steps.hdf", steps, "the fields are those of the last of 3 time steps, the others are left out"),
            ("level.hdf", level, "the field 'level' is left out: one of that name and type says how often cells were refined")]:
        told = change(name, how)
        if name == "level.hdf":  # of another program now, none of whose faces has a tag
            assert "12 boundary faces without tag are in the patch 'boundary'" in told.pop(), told
        assert len(told) == bool(words) and words in "".join(told), (name, told)


@in_folder
def test_what_cgns_has_beside_a_mesh_is_told():
    mesh = pamr.Mesh.kuhn_cube(COMM, 1)
    mesh.node_fields["T"] = np.zeros(len(mesh.points))
    mesh.write("more.cgns")
    if COMM.rank == 0:
        import h5py
        with h5py.File("more.cgns", "r+") as file:
            zone = file["Base/Zone1"]
            zone.copy("xmin", "bars")
            zone["bars"].attrs["name"] = np.bytes_("bars")
            zone["bars/ data"][:] = [3, 0]
            zone["bars/ElementRange/ data"][:] = [100, 101]
            for name, label in (("Base/units", "DimensionalUnits_t"), ("Base/Zone1/text", "Descriptor_t"), ("Base/Zone1/order", "Ordinal_t")):
                node = file.create_group(name)
                node.attrs["label"] = np.bytes_(label)
            for name, what in (("faces", "FaceCenter"), ("short", "CellCenter"), ("again", "Vertex")):
                zone.copy("NodeFields", name)
                zone[name].attrs["name"] = np.bytes_(name)
                del zone[name]["GridLocation"][" data"]
                zone[name]["GridLocation"][" data"] = np.frombuffer(what.encode(), np.int8)
            for name, label in (("ZoneBC/xmax/data", "BCDataSet_t"), ("GridCoordinates/units", "DataClass_t"), ("NodeFields/text", "Descriptor_t"),
                                ("GridCoordinates/CoordinateX/units", "DimensionalUnits_t"), ("NodeFields/T/exponents", "DimensionalExponents_t")):
                node = zone.create_group(name)
                node.attrs["label"] = np.bytes_(label)
            file.copy(zone["GridCoordinates/CoordinateX"], zone["GridCoordinates"], "CoordinateR")
            zone["GridCoordinates/CoordinateR"].attrs["name"] = np.bytes_("CoordinateR")
            for name, kind in (("xmax", "BCExtrapolate"), ("ymin", "BCTunnelInflow"), ("ymax", "BCGeneral"), ("zmin", "BCWallViscous")):
                replace_data(zone["ZoneBC"][name], np.frombuffer(kind.encode(), np.int8))
    COMM.barrier()
    back, told = told_by(lambda: pamr.Mesh.read(COMM, "more.cgns"))
    assert back.n_cells == 6 and list(back.node_fields) == ["T"], list(back.node_fields)
    assert [line.split("': ", 1)[1] for line in told] == [
        "the type 'BCExtrapolate' of the condition 'xmax' was left out", "the type 'BCTunnelInflow' of the condition 'ymin' was left out",
        "left out was what a mesh has no place for: BCDataSet_t (1), DataClass_t (1), Descriptor_t (2), DimensionalExponents_t (1), "
        "DimensionalUnits_t (2), arrays beside the coordinates (1), arrays of solutions at FaceCenter (1), arrays of solutions of other sizes (1), "
        "arrays of solutions whose name another has (1), lines (2)"], told
    assert {p[1] for p in back._core.patches if p[0] == "zmin"} == {"wall"}


@in_folder
def test_a_condition_of_cgns_is_for_the_boundary_alone():
    points, cells, _, triangles, _ = two_regions()
    rows = (lambda array: array if COMM.rank == 0 else array[:0])
    for inside, other, refined in (("wall", 2, False), ("wall", 2, True), ("rest", 1, False), ("sheet", 2, False)):
        names = {1: ("wall", "wall"), 2: ("rest", "outflow"), 3: ("sheet", "wall")}
        tag = next(t for t, (name, _) in names.items() if name == inside)
        used = {t: names[t] for t in {1, 2, tag}}
        mesh = told_by(lambda: pamr.Mesh.from_arrays(COMM, rows(points), rows(cells), (rows(triangles), rows(np.array([1, 1, 2, 2, tag]))), used))[0]
        if refined:
            mesh = pamr.refine(mesh, np.ones(len(mesh.cells), int)).mesh
        n = 4 if refined else 1
        _, told = told_by(lambda: mesh.write("both.cgns"))
        kinds = [line for line in told if "the kinds of" in line]  # of faces inside alone, which have no condition
        assert kinds == (["left out: the kinds of 1 patch ('wall'): files of CGNS have no place for that"] if inside == "sheet" else []), told
        if COMM.rank == 0:
            import h5py
            with h5py.File("both.cgns") as file:
                zone = file["Base/Zone1"]
                assert sorted(zone["ZoneBC"]) == ["rest", "wall"] and "boundary" not in zone  # whose faces have no tag
                for name in ("wall", "rest"):
                    first, last = zone[name + "/ElementRange/ data"][:]
                    assert last - first + 1 == n * (3 if name == inside else 2), (name, first, last)
                    assert list(zone[f"ZoneBC/{name}/PointRange/ data"][:].ravel()) == [first, first + 2 * n - 1]
                inner = zone[inside + "/ElementConnectivity/ data"][-3 * n:]
                x = zone["GridCoordinates/CoordinateX/ data"][:][inner - 1]
                assert sorted(x[:3]) == [0, 0, 1] or refined, x
        back = told_by(lambda: pamr.Mesh.read(COMM, "both.cgns"))[0]
        inner, faces = back.inner_faces(), faces_of(back)
        assert faces["wall"] == faces["rest"] == 2 * n and COMM.allreduce([back.patches[p] for p in inner.patches[inner.first]]) == n * [inside]
        assert {name: kind for name, kind, _ in back._core.patches if kind} == {"wall": "wall", "rest": "outflow", "boundary": "untagged"}


@in_folder
def test_names_kinds_groups_and_units_without_a_place_are_told():
    pamr.Mesh.kuhn_cube(COMM, 1).write("case")
    if COMM.rank == 0:
        boundary = pathlib.Path("case/constant/polyMesh/boundary")
        boundary.write_text(boundary.read_text().replace("type            patch;", "type wall; inGroups (sides);", 1))
    COMM.barrier()
    mesh = pamr.Mesh.read(COMM, "case")
    both = "left out: the kinds of 1 patch ('wall') and the groups of 1 patch: files of "
    for name, words in [("a.msh", "left out: the kinds of 1 patch ('wall'): files of Gmsh"), ("a.vtu", both + "VTK"), ("a.su2", both + "SU2"),
                        ("a.cgns", "the groups of 1 patch"),
                        ("a.lb8.ugrid", "the groups of 1 patch"), ("a.mesh", "1 for 'xmin', 2 for 'xmax', 3 for 'ymin'"), ("again", "")]:
        _, told = told_by(lambda: mesh.write(name))
        assert words in " ".join(told) and bool(words) == bool(told), (name, told)
    rows = (lambda array: array if COMM.rank == 0 else array[:0])
    points, cells, region, *_ = two_regions()
    mesh = told_by(lambda: pamr.Mesh.from_arrays(COMM, rows(points), rows(cells), cell_fields={"region": rows(region)}, regions={3: "gas"}))[0]
    mesh.cell_fields.set("T", np.zeros(len(mesh.cells)), "K")
    for name, words in [("b.vtu", "left out: the names of 1 region and the units of 1 field: files of VTK"), ("b.meshb", "the names of 1 region"),
                        ("b.msh", "1 field is left out: 'T' on cells"), ("b.su2", "2 fields are left out")]:
        _, told = told_by(lambda: mesh.write(name))
        assert words in " ".join(told), (name, told)


@in_folder
def test_words_of_patches_inside_and_of_regions_without_a_place_are_told():
    groups = ('$PhysicalNames\n5\n2 1 "wall"\n2 2 "rest"\n2 5 "sheet"\n3 3 "gas"\n3 4 "hot"\n$EndPhysicalNames\n')
    points, cells, region, triangles, tags = two_regions()
    text = as_files(points, cells, region, triangles, tags)["two.msh"].replace("$Nodes", groups + "$Nodes")
    twice = ["90 4 2 4 3 1 2 3 4", "95 2 2 2 5 2 3 4"]  # in a second group each
    n = len(triangles) + len(cells)
    text = text.replace(f"$Elements\n{n}", f"$Elements\n{n + len(twice)}").replace("$EndElements", "\n".join(twice) + "\n$EndElements")
    mesh, told = told_by(lambda: pamr.Mesh.read(COMM, write("groups.msh", text)))
    assert list(mesh.patch_groups.values()) == [{2: "rest", 5: "sheet"}] and list(mesh.region_groups.values()) == [{3: "gas", 4: "hot"}], (
        mesh.patch_groups, mesh.region_groups, told)
    for name, words in [("case", "left out: the groups of 1 patch and the groups of 1 region: files of OpenFOAM"), ("again.msh", ""),
                        ("a.cgns", "left out: the groups of 1 patch, the groups of 1 region"), ("a.vtu", "the groups of 1 patch, the groups of 1 region")]:
        _, told = told_by(lambda: mesh.write(name))
        assert words in " ".join(told) and ("groups" in " ".join(told)) == bool(words), (name, told)
    mesh = told_by(lambda: pamr.Mesh.from_arrays(COMM, only_on_first(points), only_on_first(cells), (only_on_first(triangles), only_on_first(tags)),
                                                 {5: ("sheet", "wall")}))[0]
    for name in ("inner", "inner.cgns"):
        assert "left out: the kinds of 1 patch ('wall'): files of" in " ".join(told_by(lambda: mesh.write(name))[1]), name
    mesh.cell_fields["region"], mesh.node_fields["region"] = np.ones(len(mesh.cells)), np.ones(len(mesh.points), int)  # neither are regions
    for name in ("region.msh", "region.mesh", "region"):
        assert "2 fields are left out: 'region' on cells, 'region' on nodes" in " ".join(told_by(lambda: mesh.write(name))[1]), name


@in_folder
def test_names_that_become_references_are_told():
    cube = pamr.Mesh.kuhn_cube(COMM, 1)
    told_by(lambda: cube.write("one.mesh"))
    back = told_by(lambda: pamr.Mesh.read(COMM, "one.mesh"))[0]
    points, cells, _, triangles, tags = two_regions()
    rows = only_on_first
    numbered = told_by(lambda: pamr.Mesh.from_arrays(COMM, rows(points), rows(cells), (rows(triangles), rows(tags)), {1: "wall", 2: "ref_2", 5: "sheet"}))[0]
    n_cells = Counter(tuple(sorted(face)) for cell in CELLS.tolist() for face in itertools.combinations(cell, 3))
    outer = np.array([face for face, n in n_cells.items() if n == 1])  # each a patch
    many = told_by(lambda: pamr.Mesh.from_arrays(COMM, rows(POINTS), rows(CELLS), (rows(outer), rows(np.arange(12)))))[0]
    for ending in (".mesh", ".meshb"):
        for mesh, words in ((cube, "6 patches have references instead of their names: 1 for 'xmin', 2 for 'xmax', 3 for 'ymin', 4 for 'ymax', 5 for "
                                   "'zmin' and 6 for 'zmax'"), (back, None),
                            (numbered, "2 patches have references instead of their names: 1 for 'wall' and 5 for 'sheet'"),
                            (many, "12 patches have references instead of their names: ")):
            _, told = told_by(lambda: mesh.write(f"names{ending}"))
            told = [line for line in told if "references" in line]
            assert len(told) == (words is not None) and (not told or told[0].startswith(words)), told
            assert mesh is not many or told[0].endswith(", ... (all are in the report, --json, as references)"), told


@in_folder
def test_triangles_in_two_conditions_of_cgns_are_counted():
    for name, part in (("all.cgns", 1), ("half.cgns", 2)):
        mesh = pamr.Mesh.kuhn_cube(COMM, 2)
        mesh.write(name)
        if COMM.rank == 0:
            import h5py
            with h5py.File(name, "r+") as file:
                conditions = file["Base/Zone1/ZoneBC"]
                file.copy(conditions["xmin"], conditions, "other")
                conditions["other"].attrs["name"] = np.bytes_("other")
                numbers = conditions["other/PointRange/ data"]
                numbers[1] = numbers[0] + (numbers[1] - numbers[0] + 1) // part - 1
        COMM.barrier()
        back, told = told_by(lambda: pamr.Mesh.read(COMM, name))
        both = f"{8 // part} triangles are in the group "
        assert sum(both in line and "'other'" in line and "'xmin'" in line for line in told) == 1, told
        assert COMM.allreduce(len(back.boundary_faces().cells)) == 48, name


def name_vertices(group, numbers):
    """Makes a condition of CGNS on faces one on vertices."""
    del group["GridLocation"]
    replace_data(group["PointRange"], np.asarray(numbers, group["PointRange/ data"].dtype).reshape(-1, 1))
    group.move("PointRange", "PointList")
    group["PointList"].attrs["label"], group["PointList"].attrs["name"] = np.bytes_("IndexArray_t"), np.bytes_("PointList")


@in_folder
def test_vertices_and_cells_in_two_conditions_of_cgns_are_counted():
    def add(file, like, name, change):
        conditions = file["Base/Zone1/ZoneBC"]
        file.copy(conditions[like], conditions, name)
        conditions[name].attrs["name"] = np.bytes_(name)
        change(conditions[name])

    def vertices(file):  # of faces that a condition on faces has, and one on vertices
        x = file["Base/Zone1/GridCoordinates/CoordinateX/ data"][:]
        for name in ("some", "others"):
            add(file, "xmin", name, lambda group: name_vertices(group, np.flatnonzero(x == 0) + 1))

    def alone(file):  # the same vertices twice, and no faces
        x = file["Base/Zone1/GridCoordinates/CoordinateX/ data"][:]
        name_vertices(file["Base/Zone1/ZoneBC/xmin"], np.flatnonzero(x == 0) + 1)
        add(file, "xmin", "some", lambda group: None)

    def cells(file):
        for name, last in (("gas", 30), ("solid", 48)):
            add(file, "xmin", name, lambda group: (replace_data(group["PointRange"], np.array([[21], [last]], np.int32)),
                                                   replace_data(group["GridLocation"], np.frombuffer(b"CellCenter", np.int8))))
    for how, n, words in ((vertices, 2, ["8 triangles are in the group 'xmin' and in 'some'", "8 triangles are in the group 'xmin' and in 'others'"]),
                          (alone, 1, ["8 triangles are in the group 'xmin' and in 'some'"]),
                          (cells, 1, ["10 tetrahedra are in the group 'gas' and in 'solid'"])):
        pamr.Mesh.kuhn_cube(COMM, 2).write("two.cgns")
        if COMM.rank == 0:
            import h5py
            with h5py.File("two.cgns", "r+") as file:
                how(file)
        COMM.barrier()
        back, told = told_by(lambda: pamr.Mesh.read(COMM, "two.cgns"))
        assert sum("in the group" in line for line in told) == n and all(any(w in line for line in told) for w in words), (how.__name__, told)
        assert faces_of(back)["xmin"] == 8, faces_of(back)


@in_folder
def test_files_of_other_programs_are_named_with_the_way_out():
    for name, text, words in [
            ("old.msh", "$NOD\n4\n1 0 0 0\n", ["line 1", "Gmsh's format 1", "-format msh41"]),
            ("fluent.msh", '(0 "GAMBIT to Fluent File")\n(2 3)\n', ["Fluent", "fluentMeshToFoam"]),
            ("freefem.msh", "4 1 4\n0 0 0 1\n", ["FreeFEM", "savemesh"]), ("freefem.mesh", "4 1 4\n0 0 1\n", ["FreeFEM", "savemesh"]),
            ("mfem.msh", MFEM, ["MFEM", ".mfem or .mesh"]), ("inline.mesh", "MFEM INLINE mesh v1.0\n", ["MFEM", "MakeSimplicial"]),
            ("medit.msh", MEDIT, ["Medit", ".mesh"]), ("gmsh.mesh", MSH, ["Gmsh", ".msh"]), ("gmsh.su2", MSH, ["line 1", "Gmsh", ".msh"]),
            ("gmsh.vtu", MSH, ["Gmsh", ".msh"]), ("legacy.vtu", VTK, ["legacy", ".vtk"]), ("xml.vtk", "<VTKFile>\n", ["XML", ".vtu"]),
            ("netgen.vol", "mesh3d\n", ['".vol" and a mesh of Netgen', "Gmsh2 Format"]), ("x.cas", "(0 1)\n", ['".cas"', "Fluent"]),
            ("gz.msh", b"\x1f\x8b\x08\x00", ["gzip", "gunzip"]), ("wide.msh", MSH.encode("utf-16"), ["UTF-16"]),
            ("page.msh", "<!DOCTYPE html>\n<html>", ["HTML"]), ("empty.msh", "", ["an empty file"]), ("empty.su2", "\n", ["an empty file"]),
            ("adf.cgns", "@(#)ADF Database Version A02011>", ["ADF", "adf2hdf"]), ("abaqus.msh", "*HEADING\n*NODE\n", ["Abaqus"]),
            ("other.msh", "hello\n", ['another beginning: "hello"']), ("medit.hdf", MEDIT, ["Medit", ".mesh"]),
            ("grid.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n", ["UNSTRUCTURED_GRID, found POLYDATA"]),
            ("curved.mfem", MFEM.replace("vertices\n4\n3\n", "vertices\n4\n\nnodes\nFiniteElementSpace\nFiniteElementCollection: "
                                         "H1_3D_P2\nVDim: 3\nOrdering: 1\n\n"), ["nodes of first order", "H1_3D_P2"])]:
        message = error_of(lambda: pamr.Mesh.read(COMM, write(name, text)))
        assert message.startswith(f"file '{name}'") and all(word in message for word in words), message


@in_folder
def test_groups_that_no_mesh_has_a_place_for_are_counted():
    groups = ('$PhysicalNames\n5\n0 9 "sensor"\n1 8 "edge"\n2 1 "wall"\n2 6 "outlet"\n3 7 "gas"\n$EndPhysicalNames\n')
    elements = ELEMENTS.replace("$Elements\n5\n", "$Elements\n8\n6 15 2 9 1 1\n7 1 2 8 1 1 2\n8 1 2 8 1 2 3\n")
    mesh, told = read("left.msh", HEAD + groups + NODES + elements)
    assert faces_of(mesh) == {"wall": 2, "physical_2": 2}
    assert told == ["1 point of the group 'sensor' was left out: a mesh has groups of triangles and tetrahedra",
                    "2 lines of the group 'edge' were left out: a mesh has groups of triangles and tetrahedra",
                    "1 named group has no element: 'outlet' (triangles)"], told
    lost = MSH.replace(" 2 1 1 ", " 2 0 1 ").replace(" 2 2 2 1 3 4", " 2 0 2 1 3 4").replace(" 2 2 2 2 3 4", " 2 0 2 2 3 4").replace(
        "4 2 7 1", "4 2 0 1")
    _, told = read("saveall.msh", lost)
    assert told == ["2 named groups have no element: 'wall' (triangles), 'gas' (tetrahedra): format 2.2 of Gmsh with Mesh.SaveAll "
                    "leaves groups out, 4.1 keeps them"], told
    only = HEAD + NAMES + NODES + ELEMENTS.replace("$Elements\n5", "$Elements\n4").replace("5 4 2 7 1 1 2 3 4\n", "")
    assert "found 4 triangles alone: where there are groups Gmsh saves only these, and a Physical Volume is missing" in error_of(
        lambda: pamr.Mesh.read(COMM, write("only.msh", only)))
    mesh, told = read("untagged.su2", SU2.replace("NMARK= 2", "NMARK= 1")[:SU2.index("MARKER_TAG= physical_2")])
    assert told == ["2 boundary faces without tag are in the patch 'boundary'"] and faces_of(mesh) == {"wall": 2, "boundary": 2}
    colors, told = read("colors.vtk", VTK + "COLOR_SCALARS tint 1\n0 .2 .4 1\n")
    tints = set().union(*COMM.allgather([int(v) for v in colors.node_fields["tint"]]))
    assert told == [] and tints == {0, 51, 102, 255}, tints
    _, told = read("untagged.vtk", VTK.replace("medit:ref", "mine"))
    assert told == ["4 triangles without tag were left out", "4 boundary faces without tag are in the patch 'boundary'"], told
    message = error_of(lambda: pamr.Mesh.read(COMM, write("poly.mesh", MEDIT.replace("End\n", "Polyhedra 2\n1 2\n3 4\nEnd\n"))))
    assert "found 2 polygons or polyhedra" in message, message


def two_regions():
    """Two tetrahedra of two regions with a tagged face between them, a node of nobody, two of six outer faces untagged."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [5, 5, 5.0]])
    cells, region = np.array([[0, 1, 2, 3], [4, 2, 1, 3]]), np.array([3, 4])
    triangles = np.array([[0, 1, 2], [0, 1, 3], [4, 2, 1], [4, 1, 3], [1, 2, 3]])
    return points, cells, region, triangles, np.array([1, 1, 2, 2, 5])


def as_files(points, cells, region, triangles, tags):
    rows = lambda array, first=0: "".join(" ".join(map(str, row)) + "\n" for row in array + first)
    tagged, celled = np.column_stack([triangles + 1, tags]), np.column_stack([cells + 1, region])
    numbered = np.column_stack([np.arange(1, len(points) + 1), points])
    elements = [f"{t + 1} 2 2 {tag} {tag} " + " ".join(map(str, row)) for t, (*row, tag) in enumerate(tagged)]
    elements += [f"{9 + c} 4 2 {tag} {tag} " + " ".join(map(str, row)) for c, (*row, tag) in enumerate(celled)]
    n, types = len(cells) + len(triangles), "10\n" * len(cells) + "5\n" * len(triangles)
    values = " ".join(map(str, [*region, *tags]))
    return {
        "two.msh": HEAD + f"$Nodes\n{len(points)}\n" + "".join(f"{int(r[0])} {r[1]} {r[2]} {r[3]}\n" for r in numbered)
        + f"$EndNodes\n$Elements\n{len(elements)}\n" + "\n".join(elements) + "\n$EndElements\n",
        "two.mesh": "MeshVersionFormatted 2\nDimension 3\nVertices\n" + f"{len(points)}\n" + rows(np.column_stack([points, 0 * points[:, 0]]))
        .replace(".0\n", "\n") + f"Triangles\n{len(tagged)}\n" + rows(tagged) + f"Tetrahedra\n{len(celled)}\n" + rows(celled) + "End\n",
        "two.mfem": f"MFEM mesh v1.0\n\ndimension\n3\n\nelements\n{len(cells)}\n" + rows(np.column_stack([region, 0 * region + 4, cells]))
        + f"\nboundary\n{len(tags)}\n" + rows(np.column_stack([tags, 0 * tags + 2, triangles]))
        + f"\nvertices\n{len(points)}\n3\n" + rows(points),
        "two.vtk": "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n" + f"POINTS {len(points)} double\n" + rows(points)
        + f"CELLS {n} {5 * len(cells) + 4 * len(triangles)}\n" + rows(np.column_stack([0 * region + 4, cells]))
        + rows(np.column_stack([0 * tags + 3, triangles])) + f"CELL_TYPES {n}\n" + types
        + f"CELL_DATA {n}\nSCALARS gmsh:physical int\nLOOKUP_TABLE default\n{values}\n"}


def shape_of(mesh):
    """The mesh by places: cells with regions, faces by patch."""
    placed = lambda rows: [tuple(sorted(map(tuple, mesh.points[row].tolist()))) for row in rows]
    faces = mesh.boundary_faces()
    cells = sum(COMM.allgather(list(zip(placed(mesh.cells), mesh.cell_fields["region"].tolist()))), [])
    patches = sum(COMM.allgather(list(zip(faces.patches.tolist(), placed(faces.nodes)))), [])
    return sorted(cells), sorted((min(f for q, f in patches if q == p), face) for p, face in patches)


def faces_by_number(mesh):
    """Faces of each patch by its number, -1 for those without a tag; those inside count once."""
    inside = mesh.inner_faces()
    patches = np.concatenate([mesh.boundary_faces().patches, inside.patches[inside.first]])
    counts = COMM.allreduce(np.bincount(patches, minlength=len(mesh.patches)))
    return dict(zip(mesh.patch_numbers, counts.tolist()))


def only_on_first(array):
    return array if COMM.rank == 0 else array[:0]


def anonymous(text):
    """What is said, without the name of the source and those that formats give to groups."""
    for name in ("physical_5", "ref_5", "patch_5"):
        text = text.replace(f"'{name}'", "'5'")
    return text.split("': ", 1)[-1] if text.startswith("file '") else text.removeprefix("from_meshio: ").removeprefix("arrays: ")


@in_folder
def test_files_arrays_and_meshio_give_the_same_mesh_and_words():
    import meshio
    arrays = two_regions()

    def every_way(arrays, strict_text=None):
        points, cells, region, triangles, tags = arrays
        ways = {name: lambda name=write(name, text): pamr.Mesh.read(COMM, name) for name, text in as_files(*arrays).items()}
        given = meshio.Mesh(points, [("tetra", cells), ("triangle", triangles)], cell_data={"gmsh:physical": [region, tags]})
        ways["meshio"] = lambda: pamr.from_meshio(COMM, given if COMM.rank == 0 else None)
        ways["arrays"] = lambda: pamr.Mesh.from_arrays(
            COMM, only_on_first(points), only_on_first(cells), (only_on_first(triangles), only_on_first(tags)),
            cell_fields={"region": only_on_first(region)})
        return ways
    found = {}
    for way, call in every_way(arrays).items():
        mesh, told = told_by(call)
        found[way] = shape_of(mesh), [anonymous(text) for text in told]
    first = found["two.msh"]
    assert [text[:30] for text in first[1]] == ["1 node of no cell was left out", "2 boundary faces without tag a"]
    assert all(one == first for one in found.values()), found
    points, cells, region, triangles, tags = arrays
    numbered = points, cells, region, triangles, np.array([7, 7, 12, 12, 9])
    for way, call in every_way(numbered).items():
        mesh, _ = told_by(call)
        assert faces_by_number(mesh) == {7: 2, 12: 2, 9: 1, -1: 2}, (way, faces_by_number(mesh))
        for name in ("back.msh", "back.mesh", "back.hdf", "back.vtu", "back.cgns"):
            told_by(lambda: mesh.write(name))
            back, told = told_by(lambda: pamr.Mesh.read(COMM, name))
            assert ("2 boundary faces without tag are in the patch 'boundary'" in " ".join(told)) == (name != "back.hdf"), (way, name, told)
            if name not in ("back.vtu", "back.cgns"):  # which have names, but no numbers
                assert faces_by_number(back) == {7: 2, 12: 2, 9: 1, -1: 2}, (way, name, faces_by_number(back))
            if name != "back.mesh":  # which has numbers, but no names
                assert shape_of(back) == shape_of(mesh) and sorted(back.patches) == sorted(mesh.patches), (way, name, back.patches)
    apart = points, cells, region, np.vstack([triangles[:-1], [[0, 1, 4]]]), tags  # of two cells that have no such face
    twice = points, cells, region, np.vstack([triangles, triangles[:1, ::-1]]), np.append(tags, 2)
    inverted = points, np.where([[True], [False]], cells[:, [1, 0, 2, 3]], cells), region, triangles, tags
    within = np.vstack([points[:4], [[0.1, 0.1, 0.1]], points[5:]])
    folded = within, cells, region, triangles, tags  # the second cell lies in the first one
    for way, call in every_way(inverted).items():
        mesh, told = told_by(call)
        new = [text for text in map(anonymous, told) if text not in first[1]]
        assert shape_of(mesh) == first[0] and new == ["1 inverted cell was turned over"], (way, told)
    for name in as_files(*inverted):
        assert "found 1 inverted" in error_of(lambda: pamr.Mesh.read(COMM, name, repair=False)), name
    for bad, words in ((apart, "found 1 apart from the cells"), (twice, "found 1 faces in two surfaces"), (folded, "found 1 faces with two on one side")):
        for way, call in every_way(bad).items():
            assert words in error_of(call), (way, error_of(call))
    if COMM.size == 1:  # the tool says the same of a file
        told = told_by(lambda: pamr.Mesh.read(COMM, write("two.msh", as_files(*arrays)["two.msh"])))[1]
        done = subprocess.run([CONVERT, "two.msh", "two.hdf"], capture_output=True, text=True)
        assert [line.removeprefix("pamr-convert: warning: ") for line in done.stderr.splitlines()] == [
            text.removeprefix("file 'two.msh': ") for text in told]


@in_folder
def test_cases_of_openfoam_come_back_with_their_order_and_regions():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    middle = mesh.points[mesh.cells].mean(axis=1)[:, 0]
    mesh.cell_fields["region"] = np.where(middle < 0.5, 0, 4).astype(np.int32)
    mesh.write("case")
    back, told = told_by(lambda: pamr.Mesh.read(COMM, "case"))
    assert told == [] and faces_of(back) == faces_of(mesh) and shape_of(back) == shape_of(mesh)
    everywhere = lambda m: np.concatenate(COMM.allgather(m.points[m.cells].mean(axis=1)))
    assert np.array_equal(everywhere(back), everywhere(mesh))
    if COMM.rank == 0:
        time = pathlib.Path("case/0")
        time.mkdir()
        (time / "T").write_text("FoamFile\n{\n version 2.0;\n format ascii;\n class volScalarField;\n object T;\n}\ndimensions [0 0 0 1 0 0 0];\n"
                                "internalField nonuniform List<scalar>\n48\n(\n" + "\n".join(map(str, range(48)))
                                + "\n)\n;\nboundaryField\n{\n \".*\" { type zeroGradient; }\n}\n")
    COMM.barrier()
    pamr.openfoam.read_fields(back, "case", "0")
    assert np.array_equal(np.concatenate(COMM.allgather(back.cell_fields["T"])), np.arange(48.0))
    if COMM.rank == 0:  # as renumberMesh does it: two cells change places
        for path in pathlib.Path("case/constant/polyMesh").glob("*r"):  # the cells on either side of the faces
            head, body = path.read_text().split("\n(\n", 1)
            swap = {"5": "6", "6": "5"}
            path.write_text(head + "\n(\n" + "\n".join(swap.get(line, line) for line in body.split("\n")))
    COMM.barrier()
    message = error_of(lambda: pamr.openfoam.read_fields(back, "case", "0"))
    assert "expected a mesh with the cells of this one in their order" in message and "renumberMesh" in message, message


def one_cell_case(**change):
    """The case of one tetrahedron, with other texts for some files; None: without the file."""
    def head(kind, name):
        return f"FoamFile\n{{\n version 2.0;\n format ascii;\n class {kind};\n object {name};\n}}\n// * * //\n"
    files = {"points": head("vectorField", "points") + "4\n(\n(0 0 0)\n(1 0 0)\n(0 1 0)\n(0 0 1)\n)\n",
             "faces": head("faceList", "faces") + "4\n(\n3(0 2 1)\n3(0 1 3)\n3(0 3 2)\n3(1 2 3)\n)\n",
             "owner": head("labelList", "owner") + "4\n(\n0\n0\n0\n0\n)\n", "neighbour": head("labelList", "neighbour") + "0\n(\n)\n",
             "boundary": head("polyBoundaryMesh", "boundary") + "2\n(\n wall { type wall; inGroups 1(wall); nFaces 3; startFace 0; }\n"
                         " rest\n {\n  type patch; /* a comment */\n  nFaces 1;\n  startFace 3;\n }\n)\n"} | change
    if COMM.rank == 0:
        folder = pathlib.Path("one/constant/polyMesh")
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).unlink(missing_ok=True)
            if text is not None:
                (folder / name).write_text(text)
    COMM.barrier()
    return files


def pack(name):
    """A file of the case as OpenFOAM's writeCompression leaves it."""
    if COMM.rank == 0:
        path = pathlib.Path("one/constant/polyMesh") / name
        path.with_name(name + ".gz").write_bytes(gzip.compress(path.read_bytes()))
        path.unlink()
    COMM.barrier()


@in_folder
def test_lists_of_one_value_and_packed_files_of_openfoam_are_read():
    good = one_cell_case()
    zones = lambda text: good["owner"].replace("4\n(\n0\n0\n0\n0\n)", text)
    for uniform in ("4{0}", "4 { 0 }", "4\n{\n0\n}"):
        one_cell_case(owner=zones(uniform), cellZones=zones("1\n(\n gas { type cellZone; cellLabels List<label> 1{0}; }\n)"))
        mesh, told = told_by(lambda: pamr.Mesh.read(COMM, "one"))
        assert faces_of(mesh) == {"wall": 3, "rest": 1} and told == [] and mesh.regions == {1: "gas"}, (uniform, told)
    for name in ("owner", "points", "faces", "neighbour", "boundary", "cellZones"):
        pack(name)
        mesh, told = told_by(lambda: pamr.Mesh.read(COMM, "one"))
        assert faces_of(mesh) == {"wall": 3, "rest": 1} and told == [] and mesh.regions == {1: "gas"}, name
    mesh.cell_fields.clear()
    if COMM.rank == 0:
        time = pathlib.Path("one/0")
        time.mkdir()
        (time / "T").write_text("FoamFile\n{\n version 2.0;\n format ascii;\n class volScalarField;\n object T;\n}\ndimensions [0 0 0 1 0 0 0];\n"
                                "internalField uniform 7;\nboundaryField\n{\n \".*\" { type zeroGradient; }\n}\n")
    COMM.barrier()
    pamr.openfoam.read_fields(mesh, "one", "0")  # which compares the packed faces
    assert COMM.allreduce(mesh.cell_fields["T"].tolist()) == [7]
    folder = pathlib.Path("one/constant/polyMesh")
    if COMM.rank == 0:
        shutil.copy(folder / "points.gz", "good.gz")
    COMM.barrier()
    whole = pathlib.Path("good.gz").read_bytes()
    for bad, words in ((whole[:-20], "that of the file"), (b"", "that of the file"), (b"no gzip at all", "damaged"),
                       (whole[:30] + bytes(9) + whole[39:], "damaged")):
        if COMM.rank == 0:
            (folder / "points.gz").write_bytes(bad)
        COMM.barrier()
        message = error_of(lambda: pamr.Mesh.read(COMM, "one"))
        assert message.startswith("file 'one/constant/polyMesh/points.gz': expected") and words in message, message
    if COMM.rank == 0:  # gzip may have packed it in parts
        text = gzip.decompress(whole)
        (folder / "points.gz").write_bytes(gzip.compress(text[:50]) + gzip.compress(text[50:]))
    COMM.barrier()
    assert faces_of(pamr.Mesh.read(COMM, "one")) == {"wall": 3, "rest": 1}


@in_folder
def test_cells_of_two_zones_stay_in_the_first_one():
    pamr.Mesh.kuhn_cube(COMM, 2).write("case")
    if COMM.rank == 0:
        head = "FoamFile\n{\n version 2.0;\n format ascii;\n class regIOobject;\n object cellZones;\n}\n"
        zone = lambda name, cells: f" {name} {{ type cellZone; cellLabels List<label> {len(cells)}({' '.join(map(str, cells))}); }}\n"
        pathlib.Path("case/constant/polyMesh/cellZones").write_text(
            head + "3\n(\n" + zone("all", range(40)) + zone("some", range(10, 44)) + zone("few", [0, 41, 47]) + ")\n")
    COMM.barrier()
    mesh, told = told_by(lambda: pamr.Mesh.read(COMM, "case"))
    region = COMM.allreduce(mesh.cell_fields["region"].tolist())
    assert mesh.regions == {1: "all", 2: "some", 3: "few"}
    assert region == [1] * 40 + [2] * 4 + [0] * 3 + [3], region
    assert told == ["file 'case': 30 tetrahedra are in the group 'all' and in 'some': they stay in 'all', which comes first",
                    "file 'case': 1 tetrahedron is in the group 'all' and in 'few': it stays in 'all', which comes first",
                    "file 'case': 1 tetrahedron is in the group 'some' and in 'few': it stays in 'some', which comes first"], told
    assert "expected elements in one group each, found 30 tetrahedra in 'all' and in 'some'" in error_of(
        lambda: pamr.Mesh.read(COMM, "case", strict=True))


@in_folder
def test_strict_reading_refuses_what_would_be_a_warning():
    arrays = two_regions()
    files = as_files(*arrays)
    for name, text in files.items():
        assert "expected" in error_of(lambda: pamr.Mesh.read(COMM, write(name, text), strict=True)), name
    for name, text in (("plain.msh", MSH), ("plain.mesh", MEDIT), ("plain.su2", SU2), ("plain.mfem", MFEM), ("plain.vtk", VTK)):
        assert pamr.Mesh.read(COMM, write(name, text), strict=True).n_cells == 1
    corner, faces = arrays[0][:4], np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
    apart = as_files(np.vstack([corner, corner + 9]), np.arange(8).reshape(2, 4), np.ones(2, int), np.vstack([faces, faces + 4]), np.ones(8, int))
    for name, text in apart.items():
        assert "the mesh is in 2 pieces" in error_of(lambda: pamr.Mesh.read(COMM, write(name, text), strict=True)), name


@in_folder
def test_bits_and_texts_of_legacy_vtk():
    point_bits = "FIELD FieldData 2\nflags 2 4 bit\n1 0 0 1 1 0 1 0\nnames 1 4 string\na\nb\nc\nd\n"
    mesh, told = read("bits.vtk", VTK.replace("CELL_DATA 5\n", "CELL_DATA 5\nSCALARS on bit 1\nLOOKUP_TABLE default\n1 0 0 1 1\n") + point_bits)
    assert told == ["the array 'names' was left out: a field has numbers, and a name without '/' and control characters"], told
    assert COMM.allreduce(mesh.cell_fields["on"].tolist()) == [1] and mesh.cell_fields["on"].dtype.kind == "i"
    text = {tuple(p): f for p, f in zip(map(tuple, mesh.points), mesh.node_fields["flags"].tolist())}
    big = lambda kind, *numbers: np.array(numbers, kind).tobytes()
    data = (VTK[:VTK.index("0 0 0 1 0 0")].replace("ASCII", "BINARY").encode() + big(">f8", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1) + b"\nCELLS 5 21\n"
            + big(">i4", 4, 0, 1, 2, 3, 3, 0, 1, 2, 3, 0, 1, 3, 3, 0, 2, 3, 3, 1, 2, 3) + b"\nCELL_TYPES 5\n" + big(">i4", 10, 5, 5, 5, 5)
            + b"\nCELL_DATA 5\nSCALARS medit:ref int 1\nLOOKUP_TABLE default\n" + big(">i4", 7, 1, 1, 2, 2)
            + b"\nSCALARS on bit 1\nLOOKUP_TABLE default\n\x98\nPOINT_DATA 4\nFIELD FieldData 1\nflags 2 4 bit\n\x9a\n")
    packed, told = read("packed.vtk", data)
    assert told == [] and COMM.allreduce(packed.cell_fields["on"].tolist()) == [1]
    assert faces_of(packed) == {"ref_1": 2, "ref_2": 2}
    assert {p: f for p, f in zip(map(tuple, packed.points), packed.node_fields["flags"].tolist())} == text
    flags = {(0, 0, 0): [1, 0], (1, 0, 0): [0, 1], (0, 1, 0): [1, 0], (0, 0, 1): [1, 0]}
    assert all(flags[p] == f for p, f in text.items()), text
    assert "fits the file" in error_of(lambda: pamr.Mesh.read(COMM, write("bad.vtk", data.replace(b"flags 2 4 bit", b"flags 99 4 bit"))))


@in_folder
def test_bad_cases_of_openfoam_are_refused_with_the_place():
    good = one_cell_case()
    mesh, told = told_by(lambda: pamr.Mesh.read(COMM, "one"))
    assert faces_of(mesh) == {"wall": 3, "rest": 1} and told == []

    def changed(name, old, new):
        assert old in good[name], (name, old)
        return {name: good[name].replace(old, new)}
    for change, words in [
            (changed("points", "(0 1 0)", "(0 one 0)"), ["points', line 13", '"one"']), (changed("points", "4\n(", "5\n("), ["points'", "("]),
            (changed("points", "(0 1 0)", "(0 nan 0)"), ["finite", "node 2"]), (changed("points", "FoamFile", "Fileless"), ["points'", "FoamFile"]),
            (changed("faces", "3(1 2 3)", "3(1 2 9)"), ["face 3", "found 9"]), (changed("faces", "3(1 2 3)", "4(1 2 3 0)"), ["1 polygons or polyhedra"]),
            (changed("faces", "4\n(", "99999999999\n("), ["fits the file"]), (changed("owner", "0\n)", "-1\n)"), ["found -1"]),
            (changed("owner", "0\n)", "1\n)"), ["polyhedra"]), (changed("owner", "4\n(", "3\n("), ["owner'", ")"]),
            (changed("faces", "3(1 2 3)", "3(0 1 2)"), ["two surfaces", "'rest'"]), (changed("boundary", "nFaces 3", "nFaces 7"), ["boundary'", "'wall'"]),
            (changed("boundary", "type wall", "type processor"), ["reconstructParMesh"]), (changed("boundary", "startFace 3", "startFace x"), ['"x"']),
            (changed("boundary", "rest\n", "wall\n"), ["'wall' twice"]), (changed("boundary", " }\n)\n", ""), ["boundary'", "end of the file"]),
            ({"boundary": None}, ["boundary'"]), ({"owner": None}, ["found a folder without"]),
            ({"cellZones": good["owner"].replace("4\n(\n0\n0\n0\n0\n)", "1\n(\n gas { type cellZone; cellLabels List<label> 1(3); }\n)")},
             ["cellZones'", "'gas'"])]:
        one_cell_case(**change)
        message = error_of(lambda: pamr.Mesh.read(COMM, "one"))
        assert message.startswith("file 'one") and all(word in message for word in words), (words, message)
        one_cell_case(cellZones=None)


@in_folder
def test_bad_files_of_the_other_readers_are_refused_with_the_place():
    def mfem(old, new):
        assert old in MFEM, old
        return "bad.mfem", MFEM.replace(old, new)

    def legacy(old, new):
        assert old in VTK, old
        return "bad.vtk", VTK.replace(old, new)
    for (name, text), words in [
            (mfem("dimension\n3", "dimension\n2"), ["line 5", "3 dimensions"]), (mfem("7 4 0", "7 9 0"), ["shape from 0 to 7"]),
            (mfem("7 4 0 1 2 3", "7 5 0 1 2 3 0 1 2 3"), ["1 hexahedra"]), (mfem("7 4 0 1 2 3", "7 4 0 1 2 9"), ["cell 0", "found 9"]),
            (mfem("elements\n1", "elements\n9999999"), ["fits the file"]), (mfem("elements\n1", "elements\n-1"), ["-1"]),
            (mfem("0 1 0\n0 0 1", "0 1 0\n0 0 x"), ['"x"']), (mfem("0 1 0\n0 0 1\n", "0 1 0\n"), ["end of the file"]),
            (mfem("vertices\n4\n3", "vertices\n4\n2"), ["in 3 dimensions"]), (mfem("boundary", "bound"), ['"bound"']),
            (mfem(MFEM[MFEM.index("vertices"):], ""), ["vertices or nodes"]),
            (legacy("POINTS 4 double", "POINTS 4 dubel"), ["line 5", '"dubel"']), (legacy("POINTS 4", "POINTS 5"), ['"CELLS"']),
            (legacy("ASCII", "HEX"), ["ASCII or BINARY"]), (legacy("CELLS 5 21", "CELLS 6 21"), ["expected 6 cells"]),
            (legacy("4 0 1 2 3\n", "9 0 1 2 3\n"), ["cell 0", "expected 4 nodes, found 9"]), (legacy("3 1 2 3\n", "3 1 2 7\n"), ["cell 4", "found 7"]),
            (legacy("CELL_TYPES 5\n10\n", "CELL_TYPES 5\n13\n"), ["cell 0: expected 6 nodes, found 4"]), (legacy("CELL_TYPES 5\n10\n", "CELL_TYPES 5\n99\n"), ["found 99"]),
            (legacy("CELL_DATA 5", "CELL_DATA 4"), ["expected 5 values"]), (legacy("SCALARS", "SCALES"), ["keyword", '"scales"']),
            (("bad.su2", SU2.replace("wall", "wa\tll")), ["name of patch", "'wa?ll'", "tabs"]),
            (("bad.msh", MSH.replace('"gas"', '"g\tas"')), ["line 8", "control characters", "group 7"]),
            (legacy("POINTS", "FIELD FieldData 1\npatch%20in%09let 1 1 int\n2\nPOINTS"), ["name of patch 2", "'in?let'"]),
            (legacy("CELL_DATA 5\n", ""), ["before scalars"]), (legacy("0 0 1\nCELLS", "0 0 nan\nCELLS"), ["finite", "node 3"])]:
        message = error_of(lambda: pamr.Mesh.read(COMM, write(name, text)))
        assert message.startswith(f"file '{name}'") and all(word in message for word in words), (words, message)


@in_folder
def test_cgns_comes_back_with_fields_and_kinds():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    mesh.node_fields["v"] = 2 * mesh.points
    mesh.cell_fields["q"] = mesh.points[mesh.cells].mean(axis=1)[:, 1]
    mesh.cell_fields["region"] = np.where(mesh.cell_fields["q"] < 0.5, 3, 4).astype(np.int32)
    mesh.write("mesh.cgns")
    back, told = told_by(lambda: pamr.Mesh.read(COMM, "mesh.cgns"))
    assert told == [] and faces_of(back) == faces_of(mesh) and shape_of(back) == shape_of(mesh)
    assert np.array_equal(back.node_fields["v"], 2 * back.points)
    assert np.allclose(back.cell_fields["q"], back.points[back.cells].mean(axis=1)[:, 1], rtol=1e-15)
    if COMM.rank == 0:  # as Gmsh writes conditions
        import h5py
        with h5py.File("mesh.cgns", "r+") as file:
            conditions = file["Base/Zone1/ZoneBC"]
            conditions.move("xmin", "inlet")
            for condition in conditions.values():
                condition["GridLocation/ data"][:] = np.frombuffer(b"CellCenter", np.int8)
    COMM.barrier()
    back, told = told_by(lambda: pamr.Mesh.read(COMM, "mesh.cgns"))
    assert set(back.patches) == set(mesh.patches) - {"xmin"} | {"inlet"} and told == [], (back.patches, told)


def replace_data(group, values):
    del group[" data"]
    group[" data"] = values


@in_folder
def test_a_cgns_file_of_several_parts_is_refused():
    for place, name, words in (("Base", "Zone2", "expected one Zone_t, found 2"), ("/", "Base2", "expected one CGNSBase_t, found 2")):
        pamr.Mesh.kuhn_cube(COMM, 1).write("parts.cgns")
        if COMM.rank == 0:
            import h5py
            with h5py.File("parts.cgns", "r+") as file:
                file.copy(file["Base/Zone1" if place == "Base" else "Base"], file[place], name)
                file[place][name].attrs["name"] = np.bytes_(name)
        COMM.barrier()
        assert words in error_of(lambda: pamr.Mesh.read(COMM, "parts.cgns")), words


@in_folder
def test_several_parts_in_a_file_are_refused():
    pamr.Mesh.kuhn_cube(COMM, 1).write("one.vtu")
    piece = pathlib.Path("one.vtu").read_bytes()
    begin, end = piece.index(b"<Piece"), piece.index(b"</Piece>") + len(b"</Piece>")
    for name, text, words in (
            ("pieces.vtu", piece[:end] + piece[begin:end] + piece[end:], "expected an unstructured grid of 1 piece, found 2"),
            ("grids.vtk", VTK + VTK[VTK.index("DATASET"):], "expected a keyword of the format, found \"dataset\""),
            ("zones.su2", "NZONE= 2\nIZONE= 1\n" + SU2, "expected one zone, found 2"),
            ("halo.su2", SU2.replace("NPOIN= 4", "NPOIN= 4 3"), "expected a mesh in one part with 4 points of its own, found 3"),
            ("blocks.mesh", MEDIT.replace("End", "Tetrahedra\n1\n1 2 3 4 8\nEnd"), "expected Tetrahedra once, found it again"),
            ("twice.msh", HEAD + "$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n7 0 0 1\n5 0 0 2\n5 0 0 3\n7 0 0 4\n8 0 0 5\n$EndNodes\n" + ELEMENTS,
             "expected every node number once, found 7 twice"),
            ("blocks.msh", MSH + NODES + ELEMENTS, "expected each section once, found $Nodes again")):
        assert words in error_of(lambda: pamr.Mesh.read(COMM, write(name, text))), (name, error_of(lambda: pamr.Mesh.read(COMM, name)))
    assert pamr.Mesh.read(COMM, write("own.su2", SU2.replace("NPOIN= 4", "NPOIN= 4 4"))).n_cells == 1


@in_folder
def test_cells_that_are_no_tetrahedra_are_refused_in_every_format():
    import meshio
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0], [5, 0, 0], [6, 0, 0], [6, 1, 0], [5, 1, 0], [5, 0, 1], [6, 0, 1], [6, 1, 1], [5, 1, 1]])
    for kind, n, words in (("hexahedron", 8, "1 hexahedra"), ("wedge", 6, "1 prisms"), ("pyramid", 5, "1 pyramids"), ("quad", 4, "1 quadrangles"),
                           ("tetra10", 10, "1 tetrahedra of second order"), ("triangle6", 6, "1 triangles of second order")):
        given = meshio.Mesh(points, [("tetra", [[0, 1, 2, 3]]), (kind, [[*range(4, 4 + n)] if n <= 8 else [*range(n)]])])
        for form, ending in (("gmsh22", ".msh"), ("vtu", ".vtu"), ("vtk", ".vtk"), ("medit", ".mesh"), ("ugrid", ".lb8.ugrid")):
            if form in ("medit", "ugrid") and kind in ("tetra10", "triangle6"):
                continue  # meshio does not write them
            name = "other" + ending
            if COMM.rank == 0:
                meshio.write(name, given, file_format=form)
            COMM.barrier()
            message = error_of(lambda: pamr.Mesh.read(COMM, name))
            assert message.startswith(f"file '{name}'") and f"found {words}" in message, (form, message)
        assert f"1 of type {kind}" in error_of(lambda: pamr.from_meshio(COMM, given if COMM.rank == 0 else None))
    for old, new, words in (("10 0 1 2 3", "12 0 1 2 3 0 1 2 3", "1 hexahedra"), ("10 0 1 2 3", "14 0 1 2 3 0", "1 pyramids"), ("5 1 2 3", "9 1 2 3 0", "1 quadrangles")):
        assert f"found {words}" in error_of(lambda: pamr.Mesh.read(COMM, write("other.su2", SU2.replace(old, new))))


@in_folder
def test_regions_and_conditions_on_vertices_are_read_from_cgns():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    mesh.write("mesh.cgns")
    if COMM.rank == 0:
        import h5py
        with h5py.File("mesh.cgns", "r+") as file:
            zone = file["Base/Zone1"]
            cells = next(g for g in zone.values() if isinstance(g, h5py.Group) and "ElementConnectivity" in g and len(g["ElementConnectivity/ data"]) == 4 * 48)
            first, nodes = int(cells["ElementRange/ data"][0]), cells["ElementConnectivity/ data"][:]
            file.copy(cells, zone, "solid")
            for group, begin, end in ((cells, 0, 20), (zone["solid"], 20, 48)):
                replace_data(group["ElementConnectivity"], nodes[4 * begin:4 * end])
                replace_data(group["ElementRange"], np.array([first + begin, first + end - 1], group["ElementRange/ data"].dtype))
            x = zone["GridCoordinates/CoordinateX/ data"][:]
            inlet = zone["ZoneBC/xmin"]
            del inlet["GridLocation"]
            name = next(n for n in inlet if n.startswith("Point"))
            vertices = np.flatnonzero(x == 0).astype(np.int32) + 1
            file.copy(inlet[name], inlet, "list")
            inlet["list"].attrs["label"], inlet["list"].attrs["name"] = np.bytes_("IndexArray_t"), np.bytes_("PointList")
            del inlet[name]
            inlet.move("list", "PointList")
            replace_data(inlet["PointList"], vertices.reshape(-1, 1))
    COMM.barrier()
    back, told = told_by(lambda: pamr.Mesh.read(COMM, "mesh.cgns"))
    assert set(back.patches) == set(mesh.patches) and told == [] and faces_of(back) == faces_of(mesh), (back.patches, told)
    region = back.cell_fields["region"]
    n = [COMM.allreduce(int((region == r).sum())) for r in (1, 2)]
    assert n == [20, 28] and back.regions[2] == "solid", (n, back.regions)


@in_folder
def test_files_of_the_newest_hdf5_format_are_read():
    import h5py
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    mesh.write("old.hdf")
    if COMM.rank == 0:
        with h5py.File("old.hdf") as old, h5py.File("new.hdf", "w", libver="latest") as new:
            for name in old:
                old.copy(name, new)
            for name, value in old.attrs.items():
                new.attrs[name] = value
    COMM.barrier()
    back, _ = told_by(lambda: pamr.Mesh.read(COMM, "new.hdf"))
    assert back._core.fingerprint() == mesh._core.fingerprint()


run_tests(globals())
