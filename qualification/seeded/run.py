#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Do the tests notice faults? Each NN-name.patch beside this script is one, with what it does to users at its head.

    run.py              puts each into a copy of the last commit, builds it, runs the tests and takes it out again
    run.py 07 gmsh      the same with those whose names contain one of these words
    run.py --check      only says whether all patches fit the files as they are

Prints what found each fault and after how many seconds. Exit code: 0 all were found, 1 one was not, 2 a patch that does
not fit or does not build, or tests that fail without any fault. The copy is build/seeded/tree (--tree: another folder),
so that your files stay as they are; its first build takes as long as any. A fault that is found costs about two minutes.

A last line "Found by NAME." at the head of a patch names a test of the full level or of every change: a gate that let the fault pass once. That
one is run alone with the fault, and without it first; it is left out where the test is not there (programs of others).
"""
import argparse
import fcntl
import os
import pathlib
import re
import select
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FAILED = re.compile(r"^ *\d+/\d+ Test +#\d+: (\S+) \.*\*\*\*", re.MULTILINE)
STARTED = re.compile(r" +Start +(\d+): (\S+)")
SILENCE = 120  # seconds
# What is built, and then run: cheap tests first.
STAGES = [(["unit_tests"], ["-L", "^quick$"]), (["all"], ["-L", "^unit$", "-LE", "^quick$", "-E", "^(consumer|seeded_faults_apply)$"]),
          ([], ["-LE", "^unit$"]), ([], ["-R", "^consumer$"])]


class Trouble(Exception):
    """The patch or the tree is no good; nothing can be said of the tests."""


class Fault:
    """A file, and blocks of its lines with what stands in their place."""

    def __init__(self, patch):
        self.name = patch.stem
        head, _, body = patch.read_text().partition("diff --git ")
        self.lines_of_head = [line for line in head.splitlines() if line]
        files = re.findall(r"^\+\+\+ b/(\S+)", body, re.MULTILINE)
        if not 1 <= len(self.lines_of_head) <= 3 or len(files) != 1 or not files[0].endswith(".cpp"):
            raise Trouble(f"{self.name}: expected one to three lines and the change of one .cpp, found another patch")
        self.file = files[0]
        named = re.fullmatch(r"Found by (\w+)\.", self.lines_of_head[-1])
        self.test = named[1] if named else None
        self.blocks = []
        for hunk in re.split(r"^@@ .*\n", body, flags=re.MULTILINE)[1:]:
            lines = [line for line in hunk.splitlines(keepends=True) if line[0] in " +-"]
            self.blocks.append(["".join(line[1:] for line in lines if line[0] in marks) for marks in (" -", " +")])

    def changed(self, root):
        """The file with the fault."""
        path = root / self.file
        text = path.read_text() if path.exists() else ""
        for before, after in self.blocks:
            if (n := ("\n" + text).count("\n" + before)) != 1:
                raise Trouble(f"{self.name}: expected its lines once in {self.file}, found them {n} times: make it anew")
            text = ("\n" + text).replace("\n" + before, "\n" + after)[1:]
        return text


def output_of(command, folder):
    """Exit code and output; what it started ends with it."""
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               errors="replace", start_new_session=True)
    try:
        return process.communicate()[0], process.returncode
    except BaseException:
        os.killpg(process.pid, signal.SIGTERM)
        process.wait()
        raise


def must(command, folder):
    output, code = output_of(command, folder)
    if code != 0:
        raise Trouble(f"{' '.join(map(str, command))}: failed with\n{output[-3000:]}")
    return output.strip()


class Tree:
    """A clone with a build folder of its own."""

    def __init__(self, folder):
        self.folder, self.build = folder, folder / "build" / "release"
        if not (folder / ".git").exists():
            folder.parent.mkdir(parents=True, exist_ok=True)
            must(["git", "clone", "--quiet", "--shared", "--no-checkout", ROOT, folder], ROOT)
        self.lock = open(folder / ".git" / "seeded.lock", "w")
        fcntl.flock(self.lock, fcntl.LOCK_EX)
        must(["git", "fetch", "--quiet", ROOT, "HEAD"], folder)
        must(["git", "checkout", "--quiet", "--force", "--detach", "FETCH_HEAD"], folder)
        if not (self.build / "build.ninja").exists():
            must(["cmake", "--preset", "release", "-DPAMR_TESTS=ON", "-DPAMR_BENCH=ON", "-DPAMR_BATCHES=ON"], folder)

    def failing_test(self):
        """The first test that fails twice, None if all pass."""
        for targets, tests in STAGES:
            if targets:
                must(["ninja", "-C", self.build, *targets], self.folder)
            for _ in range(3):
                found = FAILED.search(self.ctest("--stop-on-failure", "--parallel", str(3 * os.cpu_count()), *tests))
                if not found:
                    break
                if FAILED.search(self.ctest("-R", f"^{re.escape(found[1])}$")):
                    return found[1]
        return None

    def ctest(self, *arguments):
        """What it printed to the first test that failed, or that let nothing be heard for two minutes."""
        process = subprocess.Popen(["ctest", "--test-dir", self.build, "--no-tests=error", *arguments], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
        output, running = "", {}
        try:
            while line := self.next_line(process):
                output += line
                if started := STARTED.match(line):
                    running[started[1]] = started[2]
                if FAILED.search(line):
                    return output
                if ended := re.match(r" *\d+/\d+ Test +#(\d+):", line):
                    running.pop(ended[1], None)
        except TimeoutError:
            number, name = next(iter(running.items()))
            return output + f" 1/1 Test #{number}: {name} ...***Not heard of\n"
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGTERM)
            code = process.wait()
        if code != 0:
            raise Trouble(f"ctest {' '.join(arguments)}: failed with\n{output[-3000:]}")
        return output

    @staticmethod
    def next_line(process):
        """Empty at the end. ctest flushes each line."""
        line = b""
        while not line.endswith(b"\n"):
            if not select.select([process.stdout], [], [], SILENCE)[0]:
                raise TimeoutError
            if not (byte := os.read(process.stdout.fileno(), 1)):
                break
            line += byte
        return line.decode(errors="replace")

    def require_passing(self):
        """The tests pass without a fault; known of a commit once they did."""
        passed = self.folder / ".git" / "seeded.passed"
        commit = must(["git", "rev-parse", "HEAD"], self.folder)
        if passed.exists() and passed.read_text() == commit:
            return
        print("tests without a fault ...", flush=True)
        if test := self.failing_test():
            raise Trouble(f"expected tests that pass without a fault, found that {test} fails")
        passed.write_text(commit)

    def has(self, test):
        must(["cmake", self.build], self.folder)  # the list of tests is that of this commit
        listed = must(["ctest", "--test-dir", self.build, "-C", "full", "-N", "-R", f"^{test}$"], self.folder)
        return f": {test}\n" in listed

    def fails(self, test):
        must(["ninja", "-C", self.build, "all"], self.folder)
        return FAILED.search(output_of(["ctest", "--test-dir", self.build, "-C", "full", "-R", f"^{test}$"], self.folder)[0]) is not None

    def failing_test_with(self, fault):
        """None if no test fails."""
        path = self.folder / fault.file
        sound = path.read_text()
        if fault.test:
            if not self.has(fault.test):
                return f"left out: no {fault.test}"
            if self.fails(fault.test):
                raise Trouble(f"{fault.name}: expected {fault.test} to pass without the fault, found that it fails")
        try:
            path.write_text(fault.changed(self.folder))
            if fault.test:
                return fault.test if self.fails(fault.test) else None
            return self.failing_test()
        finally:
            path.write_text(sound)


def run(options):
    faults, misfits = [], []
    for patch in sorted(HERE.glob("*.patch")):
        try:
            faults.append(Fault(patch))
            faults[-1].changed(ROOT)
        except Trouble as trouble:
            misfits.append(str(trouble))
    if misfits or not faults:
        raise Trouble("\n".join(misfits) or "expected patches beside this script, found none")
    if options.check:
        print(f"{len(faults)} faults fit")
        return 0
    faults = [f for f in faults if not options.names or any(name in f.name for name in options.names)]
    if not faults:
        raise Trouble("expected names of faults, found none of these")
    tree = Tree(options.tree.resolve())
    if any(fault.test is None for fault in faults):
        tree.require_passing()
    rows = []
    for fault in faults:
        start = time.monotonic()
        try:
            test = tree.failing_test_with(fault) or "NOT FOUND"
        except Trouble as trouble:
            test = "DOES NOT BUILD"
            print(f"run.py: {trouble}", file=sys.stderr)
        rows.append((fault.name, fault.file, test, f"{time.monotonic() - start:.0f}"))
        print(f"{fault.name}: {test}, {rows[-1][3]} s", flush=True)
    print("\n" + "\n".join(f"{a:44} {b:54} {c:28} {d:>6}" for a, b, c, d in [("fault", "file", "found by", "s"), *rows]))
    tests = [row[2] for row in rows]
    return 2 if "DOES NOT BUILD" in tests else 1 if "NOT FOUND" in tests else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--tree", type=pathlib.Path, default=ROOT / "build" / "seeded" / "tree")
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        return run(parser.parse_args())
    except Trouble as trouble:
        print(f"run.py: {trouble}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
