#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether every number that a page of the manual promises has a test, and whether the list of them is true.

Usage: promises.py ROOT [BUILD CTEST]

The list is the table of qualification/promises.md: page, quote, what holds it. Refused are

- a quote that its page no longer has (line breaks and blanks do not count);
- a holder that does not exist. In backquotes: a unit test `Suite.Name`, a function `test_...` of a script of the tests, a script by its
  path; a page of results with the text that it has to have, `docs/reports/PAGE.md: TEXT`, where a number is measured, not promised; any
  other word is the name of a test of ctest (asked for where BUILD and CTEST are given);
- a quote with no holder;
- a paragraph or item with a number, in a part of a page that promises (below), of which no quote is a part. Numbers in code, links and
  exit codes do not count, nor does level 0.

Parts that promise: sections under a heading with "guarantee" or "promise" in it which does not begin with "Not" or "What is not", and
those of PROMISING. docs/reliability.md names the tests of its promises itself. Exit code 1 with a line for each trouble.
"""
import pathlib
import re
import subprocess
import sys

PROMISING = {"README.md": ("What it combines", "What it does **not** do"), "docs/coarsening.md": ("## What comes back", "## Several ranks"),
             "docs/tools/pamr-dsmc.md": ("## Validation", "## What is guaranteed")}
OWN_TABLES = {"docs/reliability.md"}
LIST = "qualification/promises.md"


def plain(text):
    return " ".join(text.split())


def rows_of(text):
    """Page, quote and holders of each row of the table."""
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if line.startswith("| ") and len(cells) == 3 and re.fullmatch(r"\S+\.md", cells[0]):
            yield cells[0], plain(cells[1]), re.findall(r"`([^`]+)`", cells[2])


def ctest_names(root, build, ctest):
    """Of all levels; and those of cases that cannot run where something is missing."""
    shown = subprocess.run([ctest, "--test-dir", build, "-C", "full", "-N"], capture_output=True, text=True, check=True).stdout
    left_out = (pathlib.Path(build) / "tests/cases/tables_read.txt").read_text(encoding="utf-8")
    return set(re.findall(r"Test +#\d+: (\S+)", shown)) | {line.split("\t")[0] for line in left_out.splitlines()}


class Holders:
    """What may hold a promise."""

    def __init__(self, root, names):
        self.root, self.names = root, names
        self.units = {f"{a}.{b}" for path in (root / "tests").rglob("*.cpp")
                      for a, b in re.findall(r"\bTEST(?:_F|_P)?\((\w+), *(\w+)\)", path.read_text(encoding="utf-8"))}
        self.functions = {name for path in (root / "tests").rglob("*.py")
                          for name in re.findall(r"def (test_\w+)", path.read_text(encoding="utf-8"))}

    def trouble(self, holder):
        """What is wrong with it, None if it is there."""
        path, _, text = holder.partition(": ")
        if "/" in path:
            if not (self.root / path).exists():
                return f"expected a file {path}, found none"
            if text and plain(text) not in plain((self.root / path).read_text(encoding="utf-8")):
                return f"expected '{text}' in {path}, found other words"
            return None if text or not path.endswith(".md") else f"expected the text that {path} has of it, found none"
        if re.fullmatch(r"[A-Z]\w*\.\w+", holder):
            return None if holder in self.units else f"expected a unit test {holder}, found none"
        if holder.startswith("test_"):
            return None if holder in self.functions else f"expected a function {holder} in the tests, found none"
        if self.names is not None and holder not in self.names:
            return f"expected a test {holder} of ctest, found none"
        return None


def parts_that_promise(page, text):
    begin, end = PROMISING.get(page, (None, None))
    if begin:
        if begin not in text or end not in text:
            raise SystemExit(f"promises.py: {page}: expected '{begin}' and '{end}', found other words")
        yield text[text.index(begin):text.index(end)]
    for section in re.split(r"\n(?=#+ )", text):
        heading, _, body = section.partition("\n")
        if re.match(r"#+ ", heading) and re.search("guarantee|promise", heading, re.IGNORECASE) and not re.match(
                r"#+ (Not|What is not)", heading):
            yield re.split(r"\nNot guaranteed", body)[0]


def numbered_items(part):
    """Its paragraphs, list items and rows of tables that have a number."""
    for item in re.split(r"\n(?=\s*- |\n|\||> )|\n\n", re.sub(r"```.*?```", "", part, flags=re.DOTALL)):
        words = re.sub(r"\]\([^)]*\)|`[^`]*`|^#.*$|^\| \d \|.*$|exit codes?:? [^.]*|level 0|below 0", "", item,
                       flags=re.IGNORECASE | re.MULTILINE)
        if re.search(r"(?<![A-Za-z_])\d", words):
            yield plain(item)


def troubles(root, names):
    holders, quotes = Holders(root, names), {}
    for page, quote, held_by in rows_of((root / LIST).read_text(encoding="utf-8")):
        quotes.setdefault(page, []).append(quote)
        if not (root / page).exists() or quote not in plain((root / page).read_text(encoding="utf-8")):
            yield f"{LIST}: {page} has no longer the words: {quote}"
        if not held_by:
            yield f"{LIST}: {page}: no test holds: {quote}"
        for holder in held_by:
            if (text := holders.trouble(holder)) is not None:
                yield f"{LIST}: {page}: {text}, for: {quote}"
    if not quotes:
        yield f"{LIST}: expected rows of promises, found none"
    pages = [root / "README.md", *(root / "docs").glob("*.md"), *(root / "docs/tools").glob("*.md")]
    for path in sorted(pages):
        page = str(path.relative_to(root))
        for part in () if page in OWN_TABLES else parts_that_promise(page, path.read_text(encoding="utf-8")):
            for item in numbered_items(part):
                if not any(quote in item for quote in quotes.get(page, [])):
                    yield f"{page}: {LIST} has no test for the promise: {item[:200]}"


def main():
    root = pathlib.Path(sys.argv[1])
    names = ctest_names(root, *sys.argv[2:4]) if len(sys.argv) > 2 else None
    found = list(troubles(root, names))
    for text in found:
        print(text, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
