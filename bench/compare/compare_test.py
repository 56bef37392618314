# SPDX-License-Identifier: GPL-3.0-or-later
"""compare.sh without peers, its refusals, and the arithmetic of its table. Usage: compare_test.py COMPARE.SH BUILD"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

COMPARE, BUILD = map(pathlib.Path, sys.argv[1:3])
NO_PEERS = {**os.environ, "PAMR_PEER_PYTHON": "/nowhere/python3", "PAMR_PEER_CXX": "/nowhere/mpicxx"}
PEERS = ("netgen", "dolfinx", "ug", "dmplex", "gmsh")


def rows_of(output):
    lines = [line for line in output.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if not line.startswith("|--")]


def compare(*arguments):
    return subprocess.run([COMPARE, *arguments], env=NO_PEERS, capture_output=True, text=True, timeout=600)


class Compare(unittest.TestCase):
    def test_measures_ours_and_names_the_peers_that_are_missing(self):
        run = compare("--small", BUILD)

        self.assertEqual(run.returncode, 0, run.stderr)
        head, *rows = rows_of(run.stdout)
        ours = [row for row in rows if row[1] == "PAMR"]
        self.assertEqual([row[0] for row in ours], ["W1", "W2", "W3 level 1", "W3 level 2"])
        self.assertEqual(ours[0][2], "384,000")
        for row in ours:
            self.assertEqual(len(row), len(head))
            self.assertGreater(float(row[3]), 0)
        missing = [row[1] for row in rows if row[1] != "PAMR"]
        self.assertEqual([text.split(" (")[0] for text in missing], [f"{peer}: not installed" for peer in PEERS])

    def test_refuses_what_it_does_not_know(self):
        for arguments in (["--no-such-option"], ["--peers", "nobody"], ["--levels", "6"], ["/nowhere/build"]):
            run = compare(*arguments)
            self.assertEqual(run.returncode, 2, arguments)
            self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
            self.assertEqual(run.stdout, "")

    def test_table_takes_medians_and_ratios(self):
        with tempfile.TemporaryDirectory() as folder:
            results = pathlib.Path(folder)
            ours = [("W1/55/repeats:3", "iteration", 20, 8e6, 60), ("W1/55/repeats:3", "iteration", 10, 8e6, 50),
                    ("W1/55/repeats:3", "iteration", 16, 8e6, 50), ("W1/55/repeats:3_median", "aggregate", 99, 8e6, 50),
                    ("W3/n:14/level:2/repeats:1", "iteration", 8, 4e6, 70)]
            keys = ("name", "run_type", "Mcells_per_cpu_s", "cells_out", "peak_bytes_per_cell")
            (results / "pamr.1.json").write_text(json.dumps({"benchmarks": [dict(zip(keys, run)) for run in ours]}))
            (results / "pamr.quality").write_text("| policy | level | marked | cells | worst |\n"
                                                  "| none | 2 | 9 | 4000000 | 0.1 |\n| removable | 2 | 9 | 4000000 | 0.4 |\n")
            runs = [{"peer": "netgen 1", "workload": "W1", "level": 1, "run": i + 1, "cells": 8000000, "cpu": cpu,
                     "peak": 800000000, "relate_cpu": 3.0} for i, cpu in enumerate((1.0, 5.0, 2.0))]
            (results / "netgen.json").write_text("".join(json.dumps(run) + "\n" for run in runs))
            coarsening = [{"peer": "UG 2", "coarsening": "W3", "level": 2, "run": i + 1, "cells": 4000000,
                           "cells_left": 1000, "calls": 2, "cpu": cpu} for i, cpu in enumerate((20.0, 60.0, 40.0))]
            (results / "ug.json").write_text("".join(json.dumps(run) + "\n" for run in coarsening))
            (results / "gmsh.note").write_text("not installed (python3-gmsh)\n")
            table = subprocess.run([sys.executable, "-B", COMPARE.parent / "compare/table.py", results, "netgen", "ug",
                                    "gmsh"],
                                   capture_output=True, text=True, check=True).stdout

        self.assertEqual(rows_of(table)[1:], [
            ["W1", "PAMR", "8,000,000", "0.5", "16", "1", "16", "1", "60", "-", "3"],
            ["W1", "netgen 1", "8,000,000", "2", "4", "4", "1.6", "10", "100", "-", "3"],
            ["W3 level 2", "PAMR", "4,000,000", "0.5", "8", "1", "8", "1", "70", "0.4", "1"],
            ["-", "gmsh: not installed (python3-gmsh)"] + ["-"] * 9,
            ["back to level 0 from", "code", "cells", "cells left", "calls", "CPU s", "us a cell", "runs"],
            ["W3 level 2", "UG 2", "4,000,000", "1,000", "2", "40", "10", "3"]])


unittest.main(argv=sys.argv[:1])
