#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts that packages state once more: packages to build with, versions, tests.

Usage: packaging_test.py SOURCE
"""
import json
import os
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(sys.argv[1])
DEBIAN = SOURCE / "packaging" / "debian"
# What a source package asks for beside what setup.sh installs, and what it must not name.
OF_PACKAGING = {"debhelper-compat", "dh-python", "help2man"}
ESSENTIAL = {"build-essential"}


def text_of(path):
    return path.read_text(encoding="utf-8")


def paragraphs():
    """Fields of the source and of each package in debian/control."""
    for paragraph in text_of(DEBIAN / "control").strip().split("\n\n"):
        yield {name: value.strip() for name, value in re.findall(r"^([\w-]+):((?:.*\n?)(?:[ \t].*\n?)*)", paragraph, re.M)}


def names(field):
    return {part.split()[0] for part in field.split(",") if part.strip() and not part.strip().startswith("${")}


def installed_by_setup():
    """The packages of setup.sh for all tools, the Python package and the manual."""
    script = re.sub(r" #.*", "", text_of(SOURCE / "scripts" / "setup.sh"))
    found = set()
    for array in ("packages", "python_packages", "manual_packages"):
        (body,) = re.findall(rf"^{array}=\((.*?)\)", script, re.M | re.S)
        found |= set(body.split())
    (parts,) = re.findall(r"^declare -A packages_of=\((.*?)^\)", script, re.M | re.S)
    for part in re.findall(r'\]="([^"]*)"', parts):
        found |= set(part.split())
    return found


class Packaging(unittest.TestCase):
    def test_the_source_package_asks_for_what_setup_installs(self):
        source = next(paragraphs())
        asked = names(source["Build-Depends"]) | names(source["Build-Depends-Indep"])
        self.assertEqual(asked, (installed_by_setup() - ESSENTIAL) | OF_PACKAGING)

    def test_the_library_needs_what_it_was_built_with(self):
        source, *packages = paragraphs()
        (library,) = (package for package in packages if package["Package"] == "libpamr-dev")
        self.assertLessEqual(names(library["Depends"]) - {"pamr"}, names(source["Build-Depends"]))

    def test_versions_are_those_of_the_headers(self):
        version = ".".join(re.findall(r"^#define PAMR_VERSION_\w+ (\d+)$", text_of(SOURCE / "lib/pamr/base/version.hpp"), re.M))
        self.assertRegex(text_of(DEBIAN / "changelog"), rf"^pamr \({re.escape(version)}-1\) ")
        self.assertEqual(json.loads(text_of(SOURCE / "codemeta.json"))["version"], version)

    def test_the_tests_of_the_packages_are_programs(self):
        listed = re.findall(r"^Tests: (\w+)$", text_of(DEBIAN / "tests" / "control"), re.M)
        self.assertEqual(sorted(listed + ["control"]), sorted(path.name for path in (DEBIAN / "tests").iterdir()))
        for name in listed:
            self.assertTrue(os.access(DEBIAN / "tests" / name, os.X_OK), name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
