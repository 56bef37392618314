# SPDX-License-Identifier: GPL-3.0-or-later
"""The processes of a job that is under way: their ids, and the memory that they ask for."""
import os
import pathlib
import time


def all_processes():
    """Of the machine: id, name, state, parent's id."""
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                name, rest = (entry / "stat").read_text().rsplit(")", 1)
            except OSError:
                continue  # it has ended meanwhile
            state, parent = rest.split()[:2]
            yield int(entry.name), name.split("(", 1)[1], state, int(parent)


def processes_of(job, tool):
    """Ids of the tool's processes that this job has started; without those that inspect a file for one of them."""
    return sorted(pid for pid, name, _, parent in all_processes() if name == tool[:15] and job.pid in (pid, parent))


def processes_here(tool):
    """Ids of the tool's processes that work in the folder of this one, whoever started them."""
    found = []
    for pid, name, state, _ in all_processes():
        try:
            if name == tool[:15] and state != "Z" and os.readlink(f"/proc/{pid}/cwd") == os.getcwd():
                found.append(pid)
        except OSError:
            continue  # it has ended meanwhile
    return found


def still_there(job):
    """The job and all that comes from it: name, state, and where in the system it waits, of each."""
    family, found = {job.pid}, []
    for pid, name, state, parent in sorted(all_processes()):  # parents first
        if pid == job.pid or parent in family:
            family.add(pid)
            try:
                waits = pathlib.Path(f"/proc/{pid}/wchan").read_text()
            except OSError:
                waits = "?"
            found.append((name, state, waits))
    return found


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
