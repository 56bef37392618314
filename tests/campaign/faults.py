# SPDX-License-Identifier: GPL-3.0-or-later
"""Every tool of the pipeline while something goes wrong: processes die, disks and memory end, files change, clocks jump.

    faults.py BIN SHIM RANKS SEED MPIEXEC...

Whatever happens, the name of an output holds what was there before or the whole result, never a part; the job ends
within 60 seconds; where it fails, it says so, and where it is asked to end, nothing unfinished is left. Prints one line
for each fault and tool with the number of runs and how they ended.
"""
import collections
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from job_processes import largest_size, processes_of  # noqa: E402

BIN, SHIM, RANKS = pathlib.Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
DICE = random.Random(f"{sys.argv[4]} {RANKS}")
LAUNCHER = sys.argv[5:] + [sys.argv[3]] if RANKS > 1 else []
SECONDS_TO_END = 60
PRECIOUS = b"the result of yesterday"
MOMENTS = int(os.environ.get("PAMR_MOMENTS", 50))

GAS = """
[gas]
fractions = { N2 = 1.0 }
[species.N2]
mass = 4.65e-26
diameter = 4.17e-10
omega = 0.74
t_ref = 273.0
[stream.free]
density = 1e20
temperature = 300.0
speed = 400.0
[boundary]
""" + "".join(f'{side} = {{ kind = "inflow" }}\n' for side in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")) + """
[particles]
per_cell = 8.0
[domain]
unit = 1.0
[time]
step = 5e-5
[run]
transient = 10
sampling = 20
block = 4
[reference]
area = 1.0
"""
POTENTIAL = "".join(f'[boundary.{side}]\ncondition = "{"potential" if side[0] == "x" else "symmetry"}"\n'
                    + ("value = 2.0\n" if side[0] == "x" else "")
                    for side in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax"))

Stage = collections.namedtuple("Stage", "name words output")
STAGES = [
    Stage("mesh", ["pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5"], "-o out.hdf"),
    Stage("mark", ["pamr-mark", "cube.hdf", "--all"], "-o out.hdf"),
    Stage("refine", ["pamr-refine", "marked.hdf"], "-o out.hdf"),
    Stage("read .msh", ["pamr-convert", "fine.msh"], "out.hdf"),
    Stage("write .vtu", ["pamr-convert", "fine.hdf"], "out.vtu"),
    Stage("OpenFOAM", ["pamr-convert", "fine.hdf"], "out"),
    Stage("gas", ["pamr-dsmc", "gas.toml", "--mesh", "cube.hdf"], "-o out.hdf"),
    Stage("potential", ["pamr-pb", "potential.toml", "--mesh", "cube.hdf"], "-o out.hdf"),
]


class Broken(Exception):
    """A promise that was not kept."""


def command(stage, before=(), folder="."):
    """The stage in this folder; `before` comes between the launcher and the tool."""
    words = [os.path.join(folder, word) if os.path.exists(word) else word for word in stage.words[1:]]
    output = stage.output.split()
    if folder != ".":
        output[-1] = os.path.join(folder, output[-1])
    return LAUNCHER + list(before) + [str(BIN / stage.words[0])] + words + output + ["--force", "--quiet"]


def output_of(stage):
    return stage.output.split()[-1]


def contents(path):
    """Of a file, or of all files of a folder but unfinished ones; nothing where there is none."""
    path = pathlib.Path(path)
    if path.is_dir():
        return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*"))
                if file.is_file() and ".partial" not in str(file)} or None
    return path.read_bytes() if path.exists() else None


def unfinished():
    return [str(path) for path in pathlib.Path(".").rglob("*.partial*")]


def clean(stage, old=True):
    """Removes what the run before left; an output of yesterday stands in its place."""
    output = pathlib.Path(output_of(stage))
    for path in [output, *map(pathlib.Path, unfinished())]:
        if path.is_dir():
            shutil.rmtree(path)
        elif path.exists():
            path.unlink()
    if old and output.suffix:
        output.write_bytes(PRECIOUS)


def start(words, **others):
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", **others)


def end(job, stage, whole, must_say=True, others_allowed=()):
    """Waits for the job; 'whole' or 'failed'. Raises `Broken` for what must not be."""
    try:
        out, err = job.communicate(timeout=SECONDS_TO_END)
    except subprocess.TimeoutExpired:
        job.kill()
        raise Broken(f"no end within {SECONDS_TO_END} s") from None
    found = contents(output_of(stage))
    said = f"exit code {job.returncode}: {err.strip()[-300:]}"
    if job.returncode == 0:
        if found != whole and found not in others_allowed:
            raise Broken(f"a success without the whole result ({said})")
        return "whole"
    if found not in (whole, PRECIOUS, None, *others_allowed):
        raise Broken(f"a broken output has the name ({said})")
    if must_say and not err.strip():
        raise Broken(f"it failed without a word ({said})")
    if job.returncode == 3 and "out of memory" not in err:
        raise Broken(f"an internal error ({said})")
    return "failed"


def undisturbed(stage):
    """Seconds that it takes, and what it makes."""
    clean(stage)
    begin = time.monotonic()
    job = start(command(stage))
    out, err = job.communicate(timeout=SECONDS_TO_END)
    if job.returncode != 0:
        raise Broken(f"it does not work at all: {err}")
    return time.monotonic() - begin, contents(output_of(stage))


def moments(stage, whole, seconds, act, asked):
    """The job is disturbed at random moments; one that is asked to end leaves nothing unfinished."""
    tally = collections.Counter()
    for _ in range(MOMENTS):
        clean(stage)
        begin, moment = time.monotonic(), DICE.uniform(0, 1.05 * seconds)
        job = start(command(stage))
        time.sleep(max(0, moment - (time.monotonic() - begin)))
        act(job, stage)
        tally[end(job, stage, whole, must_say=asked)] += 1
        if asked and unfinished():
            raise Broken(f"asked to end after {moment:.3f} of {seconds:.3f} s it left {unfinished()}")
    return tally


def kill_one(job, stage):
    victims = processes_of(job, stage.words[0])
    if victims:
        try:
            os.kill(DICE.choice(victims), signal.SIGKILL)
        except ProcessLookupError:
            pass


def ask(sign):
    return lambda job, stage: job.poll() is None and job.send_signal(sign)


def killed(stage, whole, seconds):
    return moments(stage, whole, seconds, kill_one, asked=False)


def interrupted(stage, whole, seconds):
    # A process that is asked before it listens ends as the system has it: without a word.
    tally = collections.Counter()
    for sign in (signal.SIGINT, signal.SIGTERM):
        tally += moments(stage, whole, seconds, ask(sign), asked=False)
    return tally


def with_fault(stage, whole, fault, before=("env",), **end_options):
    clean(stage)
    job = start(command(stage, [*before, f"FAULT={fault}", f"LD_PRELOAD={SHIM}"]))
    return end(job, stage, whole, **end_options)


def limits(most, n=16):
    """Numbers of bytes from nothing to `most`, the small ones closer together."""
    return sorted({int(most * (i / n)**2) for i in range(n)} | {1, 100, 2048})


def size_of(what):
    return sum(map(len, what.values())) if isinstance(what, dict) else len(what)


def quota(stage, whole, seconds):
    tally = collections.Counter(with_fault(stage, whole, f"quota:{n}") for n in limits(size_of(whole)))
    if unfinished():
        raise Broken(f"it left {unfinished()}")
    if not tally["failed"]:
        raise Broken("no quota made it fail")
    return tally


def broken_disk(stage, whole, seconds):
    inputs = [word for word in stage.words[1:] if os.path.exists(word)]
    if not inputs:
        return None
    return collections.Counter(with_fault(stage, whole, f"broken:{n}") for n in limits(4 * max(map(os.path.getsize, inputs))))


def no_fork(stage, whole, seconds):
    tally = collections.Counter([with_fault(stage, whole, "no-fork")])
    if not tally["whole"]:
        raise Broken("it needs processes of its own")
    return tally


def jumping_clock(stage, whole, seconds):
    tally = collections.Counter(with_fault(stage, whole, "clock") for _ in range(3))
    if tally["failed"]:
        raise Broken("a clock that jumps made it fail")
    return tally


def memory_of_one_rank(stage, whole, seconds):
    """Address space of one rank from what MPI and HDF5 take for themselves, below which they may wait for ever, to all it takes."""
    tally = collections.Counter()
    script = ('if [ "${OMPI_COMM_WORLD_RANK:-0}" = "$1" ]; then ulimit -v "$2"; fi; shift 2; exec "$@"')
    tiny = LAUNCHER + [str(BIN / "pamr-mark"), "tiny.hdf", "--all", "-o", "tiny_marked.hdf", "--force"]
    least, most = largest_size(start(tiny), "pamr-mark"), largest_size(start(command(stage)), stage.words[0])
    for i in range(24):
        clean(stage)
        kib = least + (most - least) * i // 24 if most > least else least
        job = start(command(stage, ["sh", "-c", script, "sh", str(DICE.randrange(RANKS)), str(kib)]))
        try:
            tally[end(job, stage, whole)] += 1
        except Broken as promise:
            raise Broken(f"{kib} of {most} KiB: {promise}") from None
    return tally


def full_disk(stage, whole, seconds):
    """A file system of a few sizes, and one that cannot be written to at all."""
    tally = collections.Counter()
    for size in ("16k", "128k", "512k", "ro"):
        os.makedirs("disk", exist_ok=True)
        options = "ro" if size == "ro" else "size=" + size
        if subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", "disk"], capture_output=True).returncode != 0:
            return None  # no right to mount; the quota stands for it
        try:
            words = command(stage)
            words[words.index(output_of(stage))] = os.path.join("disk", output_of(stage))
            job = start(words)
            out, err = job.communicate(timeout=SECONDS_TO_END)
            left = sorted(os.listdir("disk"))
            if job.returncode == 0 and contents(os.path.join("disk", output_of(stage))) != whole:
                raise Broken(f"{size}: a success without the whole result")
            if job.returncode != 0 and (left or job.returncode != 2 or "error: " not in err):
                raise Broken(f"{size}: exit code {job.returncode}, left {left}: {err.strip()[-300:]}")
            tally["failed" if job.returncode else "whole"] += 1
        finally:
            subprocess.run(["umount", "disk"], check=True)
    return tally


def changing_input(stage, whole, seconds):
    """The input is replaced by another sound file, and by a shorter one, again and again while it is read."""
    inputs = [word for word in stage.words[1:] if os.path.exists(word) and not word.endswith(".toml")]
    if not inputs:
        return None
    name = inputs[0]
    sound = pathlib.Path(name).read_bytes()
    tally = collections.Counter()
    for cut in (None, 0.5):
        for _ in range(8):
            clean(stage)
            job = start(command(stage))
            stopped = threading.Event()

            def change():
                while not stopped.wait(DICE.uniform(0, seconds / 4)):
                    if cut is None:
                        pathlib.Path("other").write_bytes(sound)
                        os.replace("other", name)
                    else:
                        os.truncate(name, int(len(sound) * cut))
            changer = threading.Thread(target=change)
            changer.start()
            try:
                tally[end(job, stage, whole)] += 1
            finally:
                stopped.set()
                changer.join()
                pathlib.Path(name).write_bytes(sound)
    return tally


def closed_streams(stage, whole, seconds):
    """Started with its standard streams closed, so that the next files that it opens get their numbers."""
    tally = collections.Counter()
    for closed in (">&-", "2>&-", "<&-", "<&- >&- 2>&-"):
        clean(stage)
        job = start(command(stage, ["sh", "-c", f'exec "$@" {closed}', "sh"]))
        tally[end(job, stage, whole, must_say=False)] += 1
    return tally


def strange_names(stage, whole, seconds):
    """Folders whose names have blanks, newlines, quotes, other scripts, bytes that are no text."""
    tally = collections.Counter()
    for name in (b"with blank", b"new\nline", b"quote'\"", "сетка 网格 🔺".encode(), b"\xff\xfe", b"-o", b"a%sb%n", b"x" * 200):
        folder = os.path.join(".", os.fsdecode(name))
        os.mkdir(folder)
        try:
            for word in stage.words[1:]:
                if os.path.exists(word):
                    shutil.copy(word, folder)
            words = command(stage, folder=folder)
            job = start(words)
            out, err = job.communicate(timeout=SECONDS_TO_END)
            found = contents(os.path.join(folder, output_of(stage)))
            if job.returncode != 0 or found != whole:
                raise Broken(f"{name!r}: exit code {job.returncode}: {err.strip()[-300:]}")
            tally["whole"] += 1
        finally:
            shutil.rmtree(folder)
    return tally


FAULTS = [killed, interrupted, memory_of_one_rank, quota, full_disk, broken_disk, changing_input, no_fork, closed_streams,
          strange_names, jumping_clock]


def make_inputs():
    def run(*words):
        subprocess.run([str(BIN / words[0]), *words[1:], "--quiet"], check=True, capture_output=True)
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", "14", "-o", "cube.hdf")
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", "1", "-o", "tiny.hdf")
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--all")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf")
    run("pamr-convert", "fine.hdf", "fine.msh")
    pathlib.Path("gas.toml").write_text(GAS)
    pathlib.Path("potential.toml").write_text(POTENTIAL)


def main():
    folder = tempfile.mkdtemp(prefix="pamr faults ")
    os.chdir(folder)
    make_inputs()
    n_broken = 0
    wanted = os.environ.get("PAMR_FAULTS", "").split()
    print(f"{RANKS} ranks, {MOMENTS} moments\n{'fault':20} {'tool':12} runs: whole, failed; seconds", flush=True)
    for stage in STAGES:
        if not (BIN / stage.words[0]).exists():
            continue
        seconds, whole = undisturbed(stage)
        for fault in FAULTS:
            if wanted and fault.__name__ not in wanted:
                continue
            begin = time.monotonic()
            try:
                tally = fault(stage, whole, seconds)
                text = f"{tally['whole']:5d} {tally['failed']:5d}" if tally is not None else "    -     -"
            except Broken as promise:
                n_broken += 1
                text = f"BROKEN: {promise}"
            print(f"{fault.__name__:20} {stage.name:12} {text} {time.monotonic() - begin:7.1f}", flush=True)
    os.chdir("/")
    shutil.rmtree(folder)
    sys.exit(1 if n_broken else 0)


if __name__ == "__main__":
    main()
