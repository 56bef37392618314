#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs PAMR, builds a project of its own against it, and runs the programs of README.md word for word.

Usage: consumer_test.py SOURCE BUILD CMAKE COMPILER MPIEXEC...
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE, BUILD, CMAKE, COMPILER, MPIEXEC = *sys.argv[1:5], sys.argv[5:]
CONSUMER = os.path.join(SOURCE, "tests", "consumer")


def text_of(*parts):
    with open(os.path.join(*parts), encoding="utf-8") as file:
        return file.read()


def without_license(text):
    return re.sub(r"^.*SPDX-License-Identifier.*\n", "", text, count=1)


class Consumer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="pamr consumer ")
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = cls.temporary.name
        cls.prefix = os.path.join(cls.folder, "prefix")
        cls.run_ok(CMAKE, "--install", BUILD, "--prefix", cls.prefix)
        cls.tool("pamr-mesh", "--shape", "kuhn-cube", "--n", "8", "-o", "cube.hdf")

    @classmethod
    def run_ok(cls, *command, cwd=None):
        result = subprocess.run(command, cwd=cwd or cls.folder, capture_output=True, text=True)
        if result.returncode != 0:
            raise AssertionError(f"{command} ended with {result.returncode}\n{result.stdout}\n{result.stderr}")
        return result.stdout

    @classmethod
    def tool(cls, name, *arguments):
        return cls.run_ok(*MPIEXEC, "2", os.path.join(cls.prefix, "bin", name), *arguments)

    def test_the_readme_shows_these_programs(self):
        readme = text_of(SOURCE, "README.md")
        for language, name in (("cpp", "refine_ball.cpp"), ("python", "mark_ball.py")):
            program = without_license(text_of(CONSUMER, name))
            self.assertIn(f"```{language}\n{program}```\n", readme, f"README.md must show {name} as it is")

    def test_both_programs_of_the_readme_give_the_same_mesh(self):
        build = os.path.join(self.folder, "build")
        self.run_ok(CMAKE, "-G", "Ninja", "-S", CONSUMER, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
                    f"-DCMAKE_CXX_COMPILER={COMPILER}", "-DCMAKE_BUILD_TYPE=Release")
        self.run_ok(CMAKE, "--build", build)
        self.run_ok(*MPIEXEC, "2", os.path.join(build, "refine_ball"))
        if os.path.exists(os.path.join(build, "clients")):
            self.assertIn("flux factor", self.run_ok(os.path.join(build, "clients")))
        self.tool("pamr-quality", "fine.hdf", "--gate", "inverted_cells:max:0")

        self.run_ok(sys.executable, os.path.join(CONSUMER, "mark_ball.py"))
        self.tool("pamr-refine", "cube.hdf", "-o", "fine-from-python.hdf")

        self.tool("pamr-diff", "fine.hdf", "fine-from-python.hdf")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
