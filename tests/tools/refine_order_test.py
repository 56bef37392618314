# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-refine gives the same mesh however its input is numbered, names cells of the input as parents and in errors,
and writes the same bytes on any number of ranks when it puts cells in order itself."""
import shutil

import h5py
import numpy as np

from lineage_words import Lineage
from tool_run import add_cell_field, bare_copy, kuhn_cube, refuses, run, run_tests, same_bytes


def marked_mesh(name="marked.hdf"):
    """A refined cube with closure families, marked where they are."""
    kuhn_cube("level0.hdf", 4)
    run("pamr-mark", "level0.hdf", "-o", "marked0.hdf", "--crossing-sphere", "0,0,0,0.5", "--quiet", serial=True)
    run("pamr-refine", "marked0.hdf", "-o", "level1.hdf", "--quiet", serial=True)
    run("pamr-mark", "level1.hdf", "-o", name, "--crossing-sphere", "0,0,0,0.5", "--quiet", serial=True)
    return name


def shuffled_copy(source, target, seed):
    """Cells (closure families as one) and nodes renumbered at random, as in a file from elsewhere."""
    random = np.random.default_rng(seed)
    shutil.copy(source, target)
    with h5py.File(target, "r+") as file:
        vtk, ours = file["VTKHDF"], file["PAMR"]
        family = np.cumsum(Lineage(ours["lineage"][:]).child_in_whole == 0) - 1
        place = random.permutation(family[-1] + 1)
        order = np.argsort(place[family], kind="stable")
        new_cell = np.argsort(order)
        node_order = random.permutation(len(vtk["Points"]))
        new_node = np.argsort(node_order)
        neighbors = ours["cell_to_cell"][:][order]
        ours["cell_to_cell"][:] = np.where(neighbors >= 0, new_cell[neighbors], neighbors)
        ours["lineage"][:] = ours["lineage"][:][order]
        vtk["Points"][:] = vtk["Points"][:][node_order]
        vtk["Connectivity"][:] = new_node[vtk["Connectivity"][:].reshape(-1, 4)[order]].ravel()
        for field in vtk["CellData"].values():
            field[:] = field[:][order]
        for field in vtk.get("PointData", {}).values():
            field[:] = field[:][node_order]
        for name in list(ours["checksums"].attrs):
            del ours["checksums"].attrs[name]
    return target


def refine(source, target, *options, ranks=None):
    arguments = ("pamr-refine", source, "-o", target, "--json", "-", "--force", *options)
    return (run(*arguments) if ranks is None else run(*arguments, ranks=ranks)).json


def volume(points):
    return np.einsum("ij,ij->i", np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]),
                     points[:, 3] - points[:, 0]) / 6


def corners(file):
    return file["VTKHDF/Points"][:][file["VTKHDF/Connectivity"][:].reshape(-1, 4)]


def check_parents(source, refined):
    """Every cell's centroid lies in its parent, a cell of the input, and no member of the parent's family with a smaller
    number holds it too."""
    with h5py.File(source) as old, h5py.File(refined) as new:
        parent = new["VTKHDF/CellData/parent"][:]
        centroid = corners(new).mean(axis=1)
        old_corners = corners(old)

        def min_part(cells):
            parts = []
            for i in range(4):
                replaced = old_corners[cells].copy()
                replaced[:, i] = centroid
                parts.append(volume(replaced))
            return np.min(parts, axis=0)
        assert (min_part(parent) >= -1e-15).all(), "a centroid outside its parent"
        child = Lineage(old["PAMR/lineage"][:][parent]).child_in_whole
        for back in range(1, 7):
            has = child >= back
            assert not (min_part(np.where(has, parent - back, parent))[has] >= 1e-12).any(), "not the smallest"


def mean_jump(name):
    """Mean distance between the centroids of consecutive cells."""
    with h5py.File(name) as file:
        centroid = corners(file).mean(axis=1)
    return np.linalg.norm(np.diff(centroid, axis=0), axis=1).mean()


def test_the_mesh_does_not_depend_on_the_numbering():
    expected = refine(marked_mesh(), "expected.hdf")
    for seed in (1, 2):
        shuffled = shuffled_copy("marked.hdf", "shuffled.hdf", seed)
        for order in ("keep", "curve", "auto"):
            report = refine(shuffled, "out.hdf", "--order", order)
            assert report["fingerprint"] == expected["fingerprint"], order
            assert report["cells_out"] == expected["cells_out"], order


def test_parents_are_cells_of_the_input():
    shuffled = shuffled_copy(marked_mesh(), "shuffled.hdf", 3)
    for order in ("keep", "curve"):
        refine(shuffled, "out.hdf", "--order", order)
        check_parents("shuffled.hdf", "out.hdf")
        with h5py.File("out.hdf") as file:
            assert sorted(file["VTKHDF/CellData"]) == ["level", "parent"], "marks and origins do not belong into the result"


def test_the_order_is_along_the_curve_when_asked():
    shuffled = shuffled_copy(marked_mesh(), "shuffled.hdf", 4)
    refine(shuffled, "keep.hdf", "--order", "keep")
    refine(shuffled, "curve.hdf", "--order", "curve")
    assert mean_jump("curve.hdf") < 0.5 * mean_jump("keep.hdf"), (mean_jump("curve.hdf"), mean_jump("keep.hdf"))


def test_the_same_bytes_on_any_number_of_ranks():
    shuffled = shuffled_copy(marked_mesh(), "shuffled.hdf", 5)
    bare = bare_copy(shuffled, "bare.hdf")
    for name in (shuffled, bare):
        refine(name, "serial.hdf", "--order", "curve", ranks=1)
        for ranks in (2, 3, 5):
            refine(name, "out.hdf", "--order", "curve", ranks=ranks)
            assert same_bytes("serial.hdf", "out.hdf"), (name, ranks)


def test_small_meshes_are_kept_as_they_are():
    marked_mesh()
    refine("marked.hdf", "auto.hdf")
    refine("marked.hdf", "keep.hdf", "--order", "keep")
    with h5py.File("auto.hdf") as a, h5py.File("keep.hdf") as b:
        assert (a["VTKHDF/Connectivity"][:] == b["VTKHDF/Connectivity"][:]).all()


def test_a_large_mesh_in_random_order_is_put_in_order_by_itself():
    kuhn_cube("cube.hdf", 19)
    with h5py.File("cube.hdf") as file:
        marks = np.zeros(len(file["VTKHDF/Types"]), np.int8)
    marks[:1000] = 1
    add_cell_field("cube.hdf", "refine", marks)
    refine(shuffled_copy("cube.hdf", "shuffled.hdf", 7), "out.hdf")
    refine("cube.hdf", "expected.hdf")
    assert mean_jump("out.hdf") < 2 * mean_jump("expected.hdf"), (mean_jump("out.hdf"), mean_jump("expected.hdf"))
    check_parents("shuffled.hdf", "out.hdf")


def test_errors_name_cells_by_their_numbers_in_the_file():
    def damaged(change):
        shuffled_copy("marked.hdf", "bad.hdf", 6)
        with h5py.File("bad.hdf", "r+") as file:
            change(file)
        return "bad.hdf"

    def wrong_mark(file):
        file["VTKHDF/CellData/refine"][417] = 7

    def turned(file):
        cell = int(np.flatnonzero(Lineage(file["PAMR/lineage"][:]).is_regular)[100])
        turned.cell = cell
        for dataset, row in (("VTKHDF/Connectivity", slice(4 * cell, 4 * cell + 4)), ("PAMR/cell_to_cell", cell)):
            values = file[dataset][row]
            values[[0, 1]] = values[[1, 0]]
            file[dataset][row] = values
    marked_mesh()
    for order in ("keep", "curve"):
        refuses("pamr-refine", damaged(wrong_mark), "-o", "out.hdf", "--order", order, says=("cell 417", "found 7"),
                creates="out.hdf")
        refuses("pamr-refine", damaged(turned), "-o", "out.hdf", "--order", order,
                says=(f"cell {turned.cell}", "orientation_positive"), creates="out.hdf")


def test_an_order_that_does_not_exist():
    refuses("pamr-refine", marked_mesh(), "-o", "out.hdf", "--order", "best", says=("--order",), creates="out.hdf")


run_tests(globals())
