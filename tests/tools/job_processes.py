# SPDX-License-Identifier: GPL-3.0-or-later
"""The processes of a job that is under way: their ids, and the memory that they ask for."""
import pathlib
import time


def processes_of(job, tool):
    """Ids of the tool's processes that this job has started; without those that inspect a file for one of them."""
    parents = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                name, rest = (entry / "stat").read_text().rsplit(")", 1)
            except OSError:
                continue  # it has ended meanwhile
            if name.endswith("(" + tool[:15]):
                parents[int(entry.name)] = int(rest.split()[1])
    return sorted(pid for pid, parent in parents.items() if job.pid in (pid, parent))


def largest_size(job, tool):
    """Address space of its largest process, KiB, when the job has ended."""
    largest = 0
    while job.poll() is None:
        for pid in processes_of(job, tool):
            try:
                lines = pathlib.Path(f"/proc/{pid}/status").read_text().splitlines()
            except OSError:
                continue  # it has ended meanwhile
            largest = max([largest] + [int(line.split()[1]) for line in lines if line.startswith("VmPeak:")])
        time.sleep(0.002)
    job.communicate()
    return largest
