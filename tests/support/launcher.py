# SPDX-License-Identifier: GPL-3.0-or-later
"""What the launcher of MPI does to its ranks and their output, by its version; one place for all tests."""
import re
import subprocess

# mpirun complains of a socket that it has just closed, when ranks end together, and of a limit on the size of files; that of
# Open MPI 5 of a rank that it does not reach any more
_CHATTER = re.compile(r"^(\[warn\] Epoll|.*Forwarding signal|\[[^\]\n]*\] PMIX ERROR: PMIX_ERR_UNREACH ).*\n*", re.MULTILINE)


def without_chatter(err):
    """The standard error of a job without the lines of the launcher itself, which come now and then."""
    return _CHATTER.sub("", err)


def is_of_open_mpi_5(launcher):
    """Whether a command, given up to its option for the number of ranks, is mpirun of Open MPI 5 or newer, which is PRRTE.

    It shows whole lines only, and nothing that ranks say after SIGINT or SIGTERM.
    """
    text = subprocess.run(launcher[:-1] + ["--version"], capture_output=True, text=True, timeout=60).stdout
    found = re.search(r"\(Open MPI\) (\d+)", text)
    return found is not None and int(found.group(1)) >= 5
