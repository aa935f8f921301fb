#!/usr/bin/python3 -IB
"""gnomon site: what it refuses, in words, and that its folder appears and goes as a whole."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ROOT, ProgramTest  # noqa: E402

ROWS = (ROOT / "results/quick/records.jsonl").read_text(encoding="utf-8").splitlines()[:12]


class Site(ProgramTest):
    def run_folder(self, name, processor="P", change=lambda record: None):
        folder = self.dir / name
        folder.mkdir()
        lines = []
        for line in ROWS:
            record = json.loads(line)
            record["context"]["processor"] = processor
            change(record)
            lines.append(json.dumps(record))
        (folder / "records.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
        return folder

    def submission(self, folder_name, **fields):
        folder = self.run_folder(folder_name)
        sheet = {"schema": "gnomon-submission-1", "edition": {"name": "2027", "hash": "00"}, "division": "default", "name": "m", **fields}
        (folder / "submission.json").write_text(json.dumps(sheet), encoding="utf-8")
        return folder_name

    def refused(self, words, *arguments):
        """Bad input ends with status 2 and these words, and leaves nothing."""
        before = sorted(path.name for path in self.dir.iterdir())
        result = self.gnomon("site", *arguments)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertRegex(result.stderr, words)
        self.assertEqual(sorted(path.name for path in self.dir.iterdir()), before)

    def test_bad_input_is_refused_and_nothing_is_left(self):
        self.run_folder("a")
        (self.dir / "none").mkdir()
        self.run_folder("foreign", change=lambda record: record.update(schema=99))
        self.submission("s1")
        self.submission("s2")
        self.submission("s3", schema="gnomon-submission-2")
        self.submission("s4", name="<b>")
        self.refused("records.jsonl", "none", "--out", "site")
        self.refused("foreign/records.jsonl.*schema", "foreign", "--out", "site")
        self.refused("one folder", "a", "./a", "--out", "site")
        self.refused("both submissions of 'm'", "s1", "s2", "--out", "site")
        self.refused("gnomon-submission-2", "s3", "--out", "site")
        self.refused("a-z, 0-9", "s4", "--out", "site")
        self.refused("no documentation", "a", "--out", "site", "--docs", "none")
        self.refused("something else", "a", "--out", "a")
        self.refused("is a file", "a", "--out", "a/records.jsonl")

    def test_equal_input_makes_equal_sites(self):
        self.run_folder("a")
        self.run_folder("b", "Q")
        self.environment["SOURCE_DATE_EPOCH"] = "0"
        for out in ("one", "two"):
            self.succeed("site", "a", "b", "--out", out)
        files = [sorted(path.relative_to(self.dir / out) for path in (self.dir / out).rglob("*") if path.is_file()) for out in ("one", "two")]
        self.assertEqual(*files)
        for name in files[0]:
            self.assertEqual((self.dir / "one" / name).read_bytes(), (self.dir / "two" / name).read_bytes(), name)

    def test_an_earlier_site_is_replaced_and_other_files_stay(self):
        self.run_folder("a")
        self.run_folder("b", "Q")
        self.succeed("site", "a", "b", "--out", "site", "--no-docs")
        self.assertTrue((self.dir / "site/differences").is_dir())
        self.succeed("site", "a", "--out", "site", "--no-docs")
        self.assertFalse((self.dir / "site/differences").exists())
        (self.dir / "site/mine").write_text("mine")
        self.refused("mine is not of it", "a", "--out", "site", "--no-docs")
        self.succeed("site", "a", "b", "--out", "site", "--no-docs", "--overwrite")
        self.assertEqual((self.dir / "site/mine").read_text(), "mine")
        self.assertTrue((self.dir / "site/differences").is_dir())

    def test_every_row_is_on_the_pages_of_its_technique_and_scene(self):
        self.run_folder("a")
        self.succeed("site", "a", "--out", "site", "--no-docs")
        for kind, key in (("techniques", "technique"), ("scenes", "scene")):
            counts = {}
            for line in ROWS:
                counts[json.loads(line)[key]] = counts.get(json.loads(line)[key], 0) + 1
            for name, count in counts.items():
                page = (self.dir / f"site/{kind}/{name}.html").read_text(encoding="utf-8")
                links = re.findall(r'<th scope="row"[^>]*><a href="\.\./tables/', page)
                self.assertEqual(len(links), count, name)


if __name__ == "__main__":
    unittest.main()
