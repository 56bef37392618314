# SPDX-License-Identifier: GPL-3.0-or-later
"""Every tool of the pipeline while something goes wrong: processes die, disks and memory end, files change, clocks jump.

    faults.py BIN SHIM RANKS SEED MPIEXEC...

Whatever happens, the name of an output holds what was there before or the whole result, never a part; the job ends
within 300 seconds; where it fails, it says so, and where it is asked to end, nothing unfinished is left. Prints one line
for each fault and tool with the number of runs and how they ended.

Environment: PAMR_MOMENTS (random moments for each signal, 50), PAMR_FAULTS (names of functions below, all),
PAMR_STAGES (names of tools' stages, all), PAMR_JOBS (stages at a time, 3: most of the time they wait).
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

from pipeline import SECONDS_TO_END, STAGES, Broken, contents, make_inputs, start, unfinished
from job_processes import largest_size, processes_of  # its folder is known from `pipeline`

BIN, SHIM, RANKS, SEED = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], int(sys.argv[3]), sys.argv[4]
LAUNCHER = sys.argv[5:] + [sys.argv[3]] if RANKS > 1 else []
MOMENTS = int(os.environ.get("PAMR_MOMENTS", 50))
DICE = random.Random()  # begins anew for each fault and stage


def moments(stage, act, asked):
    """The job is disturbed at random moments; one that is asked to end leaves nothing unfinished."""
    tally = collections.Counter()
    for _ in range(MOMENTS):
        stage.clean()
        begin, moment = time.monotonic(), DICE.uniform(0, 1.05 * stage.seconds)
        job = start(stage.command())
        time.sleep(max(0, moment - (time.monotonic() - begin)))
        act(job, stage)
        tally[stage.end(job, must_say=False)] += 1
        if asked and unfinished():
            raise Broken(f"asked to end after {moment:.3f} of {stage.seconds:.3f} s it left {unfinished()}")
    return tally


def kill_one(job, stage):
    victims = processes_of(job, stage.tool)
    if victims:
        try:
            os.kill(DICE.choice(victims), signal.SIGKILL)
        except ProcessLookupError:
            pass


def killed(stage):
    return moments(stage, kill_one, asked=False)


def interrupted(stage):
    # A process that is asked before it listens ends as the system has it: without a word, and with nothing written.
    tally = collections.Counter()
    for sign in (signal.SIGINT, signal.SIGTERM):
        tally += moments(stage, lambda job, stage: job.poll() is None and job.send_signal(sign), asked=True)
    return tally


def with_fault(stage, fault, *variables, **end_options):
    stage.clean()
    job = start(stage.command(["env", f"FAULT={fault}", f"LD_PRELOAD={SHIM}", *variables]))
    return stage.end(job, **end_options)


def killed_while_writing(stage):
    """After so many bytes of output, right before and right after the output gets its name."""
    faults = [f"dies:{n}" for n in limits(stage.size_of_result() // 2)] + ["dies-before", "dies-after"]
    tally = collections.Counter(with_fault(stage, fault, must_say=False) for fault in faults)
    if not tally["failed"]:
        raise Broken("nothing killed it")
    return tally


def limits(most):
    """Numbers of bytes from nothing to `most`, the small ones closer together; half as many on several ranks."""
    n = 8 if RANKS == 1 else 4
    return sorted({int(most * (i / n)**2) for i in range(n)} | {1, 100, 2048})


def quota(stage):
    tally = collections.Counter(with_fault(stage, f"quota:{n}") for n in limits(stage.size_of_result()))
    if unfinished():
        raise Broken(f"it left {unfinished()}")
    if not tally["failed"]:
        raise Broken("no quota made it fail")
    return tally


def broken_disk(stage):
    """It cannot be read, or cannot be written, from some byte on."""
    tally = collections.Counter(with_fault(stage, f"worn:{n}") for n in limits(stage.size_of_result()))
    if stage.inputs():
        most = 4 * max(map(os.path.getsize, stage.inputs()))
        tally += collections.Counter(with_fault(stage, f"broken:{n}") for n in limits(most))
    if not tally["failed"]:
        raise Broken("no broken disk made it fail")
    return tally


def no_fork(stage):
    tally = collections.Counter([with_fault(stage, "no-fork")])
    if not tally["whole"]:
        raise Broken("it needs processes of its own")
    return tally


def jumping_clock(stage):
    tally = collections.Counter(with_fault(stage, "clock") for _ in range(3))
    if tally["failed"]:
        raise Broken("a clock that jumps made it fail")
    return tally


def memory_of_one_rank(stage):
    """Address space of one rank from what the start of MPI takes, below which many ranks may wait for ever, to all that it takes."""
    tally = collections.Counter()
    script = ('if [ "${OMPI_COMM_WORLD_RANK:-0}" = "$1" ]; then ulimit -v "$2"; fi; shift 2; exec "$@"')
    tiny = LAUNCHER + [str(BIN / "pamr-mark"), "tiny.hdf", "--all", "-o", "tiny_marked.hdf", "--force"]
    nothing = ["no such file" if word in stage.inputs() else word for word in stage.arguments]
    refused = LAUNCHER + [str(BIN / stage.tool), *nothing, *stage.options, "--force"]
    # KiB: most of what the C library sets aside for a second thread, and what one rank alone can do without; most of what a
    # tool makes sure of for MPI.
    aside, n = (56 * 1024, 12) if RANKS == 1 else (24 * 1024, 8)
    least = max(largest_size(start(tiny), "pamr-mark"), largest_size(start(refused), stage.tool)) - aside
    most = largest_size(start(stage.command()), stage.tool)
    for i in range(n):
        stage.clean()
        kib = least + (most - least) * i // (n - 1) if most > least else least
        job = start(stage.command(["sh", "-c", script, "sh", str(DICE.randrange(RANKS)), str(kib)]))
        try:
            tally[stage.end(job)] += 1
        except Broken as promise:
            raise Broken(f"{kib} of {most} KiB: {promise}") from None
    return tally


def one_request_for_memory(stage):
    """One request of one rank is not met: the first ones, and others up to the last, at every step of the work."""
    tally = collections.Counter()
    with_fault(stage, "no-memory:0:0", "FAULT_COUNT=requests")
    n = int(pathlib.Path("requests").read_text())
    for i in range(MOMENTS // 2):
        request = DICE.randint(n * i // (MOMENTS // 2), n * (i + 1) // (MOMENTS // 2)) + 1
        victim = DICE.randrange(RANKS) if i % 2 else 0
        try:
            tally[with_fault(stage, f"no-memory:{victim}:{request}")] += 1
        except Broken as promise:
            raise Broken(f"request {request} of {n} on rank {victim}: {promise}") from None
    return tally


def full_disk(stage):
    """A file system of a few sizes, and one that cannot be written to at all."""
    tally = collections.Counter()
    for size in ("16k", "128k", "512k", "ro"):
        os.makedirs("disk", exist_ok=True)
        options = "ro" if size == "ro" else "size=" + size
        if subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", "disk"], capture_output=True).returncode != 0:
            return None  # no right to mount; the quota stands for it
        try:
            words = stage.command()
            words[words.index(stage.output)] = os.path.join("disk", stage.output)
            job = start(words)
            out, err = job.communicate(timeout=SECONDS_TO_END)
            left = sorted(os.listdir("disk"))
            if job.returncode == 0 and not stage.is_whole(contents(os.path.join("disk", stage.output))):
                raise Broken(f"{size}: a success without the whole result")
            if job.returncode != 0 and (left or job.returncode != 2 or "error: " not in err):
                raise Broken(f"{size}: exit code {job.returncode}, left {left}: {err.strip()[-300:]}")
            tally["failed" if job.returncode else "whole"] += 1
        finally:
            subprocess.run(["umount", "disk"], check=True)
    return tally


def changing_input(stage):
    """The input is replaced by another sound file, and by a shorter one, again and again while it is read."""
    inputs = [word for word in stage.inputs() if not word.endswith(".toml")]
    if not inputs:
        return None
    name = inputs[0]
    sound = pathlib.Path(name).read_bytes()
    tally = collections.Counter()
    for cut in (None, 0.5):
        for _ in range(4):
            stage.clean()
            job = start(stage.command())
            stopped = threading.Event()

            def change():
                while not stopped.wait(DICE.uniform(0, stage.seconds / 4)):
                    if cut is None:
                        pathlib.Path("other").write_bytes(sound)
                        os.replace("other", name)
                    else:
                        os.truncate(name, int(len(sound) * cut))
            changer = threading.Thread(target=change)
            changer.start()
            try:
                tally[stage.end(job)] += 1
            finally:
                stopped.set()
                changer.join()
                pathlib.Path(name).write_bytes(sound)
    return tally


def two_writers(stage):
    """Two jobs write one output at the same time, the second begins a little later."""
    tally = collections.Counter()
    for _ in range(4):
        stage.clean()
        first = start(stage.command())
        time.sleep(DICE.uniform(0, stage.seconds / 2))
        second = start(stage.command())
        for job in (first, second):
            job.communicate(timeout=SECONDS_TO_END)
        for job in (first, second):
            if job.returncode != 0 or not stage.is_whole(contents(stage.output)) or unfinished():
                raise Broken(f"exit code {job.returncode}, left {unfinished()}")
            tally["whole"] += 1
    return tally


def closed_streams(stage):
    """Started with its standard streams closed, so that the next files that it opens get their numbers."""
    tally = collections.Counter()
    for closed in (">&-", "2>&-", "<&-", "<&- >&- 2>&-"):
        stage.clean()
        job = start(stage.command(["sh", "-c", f'exec "$@" {closed}', "sh"]))
        tally[stage.end(job, must_say=False)] += 1
    return tally


def strange_names(stage):
    """Folders whose names have blanks, newlines, quotes, other scripts, bytes that are no text."""
    tally = collections.Counter()
    for name in (b"with blank", b"new\nline", b"quote'\"", "сетка 网格 🔺".encode(), b"\xff\xfe", b"-o", b"a%sb%n", b"x" * 200):
        folder = os.path.join(".", os.fsdecode(name))
        os.mkdir(folder)
        try:
            for word in stage.inputs():
                shutil.copy(word, folder)
            job = start(stage.command(folder=folder))
            out, err = job.communicate(timeout=SECONDS_TO_END)
            found = contents(os.path.join(folder, stage.output))
            if job.returncode != 0 or not stage.is_whole(found):
                raise Broken(f"{name!r}: exit code {job.returncode}: {err.strip()[-300:]}")
            tally["whole"] += 1
        finally:
            shutil.rmtree(folder)
    return tally


FAULTS = [killed, killed_while_writing, interrupted, memory_of_one_rank, one_request_for_memory, quota, full_disk, broken_disk,
          changing_input, two_writers, no_fork, closed_streams, strange_names, jumping_clock]


def run_stage(stage, inputs, folder):
    """All faults on one stage, in a process of its own, which ends here."""
    n_broken = 0
    shutil.copytree(inputs, folder)
    os.chdir(folder)
    stage.tools, stage.launcher = BIN, LAUNCHER
    stage.measure()
    wanted = os.environ.get("PAMR_FAULTS", "").split()
    for fault in FAULTS:
        if wanted and fault.__name__ not in wanted:
            continue
        DICE.seed(f"{SEED} {RANKS} {stage.name} {fault.__name__}")
        begin = time.monotonic()
        try:
            tally = fault(stage)
            text = f"{tally['whole']:5d} {tally['failed']:5d}" if tally is not None else "    -     -"
            if tally and tally["launcher"]:
                text += f", {tally['launcher']} with all ranks ended and the launcher waiting or crashed"
        except (Broken, subprocess.TimeoutExpired) as promise:
            n_broken += 1
            text = f"BROKEN: {promise}"
        print(f"{fault.__name__:22} {stage.name:12} {text} {time.monotonic() - begin:7.1f}", flush=True)
    os._exit(1 if n_broken else 0)


def main():
    folder = tempfile.mkdtemp(prefix="pamr faults ")
    inputs = os.path.join(folder, "inputs")
    os.mkdir(inputs)
    os.chdir(inputs)
    make_inputs(BIN)
    print(f"{RANKS} ranks, {MOMENTS} moments\n{'fault':22} {'tool':12} runs: whole, failed; seconds", flush=True)
    wanted = os.environ.get("PAMR_STAGES", "").split(",")
    waiting = [stage for stage in STAGES if (BIN / stage.tool).exists() and (wanted == [""] or stage.name in wanted)]
    running, n_bad = 0, 0
    while waiting or running:
        if waiting and running < int(os.environ.get("PAMR_JOBS", 3)):
            stage = waiting.pop(0)
            running += 1
            if os.fork() == 0:
                try:
                    run_stage(stage, inputs, os.path.join(folder, stage.name))
                except BaseException as error:  # a stage that does not work, a script that is wrong
                    print(f"{stage.name}: {type(error).__name__}: {error}", flush=True)
                os._exit(1)
        else:
            running -= 1
            n_bad += os.wait()[1] != 0
    os.chdir("/")
    shutil.rmtree(folder)
    sys.exit(1 if n_bad else 0)


if __name__ == "__main__":
    main()
