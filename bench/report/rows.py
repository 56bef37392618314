# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the tables that set codes beside ours, as Markdown."""

from measure import HOLE_VOLUME

REFINE_HEAD = (
    "code | algorithm | neighbors | level | cells out | cells split | CPU s | ours, in turn | "
    "theirs / ours: a cell out | a cell split | with neighbors: a cell out | bytes a cell out | "
    "smallest mean ratio | 0.1 % | `limit` | load | runs"
).split(" | ")
WALL_HEAD = (
    "code | who projects | level | cells out | CPU s of all levels | ours, in turn | "
    "theirs / ours: a cell out | the same from level 2 on | bytes a cell out | smallest mean ratio | 0.1 % | "
    "nodes of the wall | off it | farthest, radii | volume, relative error | `limit` | load | runs"
).split(" | ")
FRONT_HEAD = (
    "code | algorithm | steps | calls | cells | gone a step | CPU s | ours, in turn | "
    "theirs / ours: a cell out | a cell gone | bytes a cell out | smallest mean ratio | 0.1 % | `limit` | "
    "load | runs"
).split(" | ")
READ_HEAD = (
    "code | processes | cells | CPU s | wall s | M cells a wall second | theirs / ours, CPU | "
    "bytes a cell | `limit` | load | runs"
).split(" | ")
SHAPES_HEAD = "code | level | cells | smallest | 0.1 % | mean | open faces".split(" | ")


def number(value, digits=3):
    if value is None:
        return "-"
    return f"{value:.{digits}g}" if abs(value) < 1000 else f"{value:,.0f}"


def table(head, rows):
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows)]


def note_lines(notes):
    return [f"- {name}: {note}." for name, note in notes.items()]


def last_common(pair, ours):
    return max(level for level in pair.seconds if level in ours and level in pair.our_seconds)


def ratio_text(value, is_same):
    return "-" if value is None else number(value) if is_same else f"({number(value)})"


def per(seconds, count):
    return seconds / count if count and count > 0 else None


def quotient(theirs, ours):
    return theirs / ours if theirs is not None and ours else None


def our_name(ours):
    return ours[max(ours)]["peer"]


def refine_rows(ours, pairs, entries, kind):
    last = max(ours)
    row = ours[last]
    yield [
        our_name(ours),
        "red",
        "yes",
        str(last),
        f"{row['cells']:,}",
        f"{row['split']:,}",
        number(row["cpu"]),
        "1",
        "1",
        "1",
        "1",
        number(row["peak"] / row["cells"]),
        number(row["worst"]),
        number(row["low"]),
        "-",
        "-",
        "1",
    ]
    for pair in pairs:
        level, entry = last_common(pair, ours), entries[pair.name]
        theirs, our = pair.theirs[level], ours[level]
        seconds, our_seconds = pair.seconds[level], pair.our_seconds[level]
        algorithm = entry.get("uniform", entry["algorithm"]) if kind == "uniform" else entry["algorithm"]
        is_same = kind == "uniform" or algorithm == "red"
        with_neighbors = {"yes": seconds, "apart": seconds + theirs.get("relate_cpu", 0.0), "no": None}[
            entry["neighbors"]
        ]
        if entry["neighbors"] == "apart" and "relate_cpu" not in theirs:
            with_neighbors = None
        our_cost = per(our_seconds, our["cells"])
        comparable = entry["algorithm"] not in ("remeshing", "nonconforming")
        out = quotient(per(seconds, theirs["cells"]), our_cost) if comparable else None
        split = quotient(per(seconds, theirs["split"]), per(our_seconds, our["split"])) if comparable else None
        both = quotient(per(with_neighbors, theirs["cells"]), our_cost) if comparable and with_neighbors else None
        yield [
            theirs["peer"],
            algorithm,
            entry["neighbors"],
            str(level),
            f"{theirs['cells']:,}",
            f"{theirs['split']:,}",
            number(seconds),
            number(our_seconds),
            ratio_text(out, is_same),
            ratio_text(split, is_same),
            ratio_text(both, is_same),
            number(theirs["peak"] / theirs["cells"]),
            number(theirs["worst"]),
            number(theirs["low"]),
            number(pair.limit),
            number(pair.load),
            str(pair.runs),
        ]


def wall_rows(ours, pairs, entries):
    def of(row, who, level, values):
        error = row["volume"] / HOLE_VOLUME - 1
        return [
            row["peer"],
            who,
            str(level),
            f"{row['cells']:,}",
            *values[:4],
            number(row["peak"] / row["cells"]),
            number(row["worst"]),
            number(row["low"]),
            f"{row['wall_nodes']:,}",
            f"{row['off']:,}",
            number(row["farthest"]),
            number(error),
            *values[4:],
        ]

    last = max(ours)
    all_ours = sum(row.get("cpu", 0) for row in ours.values())
    yield of(
        ours[last], "PAMR, by the sphere that the file names", last, [number(all_ours), "1", "1", "1", "-", "-", "1"]
    )
    for pair in pairs:
        level, entry = last_common(pair, ours), entries[pair.name]
        is_same = entry["algorithm"] == "red"

        def cost(seconds, rows, first):
            return per(sum(seconds[n] for n in range(first, level + 1)), rows[level]["cells"])

        ratios = [
            ratio_text(quotient(cost(pair.seconds, pair.theirs, first), cost(pair.our_seconds, ours, first)), is_same)
            for first in (1, 2)
        ]
        seconds = [number(sum(times[n] for n in range(1, level + 1))) for times in (pair.seconds, pair.our_seconds)]
        yield of(
            pair.theirs[level],
            entry["surface"],
            level,
            [*seconds, *ratios, number(pair.limit), number(pair.load), str(pair.runs)],
        )


def front_rows(ours, pairs, entries):
    def sums(rows, seconds):
        return {
            "cpu": sum(seconds[n] for n in rows),
            "cells": sum(row["cells"] for row in rows.values()),
            "gone": sum(row["split"] for row in rows.values()),
            "calls": sum(row["calls"] for row in rows.values()),
        }

    def of(rows, total, algorithm, values):
        last = rows[max(rows)]
        return [
            last["peer"],
            algorithm,
            str(len(rows)),
            str(total["calls"]),
            f"{last['cells']:,}",
            f"{total['gone'] / len(rows):,.0f}",
            number(total["cpu"]),
            *values[:3],
            number(max(row["peak"] / row["cells"] for row in rows.values())),
            number(min(row["worst"] for row in rows.values())),
            number(min(row["low"] for row in rows.values())),
            *values[3:],
        ]

    our_cpu = {n: row["cpu"] for n, row in ours.items()}
    yield of(ours, sums(ours, our_cpu), "red", ["1", "1", "1", "-", "-", "1"])
    for pair in pairs:
        entry, total = entries[pair.name], sums(pair.theirs, pair.seconds)
        our = sums({n: ours[n] for n in pair.theirs}, pair.our_seconds)  # the steps that the other has made
        is_same = entry["algorithm"] == "red"
        out = quotient(per(total["cpu"], total["cells"]), per(our["cpu"], our["cells"]))
        gone = quotient(per(total["cpu"], total["gone"]), per(our["cpu"], our["gone"]))
        yield of(
            pair.theirs,
            total,
            entry["algorithm"],
            [
                number(our["cpu"]),
                ratio_text(out, is_same),
                ratio_text(gone, is_same),
                number(pair.limit),
                number(pair.load),
                str(pair.runs),
            ],
        )


def shapes_rows(levels):
    for level, row in sorted(levels.items()):
        yield [
            row["peer"] if level == 0 else "",
            str(level),
            f"{row['cells']:,}",
            number(row["worst"]),
            number(row["low"]),
            number(row["mean"]),
            "-" if row["open"] < 0 else str(row["open"]),
        ]
