# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that other programs wrote, and fields that they rewrote."""
import os
import subprocess
import sys

import h5py
import meshio
import numpy as np

from tool_run import BIN, LAUNCHER, LIMIT, RANKS, kuhn_cube, refuses, run, run_tests, same_bytes

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


def test_our_file_has_what_dolfinx_reads():
    """The datasets, types and pieces that `read_mesh` of dolfinx 0.10 asks for, on two ranks."""
    kuhn_cube("cube.hdf", 2)
    run("pamr-convert", "cube.hdf", "cube.vtkhdf")
    with h5py.File("cube.vtkhdf") as file:
        grid = file["VTKHDF"]
        kinds = {"Types": "u1", "Offsets": "<i8", "Connectivity": "<i8", "NumberOfPoints": "<i8", "Points": "<f8"}
        assert {name: grid[name].dtype.str.lstrip("|") for name in kinds} == kinds
        n_cells, n_points = grid["Types"].shape[0], int(grid["NumberOfPoints"][0])
        assert grid["Points"].shape == (n_points, 3)
        volume = 0
        for first, last in ((0, n_cells // 2), (n_cells // 2, n_cells)):
            assert (grid["Types"][first:last] == 10).all()
            offsets = grid["Offsets"][first:last + 1]
            assert (np.diff(offsets) == 4).all()
            corners = grid["Points"][:][grid["Connectivity"][offsets[0]:offsets[-1]].reshape(-1, 4)]
            volume += np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6
        assert abs(volume - 1) < 1e-12


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


def vtu_of_meshio(name, **options):
    """Six tetrahedra of the unit cube, some inverted, the face z = 0 tagged 4, a node and a line of nobody."""
    points = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)] + [(9, 9, 9)], float)
    cells = np.array([[0, 1, 3, 7], [0, 5, 1, 7], [0, 3, 2, 7], [2, 0, 6, 7], [0, 4, 5, 7], [0, 6, 4, 7]])
    mesh = meshio.Mesh(points, [("line", [[0, 8]]), ("triangle", [[3, 0, 1], [0, 3, 2]]), ("tetra", cells)],
                       point_data={"T": np.arange(9.0), "v": np.arange(27, dtype="f4").reshape(9, 3)},
                       cell_data={"gmsh:physical": [[1], [4, 4], [7] * 6], "u": [[0], [0, 0], np.arange(6, dtype="i4")]})
    mesh.write(name, **options)
    return name


def test_vtu_files_become_meshes_with_fields_and_patches():
    vtu_of_meshio("packed.vtu")
    vtu_of_meshio("plain.vtu", compression=None)
    vtu_of_meshio("text.vtu", binary=False)
    for name in ("packed", "plain", "text"):
        done = run("pamr-convert", name + ".vtu", name + ".hdf", "--json", "-")
        assert done.json["turned_cells"] == 1 and done.json["dropped_nodes"] == 1 and "turned over" in done.err
        assert done.json["patches"] == ["physical_4", "boundary"]
    assert same_bytes("packed.hdf", "plain.hdf") and same_bytes("packed.hdf", "text.hdf")
    quality = run("pamr-quality", "text.hdf", "--json", "-", "--quiet").json
    assert abs(quality["volume"] - 1) < 1e-14 and abs(quality["patches"]["physical_4"]["area"] - 1) < 1e-14
    with h5py.File("packed.hdf") as file:
        points, data = file["VTKHDF/Points"][:], file["VTKHDF/PointData"]
        number = points @ (1, 2, 4)
        assert np.array_equal(data["T"], number) and np.array_equal(data["v"][:, 1], 3 * number + 1)
        assert sorted(file["VTKHDF/CellData/u"][:]) == list(range(6))
    refuses("pamr-convert", "packed.vtu", "strict.hdf", "--strict", says=["inverted"], creates="strict.hdf")


def test_small_arrays_and_texts_of_vtu_files():
    """The base64 of a few bytes ends in the group of its header; texts are left out with a word."""
    import base64
    import struct
    word = lambda data, kind: base64.b64encode(struct.pack(kind, len(data)) + data).decode()
    for n in (1, 2, 5):
        for kind, header in (("<I", "UInt32"), ("<Q", "UInt64")):
            corners = [(2 * cell + x, y, z) for cell in range(n) for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
            points = struct.pack(f"<{12 * n}d", *(x for corner in corners for x in corner))
            nodes = struct.pack(f"<{4 * n}i", *range(4 * n))
            array = lambda name, type, data, more="": f'<DataArray type="{type}" Name="{name}" format="binary"{more}>{word(data, kind)}</DataArray>'
            with open("small.vtu", "w") as file:
                file.write(f'<VTKFile type="UnstructuredGrid" header_type="{header}"><UnstructuredGrid><Piece NumberOfPoints="{4 * n}" NumberOfCells="{n}">'
                           + "<Points>" + array("p", "Float64", points, ' NumberOfComponents="3"') + "</Points><Cells>"
                           + array("connectivity", "Int32", nodes) + array("offsets", "Int32", struct.pack(f"<{n}i", *range(4, 4 * n + 1, 4)))
                           + array("types", "UInt8", bytes([10] * n)) + "</Cells><CellData>" + array("mark", "UInt8", bytes(range(n)))
                           + '<Array type="String" Name="title" format="ascii">65 0</Array></CellData></Piece></UnstructuredGrid></VTKFile>')
            said = run("pamr-convert", "small.vtu", "small.hdf", "--force", "--json", "-")
            assert said.json["cells"] == n and "the array 'title' was left out" in said.err, said.err
            with h5py.File("small.hdf") as file:
                assert list(file["VTKHDF/CellData/mark"][:]) == list(range(n))


def test_our_own_vtu_comes_back():
    kuhn_cube("cube.hdf", 3)
    names = ["xmin", "a < b & \"c\" > d", "ymin", "ymax", "patch", "zmax"]
    with h5py.File("cube.hdf", "r+") as file:
        del file["PAMR/patches/names"]
        file.create_dataset("PAMR/patches/names", data=names, dtype=h5py.string_dtype())
        del file["PAMR/checksums"].attrs["PAMR/patches/names"]
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--box", "0,0,0,0.5,0.5,0.5")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf")
    with h5py.File("fine.hdf", "r+") as file:
        n = len(file["VTKHDF/Types"])
        file["VTKHDF/CellData/a > b"] = np.arange(n)
        file["VTKHDF/CellData/patch"] = np.full(n, 7)
    run("pamr-convert", "fine.hdf", "fine.vtu")
    run("pamr-convert", "fine.vtu", "back.hdf")
    ours, back = (run("pamr-quality", f"{m}.hdf", "--json", "-", "--quiet").json for m in ("fine", "back"))
    assert ours["cells"] == back["cells"] and ours["volume"] == back["volume"] and ours["nodes"] == back["nodes"]
    assert {name: patch["area"] for name, patch in ours["patches"].items()} == {
        name: patch["area"] for name, patch in back["patches"].items()}
    with h5py.File("back.hdf") as file, h5py.File("fine.hdf") as fine:
        assert list(file["PAMR/patches/names"].asstr()) == names
        fields = file["VTKHDF/CellData"]
        assert set(fields) == set(fine["VTKHDF/CellData"]) == {"a > b", "level", "parent", "patch"}
        assert (fields["patch"][:] == 7).all() and sorted(fields["a > b"]) == list(range(n))
        assert fields["level"].dtype == np.uint8 and not fields["level"][:].any(), "what a mesh comes from is not in a .vtu"
    run("pamr-convert", "back.hdf", "back.vtu")
    run("pamr-convert", "back.vtu", "again.hdf")
    run("pamr-convert", "again.hdf", "again.vtu")
    assert same_bytes("again.vtu", "back.vtu") and same_bytes("again.hdf", "back.hdf")


def test_vtu_files_may_have_whatever_xml_allows():
    good = open(vtu_of_meshio("plain.vtu", binary=False)).read()
    keys = '<InformationKey name="L2_NORM_RANGE" location="vtkDataArray"><Value index="0">1</Value></InformationKey>'
    odd = good.replace('format="ascii">', f'format="ascii"><!-- a > b -->{keys}').replace('Name="u"', "Name\n=\n'&#117;' note='a>b'")
    assert odd.count(keys) > 4 and "&#117;" in odd
    with open("odd.vtu", "w") as file:
        file.write(odd)
    for name in ("plain", "odd"):
        run("pamr-convert", name + ".vtu", name + ".hdf", "--quiet")
    assert same_bytes("plain.hdf", "odd.hdf")


def test_vtu_files_that_lie_are_refused():
    good = open(vtu_of_meshio("text.vtu", binary=False)).read()
    packed = open(vtu_of_meshio("packed.vtu"), "rb").read()
    wedge = good.replace("\n10\n", "\n13\n", 1)
    cases = {
        "short": (good[:len(good) // 2], []),
        "cells": (good.replace('NumberOfCells="9"', 'NumberOfCells="10"'), ["expected 10 values"]),
        "many": (good.replace('NumberOfPoints="9"', 'NumberOfPoints="99999999999999"'), ["99999999999999 points"]),
        "wedge": (wedge, ["expected 6 nodes, found 4"]),
        "word": (good.replace("\n10\n", "\nten\n", 1), ["expected numbers"]),
        "kind": (good.replace("UnstructuredGrid", "PolyData"), ["expected UnstructuredGrid"]),
        "html": ("<html><body></body></html>", ["expected a file of VTK"]),
        "empty": ("", ["expected a file of VTK"]),
        "open": (good.replace("</Points>", ""), ["expected XML"]),
        "entity": (good.replace("<VTKFile", '<!DOCTYPE VTKFile [<!ENTITY n "9">]>\n<VTKFile').replace(
            'NumberOfPoints="9"', 'NumberOfPoints="&n;"'), ['a count as NumberOfPoints, found "&n;"']),
    }
    for name, (text, words) in cases.items():
        with open(name + ".vtu", "w") as file:
            file.write(text)
        refuses("pamr-convert", name + ".vtu", "out.hdf", says=[f"{name}.vtu'"] + words, creates="out.hdf")
    dice = np.random.default_rng(1)
    for trial in range(12 if RANKS == 1 else 3):  # whatever is damaged is an error or another valid mesh, never a crash
        bad = bytearray(packed)
        for place in dice.integers(0, len(bad), 3):
            bad[place] = dice.integers(0, 256)
        with open("bad.vtu", "wb") as file:
            file.write(bad)
        done = subprocess.run([str(BIN / "pamr-convert"), "bad.vtu", "bad.hdf", "--force"], capture_output=True, text=True)
        assert done.returncode in (0, 2), done


def test_a_tool_that_a_rank_of_another_job_starts_runs_alone():
    if RANKS == 1:
        return
    kuhn_cube("cube.hdf", 2)
    program = """if True:
        import subprocess, sys
        from mpi4py import MPI
        if MPI.COMM_WORLD.rank == 0:
            done = subprocess.run(sys.argv[1:], capture_output=True, text=True, timeout=300)
            print(done.returncode, done.stdout, done.stderr)
        MPI.COMM_WORLD.barrier()
    """
    tool = [str(BIN / "pamr-convert"), "cube.hdf", "copy.hdf"]
    for shell in ([], ["sh", "-c", '"$@"', "sh"]):
        out = subprocess.run(LAUNCHER + [sys.executable, "-c", program] + shell + tool + ["--force"],
                             capture_output=True, text=True, timeout=LIMIT)
        assert out.stdout.startswith("0 48 cells"), out
    os.remove("copy.hdf")
    # started by mpirun through a shell it is still one job
    out = subprocess.run(LAUNCHER + ["sh", "-c", '"$@"', "sh"] + tool, capture_output=True, text=True, timeout=LIMIT)
    assert out.returncode == 0 and out.stdout.count("48 cells") == 1, out


run_tests(globals(), on_ranks=(test_a_file_of_dolfinx_is_read_and_refined, test_our_own_vtu_comes_back,
                               test_a_tool_that_a_rank_of_another_job_starts_runs_alone))
