# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tools as a user does and holds them to what all of them promise.

A test script is called as SCRIPT BIN_FOLDER RANKS LAUNCHER...: the folder of the tools, the number of processes, and
the command that starts them (empty for one process without a launcher). It calls `run_tests(globals())`, which runs
every function named test_... in a folder of its own.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import traceback

import h5py

BIN = pathlib.Path(sys.argv[1])
RANKS = int(sys.argv[2])
LAUNCHER = sys.argv[3:] + [sys.argv[2]] if len(sys.argv) > 3 else []


class Result:
    def __init__(self, done):
        self.code, self.out, self.err = done.returncode, done.stdout, done.stderr

    @property
    def json(self):
        return json.loads(self.out)


def run(tool, *arguments, code=0, serial=False, ranks=RANKS):
    """Runs a tool on this many processes and expects this exit code. Bad input (2): one line of error and no output."""
    launcher = LAUNCHER[:-1] + [str(ranks)] if LAUNCHER and ranks > 1 else []
    command = ([] if serial else launcher) + [str(BIN / tool)] + [str(a) for a in arguments]
    # Ranks that fail together end by themselves: mpirun need not give them a second to do so.
    environment = os.environ | ({"OMPI_MCA_odls_base_sigkill_timeout": "0"} if code else {})
    result = Result(subprocess.run(command, capture_output=True, text=True, timeout=100, env=environment))
    shown = f"{' '.join(command)}\nexit code {result.code}, expected {code}\n{result.out}\n{result.err}"
    assert result.code == code, shown
    if code == 2:
        # mpiexec itself may complain of a socket that it has just closed, when ranks end together
        lines = [line for line in result.err.splitlines() if not line.startswith("[warn] Epoll")]
        assert len(lines) == 1 and lines[0].startswith(f"{tool}: error: "), shown
        assert result.out == "", shown
    assert not list(pathlib.Path(".").glob("**/*.partial")), "a temporary file was left behind"
    return result


def refuses(tool, *arguments, says=(), creates=None):
    """Expects exit code 2, these words in the error, and that the file was not created."""
    result = run(tool, *arguments, code=2)
    for word in says:
        assert word in result.err, f"no {word!r} in: {result.err}"
    if creates is not None:
        assert not os.path.exists(creates), f"{creates} was created"
    return result


def kuhn_cube(name, n):
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", n, "-o", name, "--quiet", serial=True)
    return name


def bare_copy(source, target):
    """The mesh with its /VTKHDF part only, as a stranger would write it."""
    with h5py.File(source) as old, h5py.File(target, "w") as new:
        old.copy("VTKHDF", new)
    return target


def add_cell_field(name, field, values):
    with h5py.File(name, "r+") as file:
        file["VTKHDF"].require_group("CellData")[field] = values
    return name


def same_bytes(a, b):
    return pathlib.Path(a).read_bytes() == pathlib.Path(b).read_bytes()


def run_tests(names):
    failed = 0
    for name, test in list(names.items()):
        if not name.startswith("test_"):
            continue
        folder = tempfile.mkdtemp(prefix="pamr tool ")  # with a blank, on purpose
        os.chdir(folder)
        try:
            test()
            print(f"ok      {name}")
        except Exception:
            failed += 1
            print(f"FAILED  {name}")
            traceback.print_exc(file=sys.stdout)
        finally:
            os.chdir("/")
            shutil.rmtree(folder)
    sys.exit(1 if failed else 0)
