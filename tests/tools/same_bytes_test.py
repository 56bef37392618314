# SPDX-License-Identifier: GPL-3.0-or-later
"""The refined file is the same, byte for byte, on 1, 2, 3, 4 and 7 ranks (at the full level 8 and 16 too), however its
cells are balanced: the last of several levels of a flat and of a curved case (at the full level all of them).

Called with the name of the policy to test as the last argument, after what tool_run.py wants.
"""
import json
import sys

POLICY = sys.argv.pop()

import h5py
import numpy as np

from tool_run import FULL, kuhn_cube, of_full_level, run, run_tests, same_bytes

# How cells are balanced on each number of ranks.
BALANCE = {1: "auto", 2: "auto", 3: "scotch", 4: "blocks", 7: "scotch"}
if FULL:
    BALANCE |= {1: "scotch", 8: "scotch", 16: "auto"}
STEPS = "read preprocessing close balance number project subdivide relink transfer write".split()
KEYS = ("cells_in cells_out nodes_in nodes_out marked rounds inverted_cells off_surface_nodes fingerprint families_kept "
        "marked_not_split peak_rss_bytes peak_rss_bytes_sum bytes_per_cell_at_rest bytes_sent_max bytes_read_max").split()
# What a report says of the mesh, not of the run (the rounds of closing depend on how far a mark has to travel).
SHARED = [key for key in KEYS[:11] if key != "rounds"]


def add_fields(name, near_box=None):
    """Fields whose values are not round numbers, so that a sum in another order would show."""
    random = np.random.default_rng(11)
    with h5py.File(name, "r+") as file:
        points = file["VTKHDF/Points"][:]
        centroid = points[file["VTKHDF/Connectivity"][:].reshape(-1, 4)].mean(axis=1)
        cells, nodes = (file["VTKHDF"].require_group(group) for group in ("CellData", "PointData"))
        cells["temperature"] = 300 + random.random(len(centroid))
        cells["velocity"] = random.random((len(centroid), 3)) - 0.5
        cells["region"] = random.integers(0, 5, len(centroid)).astype(np.int32)
        nodes["potential"] = random.random(len(points))
        if near_box is not None:
            low, high = near_box
            cells["near"] = ((centroid >= low) & (centroid <= high)).all(axis=1).astype(float)


def check_report(report, ranks):
    missing = [key for key in KEYS + ["seconds"] if key not in report]
    assert not missing, f"the report lacks {missing}"
    seconds = report["seconds"]
    for step in STEPS + ["total"]:
        low, mean, high = (seconds[step][key] for key in ("min", "mean", "max"))
        assert 0 <= low <= mean * (1 + 1e-12) and mean <= high * (1 + 1e-12), (step, seconds[step])
    total = seconds["total"]["mean"]
    parts = sum(seconds[step]["mean"] for step in STEPS)
    assert set(seconds) == set(STEPS + ["total"]), "a step that nobody knows takes part in the total"
    assert abs(parts - total) <= 0.02 * total, f"the steps take {parts} s, the total is {total} s"
    assert report["inverted_cells"] == 0 and report["marked_not_split"] == 0
    assert report["cells_out"] > report["cells_in"] > 0 and report["marked"] > 0
    assert (report["bytes_sent_max"] > 0) == (ranks > 1), report["bytes_sent_max"]
    assert report["peak_rss_bytes"] <= report["peak_rss_bytes_sum"] <= ranks * report["peak_rss_bytes"]


def next_level(mesh, level, criterion, last):
    """Marks (of one policy on 1 and 3 ranks) and refines, the last level on all numbers of ranks; the new mesh and the report."""
    on_all = FULL or level == last
    for ranks in (1, 3) if POLICY == "removable" and on_all else (1,):
        run("pamr-mark", mesh, "-o", f"marked{ranks}.hdf", "--force", "--quiet", *criterion, ranks=ranks)
    if POLICY == "removable" and on_all:
        assert same_bytes("marked1.hdf", "marked3.hdf"), f"level {level}: marks depend on the number of ranks"
    reports = []
    for ranks, balance in BALANCE.items() if on_all else [(1, "auto")]:
        out = f"level{level}_on{ranks}.hdf"
        reports.append(run("pamr-refine", "marked1.hdf", "-o", out, "--quality-control", POLICY, "--balance", balance,
                           "--json", "-", "--quiet", ranks=ranks).json)
        check_report(reports[-1], ranks)
        for key in SHARED:
            assert reports[-1][key] == reports[0][key], f"level {level}, {ranks} ranks: {key} differs"
        assert same_bytes(f"level{level}_on1.hdf", out), f"level {level}: {ranks} ranks write other bytes than 1"
    return f"level{level}_on1.hdf", reports[0]


def check_mesh(mesh):
    """The invariants by another program than the one that made the mesh."""
    report = run("pamr-quality", mesh, "--json", "-", "--quiet", ranks=3).json
    assert report["conforming"] is True and report["neighbors_consistent"] is True
    assert report["inverted_cells"] == 0
    return report


def test_levels_of_a_sphere_in_the_kuhn_cube():
    mesh = kuhn_cube("level0.hdf", 3)
    add_fields(mesh)
    last = 4 if FULL else 3
    for level in range(1, last + 1):
        mesh, report = next_level(mesh, level, ["--crossing-sphere", "0.5,0.5,0.5,0.35"], last)
    found = check_mesh(mesh)
    assert abs(found["volume"] - 1) <= 1e-12 and found["fingerprint"] == report["fingerprint"]
    print(f"        {POLICY}: {report['cells_out']} cells, mean ratio {found['mean_ratio']['min']:.3f}")


def test_levels_at_the_sphere_in_a_box():
    mesh = "level0.hdf"
    run("pamr-mesh", "--shape", "sphere-in-box", "-o", mesh, "--quiet", ranks=1)
    add_fields(mesh, near_box=([-1.5, -1.5, 0], [1.5, 1.5, 1.5]))
    check_at_walls(mesh, ["--patch", "sphere", "--layers", "2", "--only-where", "near:above:0.5"], 2, 4)


@of_full_level
def test_levels_at_the_shoulder_of_the_blunt_cone():
    mesh = "level0.hdf"
    run("pamr-mesh", "--shape", "blunt-cone", "-o", mesh, "--quiet", ranks=1)
    add_fields(mesh, near_box=([7e-3, -1, 22e-3], [11e-3, 3e-3, 27e-3]))
    check_at_walls(mesh, ["--patch", "forebody", "--layers", "2", "--only-where", "near:above:0.5"], 3, 0.05)


def check_at_walls(mesh, criteria, last, size):
    """Levels at curved walls of a body of this size."""
    for level in range(1, last + 1):
        mesh, report = next_level(mesh, level, criteria, last)
        assert report["off_surface_nodes"] == 0, report["off_surface_nodes"]
    found = check_mesh(mesh)
    worst = max(patch["worst_distance"] for patch in found["patches"].values())
    assert worst <= 1e-12 * size, f"a node is {worst} off its surface"
    print(f"        {POLICY}: {report['cells_out']} cells, mean ratio {found['mean_ratio']['min']:.3f}")


if POLICY != "removable":
    of_full_level(test_levels_at_the_sphere_in_a_box)
run_tests(globals())
