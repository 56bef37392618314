# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/package.sh makes of --help: completions for bash, and man pages."""
import pathlib
import re
import shutil
import subprocess
import sys

from tool_run import BIN, run_tests

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
TOOLS = sorted(tool for tool in BIN.glob("pamr-*"))


def completions():
    subprocess.run([sys.executable, "-B", SCRIPTS / "completions.py", "made"] + TOOLS, check=True)


def replies(tool, *words):
    """What bash offers for the last of these words."""
    function = "_" + tool.replace("-", "_")
    script = f'. "made/{tool}"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); {function}; printf "%s\\n" "${{COMPREPLY[@]}}"'
    done = subprocess.run(["bash", "-c", script, "bash", tool, *words], capture_output=True, text=True, check=True)
    return done.stdout.split("\n")[:-1]


def test_each_option_of_each_tool_is_offered():
    completions()
    assert len(TOOLS) >= 8
    for tool in TOOLS:
        text = subprocess.run([tool, "--help"], capture_output=True, text=True, check=True).stdout
        options = set(re.findall(r"^  (?:-\w,? ?(?:[A-Z.a-z]+, )?)?(--[\w-]+)", text, re.M))
        offered = set(replies(tool.name, "--"))
        assert "--help" in options and options <= offered, f"{tool.name}: {options - offered}"


def test_values_that_are_words_are_offered_and_files_otherwise():
    completions()
    assert replies("pamr-refine", "--quality-control", "") == ["none", "isotropic", "short-edge", "removable"]
    assert replies("pamr-refine", "--quality-control", "s") == ["short-edge"]
    assert replies("pamr-refine", "--balance", "=", "b") == ["blocks"]
    assert replies("pamr-mark", "--size", "c") == ["cbrt"]
    pathlib.Path("a mesh.hdf").touch()
    assert replies("pamr-refine", "a") == ["a mesh.hdf"]
    assert replies("pamr-refine", "-o", "a") == ["a mesh.hdf"]


def test_man_pages_have_every_option():
    if not shutil.which("help2man"):
        print("help2man is not installed")
        return
    tool = BIN / "pamr-refine"
    page = subprocess.run(["help2man", "--no-info", "--name", "refines", tool], capture_output=True, text=True, check=True).stdout
    plain = page.replace("\\-", "-").replace("\\fB", "").replace("\\fR", "")
    assert ".SH OPTIONS" in page and "pamr-refine \\- refines" in page
    for option in replies_of_help(tool):
        assert option in plain, option


def replies_of_help(tool):
    completions()
    return [word for word in replies(tool.name, "--") if word.startswith("--")]


run_tests(globals())
