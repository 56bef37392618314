# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarsening from the command line: marks against NumPy, back to the mesh that there was, and bad input."""
import h5py
import numpy as np

from tool_run import RANKS, add_cell_field, kuhn_cube, of_full_level, prepare_alone, refuses, run, run_tests, same_bytes

prepare_alone("pamr-convert", "pamr-mark")

MESH = ("VTKHDF/Points", "VTKHDF/Connectivity", "PAMR/cell_to_cell", "PAMR/lineage", "PAMR/patches/names")
NOWHERE = ("--box", "9,9,9,9,9,9")


def parts(name):
    with h5py.File(name) as file:
        return [file[part][...] for part in MESH]


def marks(name):
    with h5py.File(name) as file:
        return file["VTKHDF/CellData/refine"][:]


def levels(name):
    with h5py.File(name) as file:
        return file["PAMR/lineage"][:].astype(np.uint64) >> np.uint64(12) & np.uint64(0xFF)


def mark(mesh, out, *criteria):
    return run("pamr-mark", mesh, "-o", out, "--force", "--json", "-", *criteria).json


def refine(mesh, out, *options):
    result = run("pamr-refine", mesh, "-o", out, "--force", "--json", "-", *options)
    if RANKS > 1:
        run("pamr-refine", mesh, "-o", "serial.hdf", "--force", "--quiet", *options, serial=True)
        assert same_bytes(out, "serial.hdf"), "the file depends on the number of ranks"
    return result


def test_refining_and_taking_all_back_gives_the_mesh_that_there_was():
    kuhn_cube("level0.hdf", 4)
    run("pamr-convert", "level0.hdf", "back.hdf")
    run("pamr-convert", "back.hdf", "now.hdf")
    for _ in range(3):
        mark("now.hdf", "marked.hdf", "--crossing-sphere", "0.1,0.2,0.3,0.5")
        refine("marked.hdf", "now.hdf")
    assert levels("now.hdf").max() == 3

    for level in (2, 1, 0):
        n_below = np.count_nonzero(levels("now.hdf") > 0)
        assert mark("now.hdf", "marked.hdf", *NOWHERE, "--coarsen-rest")["may_go"] == n_below
        dry = run("pamr-refine", "marked.hdf", "--dry-run", "--json", "-").json
        result = refine("marked.hdf", "now.hdf")
        report = result.json
        assert "nothing" not in result.err, result.err
        assert report["coarsening"]["octets_gone"] > 0 and report["coarsening"]["cells_flagged"] == n_below
        assert dry["cells_out"] == report["cells_out"] and dry["coarsening"]["octets_gone"] > 0
        assert levels("now.hdf").max() == level

    for before, after in zip(parts("level0.hdf"), parts("now.hdf")):
        assert before.dtype == after.dtype and np.array_equal(before, after)


@of_full_level
def test_the_size_is_told_beforehand_and_can_be_held():
    kuhn_cube("now.hdf", 4)
    held = []
    for x in (0.2, 0.2, 0.35, 0.5, 0.65):
        with h5py.File("now.hdf", "a") as file:
            points = file["VTKHDF/Points"][:]
            data = file["VTKHDF"].require_group("PointData")
            data.pop("f", None)
            file["PAMR/checksums"].attrs.pop("VTKHDF/PointData/f", None)
            data["f"] = np.exp(-(((np.linalg.norm(points - [x, 0.5, 0.5], axis=1) - 0.25) / 0.1) ** 2))
        report = mark("now.hdf", "marked.hdf", "--field", "f", "--above", 0.5, "--coarsen-below", 0.2, "--max-level", 3,
                      "--max-cells", 6000)
        result = refine("marked.hdf", "now.hdf").json
        assert (report["cells_after"], report["nodes_after"]) == (result["cells_out"], result["nodes_out"])
        held.append(result["cells_out"])
    assert max(held) <= 6000 and min(held[2:]) > 0.98 * 6000, held


def test_a_budget_refines_the_worst_and_coarsens_the_best():
    """The shell that is wanted has many more cells than there may be, also among those that no call lets go by itself."""
    kuhn_cube("now.hdf", 5)
    criteria = ("--field", "f", "--above", 0.02, "--coarsen-below", 0.01, "--max-level", 4, "--max-cells", 5000)
    sizes = []
    for x in (0.2, 0.2, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7):
        with h5py.File("now.hdf", "a") as file:
            points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        middle = points[cells].mean(axis=1)
        value = np.exp(-(((np.linalg.norm(middle - [x, 0.5, 0.5], axis=1) - 0.25) / 0.1) ** 2))
        with h5py.File("now.hdf", "a") as file:
            file["VTKHDF"].require_group("CellData").pop("f", None)
            file["PAMR/checksums"].attrs.pop("VTKHDF/CellData/f", None)
        add_cell_field("now.hdf", "f", value)
        report = mark("now.hdf", "marked.hdf", *criteria)
        found, times = marks("marked.hdf"), report["values_times"]
        # one factor for both thresholds: what is split is worse than what stays, what goes is better, and by as much
        assert times >= 1 and value[found == 1].min(initial=np.inf) > 0.0199 * times, times
        assert np.all(value[found == -1] < 0.0101 * times)
        result = refine("marked.hdf", "now.hdf").json
        assert report["cells_after"] == result["cells_out"]
        sizes.append((result["cells_out"], times, report["marked"], result["coarsening"]["octets_gone"]))
    assert all(0.98 * 5000 <= n <= 5000 for n, *_ in sizes[2:]), sizes
    # where the shell moves, cells are split in front for others that go behind, although all of them are wanted
    assert all(times > 1 and n_marked > 0 and n_gone > 0 for _, times, n_marked, n_gone in sizes[4:]), sizes

    # Where fewer cells are wanted, only --fill looks for more; cells still wait as long as --keep-for says.
    few = ("--field", "f", "--above", 2, "--coarsen-below", 0.2, "--max-level", 4)
    report = mark("now.hdf", "marked.hdf", *few, "--max-cells", 6000)
    assert report["values_times"] == 1 and report["marked"] == 0, report
    filled = mark("now.hdf", "marked.hdf", *few, "--max-cells", 6000, "--fill")
    assert filled["values_times"] < 1 and 0.98 * 6000 <= filled["cells_after"] <= 6000, filled
    waits = mark("now.hdf", "marked.hdf", *few, "--max-cells", 6000, "--fill", "--keep-for", 1)
    assert waits["may_go"] == 0 and 0.98 * 6000 <= waits["cells_after"] <= 6000, waits
    refuses("pamr-mark", "now.hdf", "-o", "no.hdf", "--all", "--max-cells", 10, "--fill", says=["--coarsen-below"],
            creates="no.hdf")


def test_thresholds_agree_with_numpy():
    kuhn_cube("a.hdf", 3)
    mark("a.hdf", "b.hdf", "--all")
    refine("b.hdf", "a.hdf")
    with h5py.File("a.hdf") as file:
        value = np.random.default_rng(3).random(file["PAMR/lineage"].shape[0])
    add_cell_field("a.hdf", "f", value)
    add_cell_field("a.hdf", "g", 1 - value)

    report = mark("a.hdf", "b.hdf", "--field", "f", "--above", 0.8, "--coarsen-below", 0.3)
    assert np.array_equal(marks("b.hdf"), np.where(value > 0.8, 1, np.where(value > 0.3, 0, -1)))
    assert report["may_go"] == np.count_nonzero(value <= 0.3)
    mark("a.hdf", "b.hdf", "--field", "f", "--below", 0.2, "--coarsen-below", 0.6)
    assert np.array_equal(marks("b.hdf"), np.where(value < 0.2, 1, np.where(value < 0.6, 0, -1)))
    # a cell stays that any criterion wants, and one without hysteresis of its own marks or lets go
    mark("a.hdf", "b.hdf", "--field", "f", "--above", 0.8, "--coarsen-below", 0.3, "--field", "g", "--above", 0.9)
    assert np.array_equal(marks("b.hdf"), np.where((value > 0.8) | (value < 0.1), 1, np.where(value > 0.3, 0, -1)))
    # a limit takes marks, but what it takes them from stays
    mark("a.hdf", "b.hdf", "--field", "f", "--above", 0.8, "--coarsen-rest", "--max-level", 1)
    assert np.array_equal(marks("b.hdf"), np.where(value > 0.8, 0, -1))
    mark("a.hdf", "b.hdf", "--field", "f", "--above", 0.8, "--coarsen-rest", "--min-level", 1)
    assert np.array_equal(marks("b.hdf"), np.where(value > 0.8, 1, 0))
    mark("a.hdf", "b.hdf", "--bulk-of", "f:0.3", "--coarsen-below", 0.9)
    found = marks("b.hdf")
    assert value[found == 1].min() > value[found == 0].max() and value[found == 0].min() > value[found == -1].max()
    assert value[found >= 0].sum() >= 0.9 * value.sum() > value[found >= 0].sum() - 1


def test_cells_wait_before_they_go():
    kuhn_cube("now.hdf", 2)
    mark("now.hdf", "marked.hdf", "--all")
    refine("marked.hdf", "now.hdf")
    for turn in range(3):
        report = mark("now.hdf", "marked.hdf", *NOWHERE, "--coarsen-rest", "--keep-for", 2)
        assert report["may_go"] == (384 if turn == 2 else 0)
        with h5py.File("marked.hdf") as file:
            assert (file["VTKHDF/CellData/refine_idle"][:] == turn + 1).all()
        refine("marked.hdf", "now.hdf")
    assert len(levels("now.hdf")) == 48
    # a turn in which a cell is wanted begins the count anew
    mark("now.hdf", "marked.hdf", "--all", "--coarsen-rest", "--keep-for", 2)
    with h5py.File("marked.hdf") as file:
        assert (file["VTKHDF/CellData/refine_idle"][:] == 0).all()


def test_cells_that_know_no_parent_stay_and_nothing_is_lost():
    kuhn_cube("a.hdf", 3)
    add_cell_field("a.hdf", "f", np.arange(162.0))
    add_cell_field("a.hdf", "refine", np.full(162, -1, np.int8))
    result = run("pamr-refine", "a.hdf", "-o", "b.hdf", "--json", "-")
    assert result.json["coarsening"]["cells_without_parent"] == 162
    assert "nothing was coarsened: of 162 cells that may be coarsened 162 know no parent" in result.err
    for before, after in zip(parts("a.hdf"), parts("b.hdf")):
        assert np.array_equal(before, after)
    with h5py.File("b.hdf") as file:
        assert np.array_equal(file["VTKHDF/CellData/f"][:], np.arange(162.0))


def test_bad_marks_and_options_are_refused():
    kuhn_cube("a.hdf", 2)
    run("pamr-convert", "a.hdf", "m.hdf")
    add_cell_field("m.hdf", "refine", np.full(48, -2, np.int8))
    add_cell_field("m.hdf", "real", np.full(48, np.nan))
    refuses("pamr-refine", "m.hdf", "-o", "no.hdf", says=["-1 (may be coarsened), 0 (keep) or 1 (split)", "found -2"],
            creates="no.hdf")
    refuses("pamr-refine", "m.hdf", "-o", "no.hdf", "--marks", "real", says=["integer field of one component", "reals"],
            creates="no.hdf")
    add_cell_field("a.hdf", "refine", np.full(48, -1, np.int8))
    refuses("pamr-refine", "a.hdf", "-o", "no.hdf", "--quality-control", "none", says=["removable", "coarsening"],
            creates="no.hdf")
    refuses("pamr-refine", "a.hdf", "-o", "no.hdf", "--integral", "energy", says=["energy", "no cell field"],
            creates="no.hdf")
    refuses("pamr-mark", "a.hdf", "-o", "no.hdf", "--all", "--coarsen-below", 1,
            says=["--coarsen-below 1", "criterion with a value"], creates="no.hdf")
    refuses("pamr-mark", "m.hdf", "-o", "no.hdf", "--field", "refine", "--above", 0.5, "--coarsen-below", 0.6,
            says=["--coarsen-below 0.6", "at most", "0.5"], creates="no.hdf")
    refuses("pamr-mark", "m.hdf", "-o", "no.hdf", "--bulk-of", "f:0.5", "--coarsen-below", 0.2,
            says=["at least", "0.5"], creates="no.hdf")


run_tests(globals())
