# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-refine when processes die, are asked to end, or get too little memory: it ends, says so, leaves no broken file."""
import glob
import os
import pathlib
import signal
import subprocess
import time

from job_processes import largest_size, processes_of
from tool_run import BIN, LAUNCHER, LIMIT, RANKS, kuhn_cube, run, run_tests, same_bytes

PRECIOUS = b"the result of yesterday"


def marked_cube(n=40):
    run("pamr-mark", kuhn_cube("level0.hdf", n), "-o", "marked.hdf", "--all", "--quiet", serial=True)
    run("pamr-refine", "marked.hdf", "-o", "whole.hdf", serial=True)


def command(output, limits="", mesh="marked.hdf"):
    limited = ["sh", "-c", f'{limits}; exec "$@"', "sh"] if limits else []
    return LAUNCHER + limited + [str(BIN / "pamr-refine"), mesh, "-o", output, "--force", "--quiet"]


def unfinished(output):
    """Temporary files of this output."""
    return set(glob.glob(output + ".*.partial"))


def wait_for(condition, job, seconds=LIMIT):
    """Until the condition holds; whether it did before the job ended."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and job.poll() is None:
        if condition():
            return True
        time.sleep(0.002)
    return False


def check_output(output):
    """What was there before, or the whole result if the job had just finished it."""
    contents = pathlib.Path(output).read_bytes()
    assert contents == PRECIOUS or contents == pathlib.Path("whole.hdf").read_bytes(), "a broken file has the name"


def check_end(job, output):
    """The job ends with an error and leaves no broken file under the output's name."""
    begin = time.monotonic()
    out, err = job.communicate(timeout=LIMIT)
    print(f"        ended after {time.monotonic() - begin:.1f} s with {job.returncode}: "
          f"{(err.splitlines() or ['no message'])[0]}")
    assert job.returncode != 0, (out, err)
    check_output(output)
    others = set(os.listdir(".")) - {"level0.hdf", "marked.hdf", "whole.hdf", output} - unfinished(output)
    assert not others, others
    return err


def start(output):
    """The job, and the moment at which it was started."""
    pathlib.Path(output).write_bytes(PRECIOUS)
    return subprocess.Popen(command(output), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True), time.monotonic()


def disturb(output, moment, act):
    """Acts on a running job at a moment, which is a condition on job and start; the job, once that has worked."""
    for _ in range(20):
        job, begin = start(output)
        if wait_for(lambda: len(processes_of(job, "pamr-refine")) == RANKS and moment(begin), job):
            act(job)
            return job
        job.communicate()  # it was faster than we are: once more
    raise AssertionError("no job could be caught in time")


def moments(output):
    """Shortly after the start, in the midst of the work, and while the file is written."""
    job, begin = start(output)
    assert wait_for(lambda: unfinished(output), job)
    work = time.monotonic() - begin
    job.communicate()
    print(f"        the file appears {work:.2f} s after the start")
    late = [lambda begin, part=part: time.monotonic() - begin > part * work for part in (0.4, 0.6, 0.8)]
    return late + [lambda begin: unfinished(output)]


def test_a_killed_process_ends_the_job():
    marked_cube()
    for i, moment in enumerate(moments("out.hdf")):
        victim = i % RANKS
        check_end(disturb("out.hdf", moment, lambda job: os.kill(processes_of(job, "pamr-refine")[victim], signal.SIGKILL)), "out.hdf")
        # What it may have left goes with the next run, which `run` makes sure of.
        os.remove("out.hdf")
        run("pamr-refine", "marked.hdf", "-o", "out.hdf")
    assert same_bytes("out.hdf", "whole.hdf")


def test_a_job_that_is_told_to_end():
    marked_cube()
    for sign in (signal.SIGTERM, signal.SIGINT):
        for moment in moments("out.hdf"):
            check_end(disturb("out.hdf", moment, lambda job: job.send_signal(sign)), "out.hdf")
            assert not unfinished("out.hdf"), f"{sign.name} left the unfinished file"


def size_of_run(mesh):
    """Address space of the largest process of a run that has all it wants, KiB."""
    job = subprocess.Popen(command("free.hdf", mesh=mesh), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    largest = largest_size(job, "pamr-refine")
    os.remove("free.hdf")
    return largest


def test_too_little_memory():
    """Between what a small mesh takes, which is what MPI and HDF5 want for themselves, and what this one takes."""
    run("pamr-mark", kuhn_cube("small.hdf", 8), "-o", "marked_small.hdf", "--all", "--quiet", serial=True)
    least = size_of_run("marked_small.hdf")
    if least > 1 << 33:  # KiB
        print("        not tried: the address sanitizer reserves terabytes, and its own allocator ends a job at a limit")
        return
    marked_cube(44)
    most = size_of_run("marked.hdf")
    assert most > least + 30000, (least, most)  # both with the 64 MiB that a process sets aside
    pathlib.Path("out.hdf").write_bytes(PRECIOUS)
    named = 0
    for percent in range(20, 100, 10):
        limit = least + (most - least) * percent // 100
        begin = time.monotonic()
        done = subprocess.run(command("out.hdf", f"ulimit -v {limit}"), capture_output=True, text=True, timeout=LIMIT)
        print(f"        {limit} KiB: {done.returncode} after {time.monotonic() - begin:.1f} s, "
              f"{(done.stderr.splitlines() or ['no message'])[-1][:100]}")
        if done.returncode == 0:
            assert same_bytes("out.hdf", "whole.hdf")
            pathlib.Path("out.hdf").write_bytes(PRECIOUS)
            continue
        assert done.stderr.strip(), "it ended without a message"
        check_output("out.hdf")
        named += "pamr-refine: error: out of memory" in done.stderr and done.returncode == 3
    assert named > 0, "no run with too little memory said so"


if __name__ == "__main__":
    print(f"{RANKS} ranks")
    run_tests(globals(), at_once=1)  # moments and memory are measured
