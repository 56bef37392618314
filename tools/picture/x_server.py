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


@contextlib.contextmanager
def screen():
    """Runs Xvfb, the same software on any machine; where there is none, takes the screen that is there."""
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    if shutil.which("Xvfb") is None:
        if "DISPLAY" not in os.environ:
            raise Refused("expected the program Xvfb (Debian package xvfb) or a screen (DISPLAY), found neither")
        yield
        return
    read_end, write_end = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write_end), "-screen", "0", "64x64x24", "-nolisten", "tcp"],
                              pass_fds=[write_end], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              preexec_fn=dies_with_its_parent)
    os.close(write_end)
    try:
        with os.fdopen(read_end) as answer:
            number = answer.readline().strip()
        if not number:
            raise Refused("expected Xvfb to start, found that it ended at once")
        os.environ["DISPLAY"] = ":" + number
        os.environ.pop("XAUTHORITY", None)
        yield
    finally:
        server.terminate()
        server.wait()
