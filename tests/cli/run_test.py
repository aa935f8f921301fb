#!/usr/bin/python3 -IB
"""run and table: suites, sweeps, filters, shards, and the comparison table in every format."""

import csv
import io
import json
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, NUMBERS, ProgramTest, measured, records, what  # noqa: E402

SUITE = """
title = "Two scenes, three rows each"
width = 160
height = 90
processes = 1
repetitions = 2

[[group]]
scenes = ["single_triangle", "soup:count=50"]
lights = ["point"]
techniques = ["unshadowed", "embree_rays", { use = "shadow_map:resolution=256", label = "coarse" }]
"""
SWEEP = [*HARD, "--scene", "single_triangle", "--technique", "shadow_map:resolution={256,512}", "--technique", "unshadowed"]


class Run(ProgramTest):
    def test_views_are_named_and_tell_rows_apart(self):
        call = ["run", "--scene", "fence", "--scene", "contact", "--light", "sun", "--technique", "unshadowed", *NUMBERS]

        def titles(*words):
            return re.findall(r"(?m)^[0-9a-f]{16}  (.*)$", self.succeed(*call, "--dry-run", *words))

        self.assertEqual(titles(), ["fence sun unshadowed", "contact sun unshadowed"])
        self.assertEqual(titles("--view", "*"), ["fence sun unshadowed", "fence sun low unshadowed", "contact sun unshadowed",
                                                 "contact sun close unshadowed"])
        self.assertEqual(titles("--view", "v*"), ["fence sun unshadowed", "contact sun unshadowed"])
        call = call[:3] + call[5:]  # fence alone
        self.assertEqual(titles("--view", "low,view"), ["fence sun low unshadowed", "fence sun unshadowed"])
        self.assertEqual(titles("--view", "low", "--view", "l*"), ["fence sun low unshadowed"])
        self.assertEqual(titles("--view", "*", "--filter", " low "), ["fence sun low unshadowed"])
        self.refuse(*call, "--view", "lwo", says=["no view lwo", "did you mean low", "view, low"])
        self.refuse(*call, "--view", "z*", says=["no view whose name is like z*", "view, low"])
        self.refuse(*call, "--view", "", says=["--view"])
        self.succeed(*call, "--view", "*", "--out", "out", "--quiet")
        self.assertEqual([row["view"] for row in records(self.dir / "out")], ["view", "low"])

    def test_a_suite_file_gives_one_record_for_each_row(self):
        text = self.succeed("run", self.write("mine.toml", SUITE), "--out", "out")
        rows = records(self.dir / "out")
        self.assertEqual([(r["scene"], r["technique"]) for r in rows],
                         [(s, t) for s in ("single_triangle", "soup:count=50") for t in ("unshadowed", "embree_rays", "shadow_map")])
        for row in rows:
            self.assertEqual((row["suite"], row["status"], row["light"], row["width"]), ("mine", "ok", "point", 160))
            self.assertEqual([len(process) for process in row["stages"]["resolve"]], [2])
            for key in ("mask", "error_picture", "shaded_picture"):
                self.assertTrue((self.dir / "out" / row[key]).is_file())
        self.assertEqual({r["label"] for r in rows}, {None, "coarse"})
        self.assertRegex(text, r"(?m)^6 rows: 6 ok, 0 unsupported, 0 failed;")
        self.assertLessEqual({"table.md", "table.csv", "table.tex", "table.json", "records.jsonl"}, set(self.names(self.dir / "out")))
        self.assertFalse((self.dir / "out/.scratch").exists())

    def test_without_pictures_all_numbers_are_the_same(self):
        suite = self.write("mine.toml", SUITE)
        self.assertIn("out/masks/", self.succeed("run", suite, "--out", "out"))
        self.assertNotIn("masks/", self.succeed("run", suite, "--out", "bare", "--pictures", "none"))
        self.assertEqual([name for name in self.names(self.dir / "bare") if "/" in name], [])
        without = dict(mask=None, error_picture=None, shaded_picture=None)
        self.assertEqual([measured(r) for r in records(self.dir / "bare")], [dict(measured(r), **without) for r in records(self.dir / "out")])

        kept = (self.dir / "bare/records.jsonl").read_bytes()
        done = self.gnomon("table", "bare", "--rescore")
        self.assertEqual((done.returncode, done.stderr), (0, "6 rows keep their metrics: they were run with --pictures none\n0 rows rescored\n"))
        self.assertEqual((self.dir / "bare/records.jsonl").read_bytes(), kept)
        self.succeed("report", "bare")
        # What goes on may have pictures from there on, and rows that have them stay.
        self.succeed("run", suite, "--out", "half", "--filter", "single")
        self.succeed("run", suite, "--out", "half", "--resume", "--pictures", "none")
        self.assertEqual([r["mask"] is None for r in records(self.dir / "half")], [False] * 3 + [True] * 3)
        self.assertIn("3 rows keep their metrics: they were run with --pictures none\n", self.gnomon("table", "half", "--rescore").stderr)
        for word in ("some", "", "None"):
            self.refuse("run", suite, "--pictures", word, says=["--pictures", "all or masks or none"])

    def test_shaders_that_are_kept_are_said(self):
        call = ["run", "--scene", "single_triangle", "--light", "sun", "--technique", "shadow_map", *NUMBERS, "--quiet"]
        self.environment["GNOMON_SHADERS"] = "keep"
        self.assertRegex(self.succeed(*call, "--out", "kept"), r"(?m)^shaders: kept for 1 row: their setup compiles none$")
        self.environment["GNOMON_SHADERS"] = "kept"
        self.refuse(*call, "--out", "out", says=["GNOMON_SHADERS = kept is not keep"])
        del self.environment["GNOMON_SHADERS"]
        self.assertNotIn("shaders", self.succeed(*call, "--out", "out"))
        self.assertEqual([records(self.dir / out)[0]["context"].get("shaders") for out in ("kept", "out")], ["kept", None])

    def test_a_table_says_where_float32_cannot_decide(self):
        lights = "".join(f'[[light]]\nname = "{name}"\nkind = "point"\nposition = {place}\n' for name, place in (("far", [0, 1e8, 1]), ("near", [1, 4, 1])))
        scene = self.write("lights.toml", f'scene = "single_triangle"\n{lights}')
        text = self.succeed("run", "--scene", scene, "--technique", "exact_rays", *NUMBERS, "--out", "out")
        (line,) = [line for line in text.splitlines() if line.startswith("uncertain: ")]
        self.assertRegex(line, r"float32 cannot decide [0-9.]+ % .*\(class U\): .*, light far, view \w+; the scene is outside what the reference can decide")
        far, near = records(self.dir / "out")
        self.assertEqual((far["classes"]["T"], near["classes"]["U"]), (0, 0))
        self.assertIn(line[len("uncertain: "):].split(";")[0], self.succeed("table", "out", "--format", "md"))

    def test_scenes_of_any_size_have_a_reference(self):
        for size in (1e-18, 1e-12, 1.0, 1e15):
            scene = self.write(f"size{size}.toml", "".join((
                f'[[shape]]\nkind = "plane"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [{8 * size}, {8 * size}]\n',
                f'[[shape]]\nkind = "sphere"\ncenter = [0, {1.5 * size}, 0]\nradius = {size}\n',
                f'[[light]]\nname = "lamp"\nkind = "point"\nposition = [{size}, {6 * size}, {size}]\n',
                f'[[view]]\nname = "view"\neye = [{2 * size}, {5 * size}, {7 * size}]\ntarget = [0, {0.5 * size}, 0]\n')))
            with self.subTest(size):
                self.assertIn(": certified", self.succeed("certify", "--scene", scene, "--size", "96x54"))
                self.succeed("run", "--scene", scene, "--technique", "exact_rays", *NUMBERS, "--truth", "mesh", "--out", f"out{size}")
                (row,) = records(self.dir / f"out{size}")
                self.assertEqual(row["metrics"]["mesh"]["wrong_rate"], 0)
                self.assertGreater(row["classes"]["T"], 5000)

    def test_braces_sweep_a_parameter(self):
        self.succeed("run", *SWEEP, *NUMBERS, "--out", "out")
        self.assertEqual([(r["light"], r["technique"], r["settings"]) for r in records(self.dir / "out")],
                         [(light, *technique) for light in ("point", "sun")
                          for technique in (("shadow_map", "resolution=256"), ("shadow_map", "resolution=512"), ("unshadowed", ""))])

    def test_filter_picks_rows(self):
        self.succeed("run", *SWEEP, *NUMBERS, "--filter", "sun shadow_map:.*=512$", "--out", "out")
        self.assertEqual([(r["light"], r["settings"]) for r in records(self.dir / "out")], [("sun", "resolution=512")])

    def test_dry_run_prints_rows_and_leaves_nothing(self):
        text = self.succeed("run", *SWEEP, "--dry-run", "--out", "out")
        self.assertEqual(len(re.findall(r"(?m)^[0-9a-f]{16}  single_triangle (point|sun) ", text)), 6)
        self.assertRegex(text, r"(?m)^6 rows, ")
        self.succeed("run", *SWEEP, "--dry-run")
        self.assertEqual(list(self.dir.iterdir()), [])

    def test_size_comes_before_the_sizes_of_groups(self):
        suite = self.write("mine.toml", SUITE.replace("lights =", 'sizes = ["64x36", "32x18"]\nlights ='))
        self.assertIn("\n12 rows, 1 process x 2 repetitions each, 64x36, 32x18 pixels\n", self.succeed("run", suite, "--dry-run"))
        self.assertIn("\n6 rows, 1 process x 2 repetitions each, 48x27 pixels\n",
                      self.succeed("run", suite, "--size", "48x27", "--dry-run"))

    def test_several_processes_are_fresh_ones(self):
        self.succeed("run", "--scene", "single_triangle", "--technique", "shadow_map", "--light", "sun", "--size", "160x90",
                     "--processes", "3", "--repetitions", "2", "--out", "out")
        stages = records(self.dir / "out")[0]["stages"]
        self.assertEqual([len(p) for p in stages["setup"]], [1, 1, 1])
        self.assertEqual([len(p) for p in stages["relight"]], [2, 2, 2])

    def test_threads_reach_the_record(self):
        for threads, used in (("1", 1), ("0", len(os.sched_getaffinity(0)))):  # 0: all
            self.succeed("run", "--scene", "single_triangle", "--technique", "unshadowed", "--light", "sun", *NUMBERS,
                         "--threads", threads, "--out", f"out{threads}")
            self.assertEqual(records(self.dir / f"out{threads}")[0]["context"]["threads"], used)

    def test_without_out_the_folder_is_named_after_suite_and_time(self):
        self.succeed("run", "--scene", "single_triangle", "--technique", "unshadowed", "--light", "sun", *NUMBERS)
        self.assertRegex(" ".join(p.name for p in (self.dir / "runs").iterdir()), r"^adhoc-\d{8}-\d{6}$")


class Table(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dir = cls.home
        cls.succeed(cls(), "run", *SWEEP, *NUMBERS, "--out", "out")

    def table(self, *arguments):
        return self.succeed("table", self.home / "out", *arguments)

    def test_csv_has_one_line_for_each_row(self):
        rows = list(csv.DictReader(io.StringIO(self.table("--format", "csv"), newline="")))
        self.assertEqual([r["job"] for r in rows], [r["job"] for r in records(self.home / "out")])
        for row, record in zip(rows, records(self.home / "out")):
            self.assertEqual(float(row["wrong_rate"]), record["metrics"]["shape"]["wrong_rate"])
            self.assertEqual(float(row["resolve_ms"]), record["stages"]["resolve"][0][0])

    def test_json_names_the_same_values(self):
        table = json.loads(self.table("--format", "json"))
        self.assertEqual(table["schema"], "gnomon-table-1")
        self.assertEqual([r["job"] for r in table["rows"]], [r["job"] for r in records(self.home / "out")])

    def test_latex_needs_nothing_but_booktabs(self):
        text = self.table("--format", "tex", "--caption", "Shadows & costs")
        self.assertLessEqual({"toprule", "midrule", "bottomrule"}, set(re.findall(r"\\([A-Za-z]+)", text)))
        plain = {"begin", "end", "caption", "centering", "label", "textbf", "multicolumn", "smallskip", "footnotesize", "small",
                 "toprule", "midrule", "bottomrule", "cmidrule", "addlinespace", "emph", "texttt", "setlength", "tabcolsep",
                 "mathrm", "times", "scriptsize", "par", "newline", "textwidth", "resizebox", "textasciitilde", "raggedright",
                 "medskip", "noindent", "textsuperscript"}
        self.assertEqual(set(re.findall(r"\\([A-Za-z]+)", re.sub(r"(?m)^%.*", "", text))) - plain, set())
        self.assertIn(r"Shadows \& costs", text)
        self.assertEqual(text.count(r"\begin{"), text.count(r"\end{"))

    def test_markdown_rows_have_equal_cells(self):
        rows = [line for line in self.table("--format", "md").splitlines() if line.startswith("|")]
        self.assertGreaterEqual(len(rows), 6)
        self.assertIn("shadow_map:resolution=256", " ".join(rows).replace("\\_", "_"))
        blocks = {line.count("|") for line in rows}
        self.assertEqual(len(blocks), 1, rows)

    def test_the_terminal_is_the_default(self):
        self.assertEqual(self.table(), self.table("--format", "terminal"))

    def test_columns_are_chosen_and_ordered(self):
        self.assertEqual(self.table("--format", "csv", "--columns", "technique,wrong_rate,light").splitlines()[0],
                         "technique,wrong_rate,light")
        self.assertIn("parameter.resolution", self.table("--columns", "list").splitlines())

    def test_the_folder_of_the_run_holds_the_same_tables(self):
        for name in ("md", "csv", "tex", "json"):
            self.assertEqual((self.home / f"out/table.{name}").read_bytes().decode(), self.raw("--format", name))

    def raw(self, *arguments):
        """Standard output without Python's translation of line ends."""
        return subprocess.run(self.command("table", self.home / "out", *arguments), capture_output=True, check=True,
                              env=self.environment).stdout.decode()


if __name__ == "__main__":
    unittest.main()
