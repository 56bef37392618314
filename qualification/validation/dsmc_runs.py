# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of pamr-dsmc for validation, and the table of what they found."""
import csv
import json
import math
import pathlib
import subprocess

import h5py
import numpy as np

BOLTZMANN = 1.380649e-23
OUT, RANKS, SEEDS = pathlib.Path("."), 1, 3
ARGON = dict(mass=6.63e-26, diameter=4.17e-10, omega=0.81, t_ref=273.0)
ARGON_SOFT = dict(mass=6.63e-26, diameter=4.11e-10, omega=0.81, t_ref=273.15, alpha=1.4)
NITROGEN = dict(mass=4.65e-26, diameter=4.17e-10, omega=0.74, t_ref=273.0, rotational_degrees=2)
SIDES = ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")
rows = []


def tool(name, *arguments, ranks=None):
    launcher = ["mpirun", "-n", str(ranks or RANKS)] if (ranks or RANKS) > 1 else []
    done = subprocess.run([*launcher, name, *map(str, arguments)], cwd=OUT, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{name} {' '.join(map(str, arguments))}: {done.stderr}")


def mesh(name, *arguments):
    """Makes a mesh with pamr-mesh once."""
    if not (OUT / name).exists():
        tool("pamr-mesh", *arguments, "-o", name, "--quiet", ranks=1)
    return name


def cube(n):
    return mesh(f"cube{n}.hdf", "--shape", "kuhn-cube", "--n", n)


def refined(source, target, *criterion):
    if not (OUT / target).exists():
        tool("pamr-mark", source, "-o", "marked.hdf", *criterion, "--force", "--quiet")
        tool("pamr-refine", "marked.hdf", "-o", target, "--quiet")
    return target


def toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return json.dumps(value) if isinstance(value, str) else repr(value)


def case_text(tables):
    """TOML of {"a.b": {key: value}}; a list of dictionaries becomes a list of tables."""
    text = ""
    for name, table in tables.items():
        for one in table if isinstance(table, list) else [table]:
            text += (f"[[{name}]]\n" if isinstance(table, list) else f"[{name}]\n")
            text += "".join(f"{key} = {toml(value)}\n" for key, value in one.items())
    return text


def gas(**species):
    """Tables of a gas of one species, or of equal parts of several: name=table."""
    return {**{f"species.{name}": table for name, table in species.items()},
            "gas": {"fractions": {name: 1 / len(species) for name in species}}}


def walls(kind="symmetry", **given):
    return {"boundary": {side: given.get(side, {"kind": kind}) for side in SIDES}}


def compute(name, tables, on, seed, plan=False):
    """One run; its report, with also its `history`. No mesh has the name of its flow, NAME-flow.hdf."""
    tables = {**tables, "run": {**tables.get("run", {}), "seed": seed}}
    tables.setdefault("domain", {"unit": 1.0})
    (OUT / f"{name}.toml").write_text(case_text(tables))
    if plan:
        tool("pamr-dsmc", f"{name}.toml", "--mesh", on, "--plan", "--json", f"{name}.json")
        return json.loads((OUT / f"{name}.json").read_text())
    tool("pamr-dsmc", f"{name}.toml", "--mesh", on, "-o", f"{name}-flow.hdf", "--history", f"{name}.csv", "--json", f"{name}.json",
         "--force", "--quiet")
    report = json.loads((OUT / f"{name}.json").read_text())
    assert report["lost_particles"] == 0
    with open(OUT / f"{name}.csv") as file:
        report["history"] = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    return report


def computed_once(name, tables, on, seed=1):
    """The report of a run, kept from an earlier call."""
    kept = OUT / f"{name}-report.json"
    if not kept.exists():
        kept.write_text(json.dumps(compute(name, tables, on, seed)))
    return json.loads(kept.read_text())


def fields(name, *wanted):
    """Middle points, volumes and fields of the cells of a run."""
    with h5py.File(OUT / f"{name}-flow.hdf") as file:
        corner = file["VTKHDF/Points"][:][file["VTKHDF/Connectivity"][:].reshape(-1, 4)]
        values = [file[f"VTKHDF/CellData/{one}"][:] for one in wanted]
    edges = corner[:, 1:] - corner[:, :1]
    return corner.mean(axis=1), np.abs(np.linalg.det(edges)) / 6, *values


def mean(values):
    """Mean and standard error of independent values."""
    values = np.asarray(values, dtype=float)
    return values.mean(), values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else 0.0


def together(estimates):
    """Mean of independent (value, error)."""
    return sum(v for v, _ in estimates) / len(estimates), math.sqrt(sum(e * e for _, e in estimates)) / len(estimates)


def check(case, quantity, reference, found, error, bar=0.0, most=None, gated=True):
    """Found against reference within four standard errors or the bar, the error at most `most`."""
    off = abs(found - reference)
    verdict = "reported"
    if gated:
        good = off <= max(4 * error, bar) and (most is None or error <= most)
        verdict = "pass" if good else "FAIL"
    gate = f"max(4 SE, {bar:.3g})" if bar else "4 SE"
    rows.append([case, quantity, f"{reference:.6g}", f"{found:.6g}", f"{error:.2g}", gate if gated else "",
                 "" if most is None else f"{most:.2g}", verdict])
    print("  ".join(f"{cell:>12}" for cell in rows[-1]), flush=True)


def write_results():
    new = OUT / "results.csv"
    header = ["case", "quantity", "reference", "found", "standard error", "gate", "error at most", "verdict"]
    kept = []
    if new.exists():
        mine = {row[0] for row in rows}
        kept = [row for row in list(csv.reader(new.open()))[1:] if row[0] not in mine]
    with new.open("w", newline="") as file:
        csv.writer(file).writerows([header, *kept, *rows])
    return any(row[-1] == "FAIL" for row in rows)
