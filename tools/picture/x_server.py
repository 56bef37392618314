# SPDX-License-Identifier: GPL-3.0-or-later
"""A screen in memory: Debian's VTK draws by X only."""
import contextlib
import os
import shutil
import signal
import subprocess

from refused import Refused


def dies_with_its_parent():
    """For the child: nothing is left behind when the parent is killed (Linux: PR_SET_PDEATHSIG)."""
    import ctypes
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)
    os.setpgid(0, 0)  # Ctrl-C is for the parent, which ends this one when it is done with it


def start_server(number):
    """The server and the number of its display, "" if it ended. The number is made from that of this process, as servers that
    choose one may meet one that is just ending; without -noreset a server starts anew when its last window is closed."""
    read_end, write_end = os.pipe()
    server = subprocess.Popen(["Xvfb", f":{number}", "-displayfd", str(write_end), "-noreset", "-screen", "0", "64x64x24", "-nolisten",
                               "tcp"], pass_fds=[write_end], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              preexec_fn=dies_with_its_parent)
    os.close(write_end)
    with os.fdopen(read_end) as answer:
        answered = answer.readline().strip()
    if not answered:
        server.wait()
    return server, answered


@contextlib.contextmanager
def screen():
    """Runs Xvfb, the same software on any machine; where there is none, takes the screen that is there."""
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    if shutil.which("Xvfb") is None:
        if "DISPLAY" not in os.environ:
            raise Refused("expected the program Xvfb (Debian package xvfb) or a screen (DISPLAY), found neither")
        yield
        return
    for attempt in range(10):
        server, number = start_server(1000 + (os.getpid() + 7919 * attempt) % 50000)
        if number:
            break
    else:
        raise Refused("expected Xvfb to start, found that it ended at once")
    try:
        os.environ["DISPLAY"] = ":" + number
        os.environ.pop("XAUTHORITY", None)
        yield
    finally:
        server.terminate()
        server.wait()
