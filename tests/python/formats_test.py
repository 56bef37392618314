# SPDX-License-Identifier: GPL-3.0-or-later
"""Every ending of the table of formats: written and read back by Python and by pamr-convert, or refused by both in the same words."""
import pathlib
import subprocess
import sys
import warnings

import pamr
from collective import COMM, error_of, in_folder, run_tests

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONVERT = pathlib.Path(pamr.__file__).resolve().parents[2] / "bin" / "pamr-convert"
ENDINGS = {ending: is_read for name, endings, is_read, is_written in pamr._core.formats() for ending in endings}
WRITTEN = [ending for name, endings, is_read, is_written in pamr._core.formats() for ending in endings if is_written]


def convert(*arguments):
    """Exit code and errors of the tool, which rank 0 starts alone."""
    done = subprocess.run([CONVERT, *arguments, "--quiet"], capture_output=True, text=True) if COMM.rank == 0 else None
    return COMM.bcast((done.returncode, done.stderr) if done else None)


def bytes_of(name):
    path = pathlib.Path(name)
    return {str(p.relative_to(path)): p.read_bytes() for p in path.glob("**/*") if p.is_file()} if path.is_dir() else path.read_bytes()


def read(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pamr.Mesh.read(COMM, name)


def content(mesh):
    """Cells, and the faces of each patch, by the places of their nodes; names and numbers are not the same in every format."""
    def placed(rows):
        return [tuple(sorted(map(tuple, mesh.points[row].tolist()))) for row in rows]
    faces = mesh.boundary_faces()
    here = placed(mesh.cells), list(zip(faces.patches.tolist(), placed(faces.nodes)))
    cells, patches = set(), {}
    for some_cells, some_faces in COMM.allgather(here):
        cells.update(some_cells)
        for patch, face in some_faces:
            patches.setdefault(patch, set()).add(face)
    return cells, {frozenset(faces) for faces in patches.values()}


@in_folder
def test_every_ending_comes_back_from_python_and_from_the_tool():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    mesh.write("cube.hdf")
    expected = content(mesh)
    assert len(expected[0]) == 48 and len(expected[1]) == 6
    assert sum(ENDINGS.values()) == 13 and len(ENDINGS) == 18 and len(WRITTEN) == 16
    for ending in WRITTEN:
        is_read = ENDINGS[ending]
        mesh.write(f"python{ending}")
        code, errors = convert("cube.hdf", f"tool{ending}", "--force")  # two have one .mapbc
        assert code == 0 and ("6 patches have references instead of their names" in errors) == (ending in (".mesh", ".meshb")), (ending, errors)
        assert bytes_of(f"python{ending}") == bytes_of(f"tool{ending}"), ending
        if not is_read:
            continue
        assert content(read(f"tool{ending}")) == expected, ending
        if COMM.size == 1:  # the tool runs alone in any case
            code, errors = convert(f"python{ending}", "back.hdf", "--force")
            assert code == 0 and content(read("back.hdf")) == expected, (ending, errors)


@in_folder
def test_what_is_replaced_keeps_its_rights_whatever_the_format():
    mesh = pamr.Mesh.kuhn_cube(COMM, 1)
    mesh.write("cube.hdf")
    for ending in WRITTEN:
        name = pathlib.Path(f"mine{ending}" if ending else "mine/constant/polyMesh")
        for mode in (0o600, 0o640, 0o444) if ending else (0o700, 0o750):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                mesh.write(f"mine{ending}")
                if COMM.rank == 0:
                    name.chmod(mode)
                COMM.barrier()
                mesh.write(f"mine{ending}")
            assert name.stat().st_mode & 0o777 == mode, (ending, oct(name.stat().st_mode))
            if COMM.size == 1 and mode in (0o600, 0o700):
                assert convert("cube.hdf", f"mine{ending}", "--force")[0] == 0 and name.stat().st_mode & 0o777 == mode, ending


@in_folder
def test_endings_that_are_not_read_or_not_known_have_one_message():
    readable = ", ".join(ending for ending, is_read in ENDINGS.items() if is_read and ending)
    not_read = [ending for ending, is_read in ENDINGS.items() if not is_read] + [".xyz", ".ugrid", ".r8.ugrid", ".h5"]
    assert ".vtp" in not_read and ".vtk" not in not_read and "" not in not_read
    for ending in not_read:
        message = error_of(lambda: pamr.Mesh.read(COMM, f"mesh{ending}"))
        assert message.startswith(f"file 'mesh{ending}': expected a name that ends in {readable}, found "), message
        assert COMM.size > 1 or convert(f"mesh{ending}", "x.hdf") == (2, f"pamr-convert: error: {message}\n")
    assert "found a surface: pamr-mesh" in error_of(lambda: pamr.Mesh.read(COMM, "mesh.off"))
    assert '".vtp": VTK PolyData is only written' in error_of(lambda: pamr.Mesh.read(COMM, "mesh.vtp"))
    assert "expected the folder of an OpenFOAM case, found none" in error_of(lambda: pamr.Mesh.read(COMM, "mesh"))
    mesh = pamr.Mesh.kuhn_cube(COMM, 1)
    mesh.write("cube.hdf")
    for ending in (".xyz", ".r8.ugrid"):
        message = error_of(lambda: mesh.write(f"x{ending}"))
        assert all(known in message for known in WRITTEN) and message.endswith("(an OpenFOAM case is a folder)"), message
        assert COMM.size > 1 or convert("cube.hdf", f"x{ending}") == (2, f"pamr-convert: error: {message}\n")


@in_folder
def test_endings_that_are_only_read_have_one_message():
    mesh = pamr.Mesh.kuhn_cube(COMM, 1)
    mesh.write("cube.hdf")
    for ending in sorted(set(ENDINGS) - set(WRITTEN)):
        message = error_of(lambda: mesh.write(f"x{ending}"))
        assert message.endswith(" is only read") and ".msh" in message, message
        assert COMM.size > 1 or convert("cube.hdf", f"x{ending}") == (2, f"pamr-convert: error: {message}\n")


def test_pictures_and_the_manual_know_every_ending():
    sys.path.insert(0, str(ROOT / "tools" / "picture"))
    import mesh_files
    for ending, is_read in ENDINGS.items():  # pamr-picture has readers of its own for what the others do not read
        assert is_read or ending in mesh_files.BY_VTK + mesh_files.BY_MESHIO, ending
    page = (ROOT / "docs" / "tools" / "pamr-convert.md").read_text(encoding="utf-8")
    assert all(f"`{ending}`" in page for ending in ENDINGS if ending)


run_tests(globals())
