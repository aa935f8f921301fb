#!/usr/bin/python3 -IB
"""Tables for papers and programs: LaTeX that compiles and fits its page, Markdown, tidy CSV, JSON by its schema."""

import csv
import io
import json
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, NUMBERS, ROOT, ProgramTest, records  # noqa: E402

try:
    import jsonschema
except ImportError:
    jsonschema = None

SHIPPED = sorted(folder.parent for folder in (ROOT / "results").glob("*/records.jsonl"))
DOCUMENT = r"""\documentclass[a4paper,10pt]{article}
\usepackage[landscape,margin=2cm]{geometry}
\usepackage{booktabs}
\begin{document}
\input{table}
\end{document}
"""
# Classes with two columns, and their options.
CLASSES = [("article", "a4paper,10pt,twocolumn"), ("article", "letterpaper,10pt,twocolumn"), ("IEEEtran", "conference")]
TWO_COLUMNS = r"""\documentclass[{options}]{{{name}}}
\usepackage{{booktabs}}
\begin{{document}}
{tables}
\end{{document}}
"""


class Paper(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.small = cls.home / "small"
        small = cls("run_small")
        small.dir = cls.home
        small.succeed("run", *HARD, "--scene", "contact", "--scene", "soup:ground=false,count=50", "--technique", "unshadowed",
                      "--technique", "planar_projected", "--technique",
                      "shadow_map:resolution={256,1024},filter=pcf,filter_radius=3,bias=receiver_plane,depth_bias=1.5", *NUMBERS,
                      "--out", cls.small)

    def run_small(self):
        """Only a name to make a first instance with."""

    def compile(self, table, document=DOCUMENT):
        """Its text, with every complaint of LaTeX about the page an error. Needs booktabs and nothing else."""
        (self.dir / "table.tex").write_text(table)
        (self.dir / "paper.tex").write_text(document)
        done = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "paper.tex"], cwd=self.dir, text=True,
                              capture_output=True, timeout=120, errors="replace")
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        for complaint in ("Overfull", "Float too large", "Undefined", "Missing character"):
            self.assertNotIn(complaint, done.stdout)
        return done.stdout

    @unittest.skipUnless(shutil.which("pdflatex"), "there is no pdflatex")
    def test_tables_compile_and_fit_a_page_in_landscape(self):
        for run in (self.small, *SHIPPED):
            with self.subTest(run.name):
                self.compile(self.succeed("table", run, "--format", "tex"))

    @unittest.skipUnless(shutil.which("pdflatex"), "there is no pdflatex")
    def test_tables_fit_one_and_both_columns_of_a_page(self):
        tables = []
        for run in (self.small, *SHIPPED):
            for paper in ("column", "page"):
                table = self.succeed("table", run, "--format", "tex", "--fit", paper, "--label", f"tab:{run.name}:{paper}")
                self.assertIn(f"\\label{{tab:{run.name}:{paper}}}", table)
                self.assertIn("\\begin{table*}" if paper == "page" else "\\begin{table}", table)
                tables.append(table)
        for name, options in CLASSES:
            with self.subTest(f"{name} {options}"):
                needed = (f"{name}.cls", "ptmr7t.tfm") if name == "IEEEtran" else (f"{name}.cls",)  # a class, its font
                for file in needed:
                    if not subprocess.run(["kpsewhich", file], capture_output=True).stdout:
                        self.skipTest(f"there is no {file}")
                self.compile("", TWO_COLUMNS.format(name=name, options=options, tables="\\clearpage\n".join(tables)))

    @unittest.skipUnless(shutil.which("pdflatex"), "there is no pdflatex")
    def test_analyses_fit_one_and_both_columns_of_a_page(self):
        results = ROOT / "results"
        of_runs = {self.small: ("front", "best", "map"), results / "quick": ("rank", "enough", "best"), results / "seams": ("seams",),
                   results / "animation": ("motion",), results / "scale": ("growth",),
                   results / "lights": ("forecast",)}
        tables = [self.succeed("analyze", run, *kind.split(), "--format", "tex", "--fit", paper)
                  for run, kinds in of_runs.items() for kind in kinds for paper in ("column", "page")]
        self.compile("", TWO_COLUMNS.format(name=CLASSES[0][0], options=CLASSES[0][1], tables="\\clearpage\n".join(tables)))

    def test_columns_without_room_are_refused(self):
        self.refuse("table", self.small, "--format", "tex", "--fit", "column", "--columns", "scene,technique,build,relight,resolve,error",
                    says=["--fit column has room for 45 characters, and the 6 columns take "])
        self.refuse("table", self.small, "--format", "tex", "--fit", "a4", says=["a table does not fit a4", "landscape, page, column"])

    @unittest.skipUnless(shutil.which("pdflatex"), "there is no pdflatex")
    def test_any_columns_and_captions_compile(self):
        self.compile(self.succeed("table", self.small, "--format", "tex", "--caption", r"50 % & more_of {\this} #1 ~ ^ $x$",
                                  "--columns", "scene,light,technique,reason,resolve_ms,resolve_ms_low,resolve_ms_high,causes"))

    @unittest.skipUnless(shutil.which("pdflatex"), "there is no pdflatex")
    def test_analyses_compile(self):
        for run, kinds in ((self.small, ("front", "best", "map", "growth --x resolution", "sweep --x resolution")),
                           (SHIPPED[0], ("front", "best"))):
            for kind in kinds:
                with self.subTest(f"{run.name} {kind}"):
                    self.compile(self.succeed("analyze", run, *kind.split(), "--format", "tex"))

    def test_columns_are_chosen_and_ordered_in_every_format(self):
        names = ["wrong_rate", "technique", "resolve_ms"]
        chosen = ["table", self.small, "--columns", ",".join(names), "--format"]
        self.assertEqual(self.succeed(*chosen, "csv").splitlines()[0], "wrong_rate,technique,resolve_ms")
        self.assertEqual([c["name"] for c in json.loads(self.succeed(*chosen, "json"))["columns"]], names)
        self.assertRegex(self.succeed(*chosen, "md"), r"^\| wrong \(%\) \| technique \| resolve \(ms\) \|")
        self.assertRegex(self.succeed(*chosen, "tex"), r"wrong & technique & resolve")
        self.assertRegex(self.succeed(*chosen, "terminal"), r"^ *wrong +technique +resolve")

    def test_csv_is_tidy(self):
        text = self.succeed("table", self.small, "--format", "csv")
        rows = list(csv.reader(io.StringIO(text)))
        self.assertEqual(len(rows), 1 + 2 * 2 * 4)  # a header; scenes, lights, settings
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        self.assertEqual(len(set(rows[0])), len(rows[0]))
        for row in csv.DictReader(io.StringIO(text)):
            for column in ("resolve_ms", "wrong_rate", "cause.acne"):
                if row["status"] == "ok":
                    float(row[column])

    def test_every_row_of_markdown_has_all_its_cells(self):
        for arguments in (["table", self.small], ["analyze", self.small, "front"], ["analyze", self.small, "map"]):
            lines = [line for line in self.succeed(*arguments, "--format", "md").splitlines() if line.startswith("|")]
            block = []
            for line in lines:
                cells = len(re.findall(r"(?<!\\)\|", line))
                if re.fullmatch(r"\|( -+:? \|)+", line):
                    block = [cells]
                elif block:
                    self.assertIn(cells, (block[0], len(re.findall(r"(?<!\\)\|", lines[0]))), line)

    @unittest.skipIf(jsonschema is None, "there is no python3-jsonschema")
    def test_json_keeps_its_schema(self):
        schema = json.loads((ROOT / "docs/schema/table.schema.json").read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        check = jsonschema.Draft202012Validator(schema)
        for run in (self.small, *SHIPPED):
            # A map is of a technique with two settings, all of which have a place in common.
            places = {}
            for row in records(run):
                if row["status"] == "ok":
                    place = (row["scene"], row["light"], row["view"], row["path"])
                    places.setdefault(row["technique"], {}).setdefault(row["settings"], set()).add(place)
            has_map = any(len(of) > 1 and set.intersection(*of.values()) for of in places.values())
            maps = [["analyze", run, "map"]] if has_map else []
            for arguments in (["table", run], ["analyze", run, "front"], ["analyze", run, "best"], *maps):
                with self.subTest(" ".join(map(str, arguments))):
                    table = json.loads(self.succeed(*arguments, "--format", "json"))
                    check.validate(table)
                    names = {column["name"] for column in table["columns"]}
                    for row in table["rows"]:
                        self.assertEqual(set(row), names)

    @unittest.skipIf(jsonschema is None, "there is no python3-jsonschema")
    def test_every_record_keeps_its_schema(self):
        schema = json.loads((ROOT / "docs/schema/record.schema.json").read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        check = jsonschema.Draft202012Validator(schema)
        for run in (self.small, *SHIPPED):
            for number, line in enumerate((run / "records.jsonl").read_text().splitlines(), 1):
                with self.subTest(f"{run.name}, line {number}"):
                    check.validate(json.loads(line))
        # A field that the schema does not have is an error: whoever adds one writes it down.
        row = json.loads((self.small / "records.jsonl").read_text().splitlines()[0])
        self.assertFalse(check.is_valid({**row, "new_field": 1}))
        of_paths = {"start", "frame_rate", "frame_count", "moving_stages", "kept_frames"}  # of rows that move
        self.assertEqual(set(row) | of_paths | {"truth_over"}, set(schema["properties"]))  # and none is described that nobody writes


if __name__ == "__main__":
    unittest.main()
