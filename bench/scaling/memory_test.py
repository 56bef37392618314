#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How large the arrays of the largest rank are, over an even share of those on one rank, where cells move to Scotch's parts and are written
in the order of the file again: few cells are refined, so that moving them takes the most memory, or many, so that writing may. Beyond what
a process holds without cells. Exit code 1 where it is more than the bars.

Usage: memory_test.py TOOLS LIBRARY LAUNCHER...: the folder of the tools, the library made of own_memory.cpp, and the command that starts
as many ranks as the number behind it.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

TOOLS, LIBRARY, LAUNCHER = pathlib.Path(sys.argv[1]).resolve(), os.path.abspath(sys.argv[2]), sys.argv[3:]
RANKS = 4
BARS = {"moving": (("--crossing-sphere", "0,0,0,0.2"), 1.3), "writing": (("--centroid-shell", "0.1,0,0,0,0.75"), 1.3)}


def tool(name, *arguments, launcher=(), **environment):
    subprocess.run([*launcher, TOOLS / name, *arguments, "--force", "--quiet"], check=True, env={**os.environ, **environment})


def largest(mesh, ranks):
    """The most bytes that a rank takes for arrays of ours at once."""
    pathlib.Path("own.txt").unlink(missing_ok=True)
    tool("pamr-refine", mesh, "-o", "fine.hdf", "--balance", "scotch", launcher=[*LAUNCHER, str(ranks)], LD_PRELOAD=LIBRARY,
         PAMR_OWN_MEMORY="own.txt")
    return max(int(line.split()[0]) for line in pathlib.Path("own.txt").read_text().splitlines())


def main():
    missed = False
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        tool("pamr-mesh", "--shape", "kuhn-cube", "--n", "2", "-o", "cube.hdf")
        tool("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--all")
        empty = [largest("marked.hdf", ranks) for ranks in (1, RANKS)]
        tool("pamr-mesh", "--shape", "kuhn-cube", "--n", "20", "-o", "cube.hdf")
        for step, (marks, most) in BARS.items():
            tool("pamr-mark", "cube.hdf", "-o", "marked.hdf", *marks)
            alone, of_four = [largest("marked.hdf", ranks) - without for ranks, without in zip((1, RANKS), empty)]
            found = of_four * RANKS / alone
            print(f"{step}: {1e-6 * of_four:.2f} MB on the largest of {RANKS} ranks, {1e-6 * alone:.2f} MB on one: "
                  f"{found:.2f} of an even share, at most {most}{'' if found <= most else ': FAIL'}")
            missed = missed or not found <= most
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
