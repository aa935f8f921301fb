#!/usr/bin/python3 -IB
"""Tables that fit: no line is longer than the terminal, and headings are names of columns."""

import csv
import io
import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, HARD, NUMBERS, ROOT, ProgramTest  # noqa: E402

RESULTS = ROOT / "results"
SHIPPED = sorted(folder.parent for folder in RESULTS.glob("*/records.jsonl"))
ROWS = ["run", *HARD, "--scene", "contact", "--scene", "soup:ground=false,count=50", "--technique", "unshadowed", "--technique",
        "planar_projected", "--technique", "shadow_map:resolution={256,1024},filter=pcf,filter_radius=3,bias=receiver_plane,depth_bias=1.5",
        *NUMBERS, "--out"]


class Fit(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.small = cls.home / "small"
        small = cls("run_small")
        small.dir = cls.home
        cls.printed = small.succeed(*ROWS, cls.small, "--width", "80")

    def run_small(self):
        """Only a name to make a first instance with."""

    def assert_fits(self, text, columns):
        self.assertGreater(len(text.splitlines()), 2, text)
        for line in text.splitlines():
            self.assertLessEqual(len(line), columns, text)

    def fits(self, *arguments, columns=80, status=0):
        text = self.succeed(*arguments, "--width", str(columns), status=status)
        self.assert_fits(text, columns)
        return text

    def test_lists_fit(self):
        for what in ("techniques", "scenes", "suites", "metrics", "causes", "rules"):
            for columns in (80, 120, 200):
                with self.subTest(f"{what} {columns}"):
                    self.fits("list", what, columns=columns)

    def test_a_list_keeps_what_matters_and_names_what_it_leaves_out(self):
        text = self.fits("list")
        self.assertRegex(text.splitlines()[0], "^id +title +(role +)?(promise +)?summary$")
        self.assertRegex(" ".join(text.split()), "left out for want of room: ((role, )?promise, )?sees; --wide shows all$")
        self.assertEqual(self.succeed("list", "--wide"), self.succeed("list"))

    def test_descriptions_fit(self):
        techniques = [entry["id"] for entry in json.loads(self.succeed("list", "--json"))]
        for name in (*techniques, "soup:count=50", "leaf_cards", "glass_stack", "walking_boxes", "composite", "cornell_box"):
            with self.subTest(name):
                self.fits("describe", name)

    def test_checks_fit(self):
        rules = ["--rule", "data_sheet", "--rule", "same_mask", "--rule", "gl_state"]
        self.fits("check", "unshadowed", *rules)
        self.fits("--plugin", FAULTS, "check", "returns_nan", *rules, status=1)

    def test_what_a_run_prints_fits(self):
        self.assert_fits(self.printed, 80)
        self.assertIn("left out for want of room: ", self.printed)
        self.assertIn("gnomon table --columns", " ".join(self.printed.split()))

    def test_tables_of_kept_results_fit(self):
        for run in SHIPPED:
            for columns in (80, 120, 200) if run.name in ("quick", "lights", "glass") else (80,):
                with self.subTest(f"{run.name} {columns}"):
                    self.fits("table", run, columns=columns)

    def test_columns_that_are_named_are_all_there(self):
        names = ["technique", "setup_ms", "relight_ms", "resolve_ms", "resolve_ms_low", "resolve_ms_high", "bytes", "peak_bytes",
                 "wrong_rate", "wrong_rate_all", "false_dark_rate", "false_lit_rate", "error"]
        text = self.fits("table", self.small, "--columns", ",".join(names))
        self.assertNotIn("left out", text)
        self.assertGreaterEqual(len(re.findall("(?m)^-+$", text)), 2)  # a table below another
        self.assertEqual(len(re.findall("(?m)^technique ", text)), len(re.findall("(?m)^-+$", text)))

    def test_analyses_fit(self):
        for run, *kinds in ((self.small, "front --all", "best", "map", "growth --x resolution", "growth --x resolution --error error",
                             "sweep --x resolution"),
                            (RESULTS / "quick", "front", "best", "rank", "enough"),
                            (RESULTS / "lights", "forecast"),
                            (RESULTS / "seams", "seams"),
                            (self.small, "rank --all-pairs"),
                            (RESULTS / "animation", "motion", "front --cost motion")):
            for kind in kinds:
                with self.subTest(f"{run.name} {kind}"):
                    self.fits("analyze", run, *kind.split())

    def test_comparisons_fit(self):
        self.fits("compare", self.small, self.small, "--all")
        self.fits("table", self.small, self.small, "--by", "machine")

    def test_without_a_terminal_lines_have_any_length(self):
        text = self.succeed("table", self.small)
        self.assertGreater(max(map(len, text.splitlines())), 120)
        self.assertEqual(self.succeed("table", self.small, "--wide"), text)
        self.environment["COLUMNS"] = "80"  # a terminal's
        self.assertEqual(self.succeed("table", self.small), text)

    def test_widths_are_numbers_of_columns(self):
        self.refuse("table", self.small, "--width", "80", "--wide", says=["--wide"])
        for width in ("0", "19", "x"):
            self.refuse("list", "--width", width, says=["--width"])


class Words(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.small = cls.home / "small"
        small = cls("run_small")
        small.dir = cls.home
        small.succeed(*ROWS, cls.small)

    def run_small(self):
        """Only a name to make a first instance with."""

    def heads(self, words):
        return next(csv.reader(io.StringIO(self.succeed("table", self.small, "--format", "csv", "--columns", words))))

    def test_every_heading_that_is_printed_is_a_name(self):
        rows = [line for line in self.succeed("table", self.small, "--format", "md").splitlines() if line.startswith("|")]
        words = [word.strip().replace("\\", "") for word in rows[0].strip("|").split("|")]
        again = self.succeed("table", self.small, "--format", "md", "--columns", ",".join(words))
        self.assertEqual([line for line in again.splitlines() if line.startswith("|")], rows)

    def test_units_and_line_breaks_do_not_count(self):
        self.assertEqual(self.heads("false dark,false\ndark,False Dark (%),resolve ms,memory [MiB]"),
                         ["false_dark_rate"] * 3 + ["resolve_ms", "bytes"])

    def test_headings_of_several_columns_and_wrong_ones_name_columns(self):
        self.refuse("table", self.small, "--columns", "bare pass", says=["bare pass is the heading of 2 columns", "floor, floor_ms"])
        self.refuse("table", self.small, "--columns", "fals dark", says=["did you mean false_dark_rate? Near are also: "])

    def test_analyses_take_headings_of_quantities(self):
        self.assertEqual(self.succeed("analyze", self.small, "front", "--error", "false dark"),
                         self.succeed("analyze", self.small, "front", "--error", "false_dark_rate"))
        self.refuse("analyze", self.small, "front", "--error", "fals dark", says=["did you mean"])

    def test_a_filter_keeps_the_rows_that_match(self):
        text = self.succeed("table", self.small, "--format", "csv", "--columns", "technique,scene,light", "--filter", "contact sun .*planar")
        self.assertEqual(text.splitlines(), ["technique,scene,light", "planar_projected,contact,sun"])
        self.assertNotIn("unshadowed", self.succeed("table", self.small, "--filter", "resolution=256"))
        for command in ("table", "report"):
            self.refuse(command, self.small, "--filter", "nobody", says=["small holds no record that matches nobody"])
            self.refuse(command, self.small, "--filter", "(", says=["--filter ("])

    def test_a_report_has_the_rows_that_match(self):
        sizes = []
        for number, chosen in enumerate(([], ["--filter", "unshadowed"])):
            page = self.dir / f"{number}.html"
            self.succeed("report", self.small, "--no-pictures", "--out", page, *chosen)
            sizes.append(len(page.read_text()))
        self.assertGreater(sizes[0], sizes[1])

    def test_over_all_places_alone_on_request(self):
        for kind in ("front", "best"):
            for options, places in (([], {"contact", "soup:ground=false,count=50", None}), (["--over-all"], {None})):
                with self.subTest(f"{kind} {options}"):
                    rows = json.loads(self.succeed("analyze", self.small, kind, "--format", "json", *options))["rows"]
                    self.assertEqual({row["scene"] for row in rows}, places)
        self.refuse("analyze", self.small, "map", "--over-all", says=["--over-all is for front, best and enough; map does not take it"])
        text = self.succeed("compare", self.small, self.small, "--all", "--over-all")
        self.assertNotIn("contact, light", text)


if __name__ == "__main__":
    unittest.main()
