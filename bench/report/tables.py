# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of report.sh: how each is made, in the three sizes. TABLES is the list."""

import dataclasses
import json
import os
import pathlib
import re
import statistics
import sys

import rows
from measure import Failed, Work, line_of_json, load, output_of, warm_memory
from tool_tables import cad_table, file_table, sparta_table

HERE = pathlib.Path(__file__).resolve().parent
BENCH = HERE.parent
SPHERE = "sphere:0.5,0.5,0.5,0.35"
SPHERE_AT_HOLE = "sphere:0,0,0,1.3"
SCALING_NOTE = """Ranks share the cores of this machine, so only what 1 rank and 2 ranks on 2 cores take is measured;
all else is counted, and the seconds of a cluster follow from the counts by a model."""


@dataclasses.dataclass
class Table:
    """A table: what it shows, how it is made (of a `Context`, lines of Markdown), and which report holds it."""

    title: str
    make: object
    page: str


def script(program, *words, note="", **by_size):
    """A part that is a program of its own: what it prints. `by_size`: its further words for each size; None: not in
    it."""

    def make(context):
        if by_size[context.size] is None:
            return [f"Not made with --{context.size}."]
        places = {"build": context.build, "out": context.out}
        command = [word.format(**places) for word in (program, *words, *by_size[context.size])]
        command[0] = BENCH / command[0]  # which an absolute path replaces
        text = output_of(command, context.environment)
        return [*([note, ""] if note else []), *text.rstrip().splitlines()]

    return make


BALANCE_WAYS = ("as read", "auto", "scotch", "curve", "blocks")


def folded_balance(lines):
    """The rows of bench_balance, one for each mesh and number of ranks."""
    found = {}
    for line in lines:
        words = [word.strip() for word in line.strip().strip("|").split("|")]
        if len(words) != 12 or not words[1].isdigit():
            continue
        mesh, ranks, asked, given, faces, over, neighbors, imbalance, seconds = words[:9]
        text = f"{int(faces):,} ({over}), {neighbors}, {imbalance}"
        if asked != "as read":
            text += "" if given == "none" else f", {float(seconds):.2g} s"
            text = text if given == asked else f"{'kept' if given == 'none' else given}: {text}"
        found.setdefault((mesh, ranks), {})[asked] = text
    head = ["mesh", "ranks", *(f"`{way}`" if way != "as read" else way for way in BALANCE_WAYS)]
    return rows.table(head, [[*key, *(ways[way] for way in BALANCE_WAYS)] for key, ways in found.items()])


def balance_table(context):
    make = script("balance.sh", BUILD, "--out", "{out}/balance", whole=(), quick=None, tiny=None)
    lines = make(context)
    return [SCALING_NOTE, "", *folded_balance(lines)] if context.size == "whole" else lines


def hole(context):
    """The Gmsh file of the box with a hole and, with its sphere, ours."""
    size = {"whole": 0.28, "quick": 0.28, "tiny": 0.6}[context.size]
    target = context.out / f"hole-{size}.msh"
    ours = target.with_suffix(".hdf")
    if not ours.exists():
        makers = [context.peers.command(name) for name in ("gmsh", "gmsh-debian")]
        python = next((maker[0] for maker in makers if maker), None)
        if python is None:
            raise Failed(
                "Gmsh, which makes the mesh with the hole, could not be installed: " + context.peers.errors["gmsh"]
            )
        output_of([python, "-B", HERE / "hole_mesh.py", str(size), target])
        surface = target.with_suffix(".toml")
        surface.write_text(
            '[[surface]]\nname = "wall"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n', encoding="ascii"
        )
        output_of(
            [context.build / "bin/pamr-convert", target, ours, "--surfaces", surface, "--force", "--quiet"],
            context.environment,
        )
    return target, ours


def refine_table(kind, law, **by_size):
    def make(context):
        mesh, *arguments = by_size[context.size]
        work = Work(kind, law, mesh, mesh, tuple(arguments))
        ours, pairs, notes = context.bench.all_beside(work, context.peers, context.names)
        found = rows.refine_rows(ours, pairs, context.peers.all, kind)
        return [
            f"`{law}` on `{mesh}`, {arguments[0]} level(s).",
            "",
            *rows.table(rows.REFINE_HEAD, found),
            "",
            *rows.note_lines(notes),
        ]

    return make


def wall_table(context):
    mesh, ours_mesh = hole(context)
    work = Work("wall", "wall", str(mesh), str(ours_mesh), ({"whole": 5, "quick": 3, "tiny": 2}[context.size],))
    ours, pairs, notes = context.bench.all_beside(work, context.peers, context.names)
    return [
        "A box with a round hole by Gmsh; cells with a corner on the wall of the hole are marked at every level. "
        "The first call of PAMR also makes a map of level 0, once for a mesh.",
        "",
        *rows.table(rows.WALL_HEAD, rows.wall_rows(ours, pairs, context.peers.all)),
        "",
        *rows.note_lines(notes),
    ]


def front_table(context):
    mesh, levels, steps = {"whole": ("kuhn:8", 3, 20), "quick": ("kuhn:6", 3, 20), "tiny": ("kuhn:6", 2, 3)}[
        context.size
    ]
    work = Work("front", "front", mesh, mesh, (levels, steps))
    ours, pairs, notes = context.bench.all_beside(work, context.peers, context.names)
    return [
        f"A sphere moves through `{mesh}` in {steps} steps; cells that it cuts are kept at level {levels}, those "
        "behind it are coarsened; as many calls a step as that takes.",
        "",
        *rows.table(rows.FRONT_HEAD, rows.front_rows(ours, pairs, context.peers.all)),
        "",
        *rows.note_lines(notes),
    ]


def shapes_table(context):
    """Levels of one mesh with the same marks, walls flat."""
    mesh, _ = hole(context)
    levels = {"whole": 4, "quick": 3, "tiny": 2}[context.size]
    lines, notes = [], {}
    for name in ["pamr", *context.names]:
        if name != "pamr" and "shapes" not in context.peers.all[name]["takes"]:
            continue
        command = [context.bench.ours] if name == "pamr" else context.peers.command(name)
        if command is None:
            notes[name] = context.peers.errors[name]
            continue
        environment = None if name == "pamr" else context.peers.environment(name)
        try:
            text = output_of([*command, SPHERE_AT_HOLE, mesh, levels, "assess"], environment)
        except Failed as error:
            notes[name] = str(error)
            continue
        found = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
        lines += rows.shapes_rows({row["level"]: row for row in found})
    return [
        f"A box with a round hole by Gmsh, its walls taken as flat; cells cut by `{SPHERE_AT_HOLE}` are marked at "
        "every level. Nothing here depends on the machine.",
        "",
        *rows.table(rows.SHAPES_HEAD, lines),
        "",
        *rows.note_lines(notes),
    ]


def floors(context):
    """Ours with other shape floors, on the mesh of `shapes_table`."""
    mesh, _ = hole(context)
    levels = {"whole": 4, "quick": 3, "tiny": 2}[context.size]
    return (
        output_of(
            [context.build / "bench/bench_quality_control", mesh, SPHERE_AT_HOLE, levels, "0.35,0.4,0.5"],
            context.environment,
        )
        .rstrip()
        .splitlines()
    )


def read_table(context):
    n = {"whole": 119, "quick": 55, "tiny": 8}[context.size]
    file = context.out / f"kuhn-{n}.msh"
    output_of([sys.executable, "-B", HERE / "gmsh_file.py", n, file])
    codes = {"PAMR, 2": (["mpirun", "-n", "2", context.bench.ours, "read", file], context.environment)}
    notes = {}
    for name, module in (("gmsh", "gmsh"), ("mfem", "mfem"), ("dmplex", "dmplex")):
        if name not in context.names:
            continue
        command = context.peers.command(name)
        if command is None:
            notes[name] = context.peers.errors[name]
        else:
            codes[name] = (
                [*command[:-1], BENCH / "compare/read_peer.py", module, file],
                context.peers.environment(name),
            )
    our_command = [context.bench.ours, "read", file]
    found = []
    for name, (command, environment) in codes.items():
        runs, ours, limits = [], [], []
        try:
            for _ in context.bench.turns():
                limits.append(context.bench.limit())
                warm_memory()
                ours.append(json.loads(output_of(our_command, context.environment)))
                warm_memory()
                text = output_of(command, environment)
                runs.append(line_of_json(text))
        except Failed as error:
            notes[name] = str(error)
            continue
        found += list(read_rows(name, runs, ours, limits))
    file.unlink()
    return [
        f"A binary Gmsh file of format 2.2 with {6 * n**3:,} cells, in the file cache.",
        "",
        *rows.table(rows.READ_HEAD, found),
        "",
        "Our rows include neighbors, an order along a curve and all tests of the mesh; PETSc's include edges and faces, "
        "MFEM's edges, faces and neighbors.",
        "",
        *rows.note_lines(notes),
    ]


def read_rows(name, runs, ours, limits):
    def of(processes, group, ratio):
        row = {key: statistics.median(run[key] for run in group) for key in ("cpu", "wall", "peak")}
        cells = group[0]["cells"]
        return [
            group[0]["peer"],
            processes,
            f"{cells:,}",
            rows.number(row["cpu"]),
            rows.number(row["wall"]),
            rows.number(1e-6 * cells / row["wall"]),
            ratio,
            rows.number(row["peak"] / cells),
            rows.number(statistics.median(limits)),
            rows.number(load()),
            str(len(group)),
        ]

    ratio = statistics.median(run["cpu"] for run in runs) / statistics.median(run["cpu"] for run in ours)
    if name == "PAMR, 2":
        yield of("1", ours, "1")
    yield of("2" if name == "PAMR, 2" else "1", runs, rows.number(ratio))


ADAPT_LINE = re.compile(
    r"(\d+) -> (\d+) -> (\d+) cells, (\d+) marked, (\d+) octets gone, .* (\d+) moved to siblings, (\d+) to "
    r"balance: .* ([\d.]+) outside of communication on all ranks, .*, (\d+) bytes a cell; (.*)"
)
ADAPT_STEPS = ("preprocessing", "balance", "coarsen", "close", "migrate", "number", "project", "subdivide", "relink")


def adapt_rows(lines_of_ranks):
    """Rows from what bench_adapt prints; `lines_of_ranks`: {ranks: its lines, one a step}, those of one first."""
    one = [float(ADAPT_LINE.search(line)[8]) for line in next(iter(lines_of_ranks.values()))]
    for ranks, lines in lines_of_ranks.items():
        for step, line in enumerate(lines):
            *counts, compute, memory, parts = ADAPT_LINE.search(line).groups()
            words = parts.split()
            part = dict(zip(words[::2], words[1::2]))
            yield [
                str(step + 1),
                str(ranks),
                *(f"{int(count):,}" for count in counts),
                compute,
                f"{float(compute) / one[step]:.2f}",
                *(part.get(name, "-") for name in ADAPT_STEPS),
                memory,
            ]


def middle_lines(runs):
    """Of the lines of each step, one in each run, that with the middle compute: a first run fetches its memory from the
    host of a virtual machine."""

    def compute(line):
        return float(ADAPT_LINE.search(line)[8])

    return [sorted(step, key=compute)[len(step) // 2] for step in zip(*runs, strict=True)]


def adapt_table(context):
    arguments, all_ranks = {
        "whole": ("18 4 3 0.003", (1, 4, 16)),
        "quick": ("14 3 3 0.003", (1, 4)),
        "tiny": ("6 2 2 0.05", (1, 2)),
    }[context.size]
    bench = [context.build / "bench/bench_adapt", *arguments.split()]
    repeats = min(3, context.bench.repeats)
    lines = {
        n: middle_lines(
            [output_of(["mpirun", "-n", n, *bench], context.environment).splitlines() for _ in range(repeats)]
        )
        for n in all_ranks
    }
    head = (
        "step | ranks | cells in | after coarsening | out | split | octets gone | moved to siblings | moved to balance |"
        " us a cell | over one rank"
    )
    return [
        f"`bench_adapt {arguments}`, of each step the middle of {repeats} run(s). One rank is measured; of several, which "
        "share the cores, the compute is counted.",
        "",
        *rows.table([*head.split(" | "), *ADAPT_STEPS, "peak bytes a cell"], list(adapt_rows(lines))),
    ]


def environment():
    """That of `scripts/mpi_environment.sh`, which report.sh has sourced."""
    return {**os.environ, "PAMR_PYTHON": sys.executable}


BUILD = "{build}"
TABLES = {
    "one-rank": Table("One rank", script("run.sh", BUILD, whole=(), quick=(), tiny=("1", "tiny")), "performance"),
    "quality-cost": Table(
        "Quality control", script("quality_cost.sh", BUILD, whole=(), quick=("1",), tiny=None), "performance"
    ),
    "uniform": Table(
        "Uniform refinement beside other codes",
        refine_table("uniform", "uniform", whole=("kuhn:55", 1), quick=("kuhn:30", 1), tiny=("kuhn:6", 1)),
        "peers",
    ),
    "shell": Table(
        "A shell beside other codes",
        refine_table("shell", "shell", whole=("kuhn:56", 1), quick=("kuhn:40", 1), tiny=("kuhn:8", 1)),
        "peers",
    ),
    "sphere": Table(
        "Levels around a sphere beside other codes",
        refine_table("sphere", SPHERE, whole=("kuhn:14", 5), quick=("kuhn:14", 3), tiny=("kuhn:6", 2)),
        "peers",
    ),
    "wall": Table("Levels at a curved wall beside other codes", wall_table, "peers-walls"),
    "front": Table("A front that moves, beside other codes", front_table, "peers-walls"),
    "reading": Table("Reading a Gmsh file beside other codes", read_table, "peers-walls"),
    "shapes": Table("Shapes beside other codes", shapes_table, "shapes-peers"),
    "floors": Table("Shapes with other floors", floors, "shapes-peers"),
    "two-ranks": Table(
        "Two ranks on two cores", script("two_ranks.sh", BUILD, whole=(), quick=(), tiny=None), "scaling"
    ),
    "scaling": Table(
        "Scaling",
        script(
            "scaling.sh",
            BUILD,
            "--out",
            "{out}/scaling",
            note=SCALING_NOTE,
            whole=("--repeats", "3"),
            quick=("--repeats", "1", "--ranks", "1 2 16 64"),
            tiny=("--tiny", "--repeats", "1", "--ranks", "1 2"),
        ),
        "scaling-steps",
    ),
    "many-ranks": Table(
        "256 ranks",
        script(
            "scaling.sh",
            BUILD,
            "--out",
            "{out}/many-ranks",
            "--small",
            "--repeats",
            "1",
            "--ranks",
            "1 16 64 256",
            note=SCALING_NOTE,
            whole=(),
            quick=None,
            tiny=None,
        ),
        "ranks-256",
    ),
    "adapt": Table("Refining and coarsening", adapt_table, "performance-calls"),
    "order": Table(
        "Random order",
        script("{build}/bench/bench_order", whole=("14", "5", "5"), quick=("14", "4", "3"), tiny=("6", "2", "1")),
        "performance-calls",
    ),
    "files": Table("From file to file", file_table, "performance-calls"),
    "cad": Table("Meshes of STEP files beside Gmsh", cad_table, "performance-calls"),
    "large": Table(
        "The largest run",
        script("large.sh", BUILD, "--out", "{out}/large", whole=(), quick=("--cells", "1500000"), tiny=None),
        "performance-calls",
    ),
    "large-uniform": Table(
        "The largest uniform run",
        script("large.sh", BUILD, "--out", "{out}/large", "--cube", whole=("174",), quick=("64",), tiny=None),
        "performance-calls",
    ),
    "balance": Table("Balance", balance_table, "balance"),
    "poisson-boltzmann": Table(
        "Poisson-Boltzmann beside dolfinx",
        script(
            "compare-pb.sh",
            BUILD,
            "--out",
            "{out}/pb",
            whole=(),
            quick=("--cells", "100000", "--repeats", "1"),
            tiny=None,
        ),
        "poisson-boltzmann-speed",
    ),
    "gas": Table("Gas beside dsmcFoam", script("compare-dsmc.sh", BUILD, whole=(), quick=(), tiny=None), "dsmc-speed"),
    "sparta": Table("Gas beside SPARTA", sparta_table, "dsmc-speed"),
    "partners": Table(
        "Conductivity of the gas by partner",
        script(
            "../qualification/validation/dsmc.sh",
            "--ranks",
            "1",
            "--tools",
            BUILD + "/bin",
            "--out",
            "{out}/partners",
            whole=("--seeds", "3", "partners"),
            quick=None,
            tiny=None,
        ),
        "dsmc-speed",
    ),
}
