#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What moving cells during a run gains: the gas about the blunt cone on several ranks, with and without --keep-cells.

Usage: decomposition-dsmc.py OUT [--tools FOLDER] [--ranks "2 8 16 32 64"] [--steps N]

Imbalance is the processor time of the slowest rank over the mean, which needs no core for each rank; seconds by the clock
mean something only where there is one. The stream enters an empty domain, so that the work moves. The table is printed as
Markdown; runs that are in OUT are not repeated. Docs: docs/reports/dsmc-ranks.md.
"""
import argparse
import json
import pathlib
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]


def tool(folder, name, *arguments, ranks=1):
    launcher = ["mpirun", "-q", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    start = time.monotonic()
    subprocess.run([*launcher, f"{folder}/{name}" if folder else name, *map(str, arguments)], check=True)
    return time.monotonic() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--tools", default="")
    parser.add_argument("--ranks", default="2 8 16 32 64")
    parser.add_argument("--steps", type=int, default=400)
    given = parser.parse_args()
    out = given.out
    out.mkdir(parents=True, exist_ok=True)
    text = (ROOT / "cases/blunt-cone/case.toml").read_text()
    for old, new in (('"../species.toml"', f'"{ROOT}/cases/species.toml"'), ("weight = 4e11", "weight = 1.6e12"),
                     ("sampling = 1000", f"transient = 0\nsampling = {given.steps}"), ("[boundary.forebody]", '[initial]\nstream = "vacuum"\n[boundary.forebody]')):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    (out / "case.toml").write_text(text)
    if not (out / "level0.hdf").exists():
        tool(given.tools, "pamr-mesh", out / "case.toml", "-o", out / "level0.hdf", "--quiet")
    print("| ranks | cells | imbalance | moves | messages a step, all ranks | KB a step, all ranks | seconds by the clock |\n|---|---|---|---|---|---|---|")
    for ranks in map(int, given.ranks.split()):
        for keep in (True, False):
            kept = out / f"{ranks}-{'stay' if keep else 'move'}.json"
            if not kept.exists():
                new = out / "new.json"
                seconds = tool(given.tools, "pamr-dsmc", out / "case.toml", "--mesh", out / "level0.hdf", "-o", out / "flow.hdf", "--json", new,
                               "--force", "--quiet", *(["--keep-cells"] if keep else []), ranks=ranks)
                found = json.loads(new.read_text())
                kept.write_text(json.dumps({**found["decomposition"], "seconds": seconds, "particles": found["particles"]}))
            d = json.loads(kept.read_text())
            print(f"| {ranks} | {'stay' if keep else 'move'} | {d['imbalance']:.2f} | {d['moves']} | {d['messages_per_step']:.1f} | "
                  f"{d['bytes_per_step'] / 1000:.1f} | {d['seconds']:.0f} |", flush=True)


main()
