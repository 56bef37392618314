#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts that compare results with expected values end with exit code 1 where one is wrong, and say which: made-up results, good
ones and ones that are off by little more than a gate allows.

Usage: gates_test.py ROOT
"""
import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[1]).resolve()
sys.path.append(str(ROOT / "cases"))
import bounds  # noqa: E402


def ended(*command, **environment):
    """Exit code and all output of a script."""
    done = subprocess.run([sys.executable, "-B", *map(str, command)] if str(command[0]).endswith(".py") else list(map(str, command)),
                          capture_output=True, text=True, env={**os.environ, **environment})
    return done.returncode, done.stdout + done.stderr


def program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!{sys.executable}\n{text}")
    path.chmod(0o755)


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gates ")
        self.addCleanup(folder.cleanup)
        self.out = pathlib.Path(folder.name)

    def write(self, name, content):
        path = self.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content if isinstance(content, str) else json.dumps(content))

    def assert_fails(self, result, says):
        self.assertEqual(result[0], 1, result[1])
        self.assertIn(says, result[1])

    def assert_passes(self, result):
        self.assertEqual(result[0], 0, result[1])


class Bounds(InFolder):
    def test_the_factor_of_student_is_that_of_the_tables(self):
        self.assertEqual([round(bounds.student_95(n), 3) for n in (2, 3, 10, 21)], [12.706, 4.303, 2.262, 2.086])
        self.assertEqual(bounds.student_95(1), math.inf)

    def test_a_value_beyond_either_bound_or_none_at_all_is_a_miss(self):
        self.write("expected.csv", "# why\nquantity,at_least,at_most,source\na,1,2,x\nb,,3,y\nc,4,,z\n")
        within = bounds.bounds_of(self.out / "expected.csv")

        self.assertEqual(list(bounds.misses("here", {"a": 1, "b": -9, "c": 99}, within)), [])
        self.assertEqual(len(list(bounds.misses("here", {"a": 2.01, "b": 3.01, "c": 3.99}, within))), 3)
        self.assertEqual(len(list(bounds.misses("here", {"a": math.nan, "b": math.nan, "c": math.nan}, within))), 3)


class Goals(InFolder):
    """cases/goal_levels.py with the rows of reading B that fewer levels are held to."""

    def run_with(self, force, error):
        self.write("solve0.json", {"nodes": 5, "cells": 9, "best": {"sphere": {
            "force-x": {"value": force, "error": error}, "force-z": {"value": 3.9708365, "error": 0.01}}}})
        return ended(ROOT / "cases/goal_levels.py", self.out, "--expected", ROOT / "cases/charged-spheres/expected.csv", "--case",
                     "reading-b-short")

    def test_a_value_beyond_its_tolerance_is_refused_whatever_its_own_error_bar(self):
        self.assert_passes(self.run_with(0.0412, 1e-4))
        self.assert_fails(self.run_with(0.0427, 1e-4), "force-x.value")
        self.assert_fails(self.run_with(0.0427, 1.0), "force-x.value")
        self.assert_fails(self.run_with(None, None), "force-x.value")


class SupersonicSphere(InFolder):
    CONTROLS = ("none", "isotropic", "short-edge", "removable")

    def run_with(self, drag=1.5808, error=0.0016, mean_ratio=0.352):
        """Level 0 and, with flows like the recorded ones, level 1 of a long run."""
        quality = {"cells": 9, "mean_ratio": {"min": mean_ratio, "mean": 0.7, "histogram": {"counts": [9], "edges": [0.9, 1]}},
                   "min_dihedral": {"min": 10.0}}

        def flow(c_d, c_d_error, c_h):
            return {"particles": 9, "lost_particles": 0, "quality": {"dense_gas_below_5_particles": 0.1}, "began_at_step": 0,
                    "averages_from_step": 1, "steps": 2, "averages": {"passage_steps": 1},
                    "C_D": {"value": c_d, "stderr": c_d_error, "ci95": 2 * c_d_error}, "C_H": {"value": c_h, "stderr": 7e-4, "ci95": 2e-3}}
        self.write("case0.toml", "density = 1.0 # 1/m3\n")
        self.write("level0-quality.json", quality)
        self.write("flow0.json", flow(drag, error, 0.5148))
        self.write("flow0-lines.csv", "quantity,x,value\n")
        for i, control in enumerate(self.CONTROLS):
            for kind in ("own", "recorded"):
                self.write(f"{kind}/{control}1-quality.json", quality)
            self.write(f"own/{control}1-flow.json", flow(1.585 + 1e-3 * i, 0.0018, 0.513))
            self.write(f"own/{control}1-flow-lines.csv", "quantity,x,value\n")
        return ended(ROOT / "cases/supersonic-sphere/check.py", self.out, 1, "full")

    def test_a_drag_one_percent_off_bars_that_are_wide_and_flat_cells_are_refused(self):
        self.assert_passes(self.run_with())
        self.assert_fails(self.run_with(drag=1.5966), "mean of C_D")
        self.assert_fails(self.run_with(drag=1.5966, error=0.02), "bound of 95 % of C_D")
        self.assert_fails(self.run_with(mean_ratio=0.28), "smallest mean ratio is 0.2800")


class OpenFoam(InFolder):
    def run_with(self, l2=0.0084, mean_ratio=0.3456, flux_error=0.0044):
        names = "level,cells,l2,flux,flux_error,flux_difference,first_residual,last_residual,min_mean_ratio,format\n"
        self.write("table.csv", names + "0,192,0.04977,305,0.0295,1e-11,1,2e-5,0.4758,ascii\n"
                   + "".join(f"{level},4706,{l2},313,{flux_error},3e-11,0.158,4e-5,{mean_ratio},ascii\n" for level in (1, 2)))
        for level in range(3):
            self.write(f"level{level}/log.checkMesh", "all well\nMesh OK.\n\n")
        kinds = {"inner": "wall", "outer": "wall", "symmetryX": "symmetryPlane", "symmetryY": "symmetryPlane", "symmetryZ": "symmetryPlane"}
        self.write("level2/constant/polyMesh/boundary", "".join(f"{name} {{ type {kind}; }}\n" for name, kind in kinds.items()))
        self.write("level2/0/T", "dimensions [0 0 0 1 0 0 0];\nvalue uniform 400;\nvalue uniform 300;\n")
        return ended(ROOT / "cases/openfoam-loop/check.py", self.out, 2, 1)

    def test_first_order_and_cells_under_the_floor_are_refused(self):
        self.assert_passes(self.run_with())
        self.assert_fails(self.run_with(l2=0.04977 * (192 / 4706)**0.36), "l2_rate")
        self.assert_fails(self.run_with(mean_ratio=0.31), "min_mean_ratio")
        self.assert_fails(self.run_with(flux_error=0.01), "flux_error")


class BluntCone(InFolder):
    def run_with(self, drag=1.5221, error=0.0018):
        one = {"value": drag, "stderr": error, "ci95": 2.26 * error}
        rest = {"C_L": (-0.1927, 8e-4), "C_m": (-0.0349, 7e-4), "C_H": (0.1593, 4e-4)}
        self.write("quality0.json", {"cells": 34233})
        self.write("flow0.json", {
            "quality": {"dense_gas_below_5_particles": 0.07}, "particles": 669583, "steps": 900, "averages_from_step": 600, "lost_particles": 0,
            "averages": {"groups": 10, "group_steps": 30, "passage_steps": 30, "independent": True}, "C_D": one,
            **{name: {"value": v, "stderr": e, "ci95": 2.26 * e} for name, (v, e) in rest.items()}})
        return ended(ROOT / "cases/blunt-cone/levels.py", self.out, 0, "small")

    def test_a_value_is_not_excused_by_its_own_wide_bar(self):
        self.assert_passes(self.run_with())
        self.assert_fails(self.run_with(drag=1.5421), "expected C_D")
        self.assert_fails(self.run_with(drag=1.5421, error=0.01), "bound of 95 % of C_D")


class HeatFlux(InFolder):
    def run_with(self, drag=1.6261, heat=6.51, error=0.01):
        for level in (0, 1):
            self.write(f"quality{level}.json", {"cells": 9})
            self.write(f"flow{level}.json", {"patches": {"forebody": {"C_D": {"value": drag, "ci95": 9e-4}}}})
            stations = {"0": (9.88, 0.11), "0.52": (8.14, 0.03), "1.04": (6.97, 0.02), "1.56": (heat, error)}
            self.write(f"lines{level}.csv", "name,quantity,value,stderr\n"
                       + "".join(f"S/Rn {at},q,{1e3 * q},{1e3 * e}\n" for at, (q, e) in stations.items()))
        return ended(ROOT / "cases/blunt-cone/heat_flux.py", self.out, 1)

    def test_the_last_thermocouple_and_the_drag_are_held_too(self):
        self.assert_passes(self.run_with())
        self.assert_fails(self.run_with(heat=6.7), "S/Rn 1.56: expected 6.51")
        self.assert_fails(self.run_with(heat=6.7, error=0.2), "S/Rn 1.56: expected 6.51")
        self.assert_fails(self.run_with(drag=1.69), "C_D: expected 1.64")


# What stands in for pamr-dsmc and pamr-mesh: a report with the drag, the heat and the rate of the environment.
OUR_TOOL = """
import json, os, pathlib, sys
if "--json" in sys.argv:
    made_up = {"C_D": {"value": float(os.environ["DRAG"]), "ci95": 0.009}, "C_H": {"value": 0.5103, "ci95": 0.0038},
               "averages": {"groups": 10, "group_steps": 450, "passage_steps": 240}, "particle_steps_per_second_per_core": 1e7}
    pathlib.Path(sys.argv[sys.argv.index("--json") + 1]).write_text(json.dumps(made_up))
for flag in ("-o",):
    pathlib.Path(sys.argv[sys.argv.index(flag) + 1]).touch()
"""
# And for SPARTA: ten blocks of loads about its recorded drag and heat, and the seconds of the environment for its loop.
THEIR_PROGRAM = """
import math, os, pathlib, re, sys
name = sys.argv[sys.argv.index("-in") + 1]
text = pathlib.Path(name).read_text()
unit = 0.5 * 6.63e-26 * 6.438e18 * 1355.25**2 * math.pi
for file in re.findall(r"file (\\S+\\.dat)", text):
    pathlib.Path(file).write_text("".join(f"{i} {1.5978 * (1 + e) * unit} 0 {0.5203 * (1 + e) * unit * 1355.25}\\n"
                                          for i, e in enumerate([0.007, -0.007] * 5)))
end = time = os.environ.get("SECONDS_OF_SPARTA", "1")
log = sys.argv[sys.argv.index("-log") + 1]
pathlib.Path(log).write_text(f"Loop time of {end} on 1 procs for 1000 steps with 1000 particles\\n")
sum(range(3000000))
"""


class Gas(InFolder):
    def setUp(self):
        super().setUp()
        for name in ("pamr-dsmc", "pamr-mesh"):
            program(self.out / "tools" / name, OUR_TOOL)
        program(self.out / "results/sparta/src/spa_serial", THEIR_PROGRAM)
        self.write("checkout/src/MAKE/Makefile.serial", "")

    def sparta(self, drag):
        return ended(ROOT / "qualification/validation/sparta.sh", "--ranks", 1, "--tools", self.out / "tools", "--out", self.out / "results",
                     self.out / "checkout", "sphere", DRAG=str(drag))

    def test_sparta_sh_fails_where_a_drag_is_not_as_far_from_spartas_as_recorded(self):
        self.assert_passes(self.sparta(1.5836))
        self.assert_fails(self.sparta(1.63), "sphere: C_D: expected a difference of -0.0089")

    def speed(self, seconds):
        return ended(ROOT / "bench/compare_gas.py", self.out / "tools", "--sparta", self.out / "results/sparta/src/spa_serial", "--runs", 1,
                     "--particles", 1000, "--no-cone", "--out", self.out / "speed", DRAG="1", SECONDS_OF_SPARTA=str(seconds))

    def test_compare_gas_fails_where_sparta_is_as_fast(self):
        self.assert_passes(self.speed(10))
        self.assert_fails(self.speed(0.01), "times the rate of SPARTA or more")


class Ducts(InFolder):
    """qualification/validation/ducts.py: what each row compares, without the runs."""

    def row(self, found, bound):
        self.write("one_row.py", f"""
import pathlib, sys
sys.path.append({str(ROOT / "qualification/validation")!r})
sys.argv = ["ducts.py", {str(self.out)!r}, "1", "tube"]
import ducts
ducts.tube = lambda: ducts.row("tube", "transmission", 0.672, {found}, {bound})
ducts.main()
""")
        return ended(self.out / "one_row.py")

    def test_a_transmission_beyond_four_errors_or_with_a_wide_bar_is_refused(self):
        self.assert_passes(self.row(0.6735, 0.0004))
        self.assert_fails(self.row(0.68, 0.0004), "tube: transmission: expected 0.672 within 0.0021, found 0.68")
        self.assert_fails(self.row(0.672, 0.01), "expected a bound of at most 0.0067, found 0.01")
        self.assert_fails(self.row("float('nan')", 0.0004), "found nan")


class CompactParts(InFolder):
    """bench/balance/compare_with_compact.py with made-up rows of bench_balance."""

    def compared(self, *ratios):
        rows = "".join(f"| cube | {n + 2} | scotch | scotch | 9 | {ratio} | 3 | 1.0 | 1 | 1 |\n" for n, ratio in enumerate(ratios))
        done = subprocess.run([sys.executable, "-B", str(ROOT / "bench/balance/compare_with_compact.py")], input=rows, capture_output=True,
                              text=True)
        return done.returncode, done.stdout + done.stderr

    def test_parts_of_scotch_that_miss_the_rule_are_refused(self):
        self.assert_passes(self.compared(1.1, 1.5))
        self.assert_fails(self.compared(1.1, 1.51), "found 1.51 of cube")
        self.assert_fails(self.compared(), "found none")


class TablesAreRead(InFolder):
    def test_a_table_that_no_test_reads_is_named(self):
        self.write("studies/reproduce.sh", (ROOT / "studies/reproduce.sh").read_text())
        for path in sorted(ROOT.glob("cases/*/*.csv")) + sorted(ROOT.glob("studies/*/*.csv")):
            self.write(path.relative_to(ROOT), path.read_text())
            self.write(path.relative_to(ROOT).parent / "names.py", " ".join(p.name for p in path.parent.glob("*.csv")))
        every = [f"all\t{path.relative_to(self.out)}:." for path in self.out.glob("*/*/*.csv")]
        self.write("read.txt", "\n".join(every) + "\n")
        self.assert_passes(ended(ROOT / "tests/cases/tables_are_read.py", self.out, self.out / "read.txt"))

        self.write("read.txt", "\n".join(line for line in every if "scan-repair" not in line) + "\n")
        self.assert_fails(ended(ROOT / "tests/cases/tables_are_read.py", self.out, self.out / "read.txt"),
                          "cases/scan-repair/expected.csv: no test reads the row faults_left")


class EveryTable(unittest.TestCase):
    def test_floors_are_those_that_are_promised(self):
        for case, least in (("dolfinx-loop", 0.34), ("openfoam-loop", 0.34), ("moving-front", 0.34)):
            with open(ROOT / f"cases/{case}/expected.csv", encoding="utf-8") as file:
                rows = {row["quantity"]: row for row in csv.DictReader(line for line in file if not line.startswith("#"))}
            row = rows.get("min_mean_ratio") or rows["smallest_mean_ratio"]
            self.assertGreaterEqual(float(row["at_least"]), least, case)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
