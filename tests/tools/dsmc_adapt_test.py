#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-dsmc on a mesh that it adapts as it goes: the same bytes on any ranks and after restarts, and bad cases."""
import csv
import os
import pathlib

import h5py
import numpy as np

from tool_run import RANKS, kuhn_cube, of_full_level, refuses, run, run_tests, same_bytes

# A stream that is stopped by a mirror: a shock runs from xmin into the gas.
CASE = """
[species.Ar]
mass = 6.63e-26
diameter = 4.17e-10
omega = 0.81
t_ref = 273.0
[gas]
fractions = { Ar = 1.0 }
[stream.free]
density = 1e19
temperature = 300.0
velocity = [-650.0, 0.0, 0.0]
[boundary]
xmin = { kind = "specular" }
xmax = { kind = "inflow" }
ymin = { kind = "symmetry" }
ymax = { kind = "symmetry" }
zmin = { kind = "symmetry" }
zmax = { kind = "symmetry" }
[particles]
per_cell = 60.0
[domain]
unit = 1.0
[time]
step = 5e-5
[run]
window = 10
sampling = 60
"""
ADAPT = """
[adapt]
mark = "--size-over n_scale --ratio 0.15 --coarsen-below 0.1 --max-level 1 --keep-for 1"
max_cells = 900
"""


def write(name, text):
    pathlib.Path(name).write_text(text, encoding="ascii")
    return name


def compute(case, mesh, out, *more, **kwargs):
    return run("pamr-dsmc", case, "--mesh", mesh, "-o", out, "--force", *more, **kwargs)


def test_a_mesh_follows_a_shock_with_the_same_bytes_on_any_ranks():
    kuhn_cube("cube.hdf", 4)
    case = write("case.toml", CASE + ADAPT)
    options = ["--history", "h.csv", "--series", "w", "--checkpoint", "c", "--json", "-"]
    report = compute(case, "cube.hdf", "out.hdf", *options).json
    adaptation = report["adaptation"]
    assert adaptation["times"] == 5 and adaptation["removed_particles"] == 0, adaptation
    assert adaptation["octets_gone"] > 0 and 600 < adaptation["max_cells"] <= 900, adaptation
    assert report["lost_particles"] == 0
    # Particles that adaptation clones or removes do not count in the balance.
    assert report["balance"]["holds"] and report["balance"]["particles"]["unexplained"] == 0, report["balance"]
    with h5py.File("w-0000060.hdf") as last, h5py.File("out.hdf") as out:
        assert np.array_equal(last["VTKHDF/CellData/n"][:], out["VTKHDF/CellData/n"][:])  # the averages of the last window
        assert "parent" not in out["VTKHDF/CellData"]
        levels = out["PAMR/lineage"][:].astype(np.uint64) >> np.uint64(12) & np.uint64(0xFF)
        assert set(levels) == {0, 1}
    assert [path.name for path in sorted(pathlib.Path().glob("w-*"))] == [f"w-{step:07}.hdf" for step in range(10, 70, 10)]
    if RANKS == 1:
        return
    pathlib.Path("one").mkdir()
    alone = [option if option in ("-",) or option.startswith("--") else f"one/{option}" for option in options]
    compute(case, "cube.hdf", "one/out.hdf", *alone, serial=True)
    names = ["out.hdf", "h.csv", "c", "c-50.hdf"] + [f"w-{step:07}.hdf" for step in range(10, 70, 10)]
    for name in names:
        assert same_bytes(name, f"one/{name}"), f"{name} depends on the number of ranks"


@of_full_level
def test_levels_of_vibration_follow_the_mesh():
    kuhn_cube("cube.hdf", 4)
    hot = CASE[CASE.index("[gas]"):].replace("Ar = 1.0 }", "N2 = 0.5, NO = 0.5 }\nvibration = true").replace("300.0", "3000.0").replace(
        "-650.0", "-2500.0").replace('{ kind = "specular" }', '{ kind = "diffuse", temperature = 5000.0 }').replace("5e-5", "2e-5")
    case = write("case.toml", hot + ADAPT)
    report = compute(case, "cube.hdf", "one.hdf", "--checkpoint", "one", "--history", "one.csv", "--json", "-", serial=True).json
    assert report["adaptation"]["octets_gone"] > 0 and report["balance"]["holds"], report
    last = list(csv.DictReader(open("one.csv")))[-1]
    assert 3500 < float(last["T_vib"]) < float(last["T_tr"]), last
    compute(case, "cube.hdf", "part.hdf", "--steps", 33, "--checkpoint", "half")
    compute(case, "cube.hdf", "rest.hdf", "--restart", "half", "--checkpoint", "rest", "--history", "rest.csv")
    for one, rest in (("one.hdf", "rest.hdf"), ("one.csv", "rest.csv")):
        assert same_bytes(one, rest), one


def test_a_restart_goes_on_with_the_mesh_of_the_checkpoint():
    kuhn_cube("cube.hdf", 4)
    case = write("case.toml", CASE + ADAPT)
    compute(case, "cube.hdf", "whole.hdf", "--history", "whole.csv", "--checkpoint", "whole")
    for steps in (25, 30):  # within a window, and where the mesh is adapted next
        compute(case, "cube.hdf", "part.hdf", "--steps", steps, "--checkpoint", "whole_", "--every", 10)
        compute(case, "cube.hdf", "part.hdf", "--history", "part.csv", "--restart", "whole_", "--checkpoint", "whole_")
        assert same_bytes("part.hdf", "whole.hdf") and same_bytes("part.csv", "whole.csv"), steps
        assert same_bytes("whole_-50.hdf", "whole-50.hdf")
        # of the meshes on the way none is left but that of the last checkpoint
        assert [path.name for path in pathlib.Path().glob("whole_-*")] == ["whole_-50.hdf"]
    # The windows before the checkpoint are there already, and stay.
    compute(case, "cube.hdf", "part.hdf", "--steps", 25, "--checkpoint", "again", "--series", "w")
    before = pathlib.Path("w-0000020.hdf").read_bytes()
    run("pamr-dsmc", case, "--mesh", "cube.hdf", "-o", "rest.hdf", "--restart", "again", "--series", "w")
    assert same_bytes("rest.hdf", "whole.hdf") and pathlib.Path("w-0000020.hdf").read_bytes() == before
    assert len(list(pathlib.Path().glob("w-*"))) == 6
    refuses("pamr-dsmc", case, "--mesh", "cube.hdf", "-o", "no.hdf", "--series", "w", says=["w-0000010.hdf"],
            creates="no.hdf")
    write("still.toml", CASE)
    refuses("pamr-dsmc", "still.toml", "--mesh", "cube.hdf", "-o", "no.hdf", "--restart", "whole_",
            says=["expected a checkpoint of this mesh"], creates="no.hdf")
    # On the mesh of the checkpoint, too, neither how many particles to have nor what to adapt may change unseen.
    other = write("other.toml", (CASE + ADAPT).replace("per_cell = 60.0", "per_cell = 50.0"))
    refuses("pamr-dsmc", other, "--mesh", "cube.hdf", "-o", "no.hdf", "--restart", "whole_", creates="no.hdf",
            says=["particles.per_cell: the checkpoint has 60.0, the case 50.0", "--carry"])
    refuses("pamr-dsmc", "still.toml", "--mesh", "whole_-50.hdf", "-o", "no.hdf", "--restart", "whole_", says=["adapt.mark: "],
            creates="no.hdf")
    # MESH is not read by a restart, but it may not be just any one.
    kuhn_cube("else.hdf", 3)
    for mesh in ("else.hdf", "part.hdf"):
        refuses("pamr-dsmc", case, "--mesh", mesh, "-o", "no.hdf", "--restart", "whole_", creates="no.hdf",
                says=[f"--mesh {mesh}: expected the mesh that the run of whole_ began with"])
    compute(case, "whole_-50.hdf", "part.hdf", "--restart", "whole_")  # that of the checkpoint will do
    assert same_bytes("part.hdf", "whole.hdf")
    left = pathlib.Path("whole_-40.hdf.host-00000001-123-456-0.partial")  # of a run that was killed two days ago
    left.touch()
    os.utime(left, (0, 0))
    run("pamr-dsmc", case, "--mesh", "cube.hdf", "-o", "rest.hdf", "--force", "--restart", "whole_", "--checkpoint", "whole_", serial=True)
    assert not left.exists()
    pathlib.Path("whole_-50.hdf").unlink()
    refuses("pamr-dsmc", case, "--mesh", "cube.hdf", "-o", "no.hdf", "--restart", "whole_", says=["whole_-50.hdf"],
            creates="no.hdf")


# A gas between two walls, at rest in the mean: no particle enters or leaves.
PLATES = """
[species.X]
mass = 6.63e-26
diameter = 4e-10
omega = 0.81
t_ref = 300.0
[gas]
fractions = { X = 1.0 }
[stream.free]
density = 1e22
temperature = 300.0
[boundary]
xmin = { kind = "diffuse", temperature = 200.0 }
xmax = { kind = "diffuse", temperature = 450.0 }
ymin = { kind = "specular" }
ymax = { kind = "specular" }
zmin = { kind = "specular" }
zmax = { kind = "specular" }
[particles]
per_cell = 24.0
[domain]
unit = 7.5e-4
[time]
step = 3.5e-8
[reference]
area = 1.0
patches = ["xmin"]
[run]
seed = 2
transient = 0
"""
# With a few particles a cell the density of a window is mostly noise, so cells are split and coarsened all the time.
RESTLESS = """
[adapt]
mark = "--size-over n_scale --ratio 0.2 --coarsen-below 0.15 --max-level 1"
"""


def test_adapting_after_any_number_of_steps_changes_neither_collisions_nor_heat():
    if RANKS > 1:
        return  # the same bytes as on one rank, as the test of the shock shows
    kuhn_cube("cube.hdf", 3)
    found = {}
    for window, steps in ((None, 1500), (20, 1500), (4, 900), (1, 500)):
        text = PLATES + f"sampling = {steps}\n" + (f"window = {window}\n{RESTLESS}" if window else "block = 20\n")
        report = compute(write("case.toml", text), "cube.hdf", "out.hdf", "--history", "h.csv", "--json", "-").json
        with open("h.csv", encoding="ascii") as file:
            rows = [row for row in csv.DictReader(file) if int(row["step"]) > 100]
        found[window] = [np.mean([float(row[key]) for row in rows]) for key in ("collisions_per_particle_step", "C_H")]
        assert not window or report["adaptation"]["octets_gone"] > 100, report["adaptation"]
    collisions, heat = found[None]
    for window in (20, 4, 1):  # standard errors are 0.4 % and 3 % at most
        assert abs(found[window][0] / collisions - 1) < 0.02, (window, found)
        assert abs(found[window][1] / heat - 1) < 0.12, (window, found)


def test_adapting_where_nothing_is_marked_changes_no_bit():
    kuhn_cube("cube.hdf", 3)
    text = PLATES + "sampling = 60\nwindow = 4\n"
    compute(write("still.toml", text), "cube.hdf", "still.hdf", "--history", "still.csv")
    compute(write("case.toml", text + '[adapt]\nmark = "--box 9,9,9,9,9,9"\n'), "cube.hdf", "out.hdf", "--history", "h.csv")
    assert same_bytes("h.csv", "still.csv")


def test_cases_that_cannot_be_adapted_are_refused():
    kuhn_cube("cube.hdf", 2)
    for old, new, says in (
            ("window = 10\n", "transient = 5\n", "expected window in [run]"),
            ("[adapt]\n", "[adapt]\nevery = 15\n", "a multiple of window in [run] (10)"),
            ("window = 10\n", "window = 10\nblock = 3\n", "a multiple of block (3)"),
            ("--size-over n_scale", "--size-above n_scale", '"--size-above"'),
            ("--size-over n_scale", "--size-over n_length", "n_length"),
            ('ymin = { kind = "symmetry" }\nymax = { kind = "symmetry" }',
             'ymin = { kind = "periodic", partner = "ymax" }\nymax = { kind = "periodic", partner = "ymin" }',
             "no periodic patches beside [adapt]")):
        text = (CASE + ADAPT).replace(old, new)
        assert text != CASE + ADAPT
        refuses("pamr-dsmc", write("bad.toml", text), "--mesh", "cube.hdf", "-o", "no.hdf", says=["bad.toml", says],
                creates="no.hdf")
    still = write("still.toml", CASE.replace("window = 10\n", "transient = 5\n"))
    refuses("pamr-dsmc", still, "--mesh", "cube.hdf", "-o", "no.hdf", "--series", "w", says=["window"], creates="no.hdf")


run_tests(globals())
