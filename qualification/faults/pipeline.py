# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages of the pipeline, each as a job that can be started, disturbed and held to what all of them promise."""
import io
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/tools"))
from gas_cases import gas_in_a_cube  # noqa: E402
from job_processes import processes_here, still_there  # noqa: E402

SECONDS_TO_END = 300
CRASHES = (signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE, signal.SIGILL)
PRECIOUS = b"the result of yesterday"
POTENTIAL = "".join(f'[boundary.{side}]\nkind = "{"potential" if side[0] == "x" else "symmetry"}"\n'
                    + ("value = 2.0\n" if side[0] == "x" else "")
                    for side in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax"))


class Broken(Exception):
    """A promise that was not kept."""


def contents(path):
    """Of a file, or of all files of a folder but unfinished ones; nothing where there is none."""
    path = pathlib.Path(path)
    if path.is_dir():
        return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*"))
                if file.is_file() and ".partial" not in str(file)} or None
    return path.read_bytes() if path.exists() else None


def unfinished():
    return [str(path) for path in pathlib.Path(".").rglob("*.partial*")]


def start(words, **others):
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", **others)


def same_to_rounding(found, whole):
    """Of two files of the native format: the same datasets, whose numbers agree to 1e-10 of the greatest of each."""
    def datasets(data):
        values = {}
        with h5py.File(io.BytesIO(data)) as file:
            file.visititems(lambda name, item: values.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
        return values

    def agree(a, b):
        if getattr(a, "dtype", None) is None or a.dtype.kind != "f":
            return np.array_equal(a, b)
        return a.shape == b.shape and bool(np.all(np.abs(a - b) <= 1e-10 * np.abs(b).max(initial=0)))

    try:
        ours, theirs = datasets(found), datasets(whole)
    except (KeyError, OSError, RuntimeError, ValueError):
        return False  # no whole file
    # the checksums of what differs in its last bits differ
    names = [name for name in theirs if "checksum" not in name]
    return ours.keys() == theirs.keys() and all(agree(ours[name], theirs[name]) for name in names)


class Stage:
    """One tool with its inputs and its output, in the folder in which this process works."""

    def __init__(self, name, words, output, to_rounding=False):
        self.name, self.tool, self.arguments, self.options = name, words[0], words[1:], output.split()
        self.output = self.options[-1]
        self.launcher = []  # what starts it on its number of ranks
        self.tools = None   # folder
        self.seconds = 0.0  # that it takes when nothing disturbs it
        self.whole = None   # what it makes then
        self.to_rounding = to_rounding  # its sums depend on the order in which messages arrive

    def inputs(self):
        return [word for word in self.arguments if os.path.exists(word)]

    def command(self, before=(), folder="."):
        """The job in this folder; `before` comes between the launcher and the tool."""
        words, options = self.arguments, list(self.options)
        if folder != ".":
            words = [os.path.join(folder, word) if os.path.exists(word) else word for word in words]
            options[-1] = os.path.join(folder, options[-1])
        return [*self.launcher, *before, str(self.tools / self.tool), *words, *options, "--force", "--quiet"]

    def clean(self):
        """Removes what the run before left; an output of yesterday stands in its place."""
        output = pathlib.Path(self.output)
        for path in [output, *map(pathlib.Path, unfinished())]:
            if path.is_dir():
                shutil.rmtree(path)
            elif path.exists():
                path.unlink()
        if output.suffix:
            output.write_bytes(PRECIOUS)

    def measure(self):
        """One run without trouble: its seconds and its result."""
        self.clean()
        begin = time.monotonic()
        job = start(self.command())
        out, err = job.communicate(timeout=SECONDS_TO_END)
        if job.returncode != 0:
            raise Broken(f"it does not work at all: {err}")
        self.seconds, self.whole = time.monotonic() - begin, contents(self.output)

    def is_whole(self, found):
        return found == self.whole or (self.to_rounding and same_to_rounding(found, self.whole))

    def is_harmless(self, found):
        """What the name of the output may hold in the end, whatever happened."""
        return found in (PRECIOUS, None) or self.is_whole(found)

    def size_of_result(self):
        return sum(map(len, self.whole.values())) if isinstance(self.whole, dict) else len(self.whole)

    def end(self, job, must_say=True):
        """Waits for the job; 'whole', 'failed', or 'launcher' where that waits although its ranks have ended, or crashes and they
        end: mpiexec of Open MPI 4.1 now and then does. Raises `Broken` for what must not be."""
        try:
            out, err = job.communicate(timeout=SECONDS_TO_END)
        except subprocess.TimeoutExpired:
            waiting, ranks = still_there(job), processes_here(self.tool)
            job.kill()
            if not self.launcher or ranks:
                raise Broken(f"no end within {SECONDS_TO_END} s: {waiting}") from None
            job.communicate()
            if not self.is_harmless(contents(self.output)):
                raise Broken("a broken output has the name, and the launcher waits") from None
            return "launcher"
        launcher_crashed = self.launcher and -job.returncode in CRASHES  # of a rank mpiexec would tell
        if launcher_crashed:
            deadline = time.monotonic() + SECONDS_TO_END
            while processes_here(self.tool):
                if time.monotonic() > deadline:
                    raise Broken(f"no end within {SECONDS_TO_END} s after the launcher's: {err.strip()[-300:]}")
                time.sleep(0.1)
        found = contents(self.output)
        said = f"exit code {job.returncode}: {err.strip()[-300:]}"
        if job.returncode == 0:
            if not self.is_whole(found):
                raise Broken(f"a success without the whole result ({said})")
            return "whole"
        if not self.is_harmless(found):
            raise Broken(f"a broken output has the name ({said})")
        if launcher_crashed:
            return "launcher"
        if must_say and not err.strip():
            raise Broken(f"it failed without a word ({said})")
        if job.returncode == 3 and "out of memory" not in err:
            raise Broken(f"an internal error ({said})")
        ended_by = max(-job.returncode, job.returncode - 128)  # a signal, as the system or mpirun has it
        if ended_by in CRASHES:
            raise Broken(f"it crashed ({said})")
        if ended_by == signal.SIGABRT and "std::bad_alloc" not in err:  # before the tool has begun
            raise Broken(f"it ended itself ({said})")
        return "failed"


STAGES = [  # those that take longest first, since several are disturbed at a time
    Stage("gas", ["pamr-dsmc", "gas.toml", "--mesh", "cube.hdf"], "-o out.hdf"),
    Stage("mesh", ["pamr-mesh", "--shape", "sphere-in-box", "--size", "0.6"], "-o out.hdf"),
    Stage("read .msh", ["pamr-convert", "fine.msh"], "out.hdf"),
    Stage("refine", ["pamr-refine", "marked.hdf"], "-o out.hdf"),
    Stage("potential", ["pamr-pb", "potential.toml", "--mesh", "cube.hdf"], "-o out.hdf", to_rounding=True),
    Stage("write .vtu", ["pamr-convert", "fine.hdf"], "out.vtu"),
    Stage("mark", ["pamr-mark", "cube.hdf", "--all"], "-o out.hdf"),
    Stage("OpenFOAM", ["pamr-convert", "fine.hdf"], "out"),
]


def make_inputs(tools):
    def run(*words):
        subprocess.run([str(tools / words[0]), *words[1:], "--quiet"], check=True, capture_output=True)
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", "8", "-o", "cube.hdf")
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", "1", "-o", "tiny.hdf")
    run("pamr-mark", "cube.hdf", "-o", "marked.hdf", "--all")
    run("pamr-refine", "marked.hdf", "-o", "fine.hdf")
    run("pamr-convert", "fine.hdf", "fine.msh")
    pathlib.Path("gas.toml").write_text(gas_in_a_cube(transient=4, sampling=8, end="block = 4\n[reference]\narea = 1.0\n"))
    pathlib.Path("potential.toml").write_text(POTENTIAL)
