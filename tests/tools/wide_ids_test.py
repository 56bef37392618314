# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh whose numbers begin at 2^51 goes through every tool and every format like the one that begins at 0."""
import filecmp
import json
import pathlib
import shutil

import h5py
import numpy as np

from gas_cases import gas_in_a_cube
from tool_run import RANKS, kuhn_cube, refuses, run, run_tests, same_bytes

FIRST = 2**51


def numbered_from(first, source, target):
    """A copy in which cells and nodes are numbered from `first` on."""
    shutil.copy(source, target)
    with h5py.File(target, "r+") as file:
        file["PAMR"].attrs["first_id"] = np.int64(first)
        for name in ("PAMR/cell_to_cell", "VTKHDF/CellData/parent"):
            if name in file:
                values = file[name][:]
                file[name][...] = np.where(values >= 0, values + first, values)
                file["PAMR/checksums"].attrs.pop(name, None)
    return target


def equal_but_for_numbers(wide, plain):
    """Every dataset is the same but for numbers of cells, which are greater by FIRST."""
    with h5py.File(wide) as a, h5py.File(plain) as b:
        names = []
        b.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        for name in names:
            x, y = a[name][()], b[name][()]
            if name.endswith(("cell_to_cell", "CellData/parent")):
                y = np.where(y >= 0, y + FIRST, y)
            assert np.array_equal(x, y), name
        assert a["PAMR"].attrs["first_id"] == FIRST
        assert "first_id" not in b["PAMR"].attrs
        assert a["PAMR"].attrs["fingerprint"] == b["PAMR"].attrs["fingerprint"]


def test_marking_and_refining():
    plain = kuhn_cube("plain0.hdf", 3)
    wide = numbered_from(FIRST, plain, "wide0.hdf")
    for level in range(2):
        for mesh in ("plain", "wide"):
            run("pamr-mark", f"{mesh}{level}.hdf", "-o", f"{mesh}.hdf", "--crossing-sphere", "0,0,0,0.6", "--max-cells",
                9000, "--force", "--quiet")
            run("pamr-refine", f"{mesh}.hdf", "-o", f"{mesh}{level + 1}.hdf", "--quiet")
        equal_but_for_numbers("wide.hdf", "plain.hdf")
        equal_but_for_numbers(f"wide{level + 1}.hdf", f"plain{level + 1}.hdf")
    run("pamr-refine", "wide.hdf", "-o", "one.hdf", "--quiet", serial=True)
    assert same_bytes("one.hdf", "wide2.hdf")


def test_coarsening():
    plain = kuhn_cube("plain0.hdf", 3)
    numbered_from(FIRST, plain, "wide0.hdf")
    for mesh in ("plain", "wide"):
        run("pamr-mark", f"{mesh}0.hdf", "-o", f"{mesh}-up.hdf", "--crossing-sphere", "0,0,0,0.6", "--quiet")
        run("pamr-refine", f"{mesh}-up.hdf", "-o", f"{mesh}1.hdf", "--quiet")
        run("pamr-mark", f"{mesh}1.hdf", "-o", f"{mesh}-both.hdf", "--crossing-sphere", "1,1,1,0.4", "--coarsen-rest", "--quiet")
        report = run("pamr-refine", f"{mesh}-both.hdf", "-o", f"{mesh}2.hdf", "--json", "-").json
        assert report["coarsening"]["octets_gone"] > 0, report["coarsening"]
    for name in ("-both", "2"):
        equal_but_for_numbers(f"wide{name}.hdf", f"plain{name}.hdf")


def same_trees(a, b):
    """Two files, or folders of files, have the same bytes."""
    if pathlib.Path(a).is_file():
        return same_bytes(a, b)
    names = [sorted(str(f.relative_to(root)) for f in pathlib.Path(root).rglob("*") if f.is_file()) for root in (a, b)]
    assert names[0] and names[0] == names[1], names
    return filecmp.cmpfiles(a, b, names[0], shallow=False)[0] == names[0]


def test_every_other_format():
    """Other formats count from 0 or 1 whatever the mesh counts from: their files are the same."""
    plain = kuhn_cube("plain.hdf", 2)
    numbered_from(FIRST, plain, "wide.hdf")
    formats = [(".msh", ["--order", 2]), (".vtu", []), (".cgns", []), ("", [])]
    if RANKS == 1:
        formats += [(".msh", ["--text"]), (".msh", ["--gmsh-version", "2.2"]), (".vtu", ["--order", 2]), (".mesh", []),
                    (".meshb", []), (".su2", []), (".lb8.ugrid", []), (".b8.ugrid", []), (".stl", []), (".obj", []),
                    (".ply", []), (".off", []), (".vtp", [])]
    for ending, more in formats:
        outputs = [f"{mesh}-out{ending}" for mesh in ("plain", "wide")]
        for mesh, out in zip(("plain.hdf", "wide.hdf"), outputs):
            run("pamr-convert", mesh, out, "--force", "--quiet", *more)
        assert same_trees(*outputs), (ending, more)


def test_reports_and_comparisons():
    plain = kuhn_cube("plain.hdf", 3)
    wide = numbered_from(FIRST, plain, "wide.hdf")
    reports = [run("pamr-quality", mesh, "--json", "-").json for mesh in (plain, wide)]
    assert json.dumps(reports[0]).replace("plain.hdf", "") == json.dumps(reports[1]).replace("wide.hdf", "")
    run("pamr-diff", plain, wide)
    run("pamr-diff", wide, plain)
    for method in ("scotch", "blocks"):
        for mesh in (plain, wide):
            run("pamr-partition", mesh, "-o", f"{method}-{mesh}", "-p", 4, "--method", method, "--quiet")
        equal_but_for_numbers(f"{method}-{wide}", f"{method}-{plain}")
    run("pamr-quality", wide, "--worst", 5, "--worst-out", "worst.hdf", "--quiet")
    with h5py.File("worst.hdf") as file:
        cells = file["VTKHDF/CellData/cell"][:]
        assert len(cells) == 5 and (cells >= FIRST).all() and (cells < FIRST + 6 * 27).all(), cells


def test_a_flow_on_them_and_carried():
    plain = kuhn_cube("plain0.hdf", 3)
    numbered_from(FIRST, plain, "wide0.hdf")
    with open("case.toml", "w") as file:
        file.write(gas_in_a_cube(transient=4, sampling=8, xmax='kind = "outflow"', ymin='kind = "symmetry"',
                                 ymax='kind = "symmetry"', zmin='kind = "diffuse", temperature = 500.0'))
    for mesh in ("plain", "wide"):
        run("pamr-dsmc", "case.toml", "--mesh", f"{mesh}0.hdf", "-o", f"{mesh}.hdf", "--checkpoint", f"{mesh}.ck",
            "--surface", f"{mesh}.vtu", "--quiet")
        run("pamr-dsmc", "case.toml", "--mesh", f"{mesh}0.hdf", "-o", f"{mesh}-short.hdf", "--checkpoint", f"{mesh}-short.ck",
            "--steps", "6", "--quiet", serial=True)
        run("pamr-dsmc", "case.toml", "--mesh", f"{mesh}0.hdf", "-o", f"{mesh}-again.hdf", "--restart", f"{mesh}-short.ck", "--quiet")
        assert same_bytes(f"{mesh}.hdf", f"{mesh}-again.hdf")
        run("pamr-mark", f"{mesh}.hdf", "-o", f"{mesh}-marked.hdf", "--crossing-sphere", "0,0,0,0.6", "--quiet")
        run("pamr-refine", f"{mesh}-marked.hdf", "-o", f"{mesh}1.hdf", "--quiet")
        run("pamr-dsmc", "case.toml", "--mesh", f"{mesh}1.hdf", "-o", f"{mesh}2.hdf", "--carry", f"{mesh}.ck", "--quiet")
    assert same_bytes("plain.ck", "wide.ck") and same_bytes("plain.vtu", "wide.vtu")
    equal_but_for_numbers("wide.hdf", "plain.hdf")
    equal_but_for_numbers("wide2.hdf", "plain2.hdf")


def test_numbers_that_do_not_follow_the_first():
    plain = kuhn_cube("plain.hdf", 2)
    shutil.copy(plain, "bad.hdf")
    with h5py.File("bad.hdf", "r+") as file:
        file["PAMR"].attrs["first_id"] = np.int64(FIRST)
    for tool, arguments in (("pamr-refine", ["-o", "out.hdf"]), ("pamr-mark", ["-o", "out.hdf", "--all"]),
                            ("pamr-quality", [])):
        refuses(tool, "bad.hdf", *arguments, says=["bad.hdf", "cell_to_cell", f"from {FIRST} to {FIRST + 47}"],
                creates="out.hdf")


if __name__ == "__main__":
    print(f"{RANKS} ranks")
    run_tests(globals(), on_ranks=(test_marking_and_refining, test_coarsening, test_a_flow_on_them_and_carried))
