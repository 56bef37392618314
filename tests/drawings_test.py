#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The drawings of the pages are those that their script makes, and the splits they show fill the cell."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "docs/drawings"
sys.path.insert(0, str(FOLDER))
sys.dont_write_bytecode = True
import splits  # noqa: E402


class Drawings(unittest.TestCase):
    def test_are_those_that_the_script_makes(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, "-B", FOLDER / "draw.py", folder], check=True)
            made = {path.name: path.read_text() for path in pathlib.Path(folder).iterdir()}

        self.assertEqual(made, {path.name: path.read_text() for path in FOLDER.glob("*.svg")})
        self.assertEqual(len(made), 8)

    def test_split_cells_by_the_275_triangulations_that_exist(self):
        count = 0
        for mask in range(64):
            marks = {edge for edge in range(6) if mask >> edge & 1}
            for made in splits.triangulations(marks).values():
                for cells in made:
                    count += 1
                    volumes = [splits.six_volumes([splits.node(code) for code in cell]) for cell in cells]
                    self.assertGreater(min(volumes), 0)
                    self.assertEqual(sum(volumes), 8)
                    self.assertEqual({code for cell in cells for code in cell}, {0, 1, 2, 3} | {4 + e for e in marks})
        self.assertEqual(count, 275)


unittest.main()
