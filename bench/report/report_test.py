# SPDX-License-Identifier: GPL-3.0-or-later
"""report.sh without other codes, what it refuses and names, whether it finds out codes that do other work, and the
arithmetic of its rows. Usage: report_test.py REPORT.SH BUILD"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

REPORT, BUILD = map(pathlib.Path, sys.argv[1:3])
sys.path[:0] = [str(REPORT.parent / "report"), str(REPORT.parent / "compare")]
import assess  # noqa: E402
import measure  # noqa: E402
import peers  # noqa: E402
import report  # noqa: E402
import rows  # noqa: E402
import tables  # noqa: E402
import tool_tables  # noqa: E402
import workload  # noqa: E402
import numpy as np  # noqa: E402

NO_PEERS = {
    **os.environ,
    "PAMR_PYTHON": sys.executable,
    "PAMR_PEER_PYTHON": "/nowhere/python3",
    "PAMR_PEER_CXX": "/nowhere/mpicxx",
}


def rows_of(text):
    lines = [line for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if not line.startswith("|--")]


def run_report(*arguments):
    return subprocess.run(
        [REPORT, BUILD, *map(str, arguments)], env=NO_PEERS, capture_output=True, text=True, timeout=600, check=False
    )


class Report(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_measures_ours_names_what_is_missing_and_goes_on_where_it_ended(self):
        places = ("--tiny", "--out", self.folder, "--peer-folder", self.folder / "peers")
        uniform = run_report(*places, "--table", "uniform")
        self.assertEqual(uniform.returncode, 0, uniform.stderr)
        head, ours = rows_of(uniform.stdout)
        self.assertEqual(ours[head.index("cells out")], "10,368")
        self.assertEqual(ours[head.index("cells split")], "1,296")
        self.assertGreater(float(ours[head.index("CPU s")]), 0)
        self.assertRegex(
            uniform.stdout, r"commit .*, `limit` [\d.]+, load [\d.]+ before and [\d.]+ after. "
            "Command: `bench/report.sh --tiny"
        )
        for name, entry in peers.listed().items():
            self.assertEqual(f"- {name}: " in uniform.stdout, "uniform" in entry["takes"], name)

        table = self.folder / "tiny/uniform.md"
        table.write_text(table.read_text() + "kept\n")
        both = run_report(*places, "--peers", "", "--table", "uniform", "--table", "front")
        self.assertEqual(both.returncode, 0, both.stderr)
        self.assertIn("kept", both.stdout)
        self.assertEqual([row[2] for row in rows_of(both.stdout) if row[1] == "red"], ["yes", "3"])
        self.assertNotIn("kept", run_report(*places, "--peers", "", "--table", "uniform", "--again").stdout)

    def test_the_way_from_file_to_file_has_every_step_and_the_copy(self):
        files = run_report("--tiny", "--out", self.folder, "--table", "files")
        self.assertEqual(files.returncode, 0, files.stderr)
        wall = {row[0]: float(row[1]) for row in rows_of(files.stdout)[1:]}
        steps = sum(wall[name] for name in ("read", "close", "number", "subdivide", "relink", "write"))
        self.assertLess(0, steps)
        self.assertLess(steps, wall["all steps"])
        self.assertLess(wall["all steps"], wall["the process"])
        self.assertLess(0, wall["copying the file"])
        self.assertEqual(list(self.folder.glob("tiny/*.hdf")), [])

    def test_refuses_what_it_does_not_know(self):
        for arguments in (["--no-such-option"], ["--peers", "nobody"], ["--table", "none"], ["/nowhere/build"]):
            run = run_report(*arguments)
            self.assertEqual(run.returncode, 2, arguments)
            self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
            self.assertEqual(run.stdout, "")

    def test_every_table_has_a_page_with_a_place_for_it(self):
        for name, table in tables.TABLES.items():
            page = REPORT.parent.parent / "docs/reports" / f"{table.page}.md"
            for mark in ("table", "end of table"):
                self.assertEqual(page.read_text().count(f"<!-- {mark} {name} -->\n"), 1, f"{mark} {name} in {page}")

    def test_tables_go_between_their_marks_only(self):
        page = "a\n<!-- table x -->\nold\n<!-- end of table x -->\nb\n"
        new = report.insert({"x": "| new |\n", "y": "none"}, page)
        self.assertEqual(new, "a\n<!-- table x -->\n\n| new |\n\n<!-- end of table x -->\nb\n")
        self.assertEqual(report.insert({"x": "| new |\n"}, new), new)


class Folding(unittest.TestCase):
    def test_pages_name_no_folder_of_the_machine(self):
        context = argparse.Namespace(out=pathlib.Path("/a/build/report"), build=pathlib.Path("/a/build"))
        text = f"-> /a/build/report/x.hdf by /a/build/bin/y and {report.ROOT}/bench/z"
        self.assertEqual(report.without_folders(text, context), "-> OUT/x.hdf by BUILD/bin/y and PAMR/bench/z")

    def test_steps_of_adapting_are_compared_with_those_of_one_rank(self):
        def line(compute):
            return (
                "2478 -> 2470 -> 2724806 cells, 58 marked, 3 octets gone, 556 needed, 0 closed, 160 moved to "
                f"siblings, 2560 to balance: 0.02 us a cell here, {compute} outside of communication on all ranks, "
                "0.29 s, 136 bytes a cell; preprocessing 0.012 close 0.024"
            )

        runs = [[line(compute)] for compute in (0.9, 0.1, 0.125)]
        one, four = list(tables.adapt_rows({1: [line(0.1)], 4: tables.middle_lines(runs)}))
        self.assertEqual(one[:11], ["1", "1", "2,478", "2,470", "2,724,806", "58", "3", "160", "2,560", "0.1", "1.00"])
        self.assertEqual(four[1], "4")
        self.assertEqual(four[10:], ["1.25", "0.012", "-", "-", "0.024", "-", "-", "-", "-", "-", "136"])

    def test_balance_has_a_row_for_each_mesh_and_number_of_ranks(self):
        def row(asked, given, faces):
            return f"| cone | 4 | {asked} | {given} | {faces} | 1.58 | 3 | 1.024 | 0.0481 | 0.001 | 0 | no |"

        ways = zip(tables.BALANCE_WAYS, ("none", "curve", "none", "curve", "blocks"), (1632, 1720, 936, 8, 9))
        lines = ["text", "| mesh | parts |", *(row(*way) for way in ways)]
        head, _, only = tables.folded_balance(lines)
        self.assertIn("| as read | `auto` | `scotch` |", head)
        self.assertEqual(
            only,
            "| cone | 4 | 1,632 (1.58), 3, 1.024 | curve: 1,720 (1.58), 3, 1.024, 0.048 s |"
            " kept: 936 (1.58), 3, 1.024 | 8 (1.58), 3, 1.024, 0.048 s | 9 (1.58), 3, 1.024, 0.048 s |",
        )


class SlowCodes(unittest.TestCase):
    def levels(self, program, seconds):
        return measure.levels_of_peer([sys.executable, "-c", program], seconds=seconds)

    def test_keep_the_levels_that_they_came_to_and_are_ended_with_what_they_have_started(self):
        program = (
            "import subprocess, sys\nprint('{\"level\": 1}', flush=True)\nprint('{\"lev', end='', flush=True)\n"
            "subprocess.run([sys.executable, '-c', 'import time; time.sleep(600)'])"  # its pipes stay open
        )
        self.assertEqual(self.levels(program, 5), ({1: {"level": 1}}, True))

    def test_that_cannot_be_started_have_failed(self):
        with self.assertRaisesRegex(measure.Failed, "nowhere"):
            measure.levels_of_peer(["/nowhere/python3"])

    def test_are_not_ended_in_time_and_fail_with_their_last_word(self):
        self.assertEqual(self.levels("print('{\"level\": 2}')", 60), ({2: {"level": 2}}, False))
        with self.assertRaisesRegex(measure.Failed, "code 3: no mesh"):
            self.levels("import sys; print('no mesh', file=sys.stderr); sys.exit(3)", 60)


class Assessment(unittest.TestCase):
    def setUp(self):
        cells, nodes = workload.kuhn_cube(2)
        self.corners = nodes[cells]

    def test_a_mesh_that_is_whole_has_the_volume_and_no_open_face(self):
        values, _ = assess.assess(self.corners, "cube", None)
        self.assertAlmostEqual(values["volume"], 1, 12)
        self.assertEqual(values["open"], 0)
        self.assertAlmostEqual(values["worst"], 12 * 0.5 ** (2 / 3) / 10, 12)  # squared edges 1 1 1 2 2 3

    def test_a_hanging_node_is_found(self):
        _, before = assess.assess(self.corners, "cube", None)
        middle = 0.5 * (self.corners[20, 0] + self.corners[20, 3])
        halves = np.repeat(self.corners[20:21], 2, axis=0)
        halves[0, 0], halves[1, 3] = middle, middle
        values, _ = assess.assess(np.concatenate([np.delete(self.corners, 20, axis=0), halves]), "cube", before)
        self.assertAlmostEqual(values["volume"], 1, 12)
        self.assertEqual(values["split"], 1)
        self.assertGreater(values["open"], 0)

    def test_an_inner_face_with_all_nodes_on_a_curved_wall_is_not_open(self):
        wall, ends = np.eye(3), np.array([[0.5, 0.5, 0.5], [1.5, 1.5, 1.5]])
        two = np.stack([np.vstack([wall, end]) for end in ends])
        self.assertEqual(assess.open_faces(two, "hole"), 3)  # those of the outer cell, with a node off the wall

    def test_a_code_that_does_other_work_is_found_out(self):
        work = measure.Work("sphere", "", "", "", ())
        ours = {1: {"cells": 1000}}
        good = {"cells": 2000, "volume": 1.0, "open": 0}
        conforming, hanging = {"algorithm": "bisection"}, {"algorithm": "nonconforming"}
        self.assertIsNone(measure.doubt(work, conforming, {1: good}, ours))
        self.assertIn("volume", measure.doubt(work, conforming, {1: {**good, "volume": 1 + 1e-6}}, ours))
        self.assertIn("3 faces", measure.doubt(work, conforming, {1: {**good, "open": 3}}, ours))
        self.assertIsNone(measure.doubt(work, hanging, {1: {**good, "open": 3}}, ours))
        for cells in (300, 7000):
            self.assertIn("beside our", measure.doubt(work, conforming, {1: {**good, "cells": cells}}, ours))

    def test_both_languages_find_the_same(self):
        text = measure.output_of([BUILD / "bench/bench_peer", "uniform", "kuhn:2", "1", "assess"], tables.environment())
        values, _ = assess.assess(self.corners, "cube", None)
        row = measure.lines_by_level(text)[0]
        for name, value in values.items():
            self.assertAlmostEqual(row[name], value, 6, name)

    def test_ours_is_found_to_be_whole(self):
        for law, mesh, *levels in (
            ("shell", "kuhn:5", "1"),
            (tables.SPHERE, "kuhn:4", "2"),
            ("front", "kuhn:4", "2", "2"),
        ):
            found = measure.lines_by_level(
                measure.output_of([BUILD / "bench/bench_peer", law, mesh, *levels, "assess"], tables.environment())
            )
            for row in found.values():
                self.assertAlmostEqual(row["volume"], 1, 9)
                self.assertEqual(row["open"], 0)

    def test_rows_take_medians_and_ratios(self):
        theirs = {
            1: {
                "peer": "other 1",
                "cells": 2000,
                "split": 250,
                "peak": 4e5,
                "worst": 0.5,
                "low": 0.6,
                "relate_cpu": 1.0,
            }
        }
        runs = [{1: {"cpu": cpu}} for cpu in (3.0, 9.0, 4.0)]
        ours = {1: {"peer": "PAMR", "cells": 1000, "split": 100, "cpu": 0.1, "peak": 6e4, "worst": 0.7, "low": 0.7}}
        pair = measure.Pair("other", theirs, measure.medians(runs), {1: 0.1}, 20.0, 3, 1.5)
        entries = {"other": {"algorithm": "bisection", "neighbors": "apart"}}
        found = dict(zip(rows.REFINE_HEAD, list(rows.refine_rows(ours, [pair], entries, "uniform"))[1]))
        self.assertEqual(found["CPU s"], "4")
        self.assertEqual(found["theirs / ours: a cell out"], "20")
        self.assertEqual(found["a cell split"], "16")
        self.assertEqual(found["with neighbors: a cell out"], "25")
        self.assertEqual(found["bytes a cell out"], "200")
        other = dict(zip(rows.REFINE_HEAD, list(rows.refine_rows(ours, [pair], entries, "sphere"))[1]))
        self.assertEqual(other["theirs / ours: a cell out"], "(20)")

    def test_rows_of_the_wall_tell_the_first_call_from_the_others(self):
        def levels(peer, cells):
            shape = {"worst": 0.4, "low": 0.5, "wall_nodes": 9, "off": 3, "farthest": 0.1, "volume": measure.HOLE_VOLUME}
            return {n: {"peer": peer, "cells": cells, "peak": 1e5, "cpu": 1.0, **shape} for n in (1, 2)}

        ours = levels("PAMR", 1000)
        pair = measure.Pair("other", levels("other 1", 2000), {1: 2.0, 2: 12.0}, {1: 0.6, 2: 0.1}, 20.0, 1, 1.5)
        entries = {"other": {"algorithm": "red", "surface": "nobody"}}
        found = dict(zip(rows.WALL_HEAD, list(rows.wall_rows(ours, [pair], entries))[1]))
        self.assertEqual((found["CPU s of all levels"], found["ours, in turn"]), ("14", "0.7"))
        self.assertEqual(found["theirs / ours: a cell out"], "10")
        self.assertEqual(found["the same from level 2 on"], "60")
        self.assertEqual((found["off it"], found["volume, relative error"]), ("3", "0"))

    def test_rows_of_the_front_add_up_the_steps(self):
        def steps(peer, cells, gone):
            row = {"peer": peer, "cells": cells, "split": gone, "calls": 2, "peak": 2e5, "worst": 0.4, "low": 0.5}
            return {n: {**row, "cpu": 0.5} for n in (1, 2)}

        ours = steps("PAMR", 1000, 100)
        pair = measure.Pair("other", steps("other 1", 2000, 50), {1: 3.0, 2: 5.0}, {1: 0.5, 2: 0.5}, 20.0, 1, 1.5)
        found = dict(zip(rows.FRONT_HEAD, list(rows.front_rows(ours, [pair], {"other": {"algorithm": "red"}}))[1]))
        self.assertEqual((found["steps"], found["calls"], found["CPU s"]), ("2", "4", "8"))
        self.assertEqual((found["theirs / ours: a cell out"], found["a cell gone"]), ("4", "16"))

        ended = measure.Pair("other", {1: pair.theirs[1]}, {1: 3.0}, {1: 0.5, 2: 9.0}, 20.0, 1, 1.5, was_ended=True)
        found = dict(zip(rows.FRONT_HEAD, list(rows.front_rows(ours, [ended], {"other": {"algorithm": "red"}}))[1]))
        self.assertEqual((found["steps"], found["CPU s"], found["ours, in turn"]), ("1", "3", "0.5"))
        self.assertEqual(found["theirs / ours: a cell out"], "3")

    def test_rows_of_parts_have_ratios_for_all_and_for_a_cell(self):
        def runs(cells, *seconds):
            return [{"cells": cells, "cpu": cpu, "worst": 0.2, "mean": 0.8} for cpu in seconds]

        codes = {"PAMR": runs(1000, 1.0, 2.0, 9.0), "other": runs(500, 4.0)}
        ours, theirs = (dict(zip(tool_tables.CAD_HEAD, row)) for row in tool_tables.cad_rows("p", 0.5, codes, 20.0, 1.5))
        self.assertEqual((ours["CPU s"], ours["a cell"], ours["runs"]), ("2", "1", "3"))
        self.assertEqual((theirs["theirs / ours: CPU s"], theirs["a cell"]), ("(2)", "(4)"))


unittest.main(argv=sys.argv[:1])
