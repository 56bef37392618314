#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The gain of moving cells during a run, by counting: gas about the blunt cone on 1 to 64 ranks, with and without --keep-cells.

Usage: decomposition-dsmc.py OUT [--tools FOLDER] [--ranks "1 2 8 16 32 64"] [--steps N] [--weight MOLECULES]

Counted, which needs no core for each rank: particle-steps of the rank with the most over the mean, moves, messages and
bytes. Measured, of use only where each rank has a core: processor time of the slowest rank over the mean (without waiting)
and seconds by the clock; they are left out above --cores ranks. The stream enters an empty domain, so that the work moves.
The table is printed as Markdown; runs that are in OUT are not repeated. Docs: docs/reports/dsmc-ranks.md.
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
    parser.add_argument("--ranks", default="1 2 8 16 32 64")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--weight", type=float, default=1.6e12, help="molecules of a particle")
    parser.add_argument("--cores", type=int, default=2, help="of this machine")
    given = parser.parse_args()
    out = given.out
    out.mkdir(parents=True, exist_ok=True)
    text = (ROOT / "cases/blunt-cone/case.toml").read_text()
    for old, new in (('"../species.toml"', f'"{ROOT}/cases/species.toml"'), ("weight = 4e11", f"weight = {given.weight!r}"),
                     ("sampling = 1000", f"transient = 0\nsampling = {given.steps}"), ("[boundary.forebody]", '[initial]\nstream = "vacuum"\n[boundary.forebody]')):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    case = out / "case.toml"
    if case.exists() and case.read_text() != text:
        raise SystemExit(f"{out}: expected runs of the same case, found those of another one: use another folder")
    case.write_text(text)
    if not (out / "level0.hdf").exists():
        tool(given.tools, "pamr-mesh", out / "case.toml", "-o", out / "level0.hdf", "--quiet")
    print("| ranks | cells | counted: particle-steps, most over mean | counted: moves | counted: messages a step | counted: KB a step | "
          "measured: processor time, most over mean | measured: seconds |\n|---|---|---|---|---|---|---|---|", flush=True)
    for ranks in map(int, given.ranks.split()):
        for keep in (True, False) if ranks > 1 else (True,):
            kept = out / f"{ranks}-{'stay' if keep else 'move'}.json"
            if not kept.exists():
                new = out / "new.json"
                seconds = tool(given.tools, "pamr-dsmc", out / "case.toml", "--mesh", out / "level0.hdf", "-o", out / "flow.hdf", "--json", new,
                               "--force", "--quiet", *(["--keep-cells"] if keep else []), ranks=ranks)
                found = json.loads(new.read_text())
                kept.write_text(json.dumps({**found["decomposition"], "seconds": seconds, "particles": found["particles"]}))
            d = json.loads(kept.read_text())
            measured = f"{d['imbalance']:.2f} | {d['seconds']:.0f}" if ranks <= given.cores else "|"
            print(f"| {ranks} | {'stay' if keep else 'move'} | {d['particle_imbalance']:.2f} | {d['moves']} | {d['messages_per_step']:.1f} | "
                  f"{d['bytes_per_step'] / 1000:.1f} | {measured} |", flush=True)


main()
