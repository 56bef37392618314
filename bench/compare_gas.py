#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed of pamr-dsmc beside an older version of it and beside SPARTA, one after the other in one run.

    compare_gas.py TOOLS [--before TOOLS] [--sparta PROGRAM] [--runs N] [--partner NAME] [--particles N...] [--no-cone] [--out FOLDER]
                   [--min-before X] [--min-sparta X]

TOOLS: folder with pamr-dsmc and pamr-mesh. PROGRAM: SPARTA, built serially (qualification/validation/sparta.sh builds it).
--partner: of the first tools (default nearest). --particles: about so many (default 1e5, 1e6 and 1e7).

Nitrogen with rotation, 12 particles a cell, near partners in all codes, averages of every step: a box of mirrors at rest, and a
stream of Mach 5 that enters and leaves through all sides. The time step times the most probable speed (and the stream's) is 0.3 cube
roots of a cell's volume, and 0.07 pairs of a particle collide in a step. SPARTA has cubes, as many as there are tetrahedra to within
3 %. The cone is cases/blunt-cone on its level 0 with half a million particles, whose collisions are in cells of 48 to 400 particles:
steps 900 to 1,100, not by SPARTA. Seconds are the processor's of the steps alone, as the programs report them (of SPARTA: the time of
its loop, times the part of its time that the process had the processor). Rates are medians of the runs, which take turns, and so are
their ratios. Exit code 1 if a ratio is below --min-before (default 0.9: as fast as before but for noise) or --min-sparta (default 0.95:
as fast but for noise).
"""
import argparse
import json
import math
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

BOLTZMANN = 1.380649e-23
MASS, DIAMETER, OMEGA, T_REF, TEMPERATURE = 4.65e-26, 4.17e-10, 0.74, 273.0, 300.0
PER_CELL, MACH = 12, 5.0
CASES = pathlib.Path(__file__).resolve().parents[1] / "cases"
SIDES = ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")


class Gas:
    """The case for a number of cubes along an edge of the unit cube, 6 tetrahedra each."""

    def __init__(self, cubes, mach):
        self.cubes, self.cells = cubes, 6 * cubes**3
        fast = math.sqrt(2 * BOLTZMANN * TEMPERATURE / MASS)
        self.speed = mach * math.sqrt(1.4 * BOLTZMANN * TEMPERATURE / MASS)
        self.step = 0.3 * (1 / self.cells)**(1 / 3) / (fast + self.speed)
        rate = 4 * DIAMETER**2 * math.sqrt(math.pi * BOLTZMANN * T_REF / MASS) * (TEMPERATURE / T_REF)**(1 - OMEGA)
        self.density = 2 * 0.07 / self.step / rate
        self.particles = PER_CELL * self.cells
        self.grid = round((6 * cubes**3)**(1 / 3))


def run(command, folder):
    """Runs a program; the part of its time that it had the processor."""
    begin = time.monotonic()
    with open(folder / "log", "w", encoding="utf-8") as log:
        process = subprocess.Popen(command, cwd=folder, stdout=log, stderr=log)
        _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(map(str, command))}: {(folder / 'log').read_text()}")
    return (usage.ru_utime + usage.ru_stime) / (time.monotonic() - begin)


class Pamr:
    def __init__(self, tools, partner):
        self.tools = pathlib.Path(tools).resolve()
        self.partner = partner
        self.collisions = f'[collisions]\npartner = "{partner}"\n' if partner != "nearest" else ""

    def prepare(self, gas, folder):
        self.mesh = self.mesh_name(gas.cubes)
        if not (folder / self.mesh).exists():
            subprocess.run([self.tools / "pamr-mesh", "--shape", "kuhn-cube", "--n", str(gas.cubes), "-o", self.mesh, "--quiet"],
                           cwd=folder, check=True)

    def rate(self, gas, mach, steps, folder):
        """Particle-steps a second."""
        kind = "inflow" if mach else "specular"
        (folder / "case.toml").write_text(
            f"[species.N2]\nmass = {MASS}\ndiameter = {DIAMETER}\nomega = {OMEGA}\nt_ref = {T_REF}\nrotational_degrees = 2\n"
            "[gas]\nfractions = { N2 = 1.0 }\n[gas.rotation]\nprobability = 0.2\n"
            f"[stream.free]\ndensity = {gas.density}\ntemperature = {TEMPERATURE}\nvelocity = [{gas.speed}, 0.0, 0.0]\n[boundary]\n"
            + "".join(f'{side} = {{ kind = "{kind}" }}\n' for side in SIDES) + self.collisions
            + f"[particles]\nper_cell = {PER_CELL}\n[domain]\nunit = 1.0\n[time]\nstep = {gas.step}\n"
            f"[run]\ntransient = 2\nsampling = {steps}\nblock = {steps}\n[reference]\narea = 1.0\n")
        return self.rate_of(["case.toml", "--mesh", self.mesh], folder)

    def rate_of(self, arguments, folder):
        run([self.tools / "pamr-dsmc", *arguments, "-o", "flow.hdf", "--force", "--quiet", "--json", "report.json"], folder)
        return json.loads((folder / "report.json").read_text())["particle_steps_per_second_per_core"]

    def prepare_cone(self, folder):
        """A checkpoint of step 900."""
        self.cone = self.mesh_name(f"cone-{self.partner}")
        text = (CASES / "blunt-cone/case.toml").read_text().replace("../species.toml", str(CASES / "species.toml"))
        text = text.replace("weight = 4e11", "weight = 2e12").replace("sampling = 1000", "transient = 900\nsampling = 1000\nblock = 50")
        case = folder / f"{self.cone}.toml"  # of these tools alone: the others may have another partner
        case.write_text(text + self.collisions)
        if not (folder / f"{self.cone}.checkpoint").exists():
            subprocess.run([self.tools / "pamr-mesh", CASES / "blunt-cone/case.toml", "-o", self.cone, "--quiet"], cwd=folder, check=True)
            self.rate_of([case.name, "--mesh", self.cone, "--steps", "900", "--checkpoint", f"{self.cone}.checkpoint"], folder)

    def cone_rate(self, folder):
        return self.rate_of([f"{self.cone}.toml", "--mesh", self.cone, "--restart", f"{self.cone}.checkpoint", "--steps", "1100"], folder)

    def mesh_name(self, name):
        return f"mesh{str(self.tools).replace(os.sep, '-')}-{name}.hdf"


class Sparta:
    def __init__(self, program):
        self.program = pathlib.Path(program).resolve()

    def prepare(self, _, folder):
        (folder / "N2.species").write_text(f"N2 {MASS / 1.66053907e-27:.6g} {MASS:g} 2 0.2 0 0.0 0.0 1.0 0.0\n")
        (folder / "N2.vss").write_text(f"N2 {DIAMETER:g} {OMEGA} {T_REF} 1.0\n")

    def rate(self, gas, mach, steps, folder):
        side = " ".join("oo" if mach else "rr" for _ in range(3))
        lines = ["seed 12345", "dimension 3", "global gridcut 0.0", f"boundary {side}", "create_box 0 1 0 1 0 1",
                 f"create_grid {gas.grid} {gas.grid} {gas.grid}", "balance_grid rcb cell",
                 f"global nrho {gas.density} fnum {gas.density / gas.particles}", "species N2.species N2",
                 f"mixture gas N2 nrho {gas.density} temp {TEMPERATURE} vstream {gas.speed} 0 0", "collide vss gas N2.vss",
                 "collide_modify rotate smooth vibrate no nearcp yes 20"]
        if mach:
            lines.append("fix in emit/face gas xlo xhi ylo yhi zlo zhi")
        lines += [f"create_particles gas n {gas.particles}", f"timestep {gas.step}", "stats 1000", "compute flow grid all all n u v w ke",
                  f"fix mean ave/grid all 1 {steps} {steps} c_flow[*]", "run 2 post no", f"run {steps} post no"]
        (folder / "in.speed").write_text("\n".join(lines) + "\n")
        part = run([self.program, "-in", "in.speed", "-log", "log.speed", "-screen", "none"], folder)
        loops = re.findall(r"Loop time of (\S+) on 1 procs for (\d+) steps with (\d+) particles", (folder / "log.speed").read_text())
        seconds, steps, particles = map(float, loops[-1])
        return particles * steps / (seconds * part)


def compare(codes, runs, rate):
    """Rates of the codes by `rate`(code), M particle-steps a second, and the first one's over each other's: medians."""
    rates = {name: [] for name in codes}
    for _ in range(runs):
        for name, code in codes.items():
            rates[name].append(rate(code) * 1e-6)
    first = next(iter(codes))
    ratios = [statistics.median(a / b for a, b in zip(rates[first], rates[name])) for name in list(codes)[1:]]
    return {name: statistics.median(values) for name, values in rates.items()}, ratios


def too_slow(case, ratios, least):
    """A line for each code beside which the ratio is below what is wanted."""
    return [f"{case}: expected {least[name]:g} times the rate of {name} or more, found {ratio:.2f}" for name, ratio in ratios
            if not ratio >= least[name]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tools")
    parser.add_argument("--before")
    parser.add_argument("--sparta")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--partner", default="nearest", choices=["nearest", "subcell", "any"])
    parser.add_argument("--particles", type=float, nargs="*", default=[1e5, 1e6, 1e7])
    parser.add_argument("--no-cone", action="store_true")
    parser.add_argument("--out")
    parser.add_argument("--min-before", type=float, default=0.9)
    parser.add_argument("--min-sparta", type=float, default=0.95)
    arguments = parser.parse_args()
    codes = {"pamr-dsmc": Pamr(arguments.tools, arguments.partner)}
    if arguments.before:
        codes["before"] = Pamr(arguments.before, "nearest")
    if arguments.sparta:
        codes["SPARTA"] = Sparta(arguments.sparta)
    print("| case | particles | " + " | ".join(f"{name}, M particle-steps a CPU second" for name in codes)
          + "".join(f" | times {name}" for name in list(codes)[1:]) + " |\n|" + "---|" * (1 + 2 * len(codes)))

    least = {"before": arguments.min_before, "SPARTA": arguments.min_sparta}
    slow = []

    def row(case, particles, found):
        rates, ratios = found
        slow.extend(too_slow(f"{case}, {particles:,} particles", zip(list(rates)[1:], ratios), least))
        words = [f"{rates[name]:.2f}" if name in rates else "-" for name in codes]
        words += [f"{ratio:.2f}" for ratio in ratios] + ["-"] * (len(codes) - 1 - len(ratios))
        print(f"| {case} | {particles:,} | " + " | ".join(words) + " |", flush=True)

    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(arguments.out or temporary).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        for mach in (0.0, MACH):
            for wanted in arguments.particles:
                gas = Gas(round((wanted / PER_CELL / 6)**(1 / 3)), mach)
                steps = max(20, round(1e8 / gas.particles))
                for code in codes.values():
                    code.prepare(gas, folder)
                row("stream" if mach else "box", gas.particles, compare(codes, arguments.runs, lambda code: code.rate(gas, mach, steps, folder)))
        if not arguments.no_cone:
            ours = {name: code for name, code in codes.items() if isinstance(code, Pamr)}
            for code in ours.values():
                code.prepare_cone(folder)
            row("cone, level 0", 502551, compare(ours, arguments.runs, lambda code: code.cone_rate(folder)))
    for text in slow:
        print(f"compare_gas.py: {text}", file=sys.stderr)
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
