# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-picture: what it refuses and says, and its files: complete or not there, whatever happens."""
import contextlib
import dataclasses
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import stat
import subprocess
import sys
import time

import h5py
import numpy as np

from picture_tool_test import cubes, near, pixels
from tool_run import BIN, LIMIT, add_cell_field, kuhn_cube, of_full_level, refuses, run, run_tests


def test_wrong_words_are_one_clear_message():
    coarse, _ = cubes()
    pathlib.Path("there.png").write_text("mine")

    for arguments, says in (
            (["--feild", "x"], "unknown option --feild; did you mean --field?"),
            (["--cut", "w=3"], "expected x, y, z or three numbers"),
            (["--size", "big"], "expected WIDTHxHEIGHT"),
            (["--range", "2,1", "--field", "x"], "expected two rising numbers"),
            (["--whole-cells"], "expected --cut"),
            (["--whole-cells", "--cut", "x=0.5", "--cells", "x<1"], "--cells: expected no --whole-cells"),
            (["--cells", "x=1"], "expected a field, < or >, and a number"),
            (["--cells", "x<nan"], "--cells: expected a number, found 'nan'"),
            (["--mirror", "q"], "expected some of the letters x, y, z"),
            (["--zoom", "1", "--zoom", "2"], "one for each of the 1")):
        refuses("pamr-picture", coarse, "-o", "p.png", *arguments, says=[says], creates="p.png")
    refuses("pamr-picture", coarse, "-o", "p.pdf", says=["p.pdf", ".png"], creates="p.pdf")
    refuses("pamr-picture", coarse, "-o", "there.png", says=["--force"])
    refuses("pamr-picture", coarse, "-o", coarse + ".png/p.png", says=["existing folder"])
    assert pathlib.Path("there.png").read_text() == "mine"


@of_full_level
def test_names_that_are_not_there_are_one_clear_message():
    coarse, _ = cubes()
    pathlib.Path("bad.hdf").write_text("no mesh")
    pathlib.Path("bad.vtu").write_text("no mesh")

    for arguments, says in (
            ([coarse, "--field", "temprature"], "unknown field 'temprature'; there are height, level, mean_ratio"),
            ([coarse, "--field", "u:3"], "expected a component from 0 to 2"),
            ([coarse, "--patch", "wall"], "unknown patch 'wall'; there are xmax, xmin"),
            ([coarse, "--patch", "w*"], "unknown patch 'w*'; there are xmax, xmin"),
            ([coarse, "--cells", "quality<1"], "unknown field 'quality'"),
            ([coarse, "--cells", "level>3"], "expected something to draw"),
            ([coarse, "--cut", "y=7"], "the mesh has y from 0 to 1"),
            ([coarse, "--streamlines", "x"], "expected a field with 3 components"),
            ([coarse, "--isolines", "3"], "expected a field with numbers"),
            ([coarse, "--smooth", "3", "--field", "patch"], "expected a field with numbers"),
            ([coarse, "--edges", "--no-edges"], "--edges or --no-edges"),
            (["missing.hdf"], "found nothing of that name"),
            (["bad.hdf"], "expected a native mesh"),
            (["bad.vtu"], "bad.vtu': expected a file of VTK")):
        refuses("pamr-picture", *arguments, "-o", "p.png", says=[says], creates="p.png")


def error_of(function, *arguments):
    """The words with which it is refused; in this process, which is quick."""
    from refused import Refused
    try:
        function(*arguments)
    except Refused as wrong:
        return str(wrong)
    raise AssertionError((arguments, "not refused"))


def test_options_that_would_be_ignored_are_refused_with_both_names():
    import command_line
    field, patch = ["--field", "size"], ["--field", "patch"]
    for words, says in (
            (["--edges", "--no-edges"], "expected --edges or --no-edges, found both"),
            (["--cut", "x=1", "--cut", "y=0"], "--cut: expected one, found 'x=1' and 'y=0'"),
            (["-o", "q.png"], "-o: expected one, found 'p.png' and 'q.png'"),
            (["--cut", ""], "--cut: expected a plane such as y=0.2 or 1,1,0=0.2, found ''"),
            (["--cells", ""], "--cells: expected a field, < or >, and a number"),
            ([*field, "--range", ""], "--range: expected 2 numbers"),
            (["--up", ""], "--up: expected"),
            ([*field, "--log", "--isolines", "-1,2"], "--isolines: expected values above 0 with --log, found -1"),
            ([*patch, "--cut", "x=1"], "--field patch: expected --patch beside --cut, "),
            ([*patch, "--cells", "size<1"], "--field patch: expected --patch beside --cells, "),
            *(([*words, *others], f"{words[0]}: expected a field with numbers (--field), found {what}")
              for words in (["--scale", "1"], ["--map", "viridis"], ["--smooth", "0"], ["--title", ""], ["--log"])
              for others, what in (([], "none"), (patch, "patch"))),
            ([*field, "--scale", "big"], "--scale: expected a number, found 'big'"),
            ([*field, "--smooth", "1.5"], "--smooth: expected a whole number, found '1.5'")):
        error = error_of(command_line.read, ["m.hdf", "-o", "p.png", *words], "0")
        assert says in error, (words, error)
    assert command_line.read(["-o", "p.png", "--", "-m.hdf"], "0").meshes == ["-m.hdf"]
    o = command_line.read(["a.hdf", "-o", "p.png", "b.hdf", "--field", "patch", "--cut", "x=1", "--patch", "all"], "0")
    assert (o.meshes, o.scale, o.map, o.smooth) == (["a.hdf", "b.hdf"], 1, "viridis", None), o


def test_damaged_meshes_are_bad_input():
    import mesh_files
    import values
    kuhn_cube("sound.hdf", 1)
    nodes, points, neighbors = "VTKHDF/Connectivity", "VTKHDF/Points", "PAMR/cell_to_cell"
    damages = ((nodes, np.full(24, 8)), (nodes, np.full(24, -1)), (nodes, np.arange(7)), (nodes, np.empty(0, int)),
               (points, np.zeros((8, 2))), (points, np.full((8, 3), np.nan)), (neighbors, np.zeros(9, int)),
               (neighbors, np.full((6, 4), -99)), ("PAMR/lineage", np.zeros(3, "u8")))
    fields = (np.zeros(7), np.full(6, b"a"), np.zeros((6, 3, 3)), np.zeros(6, complex), 3.0)
    for i, (name, data) in enumerate(damages + tuple((f"VTKHDF/CellData/q{k}", data) for k, data in enumerate(fields))):
        shutil.copy("sound.hdf", "bad.hdf")
        with h5py.File("bad.hdf", "r+") as file:
            if name in file:
                del file[name]
            file[name] = data
        if i < len(damages):
            assert error_of(mesh_files.read, "bad.hdf").startswith("bad.hdf: expected "), name
        else:
            error = error_of(values.values_of, mesh_files.read("bad.hdf"), name[-2:])
            assert f"field '{name[-2:]}': expected 6 rows of real numbers, found " in error, error


def children_of(pid):
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        return file.read().split()


def test_an_interrupt_says_so_and_leaves_nothing():
    coarse, _ = cubes()
    process = subprocess.Popen([str(BIN / "pamr-picture"), coarse, "-o", "p.png"], stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + LIMIT
    while not children_of(process.pid) and time.monotonic() < until:  # it draws when it has started its screen
        time.sleep(0.01)

    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=LIMIT)

    assert process.returncode == 6 and error == "pamr-picture: interrupted: outputs that were not complete are removed\n", (process.returncode, error)
    assert os.listdir(".") == [], os.listdir(".")


def in_child(function):
    """The exit code of a process that calls it."""
    child = os.fork()
    if child == 0:
        try:
            function()
        finally:
            os._exit(99)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def test_closed_streams_lose_nothing():
    import files
    import picture
    pathlib.Path("p.partial").touch()

    def interrupted_where_nobody_reads():
        reading, writing = os.pipe()
        os.close(reading)
        os.dup2(writing, 2)
        files.unfinished.append("p.partial")
        picture.interrupt(signal.SIGINT, None)

    def opens_a_file():
        os.close(0)
        os.close(2)
        files.keep_standard_streams()
        os._exit(os.open("new", os.O_CREAT | os.O_WRONLY) < 3)

    def report_without_output():
        sys.stdout = None
        error = error_of(picture.say, "{}", True)
        picture.say("done")  # where nobody listens
        os._exit(2 if error == "standard output: the report cannot be written" else 1)

    assert in_child(interrupted_where_nobody_reads) == 6 and not os.path.exists("p.partial")
    assert in_child(opens_a_file) == 0, "what is said would be in the file"
    assert in_child(report_without_output) == 2
    for option in ("--help", "--version"):
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([BIN / "pamr-picture", option], stdout=full, stderr=subprocess.PIPE, timeout=LIMIT)
        assert done.returncode == 2 and done.stderr.startswith(b"pamr-picture: error: standard output: not all "), done


def test_writes_fail_with_the_words_of_all_tools_and_leave_nothing():
    import files
    os.symlink("/dev/full", "full.png")
    refuses("pamr-picture", kuhn_cube("m.hdf", 1), "-o", "full.png", says=["full.png: expected a regular file"])
    error = error_of(files.write_whole, "none/p.png", b"new")
    assert error == "file 'none/p.png': cannot create it: No such file or directory", error
    pathlib.Path("old").write_bytes(b"old")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5, limit[1]))
    error = error_of(files.write_whole, "old", b"new and long")
    resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert error == "file 'old': cannot write it: File too large" and pathlib.Path("old").read_bytes() == b"old", error
    assert sorted(os.listdir()) == ["full.png", "m.hdf", "old"], os.listdir()
    files.remove_leftovers("none/p.png", [])  # in a folder that cannot be listed


def test_names_of_any_bytes_are_drawn_and_reported():
    name = os.fsdecode(b"n\xff$\\frac$\n.hdf")
    kuhn_cube(name, 1)
    with h5py.File(name, "r+") as file:
        file["PAMR/patches/names"][0] = "\u03bb"
    os.environ.update(LC_ALL="POSIX", PYTHONUTF8="0", PYTHONCOERCECLOCALE="0")  # letters of ASCII alone

    done = run("pamr-picture", name, "-o", "p.png", "--size", "300x300", "--field", "patch", "--quiet", "--json",
               "r.json")

    report = json.loads(pathlib.Path("r.json").read_text(encoding="utf-8"))
    assert done.err == "" and report["report"]["inputs"] == ["n\ufffd$\\frac$\n.hdf"], (done.err, report)
    assert "\u03bb" in report["meshes"][0]["patches"], report


def test_messages_of_pamr_convert_keep_the_bytes_of_names():
    import mesh_files
    os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"
    name = os.fsdecode(b"n\xff\xe2\x80\xa8b.msh")  # also a separator of lines of Unicode
    pathlib.Path(name).write_text("no mesh")
    error = error_of(mesh_files.read, name)
    assert error.startswith(f"pamr-convert: file '{name}', line 1: expected a Gmsh file"), ascii(error)
    import files
    assert files.one_line(f"{name}\ud800\n") == name + "\\ud800\\n" and files.as_unicode("\udfff") == "\\udfff"


@of_full_level
def test_a_summary_arrives_or_is_an_error_and_a_replaced_picture_keeps_its_rights():
    import picture
    program = f"import sys; sys.path.append({str(pathlib.Path(picture.__file__).parent)!r}); import picture; picture.say('done')"
    with open("/dev/full", "w", encoding="ascii") as full:
        done = subprocess.run([sys.executable, "-c", program], stdout=full, stderr=subprocess.PIPE, text=True, timeout=LIMIT)
    assert done.returncode == 1 and "Refused: standard output: not all that was printed" in done.stderr, done.stderr
    pathlib.Path("a.png").touch(mode=0o600)
    owner = (1234, 1235) if os.getuid() == 0 else (os.getuid(), os.getgid())
    os.chown("a.png", *owner)
    picture.write_whole("a.png", b"new")
    made = os.stat("a.png")
    assert pathlib.Path("a.png").read_bytes() == b"new" and stat.S_IMODE(made.st_mode) == 0o600 and (made.st_uid, made.st_gid) == owner


def test_temporary_files_have_the_names_of_all_tools():
    import files
    coarse, _ = cubes()
    ours = files.unfinished_name("p.png")
    assert re.fullmatch(r"p\.png\.[-\w]+-[0-9a-f]{8}-\d+-\d+-\d+\.partial", ours)
    tail = ours.rsplit("-", 3)[0]  # of this machine
    dead, alive, another = f"{tail}-{2**22 + 1}-7-0.partial", ours, f"q{tail[1:]}-{2**22 + 1}-7-0.partial"
    for name in (dead, alive, another, dead.replace("p.png", "m.hdf")):
        pathlib.Path(name).touch()
    for command in (["pamr-mesh", "--shape", "kuhn-cube", "--n", 1, "-o", "m.hdf"],  # knows the name that Python has made
                    ["pamr-picture", coarse, "-o", "p.png"]):
        with contextlib.suppress(AssertionError):  # of files that are left on purpose
            run(*command, "--quiet")
    assert sorted(name for name in os.listdir(".") if name.endswith(".partial")) == sorted([alive, another])
    for name in (alive, another):
        os.unlink(name)


def test_an_error_after_the_picture_names_it():
    coarse, _ = cubes()
    result = run("pamr-picture", coarse, "-o", "p\n.png", "--json", "/dev/full", code=2)
    assert result.err == "pamr-picture: error: /dev/full: cannot be written: No space left on device; complete: 'p\\n.png'\n", result.err


def test_values_without_a_place_on_the_scale_are_counted():
    kuhn_cube("n.hdf", 2)
    add_cell_field("n.hdf", "v", np.where(np.arange(48) < 3, (np.nan, np.inf, -np.inf) * 16, np.arange(48.0) - 5))
    add_cell_field("n.hdf", "u", np.where(np.arange(144).reshape(48, 3) < 9, np.nan, 1.0))  # VTK's tracer would crash
    for options, words in ((("--streamlines", "u", "--cut", "z=0.4", "--patch", "all"),
                            ["--streamlines u: 3 of 48 values are not finite and taken as 0",
                             "3 of 48 values are not finite and drawn in gray"]),
                           (("--log",), ["3 of 48 values are not finite", "3 of 48 values are not above 0"])):
        said = run("pamr-picture", "n.hdf", "-o", "v.png", "--field", "v", "--size", "500x500", "--force", *options).err
        assert len(said.splitlines()) == len(words) and all(word in said for word in words), said
    image, gray = pixels("v.png"), (191, 191, 191)
    assert near(image[:-34], gray) > 500 and near(image[-34:], gray, 2) > 50, "no legend"


def test_lines_are_drawn_beside_gaps_and_of_mirror_images():
    import flow_lines
    import mesh_files
    import panel
    from view import CUT_VIEWS, Plane, view_of
    mesh = mesh_files.read(cubes()[0])
    x = mesh.points[:, 0]
    mesh.node_fields["gap"] = np.where(x > 0.9, np.nan, x)
    mesh.node_fields["v"] = np.column_stack([x, np.ones(len(x)), 0 * x])
    mesh.node_fields["still"] = np.zeros((len(x), 3))
    wish = panel.Wish(cut=Plane(np.array([0, 0, 1.0]), 0.4), field="gap", isolines=[0.4], mirror="x", streamlines="v")

    data = panel.Subject(mesh, wish).pieces()[0][0]

    lines = panel.shapes.isolines(data, "smooth", [0.4])
    points = panel.vtk_to_numpy(lines.GetPoints().GetData())
    assert len(points) and np.abs(np.abs(points[:, 0]) - 0.4).max() < 1e-6, points
    at, vectors = panel.vtk_to_numpy(data.GetPoints().GetData()), panel.shapes.array(data.GetPointData(), "vector")
    assert np.abs(vectors[:, 0] - at[:, 0]).max() < 1e-6, "vectors of the image are not those of the mirror"
    view = view_of(*CUT_VIEWS["z"])
    found = panel.vtk_to_numpy(flow_lines.in_plane(data, "vector", view, 2.0).GetPoints().GetData())[:, 0]
    assert found.min() < -0.3 and found.max() > 0.3, "lines in one half only"
    still = panel.Subject(mesh, dataclasses.replace(wish, streamlines="still")).pieces()[0][0]
    assert flow_lines.in_plane(still, "vector", view, 2.0).GetNumberOfCells() == 0


def test_a_report_goes_into_a_pipe_which_stays():
    coarse, _ = cubes()
    os.mkfifo("pipe")
    reader = subprocess.Popen(["cat", "pipe"], stdout=subprocess.PIPE, text=True)
    try:
        run("pamr-picture", coarse, "-o", "p.png", "--json", "pipe", "--quiet")
        text, _ = reader.communicate(timeout=LIMIT)
    finally:
        reader.kill()
    assert json.loads(text)["picture"] == "p.png" and stat.S_ISFIFO(os.stat("pipe").st_mode)


if __name__ == "__main__":
    cubes()
    run_tests(globals(), at_once=2)
