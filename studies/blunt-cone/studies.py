#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the studies of the blunt cone and prints their tables: studies.sh says how.

Usage: studies.py FULL OUT RANKS [STUDY...]
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import time
from dataclasses import dataclass

import study_tables

CASE = pathlib.Path(__file__).resolve().parents[2] / "cases" / "blunt-cone"
STUDIES = ("particles", "step", "cells", "seeds", "partner", "coarse", "levels", "domain")
LONG = ("paper",)  # only when asked for


@dataclass
class Run:
    """One flow on a mesh, begun with that of a level of the full run (or with the free stream)."""
    study: str
    name: str
    mesh: str  # level<i> of the full run, or one of MESHES
    weight: float  # molecules a particle, where the time step is the longest
    sampling: int  # averaged steps
    carry: int | None = 0
    steps: float = 1.0  # time step over the usual one
    cell_fraction: float = 0.2
    partner: str = "nearest"
    seed: int = 1


RUNS = [
    Run("particles", "l0-250k", "level0", 4e12, 1200),
    Run("partner", "l0-250k-any", "level0", 4e12, 1200, partner="any"),
    Run("step", "l0-250k-double-step", "level0", 4e12, 600, steps=2.0, cell_fraction=0.4),
    Run("step", "l0-250k-half-step", "level0", 4e12, 2400, steps=0.5, cell_fraction=0.1),
    Run("particles", "l0-500k", "level0", 2e12, 1200),
    # Half as large cells with the steps and weights that the large ones have: twice the fraction of a cell.
    Run("cells", "l0-halved-500k", "halved", 2e12, 1200, cell_fraction=0.4),
    *(Run("seeds", f"l0-125k-seed{seed}", "level0", 8e12, 1200, seed=seed) for seed in range(1, 9)),
    Run("levels", "l1-380k", "level1", 4.2e12, 1600, carry=1),
    Run("partner", "l1-380k-any", "level1", 4.2e12, 1600, carry=1, partner="any"),
    Run("coarse", "coarse-any", "coarse", 3.5e12, 1200, carry=None, partner="any"),
    Run("domain", "wide", "wide", 4e12, 1800, carry=None),
    Run("levels", "l1-760k", "level1", 2.1e12, 1600, carry=1),
    Run("levels", "l2-950k", "level2", 2.5e12, 2100, carry=2),
    Run("partner", "l2-950k-any", "level2", 2.5e12, 2100, carry=2, partner="any"),
    # The paper's numbers of particles.
    Run("paper", "l1-560k-any", "level1", 2.85e12, 1650, carry=1, partner="any"),
    Run("paper", "l2-5880k-any", "level2", 4.0e11, 2150, carry=2, partner="any"),
    Run("paper", "l3-11100k-any", "level3", 3.8e11, 4400, carry=2, partner="any"),
]
# The coarsest mesh whose edges still fit the arcs of the wall; and a wider domain.
MESHES = {
    "coarse": "far = 15e-3\nforebody = 6e-3\nshoulder = 0.75e-3\nbase = 6e-3\nfillet = 1.25e-3\nsting = 3.8e-3\ngrowth = 0.8\n",
    "wide": None,
}


class Folders:
    def __init__(self, full, out, ranks):
        self.full, self.out, self.ranks = pathlib.Path(full).resolve(), pathlib.Path(out).resolve(), ranks

    def tool(self, name, *arguments, log="tools.log"):
        """Runs a tool in the folder for runs; what it prints goes to a file there."""
        command = ["mpirun", "-n", str(self.ranks), name, *map(str, arguments), "--force"]
        with open(self.out / log, "a", encoding="utf-8") as file:
            done = subprocess.run(command, cwd=self.out, stdout=file, stderr=file)
        if done.returncode != 0:
            end = (self.out / log).read_text(encoding="utf-8").splitlines()[-3:]
            sys.exit("\n".join([f"studies.py: {' '.join(command)}: ended with {done.returncode}:", *end]))

    def mesh(self, name):
        if name.startswith("level"):
            return self.full / f"{name}.hdf"
        made = self.out / f"mesh-{name}.hdf"  # runs have names of their own
        if made.exists():
            return made
        if name == "halved":
            self.tool("pamr-mark", self.full / "level0.hdf", "--all", "-o", "marked.hdf")
            self.tool("pamr-refine", "marked.hdf", "-o", made)
        else:
            case = (CASE / "case.toml").read_text(encoding="utf-8")
            if name == "wide":
                case = case.replace("[mesh.sizes]", "[mesh.geometry]\nouter_radius = 90e-3\n\n[mesh.sizes]")
            else:
                case = re.sub(r"(?<=\[mesh\.sizes\]\n).*?(?=\n#)", MESHES[name], case, flags=re.S)
            (self.out / f"mesh-{name}.toml").write_text(case, encoding="utf-8")
            self.tool("pamr-mesh", f"mesh-{name}.toml", "-o", made)
        return made


def compute(run, folders):
    if (folders.out / f"{run.name}.json").exists():
        return
    mesh = folders.mesh(run.mesh)
    case = (CASE / "case.toml").read_text(encoding="utf-8")
    for pattern, text in ((r"\"\.\./species.toml\"", json.dumps(str(CASE.parent / "species.toml"))),
                          (r"^weight = .*", f"weight = {run.weight}"),
                          (r"^step = .*", f"step = {7e-7 * run.steps}"),
                          (r"^cell_fraction = .*", f"cell_fraction = {run.cell_fraction}"),
                          (r"^sampling = .*", f"sampling = {run.sampling}\nseed = {run.seed}"),
                          (r"^\[particles\]", f"[collisions]\npartner = \"{run.partner}\"\n\n[particles]")):
        case, found = re.subn(pattern, text, case, flags=re.M)
        if found != 1:
            sys.exit(f"studies.py: expected one {pattern} in case.toml, found {found}")
    (folders.out / f"{run.name}.toml").write_text(case, encoding="utf-8")
    checkpoint = folders.out / f"{run.name}.checkpoint"
    if checkpoint.exists():
        begin = ["--restart", checkpoint]
    elif run.carry is not None:
        begin = ["--carry", folders.full / f"flow{run.carry}.checkpoint"]
    else:
        begin = []
    before, started = os.times(), time.time()
    folders.tool("pamr-dsmc", f"{run.name}.toml", "--mesh", mesh, "-o", f"{run.name}.hdf", *begin, "--checkpoint", checkpoint,
                 "--every", 300, "--surface", f"{run.name}.vtu", "--history", f"{run.name}.csv", "--json", "unready.json",
                 log=f"{run.name}.log")
    after = os.times()
    with open(folders.out / "unready.json", encoding="utf-8") as file:
        report = json.load(file)
    (folders.out / "unready.json").replace(folders.out / f"{run.name}.json")
    checkpoint.unlink(missing_ok=True)
    print(f"{run.name}: C_D {report['C_D']['value']:.4f}, C_H {report['C_H']['value']:.4f}, {report['particles']} particles, "
          f"{report['steps']} steps, {sum(after[2:4]) - sum(before[2:4]):.0f} CPU s, {time.time() - started:.0f} s", flush=True)


def main():
    folders = Folders(*sys.argv[1:3], int(sys.argv[3]))
    chosen = sys.argv[4:] or STUDIES
    for study in chosen:
        if study not in (*STUDIES, *LONG, *(run.name for run in RUNS), "tables"):
            sys.exit(f"studies.py: unknown study {study}: expected some of {' '.join(STUDIES + LONG)} tables, or a run's name")
    for run in RUNS:
        if run.study in chosen or run.name in chosen:
            compute(run, folders)
    study_tables.print_all(RUNS, folders)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("studies.py: interrupted; the same command goes on from the last checkpoint")
