# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-diff from the command line: equal meshes in any order, what differs, and bad input."""
import pathlib
import shutil

import h5py
import numpy as np

from tool_run import add_cell_field, bare_copy, kuhn_cube, refuses, run, run_tests


def permuted(source, target, shift=0.0):
    """The same points, cells and fields in another order, corners turned in even ways, points moved by `shift`."""
    random = np.random.default_rng(3)
    with h5py.File(source) as old, h5py.File(target, "w") as new:
        old.copy("VTKHDF", new)
        points, cells = old["VTKHDF/Points"][:], old["VTKHDF/Connectivity"][:].reshape(-1, 4)
        nodes, order = random.permutation(len(points)), random.permutation(len(cells))
        place = np.argsort(nodes)
        new["VTKHDF/Points"][...] = points[nodes] + shift
        new["VTKHDF/Connectivity"][...] = place[cells[order]][:, [1, 2, 0, 3]].ravel()
        for name in old.get("VTKHDF/CellData", {}):
            new["VTKHDF/CellData"][name][...] = old["VTKHDF/CellData"][name][:][order]
    return target


def test_a_mesh_is_the_same_in_any_order():
    add_cell_field(bare_copy(kuhn_cube("a.hdf", 4), "b.hdf"), "T", np.arange(384) / 7)
    permuted("b.hdf", "c.hdf")
    assert "same" in run("pamr-diff", "b.hdf", "c.hdf").out
    assert run("pamr-diff", "b.hdf", "c.hdf", "--json", "-").json["same"] is True
    assert run("pamr-diff", "b.hdf", "c.hdf", "--quiet").out == ""


def test_the_tolerance_is_for_points_and_values():
    add_cell_field(bare_copy(kuhn_cube("a.hdf", 4), "b.hdf"), "T", np.arange(384.0))
    permuted("b.hdf", "c.hdf", shift=1e-9)
    with h5py.File("c.hdf", "r+") as file:
        file["VTKHDF/CellData/T"][...] *= 1 + 1e-10
    run("pamr-diff", "b.hdf", "c.hdf", "--tolerance", "1e-8")
    result = run("pamr-diff", "b.hdf", "c.hdf", "--tolerance", "1e-11", code=1)
    assert "nodes" in result.out
    run("pamr-diff", "b.hdf", "c.hdf", code=1)


def test_it_says_what_differs_first():
    kuhn_cube("a.hdf", 3), kuhn_cube("b.hdf", 2)
    assert "162 cells in the first mesh, 48 in the second" in run("pamr-diff", "a.hdf", "b.hdf", code=1).out
    add_cell_field(bare_copy("a.hdf", "c.hdf"), "T", np.zeros(162))
    bare_copy("a.hdf", "d.hdf")
    assert '"T" is in the first mesh only' in run("pamr-diff", "c.hdf", "d.hdf", code=1).out
    values = np.zeros(162)
    values[[11, 40]] = 0.5
    add_cell_field("d.hdf", "T", values)
    report = run("pamr-diff", "c.hdf", "d.hdf", "--json", "-", code=1).json
    assert report["differences"][0]["what"] == "field T"
    assert (report["differences"][0]["count"], report["differences"][0]["first"]) == (2, 11)
    assert report["differences"][0]["largest"] == 0.5


def test_other_patches_are_another_mesh():
    bare_copy(kuhn_cube("a.hdf", 3), "b.hdf")
    report = run("pamr-diff", "a.hdf", "b.hdf", "--json", "-", code=1).json
    assert [d["what"] for d in report["differences"]] == ["patches"]
    assert report["differences"][0]["count"] == 6 * 18


def test_other_numbers_groups_and_conditions_are_noted():
    run("pamr-convert", kuhn_cube("a.hdf", 1), "a.lb8.ugrid", "--kind", "xmin=wall", "--quiet")
    run("pamr-convert", "a.lb8.ugrid", "b.hdf", "--quiet")
    mapbc = pathlib.Path("a.mapbc")
    mapbc.write_text(mapbc.read_text().replace("4000", "4010"))
    run("pamr-convert", "a.lb8.ugrid", "c.hdf", "--quiet")
    run("pamr-convert", "a.hdf", "a.msh", "--text", "--gmsh-version", "2.2", "--quiet")
    text = pathlib.Path("a.msh").read_text()
    pathlib.Path("n.msh").write_text(text.replace('2 1 "xmin"', '2 9 "xmin"').replace(" 2 2 1 ", " 2 2 9 "))
    lines = text.split("$Elements\n")[1].split("\n")
    again = lines[1].split()
    again[0], again[3] = str(int(lines[0]) + 1), "2"
    lines[:2] = [again[0], lines[1], " ".join(again)]
    pathlib.Path("g.msh").write_text(text.split("$Elements\n")[0] + "$Elements\n" + "\n".join(lines))
    for name in ("a", "n", "g"):
        run("pamr-convert", f"{name}.msh", f"{name}2.hdf", "--quiet")
    note = "other numbers, groups or conditions of patches"
    assert note in run("pamr-diff", "b.hdf", "c.hdf").out
    assert note in run("pamr-diff", "a2.hdf", "n2.hdf").out
    assert "patches" in run("pamr-diff", "a2.hdf", "g2.hdf", code=1).out
    shutil.copy("g2.hdf", "h2.hdf")
    with h5py.File("h2.hdf", "r+") as file:
        names = file["PAMR/patches/groups"].asstr()[:].tolist()
        file["PAMR/patches/groups"][...] = [words.replace("xmin", "west") for words in names]
        del file["PAMR/checksums"].attrs["PAMR/patches/groups"]
    assert run("pamr-diff", "g2.hdf", "h2.hdf", "--json", "-").json["notes"] == [note]
    assert "; " not in run("pamr-diff", "g2.hdf", "g2.hdf").out


def test_bad_input_is_refused():
    kuhn_cube("a.hdf", 3)
    shutil.copy("a.hdf", "bad.hdf")
    pathlib.Path("short.hdf").write_bytes(pathlib.Path("a.hdf").read_bytes()[:9000])
    with h5py.File("bad.hdf", "r+") as file:
        for name, rows in (("VTKHDF/Connectivity", slice(20, 24)), ("PAMR/cell_to_cell", 5)):
            file[name][rows] = file[name][rows][[1, 0, 2, 3]]
            del file["PAMR/checksums"].attrs[name]
    refuses("pamr-diff", "a.hdf", "missing.hdf", says=["missing.hdf"])
    refuses("pamr-diff", "a.hdf", "short.hdf", says=["short.hdf"])
    refuses("pamr-diff", "a.hdf", "bad.hdf", says=["bad.hdf", "orientation"])
    refuses("pamr-diff", "a.hdf")
    refuses("pamr-diff", "a.hdf", "a.hdf", "--tolerance", "-1", says=["tolerance"])


run_tests(globals())
