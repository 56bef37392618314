# SPDX-License-Identifier: GPL-3.0-or-later
"""Every tool on more ranks than there are cells, and on meshes without any: the right result or one clear error."""
import math

import h5py
import numpy as np

import tool_run
from tool_run import FULL, RANKS, refuses, run, run_tests, same_bytes

tool_run.REFUSED_BY_ALL = 1  # more ranks than cells are what this is about

POLICIES = ("none", "isotropic", "short-edge", "removable")


def helix(n_cells):
    """Tetrahedra in a row, each sharing a face with the next."""
    turn, radius, rise = math.acos(-2 / 3), 0.3 * math.sqrt(3), 1 / math.sqrt(10)
    points = np.array([[radius * math.cos(i * turn), radius * math.sin(i * turn), i * rise] for i in range(n_cells + 3)])
    cells = np.array([[c, c + 1, c + 2, c + 3] for c in range(n_cells)], dtype=np.int64).reshape(-1, 4)
    for c in cells:
        p = points[c]
        if np.dot(np.cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) < 0:
            c[:2] = c[1::-1]
    return points, cells


def write_bare(name, points, cells):
    with h5py.File(name, "w") as file:
        vtk = file.create_group("VTKHDF")
        vtk.attrs["Version"], vtk.attrs["Type"] = np.array([1, 0]), np.bytes_("UnstructuredGrid")
        vtk["NumberOfPoints"], vtk["NumberOfCells"] = np.array([len(points)]), np.array([len(cells)])
        vtk["NumberOfConnectivityIds"] = np.array([cells.size])
        vtk["Points"], vtk["Connectivity"] = points, cells.ravel()
        vtk["Offsets"], vtk["Types"] = np.arange(0, cells.size + 1, 4), np.full(len(cells), 10, np.uint8)
    return name


def refined_on(ranks, mesh, policy, out):
    """Two levels, the second one marked where closure families are."""
    serial = ranks == 1
    for level, box in enumerate(("-9,-9,-9,9,9,0.1", "-9,-9,0.1,9,9,9")):
        run("pamr-mark", out if level > 0 else mesh, "-o", "marked.hdf", "--box", box, "--force", "--quiet",
            serial=serial or level > 0 or policy != "removable")
        run("pamr-refine", "marked.hdf", "-o", out, "--quality-control", policy, "--force", "--quiet", serial=serial)
    return out


def test_refinement_gives_the_same_bytes_as_on_one_rank():
    for n_cells in (1, 3, 5):
        mesh = write_bare(f"helix{n_cells}.hdf", *helix(n_cells))
        for policy in POLICIES if n_cells == 3 and FULL else ("removable",):
            refined_on(RANKS, mesh, policy, "many.hdf")
            refined_on(1, mesh, policy, "one.hdf")
            assert same_bytes("many.hdf", "one.hdf"), (n_cells, policy)


def test_everything_marked_makes_eight_of_each():
    for n_cells in (2, 4):
        mesh = write_bare(f"helix{n_cells}.hdf", *helix(n_cells))
        run("pamr-mark", mesh, "-o", "marked.hdf", "--all", "--force", "--quiet", serial=True)
        if n_cells == 2:
            report = run("pamr-refine", "marked.hdf", "--dry-run", "--json", "-", "--quiet").json
            assert report["cells_out"] == 8 * n_cells, report
            bound = report["uniform_shape_bound"]
            for floor in (0, 0.1, 1):
                report = run("pamr-refine", "marked.hdf", "--dry-run", "--shape-floor", floor, "--json", "-", "--quiet").json
                assert report["shape_bound"] == min(floor, bound) and report["uniform_shape_bound"] == bound, report
            assert "shape_bound" not in run("pamr-refine", "marked.hdf", "--dry-run", "--quality-control", "none", "--json",
                                            "-", "--quiet").json
        report = run("pamr-refine", "marked.hdf", "-o", "out.hdf", "--force", "--json", "-", "--quiet").json
        assert report["cells_out"] == 8 * n_cells and report["inverted_cells"] == 0, report


def test_nothing_marked_leaves_the_mesh_as_it_is():
    mesh = write_bare("helix.hdf", *helix(2))
    run("pamr-mark", mesh, "-o", "marked.hdf", "--box", "5,5,5,6,6,6", "--quiet")
    run("pamr-refine", "marked.hdf", "-o", "out.hdf", "--quiet")
    with h5py.File("out.hdf") as new, h5py.File("helix.hdf") as old:
        for name in ("Points", "Connectivity"):
            assert np.array_equal(new["VTKHDF"][name], old["VTKHDF"][name]), name


def test_quality_and_differences_are_those_of_one_rank():
    for n_cells in (1, 2, 5):
        mesh = write_bare(f"helix{n_cells}.hdf", *helix(n_cells))
        many = run("pamr-quality", mesh, "--json", "-", "--quiet").json
        assert many == run("pamr-quality", mesh, "--json", "-", "--quiet", serial=True).json
        assert many["cells"] == n_cells and many["conforming"] and many["neighbors_consistent"], many
        if n_cells in (1, 5):
            run("pamr-quality", mesh, "--worst", 3, "--worst-out", f"worst{n_cells}.hdf", "--quiet")
            with h5py.File(f"worst{n_cells}.hdf") as file:
                assert len(file["VTKHDF/Types"]) == min(n_cells, 3)
    run("pamr-diff", "helix1.hdf", "helix1.hdf")
    run("pamr-diff", "helix2.hdf", "helix1.hdf", code=1)


def test_more_ranks_and_more_parts_than_cells():
    mesh = write_bare("helix.hdf", *helix(2))
    run("pamr-partition", mesh, "-o", "many.hdf", "-p", 2, "--quiet")
    with h5py.File("many.hdf") as file:
        assert sorted(file["VTKHDF/CellData/rank"]) == [0, 1]
    report = run("pamr-partition", mesh, "-o", "parts.hdf", "-p", 5, "--json", "-", "--quiet").json
    assert report["empty_parts"] == 3, report


def test_a_mesh_without_cells_is_refused_by_every_tool():
    points, _ = helix(1)
    empty = write_bare("empty.hdf", points, np.zeros((0, 4), dtype=np.int64))
    nothing = write_bare("nothing.hdf", points[:0], np.zeros((0, 4), dtype=np.int64))
    good = write_bare("good.hdf", *helix(1))
    for mesh, where in ((empty, "NumberOfCells: expected 1 cell or more"),
                        (nothing, "NumberOfPoints: expected 4 points or more")):
        refuses("pamr-refine", mesh, "-o", "out.hdf", says=[mesh, where], creates="out.hdf")
        refuses("pamr-mark", mesh, "-o", "out.hdf", "--all", says=[mesh, where], creates="out.hdf")
    refuses("pamr-quality", empty, says=[empty, "1 cell or more"])
    refuses("pamr-partition", empty, "-o", "out.hdf", "-p", 2, says=[empty, "1 cell or more"], creates="out.hdf")
    refuses("pamr-diff", good, empty, says=[empty, "1 cell or more"])


if __name__ == "__main__":
    print(f"{RANKS} ranks")
    run_tests(globals())
