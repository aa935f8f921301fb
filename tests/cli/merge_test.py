#!/usr/bin/python3 -IB
"""gnomon merge: shards become the run that they are parts of, and what does not fit together is said."""

import json
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, SMALL, ProgramTest, measured, records, what  # noqa: E402

ROWS = [*HARD, "--scene", "single_triangle", "--scene", "soup:count=50", "--technique", "shadow_map:resolution={256,512}",
        "--technique", "planar_projected", "--technique", "unshadowed"]
COUNT = 2 * 2 * 4  # two scenes, two lights, four settings
SHARDS = 3
PICTURES = ("mask", "error_picture", "shaded_picture")


class Merge(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.dir = cls.home
        cls.succeed(cls(), "run", *ROWS, *SMALL, "--out", "whole")
        for k in range(SHARDS):
            cls.succeed(cls(), "run", *ROWS, *SMALL, "--shard", f"{k}/{SHARDS}", "--out", f"part{k}")
        cls.parts = [cls.home / f"part{k}" for k in range(SHARDS)]

    def change(self, change, part=0):
        """A copy of a shard whose first record is changed."""
        copy = self.dir / "changed"
        shutil.copytree(self.parts[part], copy)
        rows = records(copy)
        change(rows[0])
        (copy / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        return copy, rows[0]

    def test_merged_shards_are_the_whole_run_row_for_row(self):
        # In any order of the folders.
        for name, parts in (("merged", self.parts), ("reversed", self.parts[::-1])):
            text = self.succeed("merge", *parts, "--out", name)
            self.assertIn(f"{COUNT} rows: {COUNT} ok, 0 unsupported, 0 failed from {SHARDS} folders", text)
            whole, merged = records(self.home / "whole"), records(self.dir / name)
            self.assertEqual([what(r) for r in merged], [what(r) for r in whole])
            self.assertEqual([r["place"] for r in merged], list(range(COUNT)))
            for a, b in zip(whole, merged):
                self.assertEqual(measured(a), measured(b))
        # Lines and pictures are those of the shards, byte for byte, and the tables are what `table` prints.
        lines = {line for part in self.parts for line in (part / "records.jsonl").read_text().splitlines()}
        self.assertEqual(set((self.dir / "merged/records.jsonl").read_text().splitlines()), lines)
        for part in self.parts:
            for row in records(part):
                for key in PICTURES:
                    self.assertEqual((self.dir / "merged" / row[key]).read_bytes(), (part / row[key]).read_bytes())
        self.assertEqual(self.names(self.dir / "merged"), self.names(self.home / "whole"))
        self.assertEqual((self.dir / "merged/table.json").read_text(), self.succeed("table", "merged", "--format", "json"))

    def test_the_same_row_twice_counts_once_and_is_said(self):
        self.succeed("run", *ROWS, *SMALL, "--filter", "soup.* sun", "--out", "again")  # other times, the same answers
        done = self.gnomon("merge", *self.parts, "again", "--out", "merged")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("note: 4 rows stand in more than one folder with the same answer", done.stderr)
        self.assertEqual(len(records(self.dir / "merged")), COUNT)
        again = {r["job"]: r["stages"] for r in records(self.dir / "again")}
        self.assertFalse(any(r["stages"] == again.get(r["job"]) for r in records(self.dir / "merged")))
        self.succeed("merge", *self.parts, "again", "--prefer-last", "--out", "last")
        self.assertEqual(sum(r["stages"] == again.get(r["job"]) for r in records(self.dir / "last")), 4)

    def test_conflicts_are_listed_and_nothing_is_written(self):
        copy, row = self.change(lambda r: r["metrics"]["shape"].update(wrong_rate=0.5))
        done = self.gnomon("merge", *self.parts, copy, "--out", "merged")
        self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
        for text in (f"conflict: job {row['job']} {row['scene']} {row['light']} {row['technique']}", str(self.parts[0]), str(copy),
                     "metrics.shape.wrong_rate: ", ", 0.5", f"1 of {COUNT} jobs has two answers; nothing is written"):
            self.assertIn(text, done.stderr)
        self.assertFalse((self.dir / "merged").exists())
        self.assertEqual([p for p in self.dir.iterdir() if p.name.startswith(".")], [])
        done = self.gnomon("merge", *self.parts, copy, "--prefer-last", "--out", "merged")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("conflict: ", done.stderr)  # still said
        rates = {r["job"]: r["metrics"]["shape"]["wrong_rate"] for r in records(self.dir / "merged")}
        self.assertEqual(rates[row["job"]], 0.5)

    def test_other_machines_are_said(self):
        copy, _ = self.change(lambda r: (r.update(job="0" * 16), r["context"].update(processor="an abacus")))
        done = self.gnomon("merge", *self.parts, copy, "--out", "merged")
        self.assertIn("note: different processors: ", done.stderr)
        self.assertIn("an abacus (1 row)", done.stderr)
        self.assertIn("times are not comparable", done.stderr)

    def test_a_failed_row_is_exit_1_as_in_a_run(self):
        copy, row = self.change(lambda r: r.update(status="failed", reason="it fell over"))
        text = self.succeed("merge", copy, *self.parts[1:], "--out", "merged", status=1)
        self.assertIn(f"{COUNT} rows: {COUNT - 1} ok, 0 unsupported, 1 failed", text)
        self.assertIn("it fell over", text)

    def test_pictures_that_are_not_there_are_counted(self):
        copy, row = self.change(lambda r: None)
        (copy / row["mask"]).unlink()
        done = self.gnomon("merge", copy, *self.parts[1:], "--out", "merged")
        self.assertEqual(done.returncode, 0)
        self.assertIn("note: 1 picture that the records name is in none of the folders", done.stderr)

    def test_bad_folders_are_refused(self):
        self.refuse("merge", self.parts[0], "--out", self.parts[1], says=[str(self.parts[1]), "holds records already"])
        self.refuse("merge", self.parts[0], "absent", "--out", "merged", says=["absent is not the folder of a run"])
        self.refuse("merge", "--out", "merged", says=["dirs"])
        self.refuse("merge", self.parts[0], says=["--out"])
        copy, _ = self.change(lambda r: r.update(schema=99))
        self.refuse("merge", copy, "--out", "merged", says=["changed/records.jsonl:1: schema = 99 is that of a newer program"])
        self.assertFalse((self.dir / "merged").exists())


if __name__ == "__main__":
    unittest.main()
