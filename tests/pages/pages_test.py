# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands in the pages: every option that they name exists; those of the first page, and in the full level those that need
nothing but each other, are run.

Usage: pages_test.py SOURCE BIN MPIEXEC...
"""
import functools
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BIN, MPIEXEC = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
TUTORIAL = SOURCE / "docs" / "tutorials" / "1-stl-to-openfoam"
PAGES = sorted([SOURCE / "README.md", *(SOURCE / "docs").rglob("*.md"), *(SOURCE / "cases").glob("*/README.md"),
                *(SOURCE / "studies").glob("*/README.md")])
COMMAND = re.compile(r"^(?:\$ )?(?:mpirun (?:-q )?-n \d+ )?(pamr-[a-z]+)\s")
DRAWS = shutil.which("Xvfb") and subprocess.run(["/usr/bin/python3", "-c", "import vtk, matplotlib, h5py"],
                                                capture_output=True).returncode == 0


def blocks(page):
    """Blocks of code of a page, each a list of lines; a line that ends with a backslash goes on."""
    text = page.read_text(encoding="utf-8")
    found = re.findall(r"^```\w*\n(.*?)^```", text, re.M | re.S)
    found += re.findall(r"(?:^    .*\n?)+", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), re.M)
    for block in found:
        yield [line.strip() for line in re.sub(r"\\\n\s*", "", block).splitlines()]


@functools.cache
def options_of(tool, *subcommand):
    text = subprocess.run([BIN / tool, *subcommand, "--help"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"--[a-z][\w-]*", text))


def commands(lines):
    """What runs: without what shows the form of a command (CASE.toml, [--option], ...)."""
    for line in lines:
        match = COMMAND.match(line)
        if match and not re.search(r"\b[A-Z]{2,}\b(?!\.)|\.\.\.|\[|\$", line.split("#")[0]):
            yield match.group(1), shlex.split(line.removeprefix("$ "), comments=True)


class Pages(unittest.TestCase):
    def run_in(self, folder, words):
        if words[0] == "mpirun":
            words = MPIEXEC + words[words.index("-n"):]
        environment = os.environ | {"PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}
        done = subprocess.run(words, cwd=folder, capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, f"{words}\n{done.stdout}\n{done.stderr}")

    def test_options_in_commands_exist(self):
        n = 0
        for page in PAGES:
            for block in blocks(page):
                for line in block:
                    match = COMMAND.match(line)
                    if not match or not (BIN / match.group(1)).exists():
                        continue
                    tool = match.group(1)
                    sub = line.split(tool, 1)[1].split()[:1] if tool == "pamr-surface" else []
                    known = options_of(tool) | (options_of(tool, *sub) if sub and sub[0].isalpha() and sub[0].islower() else set())
                    for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", line.split("#")[0].split("|")[0].split("&&")[0]):
                        n += 1
                        self.assertIn(option, known, f"{page}: {line}")
        self.assertGreater(n, 100)

    def test_every_file_that_names_the_version_has_the_same(self):
        version = ".".join(re.findall(r"^#define PAMR_VERSION_\w+ (\d+)$", (SOURCE / "lib/pamr/base/version.hpp").read_text(), re.M))
        for name, form in (("CITATION.cff", r"^version: (.*)$"), ("codemeta.json", r'"version": "(.*)"')):
            self.assertEqual(re.findall(form, (SOURCE / name).read_text(), re.M), [version], name)

    def test_commands_with_mpirun_hide_no_error_and_readme_says_what_they_need(self):
        n = 0
        for page in PAGES:
            for line in (line for block in blocks(page) for line in block if re.search(r"\bmpirun\b", line)):
                n += 1
                self.assertNotRegex(line, r"\bmpirun\b.* -q\b", f"{page}: mpirun -q hides a command that is not there")
        self.assertGreater(n, 5)
        readme = (SOURCE / "README.md").read_text(encoding="utf-8")
        self.assertLess(readme.index("scripts/mpi_environment.sh"), readme.index("mpirun"))

    @unittest.skipUnless(os.environ.get("PAMR_TEST_LEVEL") == "full", "of the full level")
    def test_blocks_that_begin_with_a_shape_run(self):
        n = 0
        for page in sorted((SOURCE / "docs").rglob("*.md")):
            for block in blocks(page):
                found = list(commands(block))
                if not found or found[0][1][:2] != ["pamr-mesh", "--shape"] or len(found) < 2 or "done" in block:
                    continue
                with tempfile.TemporaryDirectory(prefix="pamr pages ") as folder:
                    os.symlink(SOURCE / "cases", os.path.join(folder, "cases"))
                    for tool, words in found:
                        if not (BIN / tool).exists() or (tool == "pamr-dsmc" and "--plan" not in words):
                            break  # a run of the gas takes minutes
                        if tool == "pamr-picture" and not DRAWS:
                            continue
                        with self.subTest(page=page.name, command=" ".join(words)):
                            self.run_in(folder, words)
                            n += 1
        self.assertGreater(n, 8)

    def test_the_first_ten_minutes(self):
        with tempfile.TemporaryDirectory(prefix="pamr start ") as folder:
            folder = pathlib.Path(folder)
            make = ["awk", "-f", TUTORIAL / "make_body.awk", "-f", TUTORIAL.parent / "closed_body.awk"]
            stl = subprocess.run(make, capture_output=True, text=True, check=True).stdout
            (folder / "body.stl").write_text(stl)
            case = (TUTORIAL / "case.toml").read_text().replace("body = 0.008", "wall = 0.015").replace("far = 0.04", "far = 0.06")
            (folder / "case.toml").write_text(case.replace("+body", "+wall").replace('"body"', '"wall"'))
            self.run_in(folder, ["pamr-mesh", "case.toml", "-o", "wall.hdf"])
            self.run_in(folder, ["pamr-convert", "wall.hdf", "part.msh"])
            self.run_in(folder, ["pamr-mesh", "--shape", "sphere-in-box", "-o", "ball.hdf"])
            n = 0
            for block in blocks(SOURCE / "docs" / "start.md"):
                for tool, words in commands(block):
                    if not (BIN / tool).exists() or (tool == "pamr-picture" and not DRAWS):
                        continue
                    made = words[2] if tool == "pamr-convert" else words[words.index("-o") + 1] if "-o" in words else ""
                    (folder / made).is_file() and (folder / made).unlink()
                    if "part.hdf" in words and made != "part.hdf":
                        shutil.copy(folder / "ball.hdf", folder / "part.hdf")  # the mesh with a patch `sphere`
                    with self.subTest(command=" ".join(words)):
                        self.run_in(folder, words)
                        n += 1
            self.assertGreater(n, 9)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
