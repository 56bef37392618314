# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of format 1 are read, refined and written for good; cells read from them know no ancestors.

`data/format-1.hdf.xz` was written by version 0.1.0: a Kuhn cube of 6 cells, refined twice with `--quality-control none`
and marked again. It has regular cells of levels 0 and 1, whole families of 1:2 and 1:4, and broken ones of both."""
import lzma
import pathlib
import shutil

import h5py
import numpy as np

from lineage_words import Lineage
from tool_run import add_cell_field, kuhn_cube, refuses, run, run_tests, same_bytes

FINGERPRINT = "d2a39c584ed3d3ab"
REFINED = {"none": (91, "efb709f52f46e821"), "isotropic": (352, "274397bcab41e431"),
           "short-edge": (187, "1c78b1ae7bb13d56")}
"""What version 0.1.0 made of the file: cells and fingerprint."""


def old_file(name="old.hdf"):
    data = pathlib.Path(__file__).parent / "data" / "format-1.hdf.xz"
    pathlib.Path(name).write_bytes(lzma.decompress(data.read_bytes()))
    return name


def words(name, number):
    with h5py.File(name) as file:
        assert file["PAMR"].attrs["format"] == number, file["PAMR"].attrs["format"]
        return file["PAMR/lineage"][:].astype(np.int64)


def test_it_is_the_mesh_that_it_was():
    report = run("pamr-quality", old_file(), "--json", "-").json
    assert report["valid"] and report["cells"] == 44 and report["fingerprint"] == FINGERPRINT
    assert report["cells_of_level"] == [27, 17] and report["closure_cells"] == 29


def test_format_2_says_the_same_in_other_words():
    run("pamr-convert", old_file(), "new.hdf", "--quiet")
    old, new = words("old.hdf", 1), Lineage(words("new.hdf", 2))
    kind, index, child = old & 3, old >> 2 & 7, old >> 5 & 3
    assert (new.state == np.choose(kind, [0 * kind, 1 + index, 7 + index])).all()
    assert (new.child == child).all() and (new.level == old >> 8).all() and (new.broken == (old >> 7 & 1)).all()
    assert (new.path == 0).all(), "an ancestor that nobody knows"
    assert len(set(zip(kind, new.broken))) == 5, "the file has lost a sort of cell"
    run("pamr-diff", "old.hdf", "new.hdf", "--quiet")


def test_the_way_back_gives_the_same_words():
    run("pamr-convert", old_file(), "new.hdf", "--quiet")
    run("pamr-convert", "new.hdf", "again.hdf", "--format", 1, "--quiet")
    assert (words("old.hdf", 1) == words("again.hdf", 1)).all()
    run("pamr-convert", "old.hdf", "direct.hdf", "--format", 1, "--quiet")
    assert same_bytes("again.hdf", "direct.hdf")


def test_it_is_refined_as_it_was():
    for policy, (cells, fingerprint) in REFINED.items():
        report = run("pamr-refine", old_file(), "-o", "out.hdf", "--force", "--quality-control", policy, "--json",
                     "-").json
        assert (report["cells_out"], report["fingerprint"]) == (cells, fingerprint), policy


def test_children_know_their_place_and_no_more():
    run("pamr-refine", old_file(), "-o", "out.hdf", "--quiet")
    run("pamr-quality", "out.hdf", "--quiet")
    with h5py.File("out.hdf") as file:
        parent = file["VTKHDF/CellData/parent"][:]
    new, old = Lineage(words("out.hdf", 2)), words("old.hdf", 1)
    split = new.level > (old >> 8)[parent]
    assert split.any() and (new.path[split] >= 8).all() and (new.path[split] < 16).all(), "depth 1"
    assert (new.path[~split] == 0).all()


def test_ancestors_are_dropped_on_the_way_through_format_1():
    kuhn_cube("level0.hdf", 2)
    run("pamr-mark", "level0.hdf", "-o", "marked.hdf", "--all", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "level1.hdf", "--quiet")
    assert (np.sort(words("level1.hdf", 2) >> 20) == np.repeat(np.arange(8, 16), 48)).all()
    run("pamr-convert", "level1.hdf", "old.hdf", "--format", 1, "--quiet")
    assert (words("old.hdf", 1) == 1 << 8).all()
    run("pamr-convert", "old.hdf", "new.hdf", "--quiet")
    assert (words("new.hdf", 2) == 1 << 12).all()
    run("pamr-diff", "level1.hdf", "new.hdf", "--quiet")


def examples_of_the_page():
    """The functions in Python of docs/file-format-lineage.md."""
    page = (pathlib.Path(__file__).parents[2] / "docs" / "file-format-lineage.md").read_text()
    code = next(block.split("```")[0] for block in page.split("```python")[1:] if "def child_of_eight" in block)
    names = {}
    exec(code, names)
    return names


def test_the_page_makes_the_words_that_refinement_makes():
    page = examples_of_the_page()
    assert page["regular"](0) == 0
    deep = page["regular"](0)
    for level in range(13):
        deep = page["child_of_eight"](deep, level * 5 % 8)
    kuhn_cube("a.hdf", 1)
    for _ in range(3):  # 13 known ancestors become 14, the most, and then the oldest is dropped
        with h5py.File("a.hdf", "r+") as file:
            file["PAMR/lineage"][:] = deep
            file["PAMR/checksums"].attrs.pop("PAMR/lineage", None)
        run("pamr-mark", "a.hdf", "-o", "marked.hdf", "--all", "--force", "--quiet")
        run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--force", "--quiet")
        expected = [page["child_of_eight"](deep, number) for number in range(8)]
        assert (words("fine.hdf", 2) == np.tile(expected, 6)).all()
        deep = expected[3]
    lineage = Lineage([deep])
    assert lineage.level == 16 and int(lineage.path[0]).bit_length() == 43


def test_every_tool_that_writes_meshes_writes_format_1():
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", 2, "-o", "mesh.hdf", "--format", 1, "--quiet", serial=True)
    run("pamr-mark", "mesh.hdf", "-o", "marked.hdf", "--all", "--format", 1, "--quiet")
    run("pamr-partition", "marked.hdf", "-o", "parts.hdf", "-p", 2, "--format", 1, "--quiet")
    run("pamr-refine", "parts.hdf", "-o", "fine.hdf", "--format", 1, "--quiet")
    for name in ("mesh.hdf", "marked.hdf", "parts.hdf", "fine.hdf"):
        assert (words(name, 1) == (1 << 8 if name == "fine.hdf" else 0)).all()


def test_families_that_format_1_does_not_know_are_refused():
    kuhn_cube("level0.hdf", 3)
    shutil.copy("level0.hdf", "marked.hdf")
    add_cell_field("marked.hdf", "refine", (np.random.default_rng(15).uniform(size=162) < 0.1).astype(np.uint8))
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--quiet")
    other = np.flatnonzero(Lineage(words("fine.hdf", 2)).state > 10)
    assert len(other) > 0
    for command in (("pamr-refine", "marked.hdf", "-o", "old.hdf"), ("pamr-convert", "fine.hdf", "old.hdf")):
        refuses(*command, "--format", 1, says=["format 1", "closure cell of state"], creates="old.hdf")
    run("pamr-refine", "marked.hdf", "-o", "old.hdf", "--format", 1, "--quality-control", "none", "--quiet")
    run("pamr-quality", "old.hdf", "--quiet")


def test_other_formats_are_refused():
    kuhn_cube("a.hdf", 1)
    for number in (0, 5, -1, "x"):
        refuses("pamr-convert", "a.hdf", "out.hdf", "--format", number, says=["--format"], creates="out.hdf")
    for number in (1, 4):
        refuses("pamr-convert", "a.hdf", "out.msh", "--format", number, says=["--format", ".hdf"], creates="out.msh")
    with h5py.File("a.hdf", "r+") as file:
        file["PAMR"].attrs["format"] = 5
    refuses("pamr-refine", add_cell_field("a.hdf", "refine", np.ones(6, np.uint8)), "-o", "out.hdf",
            says=["format", "from 1 to 4", "found 5"], creates="out.hdf")


run_tests(globals(), on_ranks=(test_it_is_the_mesh_that_it_was, test_it_is_refined_as_it_was))
