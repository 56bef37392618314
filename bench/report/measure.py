# SPDX-License-Identifier: GPL-3.0-or-later
"""Ours and theirs in turn on one workload, with what the machine can do beside each pair, and whether both did the
work."""

import dataclasses
import json
import math
import os
import pathlib
import signal
import statistics
import subprocess
import sys
import time

FLAT_VOLUME_ERROR = 1e-9
CELLS_BESIDE_OURS = (1 / 3, 6)  # of a code that did the same work by another algorithm
HOLE_VOLUME = 4.0**3 - 4 / 3 * math.pi
LIMIT_SECONDS = 15  # it takes four to measure
MAX_SECONDS = 1800  # of one run
MISSED = ("FAIL", "NOT AS EXPECTED")
PEER_SECONDS = 240  # of one run of another code on a workload; the levels or steps that it has printed by then count


class Failed(Exception):
    """A program that has not done what it was started for, with its last word."""


def output_of(command, environment=None):
    """Standard output of a program; `Failed` with the last line of its errors. A script that prints which of its bars
    is missed (`MISSED`) and ends with code 1 has not failed."""
    text, was_ended = ended_after(command, environment, MAX_SECONDS)
    if was_ended:
        raise Failed(f"not done after {MAX_SECONDS} s")
    return text


def warm_memory(megabytes=4000):
    """Allocates and frees memory, so that the host returns what it has reclaimed before a run, not during it."""
    output_of([sys.executable, "-B", pathlib.Path(__file__).resolve().parent.parent / "compare/warm_memory.py", megabytes])


def checked(text, errors, code):
    """The text, unless the program that printed it has failed."""
    if code != 0 and not (code == 1 and any(word in text for word in MISSED)):
        lines = [line for line in errors.splitlines() if line.strip()]
        raise Failed(f"ended with code {code}: {(lines or ['no message'])[-1].strip()}"[:160])
    return text


def ended_after(command, environment, seconds):
    """What a program prints, and whether it was ended, with all that it has started, because it took longer; `Failed`
    as `output_of`."""
    try:
        run = subprocess.Popen(
            [str(word) for word in command],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
    except OSError as error:
        raise Failed(str(error)[:160]) from error
    with run:
        try:
            text, errors = run.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, signal.SIGKILL)
            return run.communicate()[0], True
        except BaseException:
            os.killpg(run.pid, signal.SIGKILL)
            raise
    return checked(text, errors, run.returncode), False


def levels_of_peer(command, environment=None, seconds=PEER_SECONDS):
    """The levels that another code prints, and whether it was ended."""
    text, was_ended = ended_after(command, environment, seconds)
    return lines_by_level(text), was_ended


def lines_by_level(text):
    """{level: values} of what a code prints; whatever else its libraries print, and half a line, is passed over."""
    rows = [json.loads(line) for line in text.splitlines() if line.startswith("{") and line.endswith("}")]
    return {row["level"]: row for row in rows}


def line_of_json(text):
    """The values of the one line of JSON that a code prints; whatever else its libraries print is passed over."""
    return json.loads(next(line for line in text.splitlines() if line.startswith("{")))


@dataclasses.dataclass
class Work:
    """A workload: of what kind, on which mesh for us and for others, and how far."""

    kind: str
    law: str
    mesh: str
    our_mesh: str
    arguments: tuple

    def command(self, mesh):
        return [self.law, mesh, *map(str, self.arguments)]


@dataclasses.dataclass
class Pair:
    """Results of one code beside ours: of each level its assessment, and medians of the seconds of both."""

    name: str
    theirs: dict
    seconds: dict
    our_seconds: dict
    limit: float
    runs: int
    load: float
    was_ended: bool = False


def doubt(work, entry, theirs, ours):
    """Why a code has not done the work that it was given, or None."""
    last = max(theirs)
    found, our = theirs[last], ours.get(last)
    if work.kind != "wall" and abs(found["volume"] - 1) > FLAT_VOLUME_ERROR:
        return f"volume {found['volume']:.9g} instead of 1"
    if entry["algorithm"] not in ("nonconforming", "remeshing"):
        broken = sum(max(0, row["open"]) for row in theirs.values())
        if broken:
            return f"{broken} faces without a cell on the other side"
    low, high = CELLS_BESIDE_OURS
    if our and not low <= found["cells"] / our["cells"] <= high:
        return f"{found['cells']:,} cells beside our {our['cells']:,}"
    return None


def medians(runs):
    return {
        level: statistics.median(run[level]["cpu"] for run in runs if level in run)
        for level in runs[0]
        if level > 0 or "cpu" in runs[0][level]
    }


class Bench:
    """Runs ours and theirs. `repeats` at most, none begun after `budget` seconds of one code."""

    def __init__(self, build, limit_size, repeats, budget):
        self.ours = build / "bench/bench_peer"
        self.refine = build / "bench/bench_refine"
        self.limit_size, self.repeats, self.budget = limit_size, repeats, budget
        self.last_limit, self.limit_measured = None, -math.inf

    def turns(self):
        """Numbers of the runs to make of one code."""
        began = time.monotonic()
        for turn in range(self.repeats):
            if turn == 0 or time.monotonic() - began < self.budget:
                yield turn

    def limit(self):
        """Millions of cells a CPU second that this machine can write to memory at this moment: measured anew when that
        was `LIMIT_SECONDS` ago."""
        if time.monotonic() - self.limit_measured < LIMIT_SECONDS:
            return self.last_limit
        text = output_of([self.refine, f"--benchmark_filter=^limit/{self.limit_size}/", "--benchmark_format=json"])
        runs = json.loads(text)["benchmarks"]
        self.last_limit = next(run["Mcells_per_cpu_s"] for run in runs if run.get("aggregate_name") == "median")
        self.limit_measured = time.monotonic()
        return self.last_limit

    def assess_ours(self, work):
        return lines_by_level(output_of([self.ours, *work.command(work.our_mesh), "assess"]))

    def beside(self, work, name, peers):
        """A `Pair`; `Failed` where the code fails."""
        command = [*peers.command(name), *work.command(work.mesh)]
        environment = peers.environment(name)
        runs, our_runs, limits, was_ended = [], [], [], False
        for _ in self.turns():
            limits.append(self.limit())
            our_runs.append(lines_by_level(output_of([self.ours, *work.command(work.our_mesh)])))
            levels, too_slow = levels_of_peer([*command, "assess"] if not runs else command, environment)
            if too_slow and runs:
                our_runs.pop()
                break
            if too_slow and max(levels, default=0) == 0:
                raise Failed(f"not done after {PEER_SECONDS} s")
            if not levels or max(levels) == 0:
                raise Failed("printed no level")
            runs.append(levels)
            was_ended = too_slow
            if was_ended:
                break
        limit = statistics.median(limits)
        return Pair(name, runs[0], medians(runs), medians(our_runs), limit, len(runs), load(), was_ended)

    def all_beside(self, work, peers, names):
        """Ours assessed, the pairs, and {name: why there is none}."""
        ours, pairs, notes = self.assess_ours(work), [], {}
        for name in names:
            if work.kind not in peers.all[name]["takes"]:
                continue
            print(f"report.sh: {work.kind}, {name}", file=sys.stderr)
            if peers.command(name) is None:
                notes[name] = peers.errors[name]
                continue
            try:
                pair = self.beside(work, name, peers)
            except Failed as error:
                notes[name] = str(error)
                continue
            wrong = doubt(work, peers.all[name], pair.theirs, ours)
            if wrong:
                notes[name] = f"does other work: {wrong}"
                continue
            if pair.was_ended:
                notes[name] = f"ended after {PEER_SECONDS} s; its row has the last level or step it came to"
            pairs.append(pair)
        return ours, pairs, notes


def load():
    with open("/proc/loadavg", encoding="ascii") as file:
        return float(file.read().split()[0])
