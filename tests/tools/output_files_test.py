# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of outputs when several runs write one, when names look like temporary ones, and what messages say of strange files."""
import ctypes
import glob
import os
import pathlib
import subprocess

import h5py
import numpy as np

from tool_run import BIN, FULL, LAUNCHER, LIMIT, RANKS, kuhn_cube, refuses, run, run_tests, same_bytes


def command(tool, *arguments):
    return LAUNCHER + [str(BIN / tool)] + [str(a) for a in arguments]


def test_runs_at_the_same_time_do_not_disturb_each_other():
    kuhn_cube("crowd.hdf", 2)
    for _ in range(4 if FULL else 2):
        jobs = [subprocess.Popen(command("pamr-mark", "crowd.hdf", "-o", f"crowd{i}.hdf", "--all", "--force", "--quiet"),
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for i in range(8 // RANKS + 1)]
        for job in jobs:
            out, err = job.communicate(timeout=LIMIT)
            assert job.returncode == 0 and not err, (job.returncode, err)
    assert all(same_bytes("crowd0.hdf", f"crowd{i}.hdf") for i in range(1, 8 // RANKS + 1))


def test_two_writers_of_one_output_leave_the_output_of_one_of_them():
    kuhn_cube("a.hdf", 6)
    kuhn_cube("b.hdf", 9)
    for name in "ab":
        run("pamr-mark", f"{name}.hdf", "-o", f"{name}m.hdf", "--all", "--quiet")
        run("pamr-refine", f"{name}m.hdf", "-o", f"{name}1.hdf", "--quiet")
        run("pamr-convert", f"{name}1.hdf", f"{name}1.vtu", "--quiet")
        run("pamr-convert", f"{name}1.hdf", f"{name}1.msh", "--quiet")
        run("pamr-convert", f"{name}1.hdf", f"{name}1", "--quiet")
    for _ in range(3 if FULL else 1):
        for output in ("out.hdf", "out.vtu", "out.msh", "out"):
            ending = pathlib.Path(output).suffix
            tool = ("pamr-refine", "{}m.hdf", "-o") if ending == ".hdf" else ("pamr-convert", "{}1.hdf")
            jobs = [subprocess.Popen(command(*[word.format(name) for word in tool], output, "--force", "--quiet"),
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for name in "ab"]
            for job in jobs:
                out, err = job.communicate(timeout=LIMIT)
                assert job.returncode == 0, err
            if ending:
                assert same_bytes(output, "a1" + ending) or same_bytes(output, "b1" + ending), output
            else:
                files = {name: sorted(os.listdir(f"{name}/constant/polyMesh")) for name in ("out", "a1", "b1")}
                assert files["out"] == files["a1"] == files["b1"], files
                assert any(all(same_bytes(f"out/constant/polyMesh/{file}", f"{name}/constant/polyMesh/{file}")
                               for file in files["out"]) for name in ("a1", "b1"))
                assert os.listdir("out/constant") == ["polyMesh"]
            assert not glob.glob("**/*.partial", recursive=True)


def test_what_a_killed_run_left_of_its_files_does_not_stop_later_ones():
    # The semaphore that Open MPI 4.1 makes for a file and names after it alone, locked by a process that is no more.
    kuhn_cube("killed.hdf", 2)
    system = ctypes.CDLL(None, use_errno=True)
    system.sem_open.restype = ctypes.c_void_p
    assert system.sem_open(b"/OMPIO_killed.hdf", os.O_CREAT, 0o600, 0), os.strerror(ctypes.get_errno())
    try:
        run("pamr-mark", "killed.hdf", "-o", "marked.hdf", "--all")
    finally:
        system.sem_unlink(b"/OMPIO_killed.hdf")


def test_paths_may_be_long():
    folder = os.path.join(*["x" * 200] * 3)
    os.makedirs(folder)
    kuhn_cube(os.path.join(folder, "cube.hdf"), 2)
    run("pamr-mark", os.path.join(folder, "cube.hdf"), "-o", os.path.join(folder, "marked.hdf"), "--all")


def test_names_that_look_like_temporary_ones_are_as_good_as_any():
    kuhn_cube("cube.hdf", 3)
    os.makedirs("case/constant/polyMesh.partial")
    os.makedirs("case/constant/polyMesh.old")
    pathlib.Path("precious").write_text("precious")
    os.symlink("precious", "x.vtu.partial")
    os.rename("cube.hdf", "q.hdf.partial")
    before = pathlib.Path("q.hdf.partial").read_bytes()
    # not by `run`, which takes such names for what a run has left
    for job in (("pamr-mark", "q.hdf.partial", "-o", "q.hdf", "--all"), ("pamr-convert", "q.hdf", "x.vtu"),
                ("pamr-convert", "q.hdf", "case")):
        done = subprocess.run(command(*job, "--quiet"), capture_output=True, text=True, timeout=LIMIT)
        assert done.returncode == 0, done.stderr
    assert pathlib.Path("q.hdf.partial").read_bytes() == before
    assert pathlib.Path("precious").read_text() == "precious" and os.path.islink("x.vtu.partial")
    assert sorted(os.listdir("case/constant")) == ["polyMesh", "polyMesh.old", "polyMesh.partial"]


def test_control_characters_of_a_file_do_not_reach_the_terminal():
    kuhn_cube("cube.hdf", 1)
    run("pamr-convert", "cube.hdf", "cube.msh", "--text", "--gmsh-version", "2.2", "--quiet")
    lines = pathlib.Path("cube.msh").read_bytes().split(b"\n")
    lines[lines.index(b"$PhysicalNames") + 2] = b"2 1 \x1b[31mred\r no quotes"
    pathlib.Path("wild.msh").write_bytes(b"\n".join(lines))
    refuses("pamr-convert", "wild.msh", "x.hdf", says=(r"\x1b[31mred\x0d no quotes",), creates="x.hdf")
    refuses("pamr-quality", "no\nsuch\x1b file.hdf", says=(r"no\nsuch\x1b file.hdf",))


# Lineage of a regular cell of a level whose ancestors are not known, as /PAMR/lineage of format 2 has it.
LEVEL_SHIFT, MAX_LEVEL = 12, 255


def at_levels(source, target, level_of):
    """The mesh with other levels; its checksum, which is then stale, goes."""
    pathlib.Path(target).write_bytes(pathlib.Path(source).read_bytes())
    with h5py.File(target, "r+") as file:
        levels = level_of(np.arange(len(file["PAMR/lineage"])))
        file["PAMR/lineage"][:] = levels << LEVEL_SHIFT
        for name in list(file["PAMR/checksums"].attrs):
            if "lineage" in name:
                del file["PAMR/checksums"].attrs[name]
    return target


def test_the_deepest_level_is_told_by_all_tools_alike():
    mesh = at_levels(kuhn_cube("cube.hdf", 4), "deep.hdf", lambda cell: np.where(cell < 8, MAX_LEVEL, 0))
    out = run("pamr-mark", mesh, "-o", "m.hdf", "--box", "0,0,0,0,0,0", "--quiet", "--json", "-")
    assert out.json["marked_too_deep"] == 0
    out = run("pamr-mark", mesh, "-o", "m.hdf", "--all", "--quiet", "--force", code=2)
    assert "the deepest there is" in out.err, out.err  # the marks around them would split them
    mesh = at_levels("cube.hdf", "deep.hdf", lambda cell: np.full(len(cell), MAX_LEVEL))
    out = run("pamr-mark", mesh, "-o", "m.hdf", "--all", "--quiet", "--force", "--json", "-")
    n = out.json["cells"]
    assert out.json["marked_too_deep"] == n and out.json["marked"] == 0 and out.json["cells_after"] == n, out.out
    assert f"{n} marked cells were left out: level {MAX_LEVEL} is the deepest there is" in out.err, out.err
    with h5py.File("m.hdf", "r+") as file:  # marks of a solver of one's own
        file["VTKHDF/CellData/refine"][:] = 1
        for name in list(file["PAMR/checksums"].attrs):
            if "refine" in name:
                del file["PAMR/checksums"].attrs[name]
    for arguments in (("--dry-run",), ("-o", "r.hdf")):
        out = run("pamr-refine", "m.hdf", *arguments, "--quiet", "--json", "-")
        assert out.json["marked_too_deep"] == n and out.json["marked"] == 0 and out.json["cells_out"] == n, out.out
        assert f"{n} marked cells were left out" in out.err, out.err


if __name__ == "__main__":
    print(f"{RANKS} ranks")
    run_tests(globals(), at_once=2, on_ranks=(test_two_writers_of_one_output_leave_the_output_of_one_of_them,
                                              test_runs_at_the_same_time_do_not_disturb_each_other,
                                              test_what_a_killed_run_left_of_its_files_does_not_stop_later_ones))
