#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a completion for bash of each tool, made of what the tool prints for --help.

Usage: completions.py OUT TOOL...    OUT/NAME for each program; bash-completion loads a file by the name of the command.
"""
import os
import re
import subprocess
import sys

CHOICES = re.compile(r"\{([^}]*)\}|([\w/-]+(?:\|[\w/-]+)+)")  # {a,b} or a|b
SCRIPT = """# bash completion of {name}, made by scripts/completions.py
_{function}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}
  if [ "$current" = = ]; then
    current=
  elif [ "$before" = = ]; then
    before=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  case $before in
{cases}  esac
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "{options}" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}}
complete -o filenames -F _{function} {name}
"""


def options_of(tool):
    """Pairs of an option's names and of the words that it takes (empty: a value of any kind; none: no value)."""
    text = subprocess.run([tool, "--help"], capture_output=True, text=True, check=True, env=os.environ | {"COLUMNS": "200"}).stdout
    for line in text.splitlines():
        if not re.match(r"  -", line):
            continue
        head = re.split(r"\s{2,}", line.strip())[0]
        names = re.findall(r"(?<![\w-])--?[A-Za-z][\w-]*", head)
        value = re.sub(r"(?<![\w-])--?[A-Za-z][\w-]*|,\s", "", head).strip(" ,")
        choices = CHOICES.search(value)
        words = re.split(r"[,|]", choices.group(1) or choices.group(2)) if choices else []
        yield names, [word for word in words if not word.isupper()] if value else None


def completion(tool):
    name = os.path.basename(tool)
    options = list(options_of(tool))
    cases = ""
    for names, words in options:
        if words is not None:
            reply = f'compgen -W "{" ".join(words)}"' if words else "compgen -f"
            cases += f'    {" | ".join(names)}) mapfile -t COMPREPLY < <({reply} -- "$current"); return ;;\n'
    return SCRIPT.format(name=name, function=name.replace("-", "_"), cases=cases,
                         options=" ".join(n for names, _ in options for n in names))


def main():
    out, tools = sys.argv[1], sys.argv[2:]
    os.makedirs(out, exist_ok=True)
    for tool in tools:
        with open(os.path.join(out, os.path.basename(tool)), "w", encoding="ascii") as file:
            file.write(completion(tool))


if __name__ == "__main__":
    main()
