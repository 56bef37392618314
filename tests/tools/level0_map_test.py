# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a map of level 0 before anything is split: the short form of qualification/validation/level0_map.py."""
import pathlib
import sys

from tool_run import of_full_level, run, run_tests

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "qualification/validation"))
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

    assert f"at least {100 * share:.0f} % more cells than with --shape-floor 0.3" in default.out, default.out
    assert "cells than with" not in lower.out and "map of level 0" not in lower.err + default.err


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
