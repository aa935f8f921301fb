#!/usr/bin/python3 -IB
"""What is large takes the time and memory that it deserves: records that claim a size, rows of many times, runs of many rows."""

import json
import os
import resource
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ProgramTest, records  # noqa: E402

MEBIBYTE = 1 << 20


class Sizes(ProgramTest):
    def setUp(self):
        super().setUp()
        self.out = self.dir / "run"
        self.succeed("run", "--scene", "single_triangle", "--light", "sun", "--technique", "shadow_map:resolution=64", "--size", "160x90",
                     "--processes", "1", "--repetitions", "1", "--out", self.out)
        (self.row,) = records(self.out)

    def write_rows(self, rows):
        with open(self.out / "records.jsonl", "w", encoding="utf-8") as file:
            for row in rows:
                file.write(json.dumps(row) + "\n")

    def usage(self, *words):
        """Processor seconds and peak MiB of a call that succeeds, and what it printed."""
        with open(self.dir / "printed", "w+b") as printed:
            child = os.posix_spawn(self.command()[0], self.command(*words), dict(self.environment),
                                   file_actions=[(os.POSIX_SPAWN_DUP2, printed.fileno(), 1), (os.POSIX_SPAWN_OPEN, 2, "/dev/null", os.O_WRONLY, 0)])
            _, status, used = os.wait4(child, 0)
            self.assertEqual(os.waitstatus_to_exitcode(status), 0)
        return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, (self.dir / "printed").read_text()

    def test_a_size_that_is_not_the_masks_is_said_before_a_frame_is_made(self):
        self.row["width"] = self.row["height"] = 16384
        self.write_rows([self.row])
        limit = 4096 * MEBIBYTE  # the frame alone is 8 GB
        for words, status in ((("report", self.out, "--out", self.dir / "x.html"), 0), (("table", self.out, "--rescore"), 2)):
            done = self.gnomon(*words, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertIn("160x90; 16384x16384 is wanted", done.stderr)

    def test_files_of_no_end_take_no_memory(self):
        """Sparse files of 64 GB in the place of records, their history and frames."""
        cache, limit, size = self.dir / "cache", 4096 * MEBIBYTE, 64 << 30
        self.environment["GNOMON_CACHE"] = str(cache)
        one = ("run", "--scene", "single_triangle", "--light", "sun", "--technique", "unshadowed", "--size", "80x45")
        self.succeed(*one, "--out", self.dir / "a")
        bound = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit))}
        for file in [cache / "history.jsonl", *(cache / "frames").glob("*.*")]:
            os.truncate(file, size)
        self.assertEqual(self.gnomon(*one, "--out", self.dir / "b", **bound).returncode, 0)
        os.truncate(self.out / "records.jsonl", size)
        for words in (("table", self.out), ("table", self.out, "--rescore", "--save"), ("report", self.out), ("merge", self.out, "--out", "m"),
                      (*one, "--resume", "--out", self.out), ("compare", self.out, self.out)):
            done = self.gnomon(*words, **bound)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("line is longer than 536870912 bytes", done.stderr)

    def test_a_row_of_a_million_times_is_told_in_seconds(self):
        self.row["stages"]["resolve"] = [[0.1 + 0.001 * (k * r % 7) for r in range(1000)] for k in range(1000)]
        self.write_rows([self.row])
        # A second or so where each draw is one number; 11 to 18 s where a resample drew all of them.
        self.assertLess(self.usage("table", self.out)[0], 4)
        self.assertLess(self.usage("report", self.out, "--no-pictures")[0], 8)

    def test_a_csv_of_many_rows_is_written_piece_by_piece(self):
        def rows(count):
            for k in range(count):
                yield self.row | {"job": f"{k:016x}", "place": count - k}
        self.write_rows(rows(100))
        _, few, text = self.usage("table", self.out, "--format", "csv")
        self.assertEqual([line.split(",")[0] for line in text.splitlines()[1:4]], [f"{k:016x}" for k in (99, 98, 97)])
        self.write_rows(rows(10_000))
        _, many, text = self.usage("table", self.out, "--format", "csv")
        self.assertEqual(len(text.splitlines()), 10_001)
        # 2 GB for 300,000 rows.
        self.assertLess(many - few, 2e9 / 300_000 * 10_000 / MEBIBYTE)

    def test_a_csv_is_the_same_from_memory_and_from_the_file(self):
        other = json.loads(json.dumps(self.row)) | {"job": "0" * 16, "place": 0, "technique": "other", "parameters": {"size": "wide"}}
        other["counts"] = [{"name": "knots", "value": 3, "unit": "1"}]
        self.write_rows([self.row | {"place": 1}, other | {"label": "of before"}, other])
        streamed = self.succeed("table", self.out, "--format", "csv")
        table = json.loads(self.succeed("table", self.out, "--format", "json"))
        self.assertEqual(streamed.splitlines()[0], ",".join(column["name"] for column in table["columns"]))
        self.assertEqual(len(streamed.splitlines()), 3)
        self.assertNotIn("of before", streamed)
        self.assertTrue(streamed.splitlines()[1].startswith("0" * 16))


if __name__ == "__main__":
    unittest.main()
