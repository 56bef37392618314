#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The blunt cone with one refinement: its shape as expected; in the full level with the same bytes on 1 and on 3 ranks, and the
loop of mesh, flow, mark and refine with few particles.

Usage: blunt_cone_test.py CASE_FOLDER TOOLS_FOLDER
"""
import filecmp
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CASE, TOOLS = sys.argv[1:3]
FULL = os.environ.get("PAMR_TEST_LEVEL") == "full"


def run(script, *options):
    result = subprocess.run([os.path.join(CASE, script), "--tools", TOOLS, *options], capture_output=True, text=True)
    if result.returncode != 0:
        raise AssertionError(f"{script} ended with {result.returncode}\n{result.stdout}\n{result.stderr}")
    return result.stdout


def rows_of(printed):
    """The rows of the table: a level and a number of cells."""
    return [line.removeprefix("level").split() for line in printed.splitlines() if re.match(r"(level)? *[01] +[0-9]", line)]


class Shape(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="blunt cone ")
        cls.addClassCleanup(temporary.cleanup)
        cls.out = {ranks: os.path.join(temporary.name, f"{ranks} ranks") for ranks in ((1, 3) if FULL else (1,))}
        cls.printed = {ranks: run("geometry.sh", "--ranks", str(ranks), "--levels", "1", "--out", out)
                       for ranks, out in cls.out.items()}

    def table(self, folder):
        return subprocess.run([sys.executable, "-B", os.path.join(CASE, "geometry.py"), folder, "1"], capture_output=True,
                              text=True)

    def test_it_prints_a_row_for_each_level(self):
        for printed in self.printed.values():
            rows = rows_of(printed)
            self.assertEqual([row[0] for row in rows], ["0", "1"])

    @unittest.skipUnless(FULL, "of the full level")
    def test_the_files_are_the_same_on_1_and_3_ranks(self):
        for name in ("level0.hdf", "marked0.hdf", "level1.hdf"):
            one, three = (os.path.join(self.out[ranks], name) for ranks in (1, 3))
            self.assertTrue(filecmp.cmp(one, three, shallow=False), name)

    def test_a_number_that_is_not_as_expected_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("quality0.json", "quality1.json", "refine1.json", "version.txt"):
                shutil.copy(os.path.join(self.out[1], name), folder)
            name = os.path.join(folder, "quality1.json")
            with open(name, encoding="utf-8") as file:
                report = json.load(file)
            report["patches"]["base"]["off_surface_nodes"] = 1
            with open(name, "w", encoding="utf-8") as file:
                json.dump(report, file)

            result = self.table(folder)

            self.assertEqual(result.returncode, 1)
            self.assertIn("level 1: expected patches/base/off_surface_nodes = 0 within 0, found 1", result.stderr)


@unittest.skipUnless(FULL, "of the full level")
class Loop(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="blunt cone ")
        cls.addClassCleanup(temporary.cleanup)
        cls.out = temporary.name
        cls.printed = run("run.sh", "--smoke", "--ranks", "1", "--out", cls.out)

    def report(self, level):
        with open(os.path.join(self.out, f"flow{level}.json"), encoding="utf-8") as file:
            return json.load(file)

    def test_it_solves_marks_refines_carries_and_prints_a_row_for_each_level_and_goes_on_where_it_was(self):
        rows = rows_of(self.printed)
        self.assertEqual([row[0] for row in rows], ["0", "1"])
        self.assertIn("carried", self.printed)
        self.assertGreater(int(rows[1][1]), 1.9 * int(rows[0][1]))
        self.assertIn("picture: " + os.path.join(self.out, "levels.png"), self.printed)
        self.assertGreater(os.path.getsize(os.path.join(self.out, "levels.png")), 20000)

        os.remove(os.path.join(self.out, "flow1.json"))
        again = run("run.sh", "--smoke", "--ranks", "1", "--resume", "--out", self.out)

        self.assertNotIn("carried", again)
        self.assertEqual(rows_of(again), rows)

        studies = run("../../studies/blunt-cone/studies.sh", "--full-run", self.out, "--out", os.path.join(self.out, "studies"), "tables")
        for level in (0, 1):
            drag = self.report(level)["C_D"]
            row = next(line for line in studies.splitlines() if line.startswith(f"| level {level} |"))
            self.assertIn(f"{drag['value']:.4f} +- {drag['ci95']:.4f}", row)
            self.assertEqual(studies.count(f"\n| {level} | at the fore-body |"), 1, studies)

    def test_the_run_without_full_names_what_lies_beyond_its_bounds(self):
        result = subprocess.run([sys.executable, "-B", os.path.join(CASE, "levels.py"), self.out, "1", "small"],
                                capture_output=True, text=True)

        self.assertRegex(result.stdout, r"\n--full, 1 +59998 +1\.5086 \+- 0\.0025")
        off = self.report(0)["C_D"]["value"] - 1.5092
        self.assertIn(f"outside of its bounds beside the long run (--full): C_D of level 0 ({off:+.4f})", result.stdout)

    def test_the_full_run_wants_averages_of_a_steady_flow_however_they_became_so(self):
        heat = self.report(0)["C_H"]["value"]
        for begun, drifts, complaints in (("steady", False, 0), ("steady", True, 1), ("most_transient", False, 1)):
            with self.subTest(begun=begun, drifts=drifts), tempfile.TemporaryDirectory() as folder:
                report = self.report(0)
                report["averages"]["begun"] = begun
                report["averages"]["change"] = {"C_H": {"value": 0.006 * heat, "ci95": 2e-3 * heat, "drifts": drifts}}
                with open(os.path.join(folder, "flow0.json"), "w", encoding="utf-8") as file:
                    json.dump(report, file)
                shutil.copy(os.path.join(self.out, "quality0.json"), folder)

                result = subprocess.run([sys.executable, "-B", os.path.join(CASE, "levels.py"), folder, "0", "full"],
                                        capture_output=True, text=True)

                self.assertIn("level 0: expected C_D = ", result.stderr)  # a short run with few particles
                self.assertEqual(len(re.findall("expected (averages of )?a steady flow", result.stderr)), complaints,
                                 result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
