# SPDX-License-Identifier: GPL-3.0-or-later
"""Input files on which HDF5 1.10 or OpenCASCADE dies are refused like any bad file, on any number of ranks, wherever they are named; and no
tool forks once MPI runs in it."""
import os
import pathlib
import shutil

import h5py

from gas_cases import gas_in_a_cube
from tool_run import BIN, bare_copy, kuhn_cube, refuses, run, run_tests

TESTS = pathlib.Path(__file__).resolve().parent.parent
CONE = TESTS / "unit" / "geometry" / "data" / "cone.iges"
PLATE = TESTS.parent / "cases" / "plate" / "cube.toml"
SURFACE = '[[surface]]\nname = "cone"\nkind = "cad"\nfile = "cone.iges"\nfaces = [1]\n'


def write(name, text):
    pathlib.Path(name).write_text(text, encoding="ascii")
    return name


def with_bytes(source, target, place, new):
    contents = bytearray(pathlib.Path(source).read_bytes())
    contents[place:place + len(new)] = new
    pathlib.Path(target).write_bytes(contents)
    return target


def dead_file(name="dead.hdf"):
    """The list of the names in a group lies nowhere: HDF5 1.10 takes the address for one in memory."""
    bare_copy(kuhn_cube("cube.hdf", 2), "bare.hdf")
    node = pathlib.Path("bare.hdf").read_bytes().index(b"TREE\0")
    return with_bytes("bare.hdf", name, node + 32, b"\xff" * 8)


def chunked_copy(source, target):
    bare_copy(source, target)
    with h5py.File(target, "r+") as file:
        points = file["VTKHDF/Points"][:]
        del file["VTKHDF/Points"]
        file["VTKHDF"].create_dataset("Points", data=points, chunks=(7, 3), compression="gzip")
    return target


def dead_chunks(name):
    """The list of the chunks of a dataset is a part of itself: HDF5 1.10 follows it until its stack is full."""
    chunked_copy(kuhn_cube("cube.hdf", 2), "chunked.hdf")
    node = pathlib.Path("chunked.hdf").read_bytes().index(b"TREE\1")
    with_bytes("chunked.hdf", name, node + 5, b"\1")
    return with_bytes(name, name, node + 56, node.to_bytes(8, "little"))


def dead_cone(name="cone.iges"):
    text = CONE.read_text()
    assert "514,2,5,1,33" in text
    return write(name, text.replace("514,2,5,1,33", "514,2,0,1,33"))


def has(tool):
    return (BIN / tool).exists()


def where_hdf5_dies(*says):
    """The words where it does, as 1.10; later versions find the damage and say where."""
    return says if "HDF5 1.10" in run("pamr-quality", "--version", serial=True).out else ("HDF5",)


def test_a_mesh_on_which_hdf5_dies():
    dead = dead_file()
    says = [f"'{dead}'", *where_hdf5_dies("expected a sound HDF5 file", "HDF5 failed on it")]
    refuses("pamr-quality", "cube.hdf", dead, says=says)
    refuses("pamr-diff", "cube.hdf", dead, says=says)
    refuses("pamr-mark", dead, "-o", "out.hdf", "--all", says=says, creates="out.hdf")
    refuses("pamr-refine", dead, "-o", "out.hdf", says=says, creates="out.hdf")
    refuses("pamr-partition", dead, "-o", "out.hdf", "-p", "2", says=says, creates="out.hdf")
    refuses("pamr-convert", dead, "out.vtu", says=says, creates="out.vtu")
    for tool, case in (("pamr-dsmc", write("case.toml", gas_in_a_cube())), ("pamr-pb", PLATE)):
        if has(tool):
            refuses(tool, case, f"--mesh={dead}", "-o", "out.hdf", says=says, creates="out.hdf")
    run("pamr-mark", "cube.hdf", "-o", dead, "--all", "--force", "--quiet")  # as an output it does no harm


def test_chunks_on_which_hdf5_dies():
    refuses("pamr-quality", dead_chunks("dead.hdf"), says=["'dead.hdf'", *where_hdf5_dies("HDF5 failed on it")])
    refuses("pamr-convert", "dead.hdf", "out.msh", says=["'dead.hdf'"], creates="out.msh")


def test_the_mesh_of_a_checkpoint_on_which_hdf5_dies():
    if not has("pamr-dsmc"):
        return
    case = write("case.toml", gas_in_a_cube(transient=5, end='window = 5\n[adapt]\nmark = "--all --max-level 0"\n'))
    run("pamr-dsmc", case, "--mesh", kuhn_cube("level0.hdf", 2), "-o", "flow.hdf", "--checkpoint", "a.ck", "--quiet", serial=True)
    mesh, = pathlib.Path(".").glob("a.ck-*.hdf")
    shutil.move(dead_file(), mesh)
    for out in (["-o", "more.hdf"], ["--plan"]):
        refuses("pamr-dsmc", case, "--mesh", "level0.hdf", "--restart", "a.ck", *out, creates="more.hdf",
                says=[mesh.name, *where_hdf5_dies("HDF5 failed on it")])


def test_a_shape_on_which_opencascade_dies():
    dead_cone()
    if "a build of PAMR with OpenCASCADE" in run("pamr-mesh", "cone.iges", "-o", "out.hdf", code=2, serial=True).err:
        return
    says = ["'cone.iges'", "expected a sound shape", "OpenCASCADE failed on it"]
    refuses("pamr-mesh", "cone.iges", "-o", "out.hdf", says=says, creates="out.hdf")
    write("case.toml", '[mesh]\nshape = "surfaces"\nlength_unit = "mm"\nregion = "-cone"\n' + SURFACE)
    refuses("pamr-mesh", "case.toml", "-o", "out.hdf", says=says, creates="out.hdf")
    kuhn_cube("cube.hdf", 2)
    refuses("pamr-convert", "cube.hdf", "out.hdf", "--cad", "cone.iges", says=says, creates="out.hdf")
    refuses("pamr-convert", "cube.hdf", "out.hdf", "--surfaces", "case.toml", says=says, creates="out.hdf")


def test_no_tool_forks_once_mpi_runs():
    watch = os.environ["PAMR_FORK_WATCH"]
    assert os.path.exists(watch), watch
    chunked_copy(kuhn_cube("cube.hdf", 2), "chunked.hdf")
    os.environ["LD_PRELOAD"] = watch  # of the process of this test
    run("pamr-mark", "chunked.hdf", "-o", "marked.hdf", "--all", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    run("pamr-convert", "fine.hdf", "fine.msh", "--quiet")
    run("pamr-quality", "fine.hdf", "--json", "quality.json", "--quiet")
    if has("pamr-dsmc"):
        run("pamr-dsmc", write("case.toml", gas_in_a_cube()), "--mesh", "cube.hdf", "-o", "flow.hdf", "--steps", "5", "--quiet")
    shutil.copy(CONE, "cone.iges")
    run("pamr-mesh", "cone.iges", "-o", "cone.hdf", "--quiet")


if __name__ == "__main__":
    run_tests(globals())
