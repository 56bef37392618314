# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of OpenFOAM read, mapped and written; decomposed cases. Runs without OpenFOAM, and asks its checkMesh where there is one."""
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

import pamr
from collective import COMM, error_of, in_folder, run_tests
from pamr import foam_case, foam_file, openfoam

HEAD = "FoamFile\n{{\n    version 2.0;\n    format {format};\n    class {kind};\n    object {name};\n}}\n// a remark with nonuniform 3(\n"


def values_of(rows, binary):
    kind = "scalar" if rows.ndim == 1 else "vector"
    return foam_file.list_bytes(kind, rows, binary)


def field_bytes(name, rows, walls, binary):
    """A field with values in the cells, a list on the patch xmin, and entries of every kind."""
    kind = "volScalarField" if rows.ndim == 1 else "volVectorField"
    head = HEAD.format(format="binary" if binary else "ascii", kind=kind, name=name).encode()
    one = b"uniform 7.5" if rows.ndim == 1 else b"uniform (1 2 3)"
    return (head + b"dimensions [0 2 -1 0 0 0 0];\ninternalField " + values_of(rows, binary) + b";\nboundaryField\n{\n"
            b"    xmin\n    {\n        type   fixedValue; /* } */\n        value  " + values_of(walls, binary) + b";\n    }\n"
            b"    xmax { type mixed; refValue " + one + b"; note \"a } and a ;\"; sub { deep 5; list 3(1 2 3); } }\n"
            b"    \"(y|z).*\"\n    { type zeroGradient; }\n}\n")


def faces_of(mesh, patch):
    """Corners of the faces of a patch in OpenFOAM's order, on every rank."""
    faces = mesh.boundary_faces()
    of = faces.patches == mesh.patches.index(patch)
    rows = zip(mesh.cell_numbers[faces.cells[of]], faces.faces[of], mesh.points[faces.nodes[of]])
    return np.array([corners for _, _, corners in sorted(sum(COMM.allgather(list(rows)), []), key=lambda row: row[:2])])


def cell_values(mesh):
    center = mesh.points[mesh.cells].mean(axis=1)
    return 300 + np.sin(5 * center[:, 0]) * center[:, 1], center ** 3


def put_fields(mesh, case, binary):
    """Files T and U in case/3, made of the whole mesh; the values on xmin are numbers of faces."""
    whole = [np.concatenate(COMM.allgather(v))[np.argsort(np.concatenate(COMM.allgather(mesh.cell_numbers)))]
             for v in cell_values(mesh)]
    walls = np.arange(len(faces_of(mesh, "xmin")), dtype=float)
    if COMM.rank == 0:
        os.makedirs(f"{case}/3")
        for name, rows in zip("TU", whole):
            lists = walls if rows.ndim == 1 else np.stack([walls, 0 * walls, -walls], axis=1)
            pathlib.Path(f"{case}/3/{name}").write_bytes(field_bytes(name, rows, lists, binary))
        pathlib.Path(f"{case}/3/phi").write_text(HEAD.format(format="ascii", kind="surfaceScalarField", name="phi"))
    COMM.barrier()


def cube(n=3):
    return pamr.balance(pamr.Mesh.kuhn_cube(COMM, n), method="scotch")


@in_folder
def test_fields_come_back_byte_for_byte():
    for binary in (False, True):
        case = f"case{int(binary)}"
        mesh = cube()
        openfoam.write_mesh(mesh, case)
        put_fields(mesh, case, binary)
        fields = openfoam.read_fields(mesh, case, "3")
        assert fields.names == ["T", "U"] and fields.not_carried == ["phi"]
        for name, rows in zip("TU", cell_values(mesh)):
            assert np.array_equal(mesh.cell_fields[name], rows)
        openfoam.write_fields(fields, case, "4")
        if COMM.rank == 0:
            for name in "TU":
                assert pathlib.Path(f"{case}/3/{name}").read_bytes() == pathlib.Path(f"{case}/4/{name}").read_bytes()
        COMM.barrier()
    if COMM.rank == 0:  # what is replaced keeps its rights, and what cannot be written says why
        os.chmod("case0/4/T", 0o640)
        foam_file.write_bytes("case0/4/T", b"new")
        assert os.stat("case0/4/T").st_mode & 0o777 == 0o640 and pathlib.Path("case0/4/T").read_bytes() == b"new"
        assert sorted(os.listdir("case0/4")) == ["T", "U"]
        try:
            foam_file.write_bytes("nowhere/T", b"new")
            raise AssertionError("written into a folder that is not there")
        except pamr.Error as error:
            assert "file 'nowhere/T': cannot create it: No such file or directory" in str(error), error


def holds(triangle, point):
    """Whether a point of its plane lies in a triangle."""
    a, b, c = triangle
    weights = np.linalg.lstsq(np.stack([b - a, c - a], axis=1), point - a, rcond=None)[0]
    return (weights > -1e-9).all() and weights.sum() < 1 + 1e-9


@in_folder
def test_meshes_are_written_in_other_units():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    before = mesh.points.copy()
    points = {}
    for scale in (1, 0.001, 0.0254):
        openfoam.write_mesh(mesh, f"case{scale}", scale=scale)
        COMM.barrier()
        points[scale] = foam_case._numbers(f"case{scale}/constant/polyMesh/points", float)
        assert np.array_equal(points[scale], scale * points[1]), scale
    assert np.array_equal(mesh.points, before)
    for scale in (0, -1, float("nan"), float("inf")):
        assert "scale: expected a number above 0" in error_of(lambda scale=scale: openfoam.write_mesh(mesh, "x", scale=scale))
    assert not os.path.exists("x")


@in_folder
def test_refined_fields_keep_integrals_and_boundary_entries():
    mesh = cube()
    openfoam.write_mesh(mesh, "level.0")
    put_fields(mesh, "level.0", True)
    fields = openfoam.read_fields(mesh, "level.0", "3")
    first = faces_of(mesh, "xmin")
    integral = [COMM.allreduce((mesh.volumes() * mesh.cell_fields["T"]).sum())]
    for turn, limit in enumerate((0.4, 0.3, 0.25)):  # transition cells of a turn are undone in the next
        result = pamr.refine(mesh, np.linalg.norm(mesh.points[mesh.cells].mean(axis=1), axis=1) < limit * 2)
        fields, mesh = fields.after(result), result.mesh
        openfoam.write_mesh(mesh, f"level{turn + 1}")
        openfoam.write_fields(fields, f"level{turn + 1}", "0")
        integral.append(COMM.allreduce((mesh.volumes() * mesh.cell_fields["T"]).sum()))
    assert max(abs(i / integral[0] - 1) for i in integral) < 1e-13
    if COMM.rank == 0:
        old = pathlib.Path("level.0/3/U").read_bytes()
        new = pathlib.Path("level3/0/U").read_bytes()
        end = old.index(b"nonuniform List")
        assert old[:end] == new[:end] and old[old.index(b"    xmax"):] == new[new.index(b"    xmax"):]
    lists = COMM.bcast(foam_file.read_field("level3/0/T").values() if COMM.rank == 0 else None)
    number = lists["boundaryField", "xmin", "value"].rows.astype(int)
    last = faces_of(mesh, "xmin")
    assert len(number) == len(last) > 2 * len(first)
    assert all(holds(first[old], new.mean(axis=0)) for old, new in zip(number, last))
    assert lists["boundaryField", "xmax", "refValue"].text == b"uniform 7.5"


@in_folder
def test_decomposed_cases_hold_the_same_mesh_and_fields():
    mesh = cube()
    ranks = (mesh.points[mesh.cells].mean(axis=1) > (0.5, 0.2, 2)).sum(axis=1) + (mesh.cell_numbers % 5 == 0)
    openfoam.write_mesh(mesh, "case", ranks=ranks)
    put_fields(mesh, "case", True)
    fields = openfoam.read_fields(mesh, "case", "3")
    openfoam.write_fields(fields, "case", "4")
    if COMM.rank == 0:
        parts = foam_case.processors("case")
        assert len(parts) == ranks_everywhere(ranks)
        check_parts("case", parts)
        shutil.rmtree("case/4")
    else:
        ranks_everywhere(ranks)
    again = openfoam.read_fields(mesh, "case", "4")  # from the processors
    openfoam.write_fields(again, "whole", "0")
    if COMM.rank == 0:
        for name in "TU":
            old, new = (foam_file.read_field(f"{path}/{name}").values() for path in ("case/3", "whole/0"))
            assert old.keys() == new.keys() and all(np.array_equal(old[k].rows, new[k].rows) for k in old)
    COMM.barrier()
    for ranks in (None, "own"):
        message = error_of(lambda ranks=ranks: openfoam.write_mesh(mesh, "case", ranks=ranks))
        assert "expected no folders of processors, found" in message, message
    openfoam.write_mesh(mesh, "case", ranks="own", force=True)
    assert len(foam_case.processors("case")) == COMM.size
    assert f"numberOfSubdomains {COMM.size};" in pathlib.Path("case/system/decomposeParDict").read_text()


def ranks_everywhere(ranks):
    return len(set(np.concatenate(COMM.allgather(ranks)).tolist()))


def check_parts(case, parts):
    """Cells, faces and points are those of the whole mesh, and both sides of a border have the same faces."""
    def read(folder, name, dtype=int):
        return foam_case._numbers(os.path.join(folder, "constant/polyMesh", name), dtype)
    points, faces = read(case, "points", float).reshape(-1, 3), read(case, "faces").reshape(-1, 4)[:, 1:]
    owner, neighbor = read(case, "owner"), read(case, "neighbour")
    cells, border = [], {}
    for number, part in enumerate(parts):
        cell, face, point, patch = (read(part, name) for name in foam_case.NAMES)
        cells += cell.tolist()
        corners = read(part, "faces").reshape(-1, 4)[:, 1:]
        assert np.array_equal(read(part, "points", float).reshape(-1, 3), points[point])
        assert np.array_equal(np.sort(point[corners], axis=1), np.sort(faces[np.abs(face) - 1], axis=1))
        inside, beyond = read(part, "owner"), read(part, "neighbour")
        turned = face < 0
        assert np.array_equal(cell[inside[~turned]], owner[face[~turned] - 1])
        assert np.array_equal(cell[inside[turned]], neighbor[-face[turned] - 1])
        assert np.array_equal(cell[beyond], neighbor[face[:len(beyond)] - 1]) and (inside[:len(beyond)] < beyond).all()
        order = np.lexsort((beyond, inside[:len(beyond)]))
        assert np.array_equal(order, np.arange(len(beyond)))
        patches = foam_case._patches(part)
        assert [p.name for p in patches[:6]] == ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"]
        assert patch.tolist() == [0, 1, 2, 3, 4, 5] + [-1] * (len(patches) - 6)
        for p in patches[6:]:
            other = int(p.name.split("to")[1])
            border[number, other] = point[corners[p.start:p.start + p.n]]
    assert sorted(cells) == list(range(len(set(owner.tolist()))))
    assert border and all(np.array_equal(rows, border[b, a][:, [0, 2, 1]]) for (a, b), rows in border.items())


def test_openfoam_finds_no_fault():
    program = shutil.which("checkMesh")
    environment = os.environ | ({"WM_PROJECT_DIR": "/usr/share/openfoam"} if os.path.isdir("/usr/share/openfoam/etc") else {})
    folder = COMM.bcast(tempfile.mkdtemp(prefix="pamr_python_"))  # OpenFOAM knows no blanks
    mesh = pamr.refine(cube(), np.ones(len(cube().cells), bool)).mesh
    mesh = pamr.refine(mesh, mesh.points[mesh.cells].mean(axis=1)[:, 0] < 0.4).mesh
    openfoam.write_mesh(mesh, folder, ranks="own")
    if COMM.rank == 0:
        if program:
            settings = pathlib.Path(__file__).parents[2] / "cases/openfoam-loop/template/system"
            shutil.copytree(settings, f"{folder}/system", dirs_exist_ok=True)
            control = pathlib.Path(f"{folder}/system/controlDict")
            control.write_text(control.read_text().replace("WRITE_FORMAT", "ascii"))
            done = subprocess.run([program, "-case", folder, "-constant"], capture_output=True, text=True, cwd="/",
                                  env=environment | {"PWD": "/"})
            assert "\nMesh OK.\n" in done.stdout, done.stdout + done.stderr
        shutil.rmtree(folder)
    COMM.barrier()


@in_folder
def test_wrong_files_are_one_error():
    mesh = cube()
    openfoam.write_mesh(mesh, "case")
    put_fields(mesh, "case", False)
    good = pathlib.Path("case/3/T").read_bytes()

    def expect(words, change):
        if COMM.rank == 0:
            pathlib.Path("case/3/T").write_bytes(change(good))
        COMM.barrier()
        message = error_of(lambda: openfoam.read_fields(mesh, "case", "3", ["T"]))
        assert words in message, message
    expect("internalField: expected 162 values, one for each cell, found 3",
           lambda t: t[:t.index(b"nonuniform List")] + b"nonuniform List<scalar> 3(1 2 3)" + t[t.index(b";\nboundaryField"):])
    expect("patch 'xmin', value: expected 18 values, one for each face, found 2",
           lambda t: t[:t.rindex(b"nonuniform List")] + b"nonuniform List<scalar> 2(1 2)" + t[t.rindex(b";\n    }\n    xmax"):])
    expect("expected lists of values for patches of the mesh, found 'nowhere'", lambda t: t.replace(b"    xmin\n", b"    nowhere\n"))
    expect("expected a field on cells (volScalarField, volVectorField, ...), found class dictionary",
           lambda t: t.replace(b"volScalarField", b"dictionary"))
    expect("expected a ';' after the entry", lambda t: t[:t.index(b";\nboundaryField")])
    expect("expected a keyword", lambda t: t[:-2])
    expect("numbers in the list", lambda t: t.replace(b"\n162\n", b"\n163\n"))
    assert "found no such folder" in error_of(lambda: openfoam.read_fields(mesh, "case", "99"))
    assert "No such file" in error_of(lambda: openfoam.read_fields(mesh, "case", "3", ["p"]))
    last = COMM.size - 1
    assert "ranks: expected numbers from 0, found -1 for cell 2" in error_of(
        lambda: openfoam.write_mesh(mesh, "case", ranks=np.where((np.arange(len(mesh.cells)) == 2) & (COMM.rank == last), -1, 0)))
    assert "found none on 0" in error_of(lambda: openfoam.write_mesh(mesh, "case", ranks=np.ones(len(mesh.cells), int)))


run_tests(globals())
