#!/usr/bin/python3 -IB
"""scripts/stale_results: kept results beside the suite and the program as they are now."""

import importlib.machinery
import importlib.util
import json
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, PROGRAM, ROOT, ProgramTest, records  # noqa: E402


class Stale(ProgramTest):
    def setUp(self):
        super().setUp()
        self.kept = self.dir / "kept"
        self.succeed("run", "quick", "--filter", "^fence (point|sun) (unshadowed|embree_rays|shadow_map)$", "--processes", "1", "--repetitions", "1",
                     "--pictures", "none", "--quiet", "--out", self.kept / "quick")

    def change(self, edit):
        file = self.kept / "quick/records.jsonl"
        rows = records(file.parent)
        for row in rows:
            row["context"]["commit"] = "0123456789"
            edit(row)
        file.write_text("".join(json.dumps(row) + "\n" for row in rows))

    def said(self, *words, status=1):
        done = subprocess.run([ROOT / "scripts/stale_results", "--program", PROGRAM, "--kept", self.kept, *words], env=self.environment, text=True,
                              capture_output=True, timeout=PATIENCE, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_rows_and_numbers_make_results_stale_and_other_sources_do_not(self):
        self.change(lambda row: row["context"].update(build="0" * 16, technique_source="0" * 16))
        text = self.said()
        self.assertRegex(text, r"(?m)^quick: \d+ rows that the suite has and the results lack: ")
        self.assertRegex(text, r"(?m)^1 folder, 1 stale; 6 rows measured again")
        self.assertNotIn("->", text)  # no number
        self.assertEqual(len(text.splitlines()), 2, text)

        def edit(row):
            row["context"].update(commit="fedcba9876-dirty" if row["light"] == "sun" else "0123456789")
            if row["technique"] == "shadow_map":
                row["metrics"]["shape"]["error"] += 1e-15
                row["context"]["gl_renderer"] = "another" if row["light"] == "sun" else row["context"]["gl_renderer"]
        self.change(edit)
        with open(self.kept / "quick/records.jsonl", "a", encoding="utf-8") as file:
            file.write(json.dumps(records(self.kept / "quick")[0] | {"job": "0" * 16, "technique": "bygone"}) + "\n")
        text = self.said("quick")
        for words in ("quick: rows of 2 commits: ", "quick: made by a tree that was no commit", "quick: 1 row that the suite has no more: fence ",
                      "quick: fence point shadow_map: metrics.shape.error "):
            self.assertIn(f"\n{words}", "\n" + text)
        self.assertRegex(text, r"1 row drawn by another OpenGL then, 5 rows measured again")
        self.assertEqual(text.count("->"), 1, text)

    def test_a_drawn_row_that_has_no_support_any_more_is_stale_but_for_one_by_vulkan(self):
        loader = importlib.machinery.SourceFileLoader("stale_results", str(ROOT / "scripts/stale_results"))
        stale = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
        loader.exec_module(stale)
        row = {"settings": "", "status": "ok", "context": {"gl_renderer": "llvmpipe", "gl_version": "4.5", "processor": "P"}}
        again = {"settings": "", "status": "unsupported", "context": {"gl_renderer": None, "processor": "P"}}
        self.assertEqual(stale.compared(row, again), (["measured again"], ["status ok -> unsupported"]))
        row["context"]["gl_version"] = "Vulkan 1.4"
        self.assertEqual(stale.compared(row, again), (["by Vulkan with rays, which is not here"], []))

    def test_a_suite_that_is_gone_is_named(self):
        (self.kept / "quick").rename(self.kept / "bygone")
        self.assertEqual(self.said(), "bygone: there is no suite bygone any more\n1 folder, 1 stale; no row measured again\n")
        self.assertIn("nowhere has no records.jsonl and no run.json", self.said("nowhere", status=2))

    def test_a_folder_without_records_has_the_suite_that_it_was_made_of(self):
        (self.kept / "quick/records.jsonl").unlink()
        file = self.kept / "quick/run.json"
        run = json.loads(file.read_text())
        run["runs"][0]["context"]["commit"] = "0123456789"
        run["runs"][0]["changes"] = ""
        file.write_text(json.dumps(run))
        self.assertEqual(self.said(status=0), "1 folder, 0 stale; no row measured again\n")
        run["runs"][0]["suite"]["text"] += "processes = 3\n"
        run["runs"][0]["context"]["commit"] = "0123456789-dirty"
        file.write_text(json.dumps(run))
        self.assertEqual(self.said(), "quick: made by a tree that was no commit\nquick: made of another text of the suite\n"
                                      "1 folder, 1 stale; no row measured again\n")

    def test_records_of_another_schema_are_refused(self):
        self.change(lambda row: row.update(schema=row["schema"] - 1))
        text = self.said(status=1)
        self.assertRegex(text, r"records\.jsonl:1: schema \d+, not \d+; scripts/convert_records \S+ brings records to today's schema")


if __name__ == "__main__":
    unittest.main()
