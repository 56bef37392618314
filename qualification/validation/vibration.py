#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibration in pamr-dsmc beside what is known of it: see vibration.sh. Each run takes at most three minutes."""
import json
import math
import pathlib
import sys

import numpy as np

import dsmc_runs as runs
from dsmc_cases import frequency
from dsmc_runs import NITROGEN, computed_once, cube, fields, refined, tool, walls

ROOT = pathlib.Path(__file__).resolve().parents[2]
THETA = 3371.0
rows, misses = [], []


def row(case, quantity, truth, found, bound, gated=True, model=0.0):
    """`bound`: of 95 %; `model`: what the truth itself may be off."""
    rows.append((case, quantity, f"{truth:.5g}" if truth is not None else "", f"{found:.5g} +- {bound:.2g}"))
    print("  ".join(rows[-1]), flush=True)
    if gated and truth is not None and not abs(found - truth) <= 2 * bound + model:
        misses.append(f"NOT AS EXPECTED: {case}: {quantity}: expected {truth:.5g}, found {found:.5g} +- {bound:.2g}")


def energy(t):
    """Of vibration in equilibrium over k, K."""
    return THETA / math.expm1(THETA / t) if t > 0 else 0.0


def number(t, c1=9.873, c2=221.0, cross_section=3e-21):
    z = c1 * t**-0.74 * math.exp(c2 * t**(-1 / 3))
    total = math.pi * NITROGEN["diameter"]**2 * (NITROGEN["t_ref"] / t)**0.24
    return z + (math.sqrt(2) * total / cross_section * (t / 5e4)**2 if cross_section else 0.0)


def vibrating(modes):
    return {"species.N2": NITROGEN, "species.N2.vibration": modes, "gas": {"fractions": {"N2": 1.0}, "vibration": True}}


def box(modes, t, t_vib, part, n=1e22, per_cell=20.0, **schedule):
    dt = part / frequency(NITROGEN, n, t)
    return {**vibrating(modes), "stream.free": dict(density=n, temperature=t, vibrational_temperature=t_vib), **walls("specular"),
            "particles": dict(per_cell=per_cell), "domain": dict(unit=1.5e-3), "time": dict(step=dt), "run": schedule}, dt


def relaxation():
    """Nitrogen of 20,000 K that does not vibrate yet: against the equation of Landau and Teller with the data of the gas."""
    n, t0, per_cell, cubes, part = 1e22, 20000.0, 20.0, 9, 0.1
    tables, dt = box(dict(temperatures=[THETA], c1=9.873, c2=221.0, cross_section=3e-21), t0, 0.0, part, n, per_cell,
                     transient=0, sampling=800, block=1)
    history = computed_once("relaxation", tables, cube(cubes))["history"]
    real = history[0]["particles"] / (6 * cubes**3 * per_cell) * n
    rotation, vibration = history[0]["T_rot"], energy(history[0]["T_vib"])
    total, smoothed = 1.5 * history[0]["T_tr"] + rotation + vibration, history[0]["T_tr"]
    zt = 5 - 2 * NITROGEN["omega"]
    for step in range(2, 801):
        for _ in range(10):
            t = (total - rotation - vibration) / 1.5
            smoothed += max(0.004, 1 / step) / 10 * (t - smoothed)  # as the temperature of a cell is
            collisions = dt / 10 * frequency(NITROGEN, real, t)
            rotation += collisions * 0.2 * zt / (zt + 2) * (t - rotation)
            vibration += collisions / number(smoothed) * (energy(t) - vibration)
        if step in (100, 200, 400, 800):
            found = energy(history[step - 1]["T_vib"])
            row("relaxation of N2 from 20,000 K", f"vibrational energy / k after {part * step:.0f} collision times, K", vibration, found,
                2 * t0 / math.sqrt(history[0]["particles"]), model=0.015 * vibration)


def equilibrium():
    """N2 with its c2, whose rate is steep in the temperature, made fast by c1: which then takes 10 collisions: stays at one temperature."""
    for t in (800.0, 2000.0, 5000.0, 15000.0):
        c1 = 10 * t**0.74 / math.exp(221 * t**(-1 / 3))
        tables, _ = box(dict(temperatures=[THETA], c1=c1, c2=221.0), t, t, 0.5, transient=0, sampling=1800, block=6)
        history = computed_once(f"equilibrium-{t:.0f}", tables, cube(6))["history"]
        for name in ("T_vib", "T_rot"):
            groups = np.reshape([r[name] / r["T_tr"] for r in history], (10, -1)).mean(axis=1)
            row(f"box at {t:.0f} K, 900 collision times", f"{name} / T_tr", 1.0, groups.mean(), 2.262 * groups.std(ddof=1) / math.sqrt(10))


CONE = ROOT / "cases/blunt-cone/case.toml"
STREAMS = {"tunnel": {}, "hot": {"temperature = 13.6": "temperature = 200.0", "speed = 1502.0": "speed = 5000.0", "step = 7e-7": "step = 2.1e-7"}}


def cone_case(stream, vibration):
    text = CONE.read_text()
    gas = (ROOT / "cases/species.toml").read_text()
    text = text[text.index("[gas]\n"):].replace('species_file = "../species.toml"\n', "")
    changes = {"weight = 4e11": "weight = 2e12", "sampling = 1000": "transient = 400\nsampling = 600\nblock = 20", **STREAMS[stream]}
    if vibration:
        changes["[gas]\n"] = "[gas]\nvibration = true\n"
    for old, new in changes.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    at = gas.index("[species.N2]")
    end = gas.find("\n[", at)
    only = gas[at:end if end > 0 else None]
    modes = f"\n[species.N2.vibration]\ntemperatures = [{THETA}]\nc1 = 9.873\nc2 = 221.0\ncross_section = 3e-21\n" if vibration else ""
    return only + modes + text + '\n[domain]\nunit = 1.0\n'


def level_1():
    """Of the tunnel's flow on level 0, by the criterion of the case."""
    if (runs.OUT / "level1.hdf").exists():
        return "level1.hdf"
    text = CONE.read_text()
    (runs.OUT / "mesh.toml").write_text(text[:text.index("# Nitrogen of the wind tunnel")])
    tool("pamr-mesh", "mesh.toml", "-o", "level0.hdf", "--force", "--quiet", ranks=1)
    (runs.OUT / "case0.toml").write_text(cone_case("tunnel", False).replace("sampling = 600", "sampling = 200"))
    tool("pamr-dsmc", "case0.toml", "--mesh", "level0.hdf", "-o", "flow0.hdf", "--force", "--quiet")
    return refined("flow0.hdf", "level1.hdf", "--size-over", "lambda", "--ratio", "1", "--only-where", "n:above:1.1718e21",
                   "--max-cells", "45000")


def cone(stream):
    on = level_1()
    found = {}
    for vibration in (False, True):
        name = f"{stream}-{'on' if vibration else 'off'}"
        kept = runs.OUT / f"{name}-report.json"
        if not kept.exists():
            (runs.OUT / f"{name}.toml").write_text(cone_case(stream, vibration))
            tool("pamr-dsmc", f"{name}.toml", "--mesh", on, "-o", f"{name}-flow.hdf", "--json", f"{name}.json", "--force", "--quiet")
            kept.write_text((runs.OUT / f"{name}.json").read_text())
        found[vibration] = json.loads(kept.read_text())
        print(name, found[vibration]["particles"], "particles", flush=True)
    off, on_ = found[False], found[True]
    for quantity in ("C_D", "C_L", "C_m", "C_H"):
        for which, report in (("without", off), ("with", on_)):
            row(f"cone, {stream}", f"{quantity} {which} vibration", None, report[quantity]["value"], report[quantity]["ci95"])
        bound = math.hypot(off[quantity]["ci95"], on_[quantity]["ci95"])
        row(f"cone, {stream}", f"{quantity}: change", None, on_[quantity]["value"] - off[quantity]["value"], bound)
    for which, report in (("without", off), ("with", on_)):
        print(f"cone, {stream}: hottest cell {which} vibration {report['quality']['max_temperature']:.0f} K", flush=True)
    _, volume, n, t, t_vib = fields(f"{stream}-on", "n", "T_tr", "T_vib")
    dense = n > 3 * 1.116e21
    print(f"cone, {stream}: in gas of three times the stream's density T_tr {np.average(t[dense], weights=(n * volume)[dense]):.0f} K, "
          f"T_vib {np.average(t_vib[dense], weights=(n * volume)[dense]):.0f} K, at most {t_vib[dense].max():.0f} K", flush=True)


def main():
    runs.OUT, runs.RANKS = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    runs.OUT.mkdir(parents=True, exist_ok=True)
    known = {"relaxation": relaxation, "equilibrium": equilibrium, "tunnel": lambda: cone("tunnel"), "hot": lambda: cone("hot")}
    for name in sys.argv[3:] or known:
        known[name]()
    print("\n".join(misses))
    sys.exit(1 if misses else 0)


main()
