# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that other programs wrote, and fields that they rewrote."""
import os
import subprocess
import sys

import h5py
import numpy as np

from tool_run import BIN, LAUNCHER, RANKS, kuhn_cube, refuses, run, run_tests

FOURTH_OF_THE_CUBES = 12


def as_dolfinx(source, target, n_steps=0):
    """The layout of dolfinx 0.10 and later (cpp/dolfinx/io/VTKHDF.h): version 2.2 in 32 bits, corners in no order, and
    nodal values of several time steps one after another in chunks."""
    with h5py.File(source) as old, h5py.File(target, "w") as file:
        grid = file.create_group("VTKHDF")
        grid.attrs.create("Version", (2, 2), dtype="i4")
        grid.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
        for name in ("Points", "Offsets", "Types", "NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
            old.copy(f"VTKHDF/{name}", grid)
        cells = old["VTKHDF/Connectivity"][:].reshape(-1, 4)
        cells[::4, :2] = cells[::4, 1::-1]
        grid["Connectivity"] = cells.ravel()
        if n_steps:
            steps = grid.create_group("Steps")
            steps.attrs.create("NSteps", (n_steps,), dtype="i4")
            x = grid["Points"][:, 0]
            grid.create_dataset("PointData/u", data=np.concatenate([x + 10 * k for k in range(n_steps)]),
                                chunks=(7,), maxshape=(None,))
    return target


def test_a_file_of_dolfinx_is_read_and_refined():
    kuhn_cube("cube.hdf", 2)
    as_dolfinx("cube.hdf", "theirs.vtkhdf", n_steps=3)

    converted = run("pamr-convert", "theirs.vtkhdf", "ours.vtkhdf")
    quality = run("pamr-quality", "ours.vtkhdf", "--json", "-", "--quiet").json
    run("pamr-mark", "theirs.vtkhdf", "-o", "marked.hdf", "--field", "u", "--above", "20.5")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf")

    assert f"{FOURTH_OF_THE_CUBES} of 48 cells were inverted and are turned over" in converted.err, converted.err
    assert quality["inverted_cells"] == 0 and abs(quality["volume"] - 1) < 1e-12
    with h5py.File("ours.vtkhdf") as file:  # the last time step
        assert np.array_equal(file["VTKHDF/PointData/u"], file["VTKHDF/Points"][:, 0] + 20)
    with h5py.File("fine.hdf") as file:
        assert file["VTKHDF/NumberOfCells"][0] > 48


def test_strict_conversion_refuses_what_it_would_remark_on():
    kuhn_cube("cube.hdf", 2)
    as_dolfinx("cube.hdf", "theirs.vtkhdf")
    refuses("pamr-convert", "theirs.vtkhdf", "ours.hdf", "--strict", says=["were inverted"], creates="ours.hdf")


def test_versions_and_steps_that_nobody_knows_are_refused():
    kuhn_cube("cube.hdf", 2)
    as_dolfinx("cube.hdf", "later.hdf")
    with h5py.File("later.hdf", "r+") as file:
        file["VTKHDF"].attrs["Version"] = (3, 1)
    refuses("pamr-quality", "later.hdf", says=["expected 1.x or 2.x, found 3.1"])
    as_dolfinx("cube.hdf", "steps.hdf", n_steps=2)
    with h5py.File("steps.hdf", "r+") as file:
        file["VTKHDF/Steps"].attrs["NSteps"] = np.array([3], dtype="i4")
    refuses("pamr-quality", "steps.hdf", says=["/VTKHDF/PointData/u", "expected 27 rows for each of 3 steps, found 54"])


def test_a_field_rewritten_in_place_is_no_damage():
    kuhn_cube("cube.hdf", 2)
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--box", "0,0,0,0.5,0.5,0.5")
    with h5py.File("marked.hdf", "r+") as file:
        file["VTKHDF/CellData/refine"][:] = 1
        del file["VTKHDF/CellData/refine_work"]
    refined = run("pamr-refine", "marked.hdf", "-o", "fine.hdf")
    assert "the values do not agree with their checksum" in refined.err and "CellData/refine" in refined.err
    with h5py.File("fine.hdf") as file:
        assert file["VTKHDF/NumberOfCells"][0] == 8 * 48

    with h5py.File("marked.hdf", "r+") as file:
        file["VTKHDF/Points"][5] += 1e-3
    refuses("pamr-refine", "marked.hdf", "-o", "more.hdf", says=["/VTKHDF/Points", "damaged"], creates="more.hdf")


def test_a_tool_that_a_rank_of_another_job_starts_runs_alone():
    if RANKS == 1:
        return
    kuhn_cube("cube.hdf", 2)
    program = """if True:
        import subprocess, sys
        from mpi4py import MPI
        if MPI.COMM_WORLD.rank == 0:
            done = subprocess.run(sys.argv[1:], capture_output=True, text=True, timeout=60)
            print(done.returncode, done.stdout, done.stderr)
        MPI.COMM_WORLD.barrier()
    """
    tool = [str(BIN / "pamr-convert"), "cube.hdf", "copy.hdf"]
    for shell in ([], ["sh", "-c", '"$@"', "sh"]):
        out = subprocess.run(LAUNCHER + [sys.executable, "-c", program] + shell + tool + ["--force"],
                             capture_output=True, text=True, timeout=100)
        assert out.stdout.startswith("0 48 cells"), out
    os.remove("copy.hdf")
    # started by mpirun through a shell it is still one job
    out = subprocess.run(LAUNCHER + ["sh", "-c", '"$@"', "sh"] + tool, capture_output=True, text=True, timeout=100)
    assert out.returncode == 0 and out.stdout.count("48 cells") == 1, out


run_tests(globals())
