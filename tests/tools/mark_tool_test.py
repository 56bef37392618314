# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-mark from the command line: marks against NumPy, the same file on any number of ranks, and bad input."""
import pathlib

import h5py
import numpy as np

from tool_run import RANKS, add_cell_field, kuhn_cube, prepare_alone, refuses, run, run_tests, same_bytes

prepare_alone("pamr-mesh", "pamr-refine")


def arrays(name):
    with h5py.File(name) as file:
        cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        return file["VTKHDF/Points"][:], cells


def marks(name, field="refine"):
    with h5py.File(name) as file:
        data = file["VTKHDF/CellData"][field]
        assert data.dtype == np.int32
        return data[:]


def volumes(points, cells):
    a, b, c, d = (points[cells[:, i]] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def mark(mesh, *criteria, **options):
    result = run("pamr-mark", mesh, "-o", "marked.hdf", "--force", "--json", "-", *criteria, **options)
    if RANKS > 1:
        run("pamr-mark", mesh, "-o", "serial.hdf", "--force", "--quiet", *criteria, serial=True)
        assert same_bytes("marked.hdf", "serial.hdf"), "the file depends on the number of ranks"
    report, found = result.json, marks("marked.hdf")
    assert report["marked"] == found.sum() and set(np.unique(found)) <= {0, 1}
    return found, report


def test_geometric_criteria_agree_with_numpy():
    points, cells = arrays(kuhn_cube("a.hdf", 5))
    distance = np.linalg.norm(points - [0.1, 0.2, 0.3], axis=1)[cells]
    centroid = points[cells].mean(axis=1)

    assert (mark("a.hdf", "--all")[0] == 1).all()
    crossing = (distance.min(axis=1) < 0.47) & (distance.max(axis=1) > 0.47)
    assert (mark("a.hdf", "--crossing-sphere", "0.1,0.2,0.3,0.47")[0] == crossing).all()
    shell = abs(np.linalg.norm(centroid - [0.1, 0.2, 0.3], axis=1) - 0.4) < 0.07
    assert (mark("a.hdf", "--centroid-shell", "0.1,0.2,0.3,0.4,0.07")[0] == shell).all()
    box = ((centroid >= [-1, 0.11, 0]) & (centroid <= [0.52, 0.77, 1])).all(axis=1)
    assert (mark("a.hdf", "--box", "-1,0.11,0,0.52,0.77,1")[0] == box).all()
    assert (mark("a.hdf", "--box", "-1,0.11,0,0.52,0.77,1", "--centroid-shell", "0.1,0.2,0.3,0.4,0.07")[0]
            == (box | shell)).all()


def test_layers_at_a_patch_agree_with_numpy():
    points, cells = arrays(kuhn_cube("a.hdf", 5))
    near = (points[cells][:, :, 0] == 0).sum(axis=1) == 3
    for layers in range(1, 4):
        assert (mark("a.hdf", "--patch", "xmin", "--layers", layers)[0] == near).all(), layers
        touched = np.zeros(len(points), bool)
        touched[cells[near]] = True
        near = touched[cells].any(axis=1)
    assert mark("a.hdf", "--patch", "xmin", "--layers", 2 * 10 ** 9)[0].all(), "ends with the mesh"


def test_field_criteria_agree_with_numpy():
    points, cells = arrays(kuhn_cube("a.hdf", 4))
    length = 0.05 + 0.1 * points[cells].mean(axis=1)[:, 0]
    add_cell_field("a.hdf", "lambda", length)
    add_cell_field("a.hdf", "count", np.arange(len(cells)))
    size = np.cbrt(volumes(points, cells))

    assert (mark("a.hdf", "--field", "lambda", "--above", "0.1")[0] == (length > 0.1)).all()
    assert (mark("a.hdf", "--field", "count", "--below", "17")[0] == (np.arange(len(cells)) < 17)).all()
    assert (mark("a.hdf", "--size-over", "lambda", "--ratio", "1.4")[0] == (size / length > 1.4)).all()
    edge = np.linalg.norm(points[cells][:, [0, 0, 0, 1, 1, 2]] - points[cells][:, [1, 2, 3, 2, 3, 3]], axis=2).max(axis=1)
    assert (mark("a.hdf", "--size-over", "lambda", "--ratio", "4.2", "--size", "longest-edge")[0]
            == (edge / length > 4.2)).all()
    assert (mark("a.hdf", "--all", "--only-where", "lambda:above:0.1", "--only-where", "count:below:100")[0]
            == ((length > 0.1) & (np.arange(len(cells)) < 100))).all()
    error = 1e-4 * (np.arange(len(cells)) % 7)
    add_cell_field("a.hdf", "error", error)
    assert (mark("a.hdf", "--all", "--only-where", "lambda:above:0.1", "--error", "error:40")[0]
            == (length - 40 * error > 0.1)).all()
    assert (mark("a.hdf", "--field", "lambda", "--above", "0.14", "--field", "count", "--below", "5")[0]
            == ((length > 0.14) | (np.arange(len(cells)) < 5))).all()


def test_recovered_error_follows_a_front():
    points, cells = arrays(kuhn_cube("a.hdf", 6))
    with h5py.File("a.hdf", "r+") as file:
        file["VTKHDF"].require_group("PointData")["psi"] = np.tanh(20 * (points[:, 0] - 0.45))
    x = points[cells].mean(axis=1)[:, 0]

    for bar in (("--theta", "0.5"), ("--target", "0.7"), ("--bulk", "0.5")):
        found, report = mark("a.hdf", "--recovered-error", "psi", *bar)
        assert 0 < report["marked"] < len(cells) // 2
        assert (abs(x[found == 1] - 0.45) < 0.25).all(), bar


def test_the_bulk_of_a_field_is_the_fewest_cells_that_carry_it():
    points, cells = arrays(kuhn_cube("a.hdf", 3))
    share = np.linspace(1, 2, len(cells)) ** 3
    add_cell_field("a.hdf", "part", share)
    largest = np.sort(share)[::-1].cumsum()
    found, _ = mark("a.hdf", "--bulk-of", "part:0.3")
    assert found.sum() == np.searchsorted(largest, 0.3 * share.sum()) + 1
    assert share[found == 1].min() > share[found == 0].max()
    usual, _ = mark("a.hdf", "--bulk-of", "part")
    assert list(usual) == list(found), "a fraction of 0.3 is the usual one"
    refuses("pamr-mark", "a.hdf", "-o", "out.hdf", "--bulk-of", ":0.3", says=["FIELD or"], creates="out.hdf")
    add_cell_field("a.hdf", "huge", np.full(len(cells), 1e308))
    refuses("pamr-mark", "a.hdf", "-o", "out.hdf", "--bulk-of", "huge", says=["too large"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", "-o", "out.hdf", "--bulk-of", "part:1.5", says=["at most 1"], creates="out.hdf")
    add_cell_field("a.hdf", "change", -share)
    refuses("pamr-mark", "a.hdf", "-o", "out.hdf", "--bulk-of", "change:0.5", says=["change"], creates="out.hdf")


def test_the_size_after_refinement_is_exact_and_keeps_the_budget():
    kuhn_cube("a.hdf", 4)
    for budget in (384, 400, 700, 2000):
        _, report = mark("a.hdf", "--crossing-sphere", "0,0,0,0.61", "--max-cells", budget)
        assert report["cells_after"] <= budget and report["marked"] <= report["wanted"]
        refined = run("pamr-refine", "marked.hdf", "-o", "finer.hdf", "--force", "--json", "-").json
        assert refined["cells_out"] == report["cells_after"], (budget, refined, report)
        assert refined["nodes_out"] == report["nodes_after"]
    assert report["marked"] == report["wanted"]


def test_levels_limit_the_marks():
    kuhn_cube("a.hdf", 2)
    mark("a.hdf", "--box", "0,0,0,0.5,0.5,0.5")
    run("pamr-refine", "marked.hdf", "-o", "finer.hdf", "--quiet")
    assert mark("finer.hdf", "--all", "--max-level", "0")[1]["marked"] == 0
    once = mark("finer.hdf", "--all", "--max-level", "1")[1]
    assert once["split_beyond_max_level"] == 0
    assert 0 < once["marked"] < once["cells"]
    assert mark("finer.hdf", "--all", "--max-level", "2")[1]["marked"] == once["cells"]


def test_marks_are_replaced_and_other_fields_kept():
    kuhn_cube("a.hdf", 2)
    add_cell_field("a.hdf", "refine", np.arange(48, dtype=np.int8) % 3 - 1)  # marks of a solver of one's own
    add_cell_field("a.hdf", "refine_work", np.arange(48, dtype=np.uint8))
    add_cell_field("a.hdf", "rho", np.arange(48) / 3)
    found, _ = mark("a.hdf", "--all")
    assert (found == 1).all()
    with h5py.File("marked.hdf") as file:
        assert (file["VTKHDF/CellData/rho"][:] == np.arange(48) / 3).all()


def test_marks_do_not_replace_data():
    kuhn_cube("a.hdf", 2)
    idle = ("--field", "e", "--above", "40", "--coarsen-below", "3", "--keep-for", "2")
    for field, values, says, more in (
            ("e", np.arange(48.0), "expected integers from -1 to 1, found reals", ()),
            ("u", np.zeros((48, 3), int), "expected integers from -1 to 1, found 3 components", ()),
            ("n", np.arange(48) // 40 * 7, "expected integers from -1 to 1, found 7 in cell 40", ()),
            ("region", np.zeros(48, int), "found the regions of the mesh", ()),
            ("m_work", np.arange(48.0), "expected integers from 0 to 255, found reals", ()),
            ("w_work", np.arange(48), "expected integers from 0 to 255, found integers of another type", ()),
            ("i_idle", np.arange(48), "expected integers from 0 to 255, found integers of another type", idle)):
        add_cell_field("a.hdf", field, values)
        name = field.split("_")[0]
        before = pathlib.Path("a.hdf").read_bytes()
        refuses("pamr-mark", "a.hdf", "-o", "out.hdf", "--marks", name, *(more or ("--all",)),
                says=["a.hdf", f"cell field '{field}'", says], creates="out.hdf")
        assert pathlib.Path("a.hdf").read_bytes() == before
    for name in ("x", "i"):  # counts that are not asked for stay
        run("pamr-mark", "a.hdf", "-o", "out.hdf", "--marks", name, "--all", "--quiet", "--force")
        assert (marks("out.hdf", name) == 1).all()
        with h5py.File("out.hdf") as file:
            assert (file["VTKHDF/CellData/e"][:] == np.arange(48)).all()
            assert (file["VTKHDF/CellData/i_idle"][:] == np.arange(48)).all()


def test_places_that_hold_no_cell_are_reported():
    kuhn_cube("a.hdf", 2)
    here, away = ("--box", "0,0,0,1,1,0.4"), ("--crossing-sphere", "5,5,5,1", "--centroid-shell", "0,0,9,1,0.1", "--box", "2,2,2,3,3,3")
    warnings = run("pamr-mark", "a.hdf", "-o", "b.hdf", *here, *away).err.splitlines()
    assert [warning.split(": ", 2)[2] for warning in warnings] == [
        f"no cell meets the criterion {option} {place}" for option, place in zip(away[::2], away[1::2])], warnings
    assert run("pamr-mark", "a.hdf", "-o", "b.hdf", *here, "--coarsen-rest", *away, "--force").err == ""  # may mean just that
    assert run("pamr-mark", "a.hdf", "-o", "b.hdf", *here, "--force").err == ""


def work_and_children(*criterion):
    """What pamr-mark foresees of a.hdf, and how many cells come of each of its cells."""
    mark("a.hdf", *criterion)
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet", "--force")
    with h5py.File("marked.hdf") as file, h5py.File("fine.hdf") as fine:
        work = file["VTKHDF/CellData/refine_work"][:]
        assert work.dtype == np.uint8 and "refine_work" not in fine["VTKHDF/CellData"]
        return work, np.bincount(fine["VTKHDF/CellData/parent"][:], minlength=len(work))


def test_work_is_the_cells_to_come_and_more_where_they_cost_more():
    kuhn_cube("a.hdf", 5)
    work, children = work_and_children("--crossing-sphere", "0.1,0.2,0.3,0.47")
    assert (work == children + 2 * ((children > 1) & (children < 8))).all() and {1, 2, 3, 4, 7, 8} == set(children)

    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", "a.hdf", "--quiet", "--force")
    work, children = work_and_children("--patch", "sphere")
    with h5py.File("a.hdf") as file:
        patch = [name.decode() for name in file["PAMR/patches/names"][:]].index("sphere")
        at_wall = (file["PAMR/cell_to_cell"][:] == -1 - patch).any(axis=1) & (children > 1)
    assert at_wall.any()
    assert (work == children + 2 * ((children > 1) & (children < 8)) + at_wall * (5 * children // 4)).all()


def test_work_shares_the_cells_out_and_decides_nothing():
    kuhn_cube("a.hdf", 5)
    work, _ = work_and_children("--crossing-sphere", "0.1,0.2,0.3,0.47")
    random = np.random.default_rng(3)
    for nonsense in (None, np.zeros(len(work), np.uint8), random.integers(0, 256, len(work), np.uint8)):
        with h5py.File("marked.hdf", "r+") as file:
            fields = file["VTKHDF/CellData"]
            fields.pop("refine_work", None)
            file["PAMR/checksums"].attrs.pop("VTKHDF/CellData/refine_work", None)
            if nonsense is not None:
                fields["refine_work"] = nonsense
        run("pamr-refine", "marked.hdf", "-o", "other.hdf", "--quiet", "--force")
        assert same_bytes("fine.hdf", "other.hdf")
    with h5py.File("marked.hdf", "r+") as file:  # a field of the user: of another type
        del file["VTKHDF/CellData/refine_work"], file["PAMR/checksums"].attrs["VTKHDF/CellData/refine_work"]
        file["VTKHDF/CellData/refine_work"] = np.arange(len(work))
    run("pamr-refine", "marked.hdf", "-o", "other.hdf", "--quiet", "--force")
    with h5py.File("other.hdf") as file:
        assert (file["VTKHDF/CellData/refine_work"][:] == file["VTKHDF/CellData/parent"][:]).all()


def test_limits_that_are_not_kept_are_reported():
    kuhn_cube("a.hdf", 4)
    points, cells = arrays("a.hdf")
    add_cell_field("a.hdf", "x", points[cells].mean(axis=1)[:, 0])

    def warned(mesh, *criteria):
        result = run("pamr-mark", mesh, "-o", "marked.hdf", "--force", "--json", "-", *criteria)
        run("pamr-refine", "marked.hdf", "-o", "finer.hdf", "--force", "--quiet")
        with h5py.File("finer.hdf") as file:
            assert len(file["PAMR/cell_to_cell"]) == result.json["cells_after"]
        return result.json, result.err

    high = ("--field", "x", "--above", "0.6", "--coarsen-below", "0.3")
    report, said = warned("a.hdf", *high, "--max-cells", 300)  # level 0 cannot be coarsened
    assert report["marked"] == 0 and report["cells_after"] == 384 and "384 cells" in said and "--max-cells 300" in said
    report, said = warned("a.hdf", *high, "--max-cells", 10**6, "--fill")
    assert report["cells_after"] == 8 * 384 and "--fill: 3072 cells" in said
    run("pamr-mark", "a.hdf", "-o", "all.hdf", "--all", "--quiet")
    run("pamr-refine", "all.hdf", "-o", "fine.hdf", "--quiet")
    # a criterion without a value is limited too
    report, said = warned("fine.hdf", *high, "--box", "0,0,0,1,1,1", "--max-cells", 4000)
    assert 3072 <= report["cells_after"] <= 4000 and report["marked"] > 0 and not said
    report, said = warned("fine.hdf", *high, "--max-cells", 100)
    assert report["marked"] == 0 and report["cells_after"] == 384 and "more than --max-cells 100" in said
    report, said = warned("fine.hdf", "--field", "x", "--above", "2", "--coarsen-rest", "--keep-for", 2)
    assert report["may_go"] == 0 and not said  # they wait


def test_bad_input_is_refused():
    kuhn_cube("a.hdf", 3)
    pathlib.Path("short.hdf").write_bytes(pathlib.Path("a.hdf").read_bytes()[:9000])
    out = ("-o", "out.hdf")
    refuses("pamr-mark", "missing.hdf", *out, "--all", says=["missing.hdf"], creates="out.hdf")
    refuses("pamr-mark", "short.hdf", *out, "--all", says=["short.hdf"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", "-o", "no folder/out.hdf", "--all", says=["no folder"])
    refuses("pamr-mark", "a.hdf", *out, "--patch", "wing", says=["a.hdf", "wing", "xmin"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--field", "T", "--above", "1", says=["a.hdf", '"T"'], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--field", "T", says=["--above"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, says=["criterion"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--all", "--max-level", "-1", says=["--max-level"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--crossing-sphere", "0,0,1", says=["X,Y,Z,R"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--round", says=["--round"], creates="out.hdf")
    for option, beside in (("--min-level", "--coarsen-below"), ("--keep-for", "--coarsen-rest"), ("--size", "--size-over")):
        refuses("pamr-mark", "a.hdf", *out, "--all", option, "cbrt" if option == "--size" else "1", says=[option, beside],
                creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--all", "--max-level", "1", "--max-level", "2", says=["found it 2 times"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--centroid-shell", "0,0,0,1,-0.1", says=["width", "-0.1"], creates="out.hdf")
    refuses("pamr-mark", "a.hdf", *out, "--all", "--quality-control", "none", "--shape-floor", "0.3",
            says=["--shape-floor: expected --quality-control removable beside it"], creates="out.hdf")
    for taken in ("region", "level", "level0_cell", "level0_key"):
        refuses("pamr-mark", "a.hdf", *out, "--all", "--marks", taken, says=["--marks", f"'{taken}'"], creates="out.hdf")
    before = pathlib.Path("a.hdf").read_bytes()
    refuses("pamr-mark", "a.hdf", "-o", "a.hdf", "--all", "--force", says=["a.hdf"])
    pathlib.Path("old.hdf").write_text("mine")
    refuses("pamr-mark", "a.hdf", "-o", "old.hdf", "--all", says=["--force"])
    assert pathlib.Path("old.hdf").read_text() == "mine" and pathlib.Path("a.hdf").read_bytes() == before


def test_an_invalid_mesh_is_refused():
    kuhn_cube("bad.hdf", 2)
    with h5py.File("bad.hdf", "r+") as file:
        for name, rows in (("VTKHDF/Connectivity", slice(20, 24)), ("PAMR/cell_to_cell", 5)):
            file[name][rows] = file[name][rows][[1, 0, 2, 3]]
            del file["PAMR/checksums"].attrs[name]
    refuses("pamr-mark", "bad.hdf", "-o", "out.hdf", "--all", says=["bad.hdf", "orientation", "5"], creates="out.hdf")


run_tests(globals(), on_ranks=(test_geometric_criteria_agree_with_numpy, test_layers_at_a_patch_agree_with_numpy,
                               test_field_criteria_agree_with_numpy, test_recovered_error_follows_a_front,
                               test_the_bulk_of_a_field_is_the_fewest_cells_that_carry_it,
                               test_the_size_after_refinement_is_exact_and_keeps_the_budget,
                               test_marks_are_replaced_and_other_fields_kept))
