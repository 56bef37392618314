# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of what whole tools take, files included."""

import json
import pathlib
import resource
import shutil
import statistics
import sys
import time

import rows
from measure import Failed, line_of_json, load, output_of, warm_memory

BENCH = pathlib.Path(__file__).resolve().parents[1]
PARTS = BENCH.parent / "tests/unit/geometry/data"
CAD_HEAD = (
    "part | edges | code | cells | CPU s | theirs / ours: CPU s | a cell | smallest mean ratio | mean | `limit` | "
    "load | runs"
).split(" | ")
FILE_HEAD = "step | wall s | CPU s | wall s on two ranks | CPU s of the slower".split(" | ")


def cpu_of(command, environment):
    """What a program printed, and the processor seconds of it and its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = output_of(command, environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return text, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def our_cad_run(context, part, size):
    mesh = context.out / "part.hdf"
    tools = context.build / "bin"
    text, cpu = cpu_of(
        [tools / "pamr-mesh", part, "--size", size, "-o", mesh, "--force", "--quiet", "--json", "-"], context.environment
    )
    found = json.loads(text)
    shapes = json.loads(output_of([tools / "pamr-quality", mesh, "--quiet", "--json", "-"], context.environment))
    ratio = shapes["mean_ratio"]
    mesh.unlink()
    return {"cells": found["cells"], "cpu": cpu, "worst": ratio["min"], "mean": ratio["mean"]}


def cad_rows(part, size, codes, limit, load_then):
    """`codes`: {name: runs}, ours first. Ratios in parentheses: the meshes differ."""
    medians = {name: statistics.median(run["cpu"] for run in runs) for name, runs in codes.items()}
    ours = next(iter(codes))
    cells = {name: runs[0]["cells"] for name, runs in codes.items()}
    for name, runs in codes.items():
        ratio = medians[name] / medians[ours]
        yield [
            part,
            f"{size:g}",
            name,
            f"{cells[name]:,}",
            rows.number(medians[name]),
            "1" if name == ours else f"({rows.number(ratio)})",
            "1" if name == ours else f"({rows.number(ratio * cells[ours] / cells[name])})",
            rows.number(runs[0]["worst"]),
            rows.number(runs[0]["mean"]),
            rows.number(limit),
            rows.number(load_then),
            str(len(runs)),
        ]


def cad_table(context):
    sizes = {"whole": (0.15, 0.15, 0.06), "quick": (0.3, 0.3, 0.1), "tiny": (0.6, 0.6, 0.3)}[context.size]
    peers = [name for name in ("gmsh", "gmsh-debian") if name in context.names]
    lines, notes = [], {}
    for name, size in zip(("pipe_tee", "spool", "egg"), sizes):
        part = PARTS / f"{name}.step"
        codes, limits = {"PAMR": []}, []
        for _ in range(min(3, context.bench.repeats)):
            limits.append(context.bench.limit())
            codes["PAMR"].append(our_cad_run(context, part, size))
            for peer in peers:
                command = context.peers.command(peer)
                if command is None:
                    notes[peer] = context.peers.errors[peer]
                    continue
                try:
                    text = output_of(
                        [*command[:-1], BENCH / "compare/cad_peer.py", part, size], context.peers.environment(peer)
                    )
                except Failed as error:
                    notes[peer] = f"{name}: {error}"
                    continue
                run = line_of_json(text)
                codes.setdefault(run["peer"], []).append(run)
        lines += cad_rows(name, size, codes, statistics.median(limits), load())
    return [
        "Largest edges as given, in mm. PAMR: the whole process, the file written too; Gmsh: reading the file and "
        "meshing. The meshes differ, so ratios are in parentheses.",
        "",
        *rows.table(CAD_HEAD, lines),
        "",
        *rows.note_lines(notes),
    ]


def sparta_table(context):
    """The gas of `compare_gas.py` and of the sphere in SPARTA, too: how fast, and what both find."""
    particles, quick = {"whole": (("1e5", "1e6"), ()), "quick": (("1e5",), ("--quick",)), "tiny": ((), ())}[context.size]
    if not particles or "sparta" not in context.names:
        return ["Made with SPARTA among the codes, and not with --tiny."]
    sources = context.peers.sources("sparta")
    if sources is None:
        return list(rows.note_lines({"sparta": context.peers.errors["sparta"]}))
    tools, out = context.build / "bin", context.out / sources.name
    validation = [BENCH.parent / "qualification/validation/sparta.sh", *quick, "--ranks", "1", "--tools", tools]
    found = output_of([*validation, "--out", out, sources, "box", "sphere"], context.environment)
    numbers = "\n".join(line for line in found.splitlines() if not line.startswith("building"))
    compare = [sys.executable, "-B", BENCH / "compare_gas.py", tools, "--sparta", out / "sparta/src/spa_serial"]
    options = ["--particles", *particles, "--no-cone", "--min-sparta", "0"]
    speed = output_of([*compare, *options], context.environment)
    commit = context.peers.all["sparta"]["commit"][:8]
    return [
        f"SPARTA {commit}, near partners in both, medians of three runs in turn:",
        "",
        *speed.strip().splitlines(),
        "",
        "The same gas in both, 95 % bounds:",
        "",
        *(f"    {line}".rstrip() for line in numbers.strip().splitlines()),
    ]


def file_table(context):
    """W2 by the tools, from file to file."""
    n = {"whole": 56, "quick": 56, "tiny": 12}[context.size]
    tools = context.build / "bin"
    start, marked, fine, copy = (context.out / f"{name}.hdf" for name in ("start", "marked", "fine", "copy"))
    output_of(
        [tools / "pamr-mesh", "--shape", "kuhn-cube", "--n", n, "-o", start, "--force", "--quiet"], context.environment
    )
    output_of(
        [tools / "pamr-mark", start, "-o", marked, "--centroid-shell", "0.5,0.5,0.5,0.35,0.06", "--force", "--quiet"],
        context.environment,
    )
    command = [tools / "pamr-refine", marked, "-o", fine, "--force", "--quiet", "--json", "-"]
    alone, of_two, copies = [], [], []
    for _ in range(context.bench.repeats):
        for launcher, runs in ([], alone), (["mpirun", "-n", "2"], of_two):
            warm_memory(2700)
            began = time.monotonic()
            text, cpu = cpu_of([*launcher, *command], context.environment)
            runs.append((time.monotonic() - began, cpu, json.loads(text)))
        began = time.monotonic()
        shutil.copyfile(fine, copy)
        copies.append(time.monotonic() - began)

    def row(step, name):
        columns = [(runs, key) for runs in (alone, of_two) for key in ("seconds", "cpu_seconds")]
        return [name, *(rows.number(statistics.median(run[2][key][step]["max"] for run in runs)) for runs, key in columns)]

    found = [row(step, step) for step in alone[0][2]["seconds"] if step != "total"]
    found.append(row("total", "all steps"))
    found.append(["the process", *(rows.number(statistics.median(run[i] for run in alone)) for i in (0, 1)), "-", "-"])
    found.append(["copying the file", rows.number(statistics.median(copies)), "-", "-", "-"])
    size = fine.stat().st_size
    for file in (start, marked, fine, copy):
        file.unlink()
    report = alone[0][2]
    return [
        f"`pamr-refine` from {report['cells_in']:,} cells to {report['cells_out']:,}, a file of {size / 1e6:.0f} MB, on "
        "one rank and on two.",
        "",
        *rows.table(FILE_HEAD, found),
    ]
