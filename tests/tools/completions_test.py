# SPDX-License-Identifier: GPL-3.0-or-later
"""--help of the tools, and what scripts/package.sh makes of it: completions for bash, and man pages."""
import functools
import os
import pathlib
import re
import shlex
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


@functools.cache
def help_of(tool, *command, columns=None):
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"} | ({"COLUMNS": columns} if columns else {})
    return subprocess.run([BIN / tool, *command, "--help"], capture_output=True, text=True, check=True, env=environment).stdout


def helps():
    """Each tool and each command of pamr-surface, with its text."""
    surface = re.search(r"^Subcommands:\n((?:  .*\n)+)", help_of("pamr-surface"), re.M).group(1)
    pages = [(tool.name,) for tool in TOOLS] + [("pamr-surface", word) for word in re.findall(r"^  (\w+)", surface, re.M)]
    return [(page, help_of(*page, columns="100")) for page in pages]


def examples(text):
    """The commands of all examples, in words; a line that ends with a backslash goes on."""
    for line in re.findall(r"^  (?:Example: )?((?:mpirun |pamr-\w+ ).*)$", re.sub(r" \\\n\s*", " ", text), re.M):
        for part in line.split(" && "):
            words = shlex.split(part)
            yield words[words.index("-n") + 2:] if words[0] == "mpirun" else words


def test_help_is_as_wide_as_asked_for_and_at_most_100_columns():
    for columns, most in (None, 80), ("72", 72), ("20", 60), ("300", 100), ("wide", 80):
        widths = [len(line) for line in help_of("pamr-convert", columns=columns).splitlines()]
        assert most - 12 < max(widths) <= most, f"COLUMNS={columns}: {max(widths)}"
    for page, text in helps():
        assert max(len(line) for line in text.splitlines()) <= 100, page


def test_every_option_is_in_a_group_that_can_be_surveyed():
    for page, text in helps():
        group, n = None, {}
        for line in text.splitlines():
            if re.match(r"\S.*:$", line):
                group = line
            elif re.match(r"  -", line):
                n[group] = n.get(group, 0) + 1
        assert n and None not in n and max(n.values()) <= 12, f"{page}: {n}"
        assert page[0] == "pamr-picture" or list(n)[-1] == "Options of all tools:", f"{page}: {n}"


def test_commands_have_examples_and_defaults_of_their_own():
    for page, text in helps():
        if len(page) == 2:
            example = re.search(r"^  Example: pamr-surface (\w+) ", text, re.M)
            assert example and example.group(1) == page[1], f"{page}: {example}"
            if "--steps" in text:
                assert re.search(r"--steps INT:1 to \d+(=| \[)\d", text), page  # by the version of CLI11


def test_every_tool_has_examples_and_all_of_them_can_be_read():
    seen = set()
    for page, text in helps():
        commands = list(examples(text))
        assert any(words[0] == page[0] for words in commands), page
        for words in commands:
            if tuple(words) in seen:
                continue
            seen.add(tuple(words))
            if "--json" in words:
                del words[words.index("--json"):words.index("--json") + 2]
            done = subprocess.run([BIN / words[0], *words[1:], "--json", "no folder/x"], capture_output=True, text=True)
            assert done.returncode == 2 and "--help)" not in done.stderr, f"{words}: {done.stderr}"


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
