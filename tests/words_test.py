#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts every word of words.py, and every exception, into a file and sees what is found."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
sys.dont_write_bytecode = True
import words  # noqa: E402

# One example of each pattern, in the order of the table.
EXAMPLES = ("neighbours", "centre", "colours", "micrometres", "behaviour", "favourite", "grey", "discretisation", "is told",
            "round the", "besides", "ledgers", "Analyst", "FaceCard", "doomed_path", "closed_forms", "patience",
            "tie_patches", "judge_cells", "cells that may go", "octets taken back", "least_worst", "most_cells", "poorest_cell")
GOOD = "neighbors center otherwise noise counterclockwise around the least_squares almost_all told apart precise\n"


class Words(unittest.TestCase):
    def test_every_pattern_is_found(self):
        self.assertEqual(len(EXAMPLES), len(words.WORDS))
        for example, pattern in zip(EXAMPLES, words.WORDS):
            found = list(words.found_in("lib/a.cpp", f"int x;\n// some {example} here\n"))
            self.assertEqual(len(found), 1, (pattern, found))
            self.assertIn(f'lib/a.cpp:2: "{example}"', found[0])

    def test_good_words_pass(self):
        self.assertEqual(list(words.found_in("docs/a.md", GOOD)), [])

    def test_exceptions_hold_for_their_files_only(self):
        self.assertEqual(list(words.found_in("lib/pamr/io/export/write_foam.cpp", "neighbour\n")), [])
        self.assertEqual(len(list(words.found_in("lib/pamr/io/export/write_foam.cpp", "neighbours\n"))), 1)
        self.assertEqual(len(list(words.found_in("lib/pamr/mesh/ring.hpp", "neighbour\n"))), 1)

    def test_files_of_a_tree_are_read(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "a.md").write_text("besides\n")
            pathlib.Path(folder, "picture.png").write_bytes(b"besides")
            self.assertEqual([line.split(":")[0] for line in words.violations(pathlib.Path(folder))], ["a.md"])


if __name__ == "__main__":
    unittest.main()
