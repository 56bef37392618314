#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""compile_commands.py BUILD < FILES: prints the command that checks each of these sources alone, as BUILD would compile it.

Sources that BUILD does not compile (of parts that are left out) have none.
"""
import json
import pathlib
import shlex
import sys

build = pathlib.Path(sys.argv[1])
root = pathlib.Path(__file__).resolve().parent.parent
command_of = {entry["file"]: entry for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))}
for name in sys.stdin.read().splitlines():
    entry = command_of.get(str(root / name))
    if entry is None:
        continue
    words = shlex.split(entry["command"])
    kept = [word for i, word in enumerate(words) if word not in ("-c", "-o") and words[i - 1] != "-o" and not word.startswith("-O")]
    print("cd", shlex.quote(entry["directory"]), "&&", shlex.join([*kept, "-fsyntax-only"]))
