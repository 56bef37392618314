# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-partition from the command line: the parts it writes against what it reports, families, weights, bad input."""
import os

import h5py
import numpy as np

from lineage_words import Lineage
from tool_run import RANKS, add_cell_field, kuhn_cube, refuses, run, run_tests, same_bytes


def read(name):
    with h5py.File(name) as file:
        return (file["VTKHDF/CellData/rank"][:], file["PAMR/cell_to_cell"][:],
                file["PAMR/lineage"][:] if "lineage" in file["PAMR"] else None)


def neighbors_of(rank, neighbors, parts):
    """How many other parts each part shares faces with."""
    inside = neighbors >= 0
    other = np.where(inside, rank[np.where(inside, neighbors, 0)], rank[:, None])
    pairs = {(a, b) for row, a in zip(other, rank) for b in row if a != b}
    return [sum(1 for a, _ in pairs if a == part) for part in range(parts)]


def partition(mesh, parts, *options):
    report = run("pamr-partition", mesh, "-o", "parts.hdf", "--force", "-p", parts, "--json", "-", *options).json
    rank, neighbors, lineage = read("parts.hdf")
    assert report["parts"] == parts and report["cells"] == len(rank)
    assert rank.min() >= 0 and rank.max() < parts
    inside = neighbors >= 0
    other = np.where(inside, rank[np.where(inside, neighbors, 0)], rank[:, None])
    assert report["edge_cut"] == (other != rank[:, None]).sum() // 2
    of_part = neighbors_of(rank, neighbors, parts)
    assert report["neighbors_max"] == max(of_part) and np.isclose(report["neighbors_mean"], np.mean(of_part))
    if lineage is None:  # otherwise the runs are rounded to whole families
        of_run = neighbors_of((2 * np.arange(len(rank)) + 1) * parts // (2 * len(rank)), neighbors, parts)
        assert report["neighbors_max_before"] == max(of_run), (report, of_run)
        assert np.isclose(report["neighbors_mean_before"], np.mean(of_run))
    assert report["empty_parts"] == parts - len(set(rank))
    if lineage is not None:
        first = np.arange(len(rank)) - Lineage(lineage).child_in_whole
        assert (rank == rank[first]).all(), "a family is torn"
    return rank, report


def imbalance(rank, weight, parts):
    return np.bincount(rank, weight, parts).max() * parts / weight.sum()


def test_uniform_weights_give_parts_of_equal_size():
    kuhn_cube("a.hdf", 8)
    for parts in (1, 2, 3, 7):
        for method in ("scotch", "blocks"):
            rank, report = partition("a.hdf", parts, "--weights", "uniform", "--method", method)
            assert np.isclose(report["imbalance_after"], imbalance(rank, np.ones(len(rank)), parts))
            assert report["imbalance_after"] <= 1.05
            assert report["method"] == (method if parts > 1 else "none")


def test_scotch_cuts_fewer_faces_than_runs_of_cells():
    kuhn_cube("a.hdf", 12)
    scotch = partition("a.hdf", 8, "--method", "scotch")[1]
    blocks = partition("a.hdf", 8, "--method", "blocks")[1]
    assert scotch["edge_cut"] < blocks["edge_cut"] == blocks["edge_cut_before"]


def test_weights_refine_balance_the_refined_mesh():
    kuhn_cube("a.hdf", 8)
    run("pamr-mark", "a.hdf", "-o", "b.hdf", "--box", "0,0,0,1,1,0.3", "--quiet")
    rank, report = partition("b.hdf", 4)
    assert report["weights"] == "refine" and report["imbalance_before"] > 1.5 and report["imbalance_after"] <= 1.05
    # the field survives the refinement: children bear the rank of their parent
    run("pamr-refine", "parts.hdf", "-o", "fine.hdf", "--quiet")
    with h5py.File("fine.hdf") as file:
        children = file["VTKHDF/CellData/rank"][:]
    assert np.isclose(report["imbalance_after"], imbalance(children, np.ones(len(children)), 4))

    # a mesh that holds closure families
    run("pamr-mark", "fine.hdf", "-o", "marked.hdf", "--box", "0.2,0,0,0.6,1,0.4", "--quiet")
    assert partition("marked.hdf", 5)[1]["imbalance_after"] <= 1.05


def test_the_papers_weights_count_a_marked_cell_eight_times():
    kuhn_cube("a.hdf", 6)
    run("pamr-mark", "a.hdf", "-o", "b.hdf", "--box", "0,0,0,1,1,0.4", "--quiet")
    with h5py.File("b.hdf") as file:
        weight = np.where(file["VTKHDF/CellData/refine"][:] == 1, 8, 1)
    rank, report = partition("b.hdf", 4, "--weights", "8/1")
    assert np.isclose(report["imbalance_after"], imbalance(rank, weight, 4)) and report["imbalance_after"] <= 1.05
    add_cell_field("a.hdf", "weight", weight)
    assert (partition("a.hdf", 4, "--weights", "weight")[0] == rank).all()
    for options in (("--shape-floor", 0.3), ("--quality-control", "none")):  # of marks alone, so not uniform
        refuses("pamr-partition", "a.hdf", "-o", "b2.hdf", "-p", 2, *options, says=["'refine'", "a.hdf"], creates="b2.hdf")
    refuses("pamr-partition", "a.hdf", "-o", "b2.hdf", "-p", 2, "--weights", "8/1", says=["'refine'", "a.hdf"],
            creates="b2.hdf")


def test_parts_do_not_replace_data():
    kuhn_cube("a.hdf", 2)
    add_cell_field("a.hdf", "rank", np.arange(48.0))
    refuses("pamr-partition", "a.hdf", "-o", "b.hdf", "-p", 2, says=["a.hdf", "cell field 'rank'", "found reals"], creates="b.hdf")


def test_a_mesh_without_marks_counts_each_cell_once():
    kuhn_cube("a.hdf", 5)
    rank, report = partition("a.hdf", 3)
    assert report["weights"] == "uniform" and (rank == partition("a.hdf", 3, "--weights", "uniform")[0]).all()


def test_a_cell_field_may_weigh():
    kuhn_cube("a.hdf", 8)
    particles = np.random.default_rng(1).integers(0, 40, 3072) ** 2
    add_cell_field("a.hdf", "particles", particles)
    rank, report = partition("a.hdf", 6, "--weights", "particles")
    assert np.isclose(report["imbalance_after"], imbalance(rank, particles, 6), rtol=1e-6)
    assert report["imbalance_after"] <= 1.05


def test_pamr_refine_makes_the_same_mesh_whatever_cells_weigh():
    kuhn_cube("a.hdf", 5)
    run("pamr-mark", "a.hdf", "-o", "b.hdf", "--box", "0,0,0,1,1,0.3", "--quiet")
    add_cell_field("b.hdf", "particles", 0.5 + np.random.default_rng(2).random(750))
    cuts = set()
    for weights, method in (("exact", "scotch"), ("8/1", "scotch"), ("uniform", "blocks"), ("particles", "scotch"),
                            ("particles", "blocks")):
        report = run("pamr-refine", "b.hdf", "-o", "fine.hdf", "--force", "--weights", weights, "--balance", method,
                     "--json", "-").json
        balance = report["balance"]
        assert {"edge_cut_before", "edge_cut_after", "moved_cells", "neighbors_max_before", "neighbors_max_after",
                "imbalance_before", "imbalance_after"} <= set(balance)
        if weights == "exact":
            os.rename("fine.hdf", "first.hdf")
            assert balance["imbalance_after"] <= 1.05
        else:
            assert same_bytes("first.hdf", "fine.hdf"), (weights, method)
        cuts.add((balance["edge_cut_after"], balance["moved_cells"], balance["imbalance_after"]))
    assert len(cuts) == (5 if RANKS > 1 else 1), cuts  # each was heeded


def test_more_parts_than_cells_leave_parts_empty():
    kuhn_cube("a.hdf", 1)
    for method in ("scotch", "blocks"):
        rank, report = partition("a.hdf", 10, "--method", method)
        assert len(set(rank)) == 6 and report["empty_parts"] == 4


def test_huge_weights_in_a_million_parts():
    kuhn_cube("a.hdf", 1)
    add_cell_field("a.hdf", "huge", np.full(6, 1e30))
    report = run("pamr-partition", "a.hdf", "-o", "parts.hdf", "--force", "-p", 2**20, "--weights", "huge", "--json",
                 "-").json
    assert report["empty_parts"] == 2**20 - 6


def test_the_rest_of_the_file_stays_as_it_is():
    kuhn_cube("a.hdf", 4)
    partition("a.hdf", 3)
    run("pamr-diff", "a.hdf", "parts.hdf", code=1)  # the field `rank` is new, and nothing else
    with h5py.File("a.hdf") as old, h5py.File("parts.hdf") as new:
        assert (old["VTKHDF/Connectivity"][:] == new["VTKHDF/Connectivity"][:]).all()
        assert (old["VTKHDF/Points"][:] == new["VTKHDF/Points"][:]).all()
        assert set(new["VTKHDF/CellData"]) == {"rank", "level"}
    # made again it replaces the field, and is the same
    run("pamr-partition", "parts.hdf", "-o", "again.hdf", "-p", 3, "--quiet")
    assert same_bytes("parts.hdf", "again.hdf")


def test_bad_input_is_refused_in_one_line():
    kuhn_cube("a.hdf", 2)
    add_cell_field("a.hdf", "negative", np.where(np.arange(48) == 17, -2.0, 1.0))
    add_cell_field("a.hdf", "nothing", np.zeros(48))
    add_cell_field("a.hdf", "nan", np.where(np.arange(48) == 5, np.nan, 1.0))
    add_cell_field("a.hdf", "vector", np.ones((48, 3)))
    add_cell_field("a.hdf", "refine", np.where(np.arange(48) == 5, 2, 0))
    add_cell_field("a.hdf", "marks", np.where(np.arange(48) == 5, 1, 0))
    for field, words in (("negative", ["'negative'", "at least 0", "-2", "cell 17"]), ("nan", ["nan", "cell 5"]),
                         ("nothing", ["found 0 in all the 48 cells"]), ("vector", ["one component", "3"]),
                         ("missing", ["'missing'", "a.hdf"]), ("refine", ["refine", "cell 5"])):
        refuses("pamr-partition", "a.hdf", "-o", "b.hdf", "-p", 2, "--weights", field, says=words, creates="b.hdf")
        if field != "refine":
            refuses("pamr-refine", "a.hdf", "-o", "b.hdf", "--marks", "marks", "--weights", field, says=words,
                    creates="b.hdf")
    for options, words in ((("--marks", "absent"), ["absent"]),  # asked for, so not uniform
                           (("--marks", "marks", "--weights", "uniform"), ["--marks", "--weights refine or 8/1"]),
                           (("--shape-floor", "0.3", "--weights", "8/1"), ["--shape-floor", "--weights refine"])):
        refuses("pamr-partition", "a.hdf", "-o", "b.hdf", "-p", 2, *options, says=words, creates="b.hdf")
    refuses("pamr-partition", "a.hdf", "-o", "b.hdf", "-p", 0, creates="b.hdf")
    refuses("pamr-partition", "a.hdf", "-o", "b.hdf", creates="b.hdf")
    refuses("pamr-partition", "a.hdf", "-o", "b.hdf", "-p", 2, "--method", "metis", creates="b.hdf")
    refuses("pamr-partition", "a.hdf", "-o", "a.hdf", "-p", 2, "--force")


run_tests(globals(), on_ranks=(test_pamr_refine_makes_the_same_mesh_whatever_cells_weigh, test_weights_refine_balance_the_refined_mesh,
                               test_the_papers_weights_count_a_marked_cell_eight_times, test_the_rest_of_the_file_stays_as_it_is))
