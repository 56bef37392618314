#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What every tool promises about exit codes, messages and files, tried on the probe on 1 and 3 ranks.

Usage: life_of_a_tool_test.py PROBE VERSION LEFT_OUT MPIEXEC...
"""
import concurrent.futures
import glob
import json
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
import launcher  # noqa: E402

PROBE, VERSION, LEFT_OUT, *MPIEXEC = sys.argv[1:]
IS_OPEN_MPI_5 = launcher.is_of_open_mpi_5(MPIEXEC)


def command(ranks, arguments):
    return ([] if ranks == 1 else MPIEXEC + [str(ranks)]) + [PROBE] + arguments


def finished(job):
    done = subprocess.run(job, capture_output=True, text=True, timeout=300)
    done.stderr = launcher.without_chatter(done.stderr)
    return done


def run(ranks, *arguments):
    return finished(command(ranks, list(arguments)))


class LifeOfATool(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="with blank ")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.input = self.path("in put.txt")
        with open(self.input, "w") as file:
            file.write("x\n")

    def path(self, name):
        return os.path.join(self.folder, name)

    def assert_error_once(self, result, code, *words):
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(result.stdout, "")
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith("pamr-probe: error: "), lines[0])
        for word in words:
            self.assertIn(word, lines[0])

    def test_done_gives_one_summary_line_and_code_0(self):
        for ranks in (1, 3):
            result = run(ranks, self.input)
            self.assertEqual((result.returncode, result.stdout, result.stderr), (0, f"done on {ranks} ranks\n", ""))

    def test_quiet_gives_no_summary(self):
        result = run(1, "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_help_has_the_example_and_version_the_version(self):
        for ranks in (1, 3):
            self.assertEqual(run(ranks, "--help").stdout.count("pamr-probe --how gate"), 1)
            first, second, *left_out = run(ranks, "--version").stdout.splitlines()
            self.assertRegex(first, rf"^pamr-probe {re.escape(VERSION)}( \(commit [0-9a-f]{{7,}}( with changes)?\))?$")
            self.assertRegex(second, r"^\S.* \d+\.[\d.]+, HDF5 1\.\d+\.\d+, CGAL \d[\d.]+, Scotch \d[\d.]+ \(64-bit integers\)$")
            self.assertEqual(left_out, [f"left out of this build: {LEFT_OUT}"] if LEFT_OUT else [])

    def test_version_has_a_commit_of_the_repository(self):
        git = ["git", "-c", "safe.directory=*", "-C", os.path.dirname(os.path.abspath(__file__))]
        if subprocess.run(git + ["ls-files", "--error-unmatch", os.path.basename(__file__)], capture_output=True).returncode != 0:
            return  # an archive
        commit = re.search(r"commit ([0-9a-f]+)", run(1, "--version").stdout).group(1)
        self.assertEqual(subprocess.run(git + ["cat-file", "-e", commit + "^{commit}"]).returncode, 0, commit)

    def test_a_gate_gives_code_1(self):
        for ranks in (1, 3):
            self.assertEqual(run(ranks, "--how", "gate").returncode, 1)

    def test_bad_usage_gives_code_2_and_one_line(self):
        for ranks in (1, 3):
            self.assert_error_once(run(ranks, "--no-such-option"), 2, "--no-such-option", "--help")

    def test_an_agreed_error_gives_code_2_and_one_line(self):
        for ranks in (1, 3):
            self.assert_error_once(run(ranks, "--how", "agreed-error"), 2, "cell 7", "expected", "found")

    def test_a_failure_on_all_ranks_gives_code_3_and_one_line(self):
        for ranks in (1, 3):
            self.assert_error_once(run(ranks, "--how", "failure-everywhere"), 3, "uncaught exception", "comm.size() == 0")

    def test_a_failure_on_one_rank_ends_all_with_code_3(self):
        self.assert_error_once(run(3, "--how", "failure-on-one"), 3, "slot 12 of 4", "rank 2")
        self.assert_error_once(run(3, "--how", "memory-on-one"), 3, "out of memory", "rank 2")

    def test_a_missing_input_is_named(self):
        for ranks in (1, 3):
            self.assert_error_once(run(ranks, self.path("none")), 2, self.path("none"), "expected", "found")

    def test_an_existing_output_is_kept_unless_forced(self):
        output = self.path("out")
        with open(output, "w") as file:
            file.write("precious")
        for ranks in (1, 3):
            self.assert_error_once(run(ranks, self.input, "-o", output), 2, output, "--force")
            with open(output) as file:
                self.assertEqual(file.read(), "precious")
        self.assertEqual(run(3, self.input, "-o", output, "--force").returncode, 0)
        with open(output) as file:
            self.assertEqual(file.read(), "all of it\n")

    def test_a_bad_place_for_the_output_is_refused_before_work(self):
        here = os.path.join(self.folder, ".", "in put.txt")
        os.symlink(self.input, self.path("link"))
        for place, word in ((self.path("no/out"), "folder"), (here, "same file"), (self.path("link"), "same file"),
                            (self.folder, "folder"), ("/dev/null", "device")):
            result = run(1, self.input, "-o", place, "--force", "--how", "failure-everywhere")
            self.assert_error_once(result, 2, place, word)
        self.assertEqual(os.path.islink(self.path("link")), True)

    @unittest.skipIf(os.geteuid() == 0 and not os.path.isdir("/proc/sys"), "root may write everywhere")
    def test_a_folder_without_write_permission_is_refused(self):
        folder = "/proc/sys" if os.geteuid() == 0 else self.path("locked")
        if folder == self.path("locked"):
            os.mkdir(folder, 0o500)
        self.assert_error_once(run(1, "-o", os.path.join(folder, "out")), 2, folder)

    def test_the_report_is_whole_and_replaces_an_old_one(self):
        report = self.path("report.json")
        for ranks in (1, 3):
            result = run(ranks, self.input, "--json", report)
            self.assertEqual(result.returncode, 0)
            with open(report) as file:
                found = json.load(file)
                self.assertEqual(list(found)[0], "report")
                head = found.pop("report")
                self.assertEqual(found, {"ranks": ranks, "input": self.input})
                self.assertRegex(head.pop("version"), r"^\d+\.\d+\.\d+$")
                self.assertIsInstance(head.pop("commit"), str)
                self.assertEqual(head, {"tool": "pamr-probe", "format": 1, "inputs": [self.input]})
        self.assertEqual(sorted(os.listdir(self.folder)), ["in put.txt", "report.json"])

    def test_the_report_on_standard_output_is_alone_there(self):
        for ranks in (1, 3):
            result = run(ranks, "--json", "-")
            self.assertEqual(json.loads(result.stdout)["ranks"], ranks)
            self.assertEqual(result.stderr, f"done on {ranks} ranks\n")

    def test_a_long_report_on_standard_output_is_whole(self):
        for ranks in (1, 3):
            result = run(ranks, "--json", "-", "--how", "long-report")
            self.assertEqual(json.loads(result.stdout)["numbers"], [12345] * 4000)
            self.assertEqual(result.stderr, f"done on {ranks} ranks\n")

    def test_a_long_report_is_whole_though_the_launcher_is_held_up(self):
        """As by other work on a busy machine: what is read late is not held back and put into what standard error gets."""
        with open(self.path("out"), "w+") as out, open(self.path("err"), "w+") as err:
            process = subprocess.Popen(command(3, ["--json", "-", "--how", "long-report"]), stdout=out, stderr=err)
            while process.poll() is None:
                process.send_signal(signal.SIGSTOP)
                time.sleep(0.07)
                process.send_signal(signal.SIGCONT)
                time.sleep(0.005)
            out.seek(0), err.seek(0)
            self.assertEqual(json.load(out)["numbers"], [12345] * 4000)
            self.assertEqual(err.read(), "done on 3 ranks\n")

    def test_the_report_must_have_a_place_of_its_own(self):
        self.assert_error_once(run(1, "--json", self.path("no/report")), 2, "folder")
        self.assert_error_once(run(1, self.input, "--json", self.input), 2, "same file")
        self.assert_error_once(run(1, "-o", self.path("x"), "--json", self.path("x")), 2, "same file")

    def test_a_full_disk_is_an_error(self):
        result = run(1, "--json", "/dev/full")
        self.assert_error_once(result, 2, "/dev/full", "written")

    def test_what_is_printed_has_to_arrive(self):
        for arguments in ([], ["--help"], ["--version"], ["--how", "gate"], ["--json", "-"]):
            with open("/dev/full", "w", encoding="ascii") as full:
                result = subprocess.run([PROBE] + arguments, stdout=full, stderr=subprocess.PIPE, text=True, timeout=300)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertRegex(result.stderr.splitlines()[-1], "^pamr-probe: error: standard output: .* written")
        with open("/dev/full", "w", encoding="ascii") as full:
            self.assertEqual(subprocess.run([PROBE, "--quiet"], stdout=full, timeout=300).returncode, 0)

    def test_nothing_is_printed_into_files_where_streams_are_closed(self):
        out = self.path("out")
        for number in (0, 1, 2):
            closed = subprocess.run([PROBE, "-o", out, "--force", "--how", "warn"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE, preexec_fn=lambda: os.close(number), timeout=300)
            streams = [b"", b"done on 1 ranks\n", b"pamr-probe: warning: a file named a\\nb\\x1b\n"]
            streams[number] = b""  # nobody listens
            self.assertEqual([closed.returncode, closed.stdout, closed.stderr], [0] + streams[1:], number)
            with open(out, encoding="ascii") as file:
                self.assertEqual(file.read(), "all of it\n")

    def start_two(self, first, second, folder=None):
        """A job of two ranks that begin differently, by a shell: mpirun of Open MPI 5.0.7 crashes if a command has a colon."""
        def begin(where, arguments):
            return f"cd {shlex.quote(where)} && exec {shlex.join([PROBE] + arguments)}"
        script = 'if [ "${OMPI_COMM_WORLD_RANK:-$PMI_RANK}" = 0 ]; then %s; else %s; fi' % (
            begin(self.folder, first), begin(folder or self.folder, second))
        return finished(MPIEXEC + ["2", "sh", "-c", script])

    def test_ranks_have_to_begin_alike(self):
        os.mkdir(self.path("other"))
        out = self.path("out")
        for first, second, words in ((["-o", out], ["-o", out + "2"], ["'" + out + "'", "'" + out + "2' on rank 1"]),
                                     (["-o", out], ["-o", out, "--force"], ["found none on rank 0 and '--force' on rank 1"]),
                                     (["--help"], ["-o", out], ["'--help' on rank 0"]),
                                     (["--nonsense"], ["-o", out], ["'--nonsense' on rank 0"])):
            self.assert_error_once(self.start_two(first, second), 2, "expected the same arguments", *words)
        self.assert_error_once(self.start_two(["-o", "out"], ["-o", "out"], self.path("other")), 2, "working folder", "other' on rank 1")
        self.assertEqual(sorted(os.listdir(self.folder)), ["in put.txt", "other"])

    def test_nothing_changes_the_outcome_when_the_work_is_done(self):
        warning = "pamr-probe: warning: MPI or another library failed while the process ended, when all work was done"
        ends = [("interrupt-at-end", None), ("error-at-end", "pamr-probe: warning: MPI did not end as it should (its error {}), when all work was done")]
        if "ASAN_OPTIONS" not in os.environ:  # else the sanitizer sees a crash first
            ends += [("crash-at-end", warning), ("crash-at-exit", warning), ("code-at-exit", warning)]
        for ranks in (1, 3):
            for how, said in ends:
                out = self.path(f"out-{how}-{ranks}")
                result = run(ranks, self.input, "-o", out, "--how", how)
                said = f"{said}; complete: '{out}'\n" if said else ""
                found = re.sub(r"its error \d+", "its error {}", result.stderr)
                self.assertEqual((result.returncode, found), (0, ranks * said), (ranks, how))

    def test_nothing_changes_an_error_that_was_printed(self):
        if "ASAN_OPTIONS" in os.environ:
            return  # the sanitizer sees a crash first
        for ranks in (1, 3):
            for how in ("crash-at-end", "crash-at-exit", "code-at-exit"):
                self.assert_error_once(run(ranks, self.input, "--how", how + "-of-error"), 2, "expected a report, found none")

    def test_what_fails_behind_an_output_says_that_it_is_complete(self):
        out = self.path("out")
        said = f"; complete: '{out}'"
        for ranks in (1, 3):
            def run_again(*arguments):
                return run(ranks, self.input, "-o", out, "--force", *arguments)
            self.assert_error_once(run_again("--how", "error-behind"), 2, "found none" + said)
            self.assert_error_once(run_again("--json", "/dev/full"), 2, "/dev/full", said)
            self.assert_error_once(run_again("--how", "failure-behind"), 3, "slot 12 of 4", said)
            if "ASAN_OPTIONS" not in os.environ:
                crashed = run_again("--how", "crash-behind")
                self.assertNotIn(crashed.returncode, (0, 2, 3, 6))
                self.assertEqual(crashed.stderr.count("pamr-probe: error: crashed" + said + "\n"), 1, crashed.stderr)
            with open(out, encoding="ascii") as file:
                self.assertEqual(file.read(), "all of it\n")
        self.assertNotIn("complete", run(1, self.input, "-o", self.path("no"), "--how", "agreed-error").stderr)

    def test_an_interrupt_behind_an_output_says_that_it_is_complete(self):
        out = self.path("out")
        process = subprocess.Popen([PROBE, "-o", out, "--how", "sleep-behind"], stderr=subprocess.PIPE, text=True)
        self.wait_until(lambda: os.path.exists(out))
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=300)
        self.assertEqual((process.returncode, err),
                         (6, f"pamr-probe: interrupted: outputs that were not complete are removed; complete: '{out}'\n"))

    def test_a_reader_that_leaves_ends_nothing(self):
        """Of standard output, which is an error when all is done, and of standard error, where nobody is left to tell."""
        out = self.path("out")
        for stream, code in (("stdout", 2), ("stderr", 0)):
            process = subprocess.Popen([PROBE, self.input, "-o", out, "--force", "--how", "warn"],
                                       **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE})
            getattr(process, stream).close()
            setattr(process, stream, None)
            printed, said = process.communicate(timeout=300)
            self.assertEqual(process.returncode, code, (stream, said))
            if stream == "stdout":
                self.assertRegex(said.decode().splitlines()[-1], "^pamr-probe: error: standard output: .*Broken pipe; complete: '.*out'$")

    def test_a_replaced_file_keeps_its_rights(self):
        for name, mode in (("secret.json", 0o600), ("shared.json", 0o664), ("fixed.json", 0o444)):
            with open(self.path(name), "w", encoding="ascii"):
                os.chmod(self.path(name), mode)
            for ranks in (1, 3):
                self.assertEqual(run(ranks, self.input, "--json", self.path(name)).returncode, 0)
                self.assertEqual(os.stat(self.path(name)).st_mode & 0o777, mode)

    def test_a_name_that_is_no_utf_8_does_not_break_the_report(self):
        name = os.path.join(os.fsencode(self.folder), b"caf\xe9")
        with open(name, "w"):
            pass
        result = subprocess.run([PROBE, name, "--json", "-"], capture_output=True, timeout=300)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("caf\ufffd", json.loads(result.stdout.decode())["input"])

    def unfinished(self):
        return glob.glob(glob.escape(self.path("out.")) + "*.partial")

    def test_alone_it_starts_no_daemon(self):
        process = self.asleep_over_its_output(1)
        with open(f"/proc/{process.pid}/task/{process.pid}/children", encoding="ascii") as file:
            children = file.read().split()
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=300)
        self.assertEqual(children, [])

    def wait_until(self, condition, seconds=300):
        until = time.monotonic() + seconds
        while not condition() and time.monotonic() < until:
            time.sleep(0.05)
        self.assertTrue(condition())

    def asleep_over_its_output(self, ranks):
        before = self.unfinished()
        process = subprocess.Popen(command(ranks, ["-o", self.path("out"), "--how", "sleep"]),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_until(lambda: set(self.unfinished()) - set(before))
        return process

    def test_an_interrupt_removes_the_temporary_output(self):
        for ranks in (1, 3):
            for number in (signal.SIGINT, signal.SIGTERM):
                process = self.asleep_over_its_output(ranks)
                process.send_signal(number)
                self.assertNotEqual(process.wait(timeout=300), 0)
                self.wait_until(lambda: not self.unfinished())
                self.assertEqual(os.listdir(self.folder), ["in put.txt"])

    def test_an_interrupt_gives_one_message_and_code_6(self):
        """mpirun hands SIGUSR1 on, with the exit code; after Ctrl-C its own exit code is 1 whatever the ranks say, which
        that of Open MPI 5 does not show any more."""
        said = "pamr-probe: interrupted: outputs that were not complete are removed\n"
        for how, ranks, number, code in (("sleep", 1, signal.SIGINT, 6), ("sleep", 1, signal.SIGTERM, 6), ("sleep", 3, signal.SIGUSR1, 6),
                                         ("sleep", 3, signal.SIGINT, 1), ("sleep-deeply", 3, signal.SIGINT, 1)):
            process = subprocess.Popen(command(ranks, ["-o", self.path("out"), "--how", how]), stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            self.wait_until(self.unfinished)
            process.send_signal(number)
            out, err = process.communicate(timeout=300)
            self.assertEqual((process.returncode, out), (code, ""), (how, ranks, number, err))
            is_shown = not (IS_OPEN_MPI_5 and ranks > 1 and number == signal.SIGINT)
            self.assertIn(err.count(said), (1,) if is_shown else (0, 1), (how, ranks, number, err))
            self.wait_until(lambda: not self.unfinished())

    def test_signals_in_a_row_give_one_message(self):
        process = subprocess.Popen(command(3, ["-o", self.path("out"), "--how", "sleep"]), stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.wait_until(self.unfinished)
        with open(f"/proc/{process.pid}/task/{process.pid}/children", encoding="ascii") as file:
            ranks = [int(child) for child in file.read().split() if os.path.samefile(f"/proc/{child}/exe", PROBE)]
        self.assertEqual(len(ranks), 3)
        for number in (signal.SIGUSR1, signal.SIGTERM):
            for rank in ranks:
                os.kill(rank, number)
            time.sleep(0.1)
        _, err = process.communicate(timeout=300)
        self.assertEqual(err.count("interrupted: "), 1, err)

    def test_a_hangup_ends_it_unless_it_is_ignored(self):
        for before, code in ((signal.SIG_DFL, 6), (signal.SIG_IGN, None)):
            process = subprocess.Popen([PROBE, "-o", self.path("out"), "--how", "sleep"], stderr=subprocess.DEVNULL,
                                       preexec_fn=lambda: signal.signal(signal.SIGHUP, before))  # nohup
            self.wait_until(self.unfinished)
            process.send_signal(signal.SIGHUP)
            if code is None:
                self.assertRaises(subprocess.TimeoutExpired, process.wait, 0.5)
                process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(timeout=300), 6)
            self.assertEqual(os.listdir(self.folder), ["in put.txt"])

    def on_terminal(self, ranks, how):
        """What a terminal gets of standard error."""
        main, end = os.openpty()
        process = subprocess.Popen(command(ranks, ["--how", how]), stdout=subprocess.DEVNULL, stderr=end)
        os.close(end)
        text = b""
        while True:
            try:
                part = os.read(main, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            text += part
            if how == "step" and b"0:02" in text or how == "progress-cut" and b"walking: 1 of" in text:
                process.send_signal(signal.SIGTERM)
                how = "ended"
        os.close(main)
        process.wait(timeout=300)
        return text

    def assert_progress_is_a_bar_on_a_terminal(self, ranks):
        if ranks > 1 and IS_OPEN_MPI_5:  # a line that is not complete would not be seen
            self.assertNotIn(b"\r", self.on_terminal(ranks, "progress"))
            return
        text = self.on_terminal(ranks, "progress")
        self.assertRegex(text, rb"\r\x1b\[K\[#+\.+\] walking: \d+ of 40 steps \(\d+ %\), [0-9.]+ steps/s, 0:0\d left, uphill")
        self.assertGreater(text.count(b"walking"), 5)
        text = self.on_terminal(ranks, "step")
        self.assertIn(b"\r\x1b[Kresting 7 cells, 0:01\r\x1b[Kresting 7 cells, 0:02", text)
        text = self.on_terminal(ranks, "progress-cut")
        self.assertRegex(text, rb"uphill\r\x1b\[Kpamr-probe: interrupted")

    def test_progress_is_a_bar_on_a_terminal(self):
        self.assert_progress_is_a_bar_on_a_terminal(1)

    def test_progress_is_a_bar_on_a_terminal_also_under_mpirun(self):
        self.assert_progress_is_a_bar_on_a_terminal(3)

    def assert_long_steps_are_lines_elsewhere(self, ranks):
        result = run(ranks, "--how", "step")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(result.stderr.startswith("resting 7 cells, 0:10\n"), result.stderr)  # a slow machine says 0:20 too
        self.assertEqual(run(ranks, "--how", "step", "--quiet").stderr, "")

    def test_long_steps_are_lines_elsewhere(self):
        self.assert_long_steps_are_lines_elsewhere(1)

    def test_long_steps_are_lines_elsewhere_on_3_ranks(self):
        self.assert_long_steps_are_lines_elsewhere(3)

    def test_long_summaries_go_on_in_the_next_line(self):
        lines = run(1, "--how", "long").stdout.splitlines()[:-1]
        self.assertGreater(len(lines), 3)
        self.assertTrue(all(len(line) <= 160 for line in lines), lines)
        self.assertTrue(all(line.startswith("  part ") for line in lines[1:]), lines)
        self.assertEqual(" ".join(line.strip() for line in lines), "done, " + ", ".join(f"part {i}" for i in range(60)) + "; end")

    def test_what_killed_runs_left_goes_and_what_others_write_stays(self):
        killed = self.asleep_over_its_output(1)
        killed.kill()
        killed.wait()
        left, = self.unfinished()
        alive = self.asleep_over_its_output(1)  # removes what the killed one has left
        writing, = self.unfinished()
        self.assertNotEqual(left, writing)
        mine = self.path("out.partial")  # no such name, whatever it looks like
        with open(mine, "w") as file:
            file.write("precious")
        for ranks in (1, 3):
            self.assertEqual(run(ranks, self.input, "-o", self.path("out"), "--force").returncode, 0)
            self.assertEqual(self.unfinished(), [writing])
        with open(mine) as file:
            self.assertEqual(file.read(), "precious")
        alive.kill()
        alive.wait()
        os.rename(writing, writing.replace("out.", "other."))  # left of another output
        self.assertEqual(run(1, self.input, "-o", self.path("out"), "--force").returncode, 0)
        self.assertEqual(len(os.listdir(self.folder)), 4)

    def test_a_leftover_that_is_an_input_stays(self):
        killed = self.asleep_over_its_output(1)
        killed.kill()
        killed.wait()
        left, = self.unfinished()
        for ranks in (1, 3):
            self.assertEqual(run(ranks, left, "-o", self.path("out"), "--force").returncode, 0)
            self.assertTrue(os.path.exists(left))

    def test_messages_have_no_control_characters(self):
        for ranks in (1, 3):
            self.assert_error_once(run(ranks, "--how", "wild-error"), 2, r"found \x1b[31m red \x0d\n and \x7f \x9b 2J, café")
            self.assertEqual(run(ranks, "--how", "warn").stderr, "pamr-probe: warning: a file named a\\nb\\x1b\n")

    def test_the_working_folder_may_be_gone(self):
        # of the processes of the tool: what starts them needs one
        gone = 'here=$(mktemp -d) && cd "$here" && rmdir "$here" && exec "$@"'
        for ranks in (1, 3):
            def run_there(*arguments):
                return subprocess.run(MPIEXEC + [str(ranks), "sh", "-c", gone, "sh", PROBE] + list(arguments),
                                      capture_output=True, text=True, timeout=300)
            result = run_there(self.input, "-o", self.path("out"), "--force", "--json", self.path("report.json"))
            self.assertEqual(result.returncode, 0, result.stderr)
            result = run_there("-o", "out")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("pamr-probe: error: ", result.stderr)
            self.assertIn("No such file or directory", result.stderr)


def run_side_by_side(tests, at_once):
    """Several tests at a time: nearly all that they do is to wait for processes. True if all of them pass."""
    def run_one(test):
        begin, result = time.monotonic(), unittest.TestResult()
        test.run(result)
        return test, result, time.monotonic() - begin
    passed = True
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        for test, result, seconds in pool.map(run_one, tests):
            print(f"{'ok    ' if result.wasSuccessful() else 'FAILED'}  {test.id().split('.')[-1]} ({seconds:.1f} s)")
            for _, text in result.failures + result.errors:
                print(text)
            passed = passed and result.wasSuccessful() and result.testsRun == 1
    return passed


if __name__ == "__main__":
    sys.exit(0 if run_side_by_side(unittest.defaultTestLoader.loadTestsFromTestCase(LifeOfATool), at_once=5) else 1)
