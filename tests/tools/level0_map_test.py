# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a map of level 0 before anything is split: the short form of qualification/validation/level0_map.py."""
import json
import pathlib
import subprocess
import sys

from tool_run import of_full_level, run, run_tests

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"
sys.path.append(str(ROOT / "qualification/validation"))
import level0_map  # noqa: E402
import other_bodies  # noqa: E402


def call(tool, *words):
    return run(tool, *words, serial=tool != "pamr-refine").out


def holds(name, n_levels):
    """A test of its own for each mesh, so that several run at a time."""
    def test():
        row, faults = level0_map.check(call, name, pathlib.Path(".").resolve(), n_levels)
        assert not faults, (faults, row)

    return test


for mesh in level0_map.CASES:
    test = holds(mesh, 3 if mesh == "hole of 12" else 4)
    globals()[f"test_what_is_said_of_the_map_holds_for_the_{mesh.replace(' ', '_')}"] = test if mesh == "hole of 12" else of_full_level(test)


def refine_twice(body, wall):
    """The file of level 1, where all was split, with marks at the wall."""
    other_bodies.make(call, body, pathlib.Path("."))
    run("pamr-mark", "level0.hdf", "-o", "marked0.hdf", "--all", "--quiet", serial=True)
    first = run("pamr-refine", "marked0.hdf", "-o", "level1.hdf", serial=True)
    run("pamr-mark", "level1.hdf", "-o", "marked1.hdf", "--patch", wall, "--quiet", serial=True)
    return first


def test_a_floor_near_what_splitting_gives_is_said_to_cost_cells():
    first = refine_twice(other_bodies.shell(0, other_bodies.HOLE), "inner")
    assert "240 bent cells proved to be at least 0.4" in first.err and "splitting these cells into eight alone" in first.err, first.err
    floors = run("pamr-refine", "marked1.hdf", "--dry-run", "--floors", "--json", "dry.json")
    assert "splitting into eight alone: mean ratio 0.3" in floors.out, floors.out
    cells = [run("pamr-refine", "marked1.hdf", "--dry-run", "--shape-floor", floor, "--json", "-", "--quiet").json["cells_out"] for floor in (0.3, 0.35)]
    share = cells[1] / cells[0] - 1
    assert share > 0.05

    default = run("pamr-refine", "marked1.hdf", "-o", "level2.hdf", "--json", "report.json")
    lower = run("pamr-refine", "marked1.hdf", "-o", "lower.hdf", "--shape-floor", 0.3)

    with open("report.json", encoding="utf-8") as file:
        found = json.load(file)
    assert abs(found["floor_cost"] - share) < 0.1 * share and found["lower_floor"] == 0.3, (found["floor_cost"], share)
    assert f"some {100 * found['floor_cost']:.0f} % more cells than with --shape-floor 0.3" in default.out, default.out
    assert "cells than with" not in lower.out and "map of level 0" not in lower.err + default.err


def test_a_floor_that_flat_cells_cannot_have_is_said_to_cost_cells():
    for width, share in ((0.4, None), (2, 4), (4, 5)):  # of bricks that are 1, 5 and 10 times as wide as long
        subprocess.run([sys.executable, "-B", CASES / "box_mesh.py", "box.msh", "10", "4", "4", "0", "1", str(width)], check=True)
        run("pamr-convert", "box.msh", "box.hdf", "--force", "--quiet", serial=True)
        run("pamr-mark", "box.hdf", "-o", "marked.hdf", "--box", f"0,0,0,0.2,{width / 4},{width / 4}", "--force", "--quiet", serial=True)
        told = run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--force", "--json", "-").json
        none = run("pamr-refine", "marked.hdf", "-o", "none.hdf", "--force", "--shape-floor", 0, "--json", "-").json
        assert told["lower_floor"] == none["floor_cost"] == 0
        said = run("pamr-refine", "marked.hdf", "-o", "fine.hdf", "--force").out
        assert ("cells than with --shape-floor 0:" in said) == (share is not None), said
        if share is not None:
            assert told["floor_cost"] > share and abs(told["cells_out"] / none["cells_out"] - 1 - told["floor_cost"]) < 0.01 * told["floor_cost"], told


def test_a_floor_that_costs_little_is_not_mentioned():
    first = refine_twice(other_bodies.bore(8), "bore")
    assert "432 bent cells" in first.err, first.err
    assert "cells than with" not in run("pamr-refine", "marked1.hdf", "-o", "level2.hdf").out


def test_a_map_that_is_not_proved_is_warned_of_with_its_place():
    other_bodies.make(call, other_bodies.bore(3), pathlib.Path("."))
    run("pamr-mark", "level0.hdf", "-o", "marked.hdf", "--all", "--quiet", serial=True)
    told = run("pamr-refine", "marked.hdf", "-o", "level1.hdf", "--quiet", "--json", "-")
    assert told.json["level0"]["shapes"]["determinant"]["value"] <= 0 and told.json["level0"]["shapes"]["mean_ratio"]["value"] == -1
    assert "the map of level 0 is not proved to be free of folds near (" in told.err, told.err


run_tests(globals())
