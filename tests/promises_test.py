#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""promises.py sees a number that changed, a test that is gone and a promise without a test."""
import pathlib
import tempfile
import unittest

import promises

README = "What it combines\n\n- small: 3 units\n\nWhat it does **not** do\n"
COARSENING = "## What comes back\n\nall\n\n## Several ranks\n"
DSMC = "## Validation\n\nnone\n\n## What is guaranteed\n\n- No particle is lost.\n"
PAGE = "# A tool\n\n## What is guaranteed\n\n- Errors stay below\n  1e-3 of all.\n\n## Not guaranteed\n\n- 7 days.\n"


class Promises(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name, text in {"README.md": README, "docs/coarsening.md": COARSENING, "docs/tools/pamr-dsmc.md": DSMC, "docs/tools/a.md": PAGE,
                           "docs/reports/speed.md": "| 12.5 |", "tests/a_test.cpp": "TEST(Errors, StaySmall) {}",
                           "tests/b_test.py": "def test_units():\n"}.items():
            self.write(name, text)
        self.rows = ["README.md | small: 3 units | `test_units`", "docs/tools/a.md | below 1e-3 of | `Errors.StaySmall`, `errors_np1`"]

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text, encoding="utf-8")

    def troubles(self, *rows):
        self.write(promises.LIST, "".join(f"| {row} |\n" for row in rows))
        return list(promises.troubles(self.root, {"errors_np1"}))

    def test_a_list_that_is_true_is_accepted(self):
        self.assertEqual(self.troubles(*self.rows), [])
        self.assertEqual(self.troubles(*self.rows, "docs/coarsening.md | all | `docs/reports/speed.md: 12.5`"), [])

    def test_words_that_a_page_no_longer_has_are_named(self):
        self.write("docs/tools/a.md", PAGE.replace("1e-3", "1e-2"))
        self.assertIn("has no longer the words: below 1e-3 of", self.troubles(*self.rows)[0])

    def test_tests_that_are_not_there_are_named(self):
        for holder in ("`Errors.StayTiny`", "`test_nothing`", "`errors_np7`", "`bench/none.py`", "`docs/reports/speed.md: 13`", "nothing"):
            with self.subTest(holder):
                self.assertEqual(len(self.troubles(*self.rows, f"docs/coarsening.md | all | {holder}")), 1)

    def test_a_promise_without_a_row_is_named(self):
        self.assertIn("docs/tools/a.md", self.troubles(self.rows[0])[0])
        self.assertIn("no test for the promise: - small: 3 units", self.troubles(self.rows[1])[0])
        self.assertEqual(len(self.troubles()), 3)


if __name__ == "__main__":
    unittest.main()
