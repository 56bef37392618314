# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tools as a user does and holds them to what all of them promise.

A test script is called as SCRIPT BIN_FOLDER RANKS LAUNCHER...: the folder of the tools, the number of processes, and
the command that starts them (empty for one process without a launcher). It calls `run_tests(globals())`, which runs
every function named test_... in a folder and a process of its own, several at a time.
"""
import contextlib
import fcntl
import hashlib
import json
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import tempfile
import time
import traceback

import h5py

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "tools/picture"), str(ROOT / "tests/support")]  # tet, the numbering of a tetrahedron; whole_meshio
from launcher import without_chatter  # noqa: E402

BIN = pathlib.Path(sys.argv[1])
RANKS = int(sys.argv[2])
LAUNCHER = sys.argv[3:] + [sys.argv[2]] if len(sys.argv) > 3 else []
SHARED = tempfile.mkdtemp(prefix="pamr-tools-")  # of all the tests of this script
FULL = os.environ.get("PAMR_TEST_LEVEL") == "full"
LIMIT = 300 * int(os.environ.get("PAMR_TEST_TIMEOUT_FACTOR", 1))  # of one run, in seconds
REFUSED_BY_ALL = 1 if FULL else 3  # one refusal in so many is tried on all ranks
alone = set()  # tools that this script runs on one process
n_refused = 0
at_end = contextlib.ExitStack()  # what the running test leaves when it ends


def prepare_alone(*tools):
    """These tools, which have scripts of their own, prepare meshes here or look at them: one process suffices, but at the full level.

    A start on three ranks costs six times the processor time of one process, and most runs are little else.
    """
    if not FULL:
        alone.update(tools)


class Result:
    def __init__(self, done):
        self.code, self.out, self.err = done.returncode, done.stdout, without_chatter(done.stderr)

    @property
    def json(self):
        return json.loads(self.out)


def check_head(tool, result, where):
    """Every report says first which tool wrote it, about which files."""
    if result.code not in (0, 1) or where != "-" and not os.path.isfile(where):
        return
    text = result.out if where == "-" else pathlib.Path(where).read_text()
    found = json.loads(text)
    head = found["report"]
    assert list(found)[0] == "report" and list(head) == ["tool", "version", "commit", "format", "inputs"], text[:400]
    assert head["tool"] == tool and head["format"] == 1 and all(isinstance(name, str) for name in head["inputs"]), text[:400]


def run(tool, *arguments, code=0, serial=False, ranks=None):
    """Runs a tool on this many processes and expects this exit code. Bad input (2): one line of error and no output."""
    if ranks is None:
        ranks = 1 if tool in alone else RANKS
    start = LAUNCHER[:-1] + [str(ranks)] if LAUNCHER and ranks > 1 else []
    command = ([] if serial else start) + [str(BIN / tool)] + [str(a) for a in arguments]
    # Ranks that fail together end by themselves: mpirun need not give them a second to do so.
    environment = os.environ | ({"OMPI_MCA_odls_base_sigkill_timeout": "0"} if code else {})
    result = Result(subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, env=environment))
    shown = f"{' '.join(command)}\nexit code {result.code}, expected {code}\n{result.out}\n{result.err}"
    assert result.code == code, shown
    if code == 2:
        lines = result.err.splitlines()
        assert len(lines) == 1 and lines[0].startswith(f"{tool}: error: "), shown
        assert result.out == "", shown
    elif "--json" in arguments:
        check_head(tool, result, arguments[arguments.index("--json") + 1])
    assert not list(pathlib.Path(".").glob("**/*.partial")), "a temporary file was left behind"
    return result


def refuses(tool, *arguments, says=(), creates=None):
    """Expects exit code 2, these words in the error, and that the file was not created.

    The first refusal of a test and one in three of all are tried on all ranks, the rest on one process.
    """
    global n_refused
    n_refused += 1
    result = run(tool, *arguments, code=2, serial=(n_refused - 1) % REFUSED_BY_ALL != 0)
    for word in says:
        assert word in result.err, f"no {word!r} in: {result.err}"
    if creates is not None:
        assert not os.path.exists(creates), f"{creates} was created"
    return result


def bare_copy(source, target):
    """The mesh with its /VTKHDF part only, as a stranger would write it."""
    with h5py.File(source) as old, h5py.File(target, "w") as new:
        old.copy("VTKHDF", new)
        new["VTKHDF"].require_group("CellData").pop("level", None)  # which only PAMR writes
    return target


def add_cell_field(name, field, values):
    with h5py.File(name, "r+") as file:
        file["VTKHDF"].require_group("CellData")[field] = values
    return name


def same_bytes(a, b):
    return pathlib.Path(a).read_bytes() == pathlib.Path(b).read_bytes()


def of_one_process(test):
    """A test of what one process computes on any number of ranks, or of values that other tests hold to be the same on them.

    Where there are several ranks, it is of the full level.
    """
    test.is_of_one_process = True
    return test


def of_full_level(test):
    """A long test of whose kind a shorter one stays for every change."""
    test.is_of_full_level = True
    return test


def is_due(test, on_ranks):
    if FULL:
        return True
    of_one = getattr(test, "is_of_one_process", False) or on_ranks is not None and test not in on_ranks
    return not (getattr(test, "is_of_full_level", False) or RANKS > 1 and of_one)


def once(function):
    """A function of plain arguments that several tests call: the first one computes, the others get what it returned."""
    def kept(*arguments):
        name = os.path.join(SHARED, hashlib.sha1(repr((function.__name__, arguments)).encode()).hexdigest())
        with open(name + ".lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not os.path.exists(name):
                result = function(*arguments)
                with open(name, "wb") as file:
                    pickle.dump(result, file)
        with open(name, "rb") as file:
            return pickle.load(file)
    return kept


@once
def cube_of_all(n):
    name = os.path.join(SHARED, f"cube{n}.hdf")
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", n, "-o", name, "--quiet", serial=True)
    return name


def kuhn_cube(name, n):
    shutil.copyfile(cube_of_all(n), name)
    return name


def run_one(name, test, log):
    """A test in a folder and a process of its own, which ends here; what it prints goes to the log."""
    with open(log, "w", buffering=1) as out:
        os.dup2(out.fileno(), 1)
        os.dup2(out.fileno(), 2)
        sys.stdout = sys.stderr = out
        folder = tempfile.mkdtemp(prefix="pamr tool ")  # with a blank, on purpose
        os.chdir(folder)
        begin, failed = time.monotonic(), False
        try:
            with at_end:
                test()
        except BaseException:
            failed = True
            traceback.print_exc(file=out)
        print(f"{'FAILED' if failed else 'ok    '}  {name} ({time.monotonic() - begin:.1f} s)", file=out)
        os.chdir("/")
        shutil.rmtree(folder, ignore_errors=not failed)
    os._exit(1 if failed else 0)


def run_tests(names, at_once=3, on_ranks=None):
    """Runs the tests, so many at a time: most of their time they wait for processes to start and to end.

    Where `on_ranks` names tests, all others are of one process (as `of_one_process` says).
    """
    waiting = [(name, test) for name, test in names.items() if name.startswith("test_") and is_due(test, on_ranks)]
    running, n_failed = {}, 0
    sys.stdout.flush()
    while waiting or running:
        while waiting and len(running) < at_once:
            name, test = waiting.pop(0)
            log = os.path.join(SHARED, name + ".log")
            pid = os.fork()
            if pid == 0:
                run_one(name, test, log)
            running[pid] = log
        pid, status = os.wait()
        if pid in running:
            n_failed += status != 0
            print(pathlib.Path(running.pop(pid)).read_text(), end="", flush=True)
    shutil.rmtree(SHARED)
    sys.exit(1 if n_failed else 0)
