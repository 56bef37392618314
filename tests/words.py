#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Words that must not come back, in code and pages: the field has better ones, or American English has.

Usage: words.py ROOT    lists every one under ROOT as FILE:LINE: "word": what to write; exit code 1 when there is one.
The words are the table below, the exceptions the one after it; words_test.py tries both.
"""
import pathlib
import re
import sys

from layers import files_of

STEMS = ("categor character diagonal discret factor general initial linear local maxim minim normal optim organ parallel "
         "polar polygon real recogn serial summar symmetr synchron visual").replace(" ", "|")

# Pattern of the word -> what to write instead.
WORDS = {
    # American spelling
    r"neighbour\w*": "neighbor",
    r"\bcentre[sd]?\b": "center",
    r"colour\w*": "color",
    r"\b(milli|centi|micro|kilo|nano)?metres?\b": "meter",
    r"behaviour\w*": "behavior",
    r"\bfavour\w*": "favor",
    r"\bgrey\b": "gray",
    rf"\b({STEMS})is(e|ed|es|er|ing|ation|ations)\b": "-ize",
    # what a native reader stops at
    r"\b(is|are|was|were) told\b": "is reported",
    r"\bround the\b": "around the",
    r"\bbesides\b": "also, as well as, other than",
    # the field's words for ours
    r"ledger\w*": "off-surface nodes",
    r"\bAnalyst\b": "a name that says what it computes",
    r"\b(Laps|FaceCard)\b": "step timer, face record",
    r"\bdoomed_\w+": "what is to be removed",
    r"\bclosed_forms?\b": "kinetic theory, analytic solution",
    r"\b(slowness|patience)\b": "ratio of time steps, stall limit",
    r"\btie_patches\b": "associate_surfaces",
    r"\bjudge\w*": "assess, classify",
    r"\b(cells?|octets?|siblings) (that |all )?may go\b": "may be coarsened",
    r"\boctets? (is |are )?taken back\b": "coarsened",
    # the ends of a range
    r"\bleast_(?!squares)\w+": "min_",
    r"\b(greatest|most(?!_probable)|busiest|hottest)_\w+": "max_",
    r"\bpoorest_\w+": "worst_",
}

# Pattern of the files -> words that they may hold, and why.
EXCEPTIONS = (
    (r"tests/words(_test)?\.py$", r".*"),  # the list itself
    (r"CHANGELOG\.md$|docs/glossary\.md$", r".*"),  # what things were called before
    (r".*(foam|convert|compare-dsmc)[^/]*$", r"neighbour"),  # the name of a file of OpenFOAM
    (r"lib/meshing/mesh3\.cpp$", r"behaviour\w*"),  # a header of CGAL
    (r"tests/.*cad[^/]*$", r"(milli)?metre"),  # a unit in STEP files
    (r".*", r"most_transient"),  # a key of case files
    (r"lib/pamr/check/|tests/|qualification/|cases/|docs/tools/pamr-quality", r"ledger\w*"),  # a key of reports
    (r"tests/unit/.*(toml|word|case)[^/]*$", r"centre|colour"),  # keys that are refused
)
TEXT = {".cpp", ".hpp", ".ipp", ".py", ".sh", ".md", ".txt", ".toml", ".cmake", ".in", ".yml"}


def is_excepted(name, word):
    return any(re.match(place, name) and re.fullmatch(words, word) for place, words in EXCEPTIONS)


def found_in(name, text):
    for number, line in enumerate(text.splitlines(), 1):
        for pattern, better in WORDS.items():
            for match in re.finditer(pattern, line):
                if not is_excepted(name, match.group(0)):
                    yield f'{name}:{number}: "{match.group(0)}": {better}'


def violations(root):
    for path in files_of(root):
        if path.suffix in TEXT:
            yield from found_in(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8", errors="replace"))


def main():
    found = list(violations(pathlib.Path(sys.argv[1])))
    print("\n".join(found) if found else "words: none of those that must not come back")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
