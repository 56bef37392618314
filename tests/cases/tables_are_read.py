#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a test compares with every row of every table of expected values.

Usage: tables_are_read.py ROOT FILE

Tables are the .csv files of cases/*/ and studies/*/. FILE is written by tests/cases/CMakeLists.txt: lines `test<TAB>table:rows`, where
`rows` is a regular expression for the beginning of the rows that this test reaches. A test of a case counts where a script of the case's
folder names the table. What takes hours is held by a step of studies/reproduce.sh (BY_CAMPAIGN), which fails as the tests do.
Exit code 1 with a line for each row that nothing reads, and for each entry that reaches no row.
"""
import pathlib
import re
import sys

BY_CAMPAIGN = {  # step: the tables and rows that its command compares with
    "cone": ["cases/blunt-cone/expected.csv:full,"],
    "sphere": ["cases/supersonic-sphere/expected.csv:full,"],
    "heat-flux": ["cases/blunt-cone/heat-flux.csv:."],
    "table5": ["studies/charged-spheres/expected.csv:."],
    "pairs": ["studies/charged-spheres/pairs.csv:."],
}
NO_GATE = {"studies/charged-spheres/truth.csv": "studies/charged-spheres/orders.py and bars.py"}  # by hand, with exit codes of their own


def rows_of(table):
    """The rows without comments and without the names of the columns."""
    return [line for line in table.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")][1:]


def readers(root, declared):
    """By table the pairs of a reader's name and the rows that it reaches."""
    found = {}
    lines = [line.split("\t") for line in declared.splitlines()]
    steps = (root / "studies/reproduce.sh").read_text(encoding="utf-8")
    for step, reads in BY_CAMPAIGN.items():
        if not re.search(rf"^    {step}\) command=", steps, re.MULTILINE):
            sys.exit(f"tables_are_read.py: expected a step {step} in studies/reproduce.sh, found none")
        lines += [(f"studies/reproduce.sh {step}", read) for read in reads]
    for name, read in lines:
        table, _, rows = read.partition(":")
        found.setdefault(table, []).append((name, rows))
    return found


def names_it(table):
    """Whether a script beside the table, or of the cases in common, names the file."""
    scripts = [path for path in table.parent.iterdir() if path.suffix in (".py", ".sh")]
    return any(table.name in path.read_text(encoding="utf-8") for path in scripts)


def troubles(root, declared):
    found = readers(root, declared)
    tables = sorted(path for folder in ("cases", "studies") for path in (root / folder).glob("*/*.csv"))
    for table in tables:
        name = str(table.relative_to(root))
        if name in NO_GATE:
            continue
        if not names_it(table):
            yield f"{name}: expected a script beside it that reads it, found none"
        rows = rows_of(table)
        for row in rows:
            if not any(re.match(pattern, row) for _, pattern in found.get(name, [])):
                yield f"{name}: no test reads the row {row}"
        for reader, pattern in found.get(name, []):
            if not any(re.match(pattern, row) for row in rows):
                yield f"{name}: expected rows that begin with {pattern}, which {reader} is to read, found none"
    for name in sorted(set(found) - {str(table.relative_to(root)) for table in tables}):
        yield f"{name}: expected this table, which {found[name][0][0]} is to read, found none"


def main():
    root, declared = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    found = list(troubles(root, declared.read_text(encoding="utf-8")))
    for text in found:
        print(text, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
