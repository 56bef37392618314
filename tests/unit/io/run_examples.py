# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the Python examples of a manual page, one after the other, in the folder given."""
import os
import re
import sys

page, folder = sys.argv[1:]
with open(page, encoding="utf-8") as file:
    examples = re.findall(r"^```python\n(.*?)^```", file.read(), re.DOTALL | re.MULTILINE)
os.chdir(folder)
names = {}
for example in examples:
    exec(compile(example, page, "exec"), names)
if not examples:
    sys.exit("no examples found in " + page)
