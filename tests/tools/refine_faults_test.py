# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-refine when processes die or are told to end: the job ends and leaves no broken file under its output's name."""
import os
import pathlib
import signal
import subprocess
import time

from tool_run import BIN, LAUNCHER, RANKS, kuhn_cube, run, run_tests, same_bytes

SECONDS_TO_END = 10
PRECIOUS = b"the result of yesterday"


def marked_cube(n=40):
    run("pamr-mark", kuhn_cube("level0.hdf", n), "-o", "marked.hdf", "--all", "--quiet", serial=True)
    run("pamr-refine", "marked.hdf", "-o", "whole.hdf", serial=True)


def command(output):
    return LAUNCHER + [str(BIN / "pamr-refine"), "marked.hdf", "-o", output, "--force", "--quiet"]


def processes_of(job):
    """Ids of the tool's processes that this job has started."""
    parents = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                name, rest = (entry / "stat").read_text().rsplit(")", 1)
            except OSError:
                continue  # it has ended meanwhile
            if name.endswith("(pamr-refine"):
                parents[int(entry.name)] = int(rest.split()[1])
    return sorted(pid for pid, parent in parents.items() if job.pid in (pid, parent))


def wait_for(condition, job, seconds=60):
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
    """The job ends soon with an error and leaves no broken file under the output's name."""
    begin = time.monotonic()
    out, err = job.communicate(timeout=SECONDS_TO_END)
    print(f"        ended after {time.monotonic() - begin:.1f} s with {job.returncode}: "
          f"{(err.splitlines() or ['no message'])[0]}")
    assert job.returncode != 0, (out, err)
    check_output(output)
    others = set(os.listdir(".")) - {"level0.hdf", "marked.hdf", "whole.hdf", output, output + ".partial"}
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
        if wait_for(lambda: len(processes_of(job)) == RANKS and moment(begin), job):
            act(job)
            return job
        job.communicate()  # it was faster than we are: once more
    raise AssertionError("no job could be caught in time")


def moments(output):
    """Shortly after the start, in the midst of the work, and while the file is written."""
    job, begin = start(output)
    assert wait_for(lambda: os.path.exists(output + ".partial"), job)
    work = time.monotonic() - begin
    job.communicate()
    print(f"        the file appears {work:.2f} s after the start")
    late = [lambda begin, part=part: time.monotonic() - begin > part * work for part in (0.4, 0.6, 0.8)]
    return late + [lambda begin: os.path.exists(output + ".partial")]


def test_a_killed_process_ends_the_job():
    marked_cube()
    for i, moment in enumerate(moments("out.hdf")):
        victim = i % RANKS
        check_end(disturb("out.hdf", moment, lambda job: os.kill(processes_of(job)[victim], signal.SIGKILL)), "out.hdf")
    # What a killed run leaves behind is in nobody's way.
    os.remove("out.hdf")
    run("pamr-refine", "marked.hdf", "-o", "out.hdf")
    assert same_bytes("out.hdf", "whole.hdf")


def test_a_job_that_is_told_to_end():
    marked_cube()
    for sign in (signal.SIGTERM, signal.SIGINT):
        for moment in moments("out.hdf"):
            check_end(disturb("out.hdf", moment, lambda job: job.send_signal(sign)), "out.hdf")
            assert not os.path.exists("out.hdf.partial"), f"{sign.name} left the unfinished file"


if __name__ == "__main__":
    print(f"{RANKS} ranks")
    run_tests(globals())
