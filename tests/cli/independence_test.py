#!/usr/bin/python3 -IB
"""What a row reports does not depend on what ran before it: in a whole run, alone, in a run that went on, and in merged shards."""

import json
import signal
import sys
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ProgramTest, measured, records, small_maps  # noqa: E402

# The first scene is one that every technique of hard shadows supports, under the lamp the others do. Its smaller pictures come between those of the lights: each row but the
# first of a technique finds the room that a larger one left.
SUITE = """
width = 96
height = 64
processes = 1
repetitions = 1
warmups = 1
[[group]]
scenes = ["sphere_over_plane:segments=24"]
sizes = ["96x64", "64x48"]
techniques = [TECHNIQUES]
[[group]]
scenes = ["LAMP"]
lights = ["lamp"]
sizes = ["96x64", "64x48"]
techniques = [TECHNIQUES]
[[group]]
scenes = ["soup:count=300"]
techniques = [TECHNIQUES]
"""
LAMP = """
scene = "sphere_over_plane:segments=24"
[[light]]
name = "lamp"
kind = "disc"
center = [3, 6, 2]
normal = [-3, -6, -2]
radius = 0.5
"""


class Independence(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.suite = cls.home / "every.toml"
        lamp = cls.home / "lamp.toml"
        lamp.write_text(LAMP)
        techniques = ", ".join(f'"{technique}"' for technique in small_maps())
        cls.suite.write_text(SUITE.replace("LAMP", str(lamp)).replace("TECHNIQUES", techniques))

    def run_suite(self, out, *options):
        self.succeed("run", self.suite, "--quiet", "--out", out, *options)
        return self.rows(out)

    def rows(self, out):
        """All that must be the same in a run's rows, with the content of their pictures, by job."""
        rows = {}
        for record in records(self.dir / out):
            pictures = [record[key] and (self.dir / out / record[key]).read_bytes() for key in ("mask", "error_picture", "shaded_picture")]
            rows[record["job"]] = dict(measured(record), pictures=pictures)
        return rows

    def assert_same(self, rows, whole):
        self.assertEqual(rows.keys(), whole.keys())
        for job, row in rows.items():
            title = " ".join(str(whole[job][key]) for key in ("scene", "light", "width", "technique"))
            self.assertEqual(row.keys(), whole[job].keys(), title)
            for key, value in row.items():
                self.assertEqual(value, whole[job][key], f"{key} of {title}")

    def test_a_row_is_the_same_whatever_ran_before_it(self):
        whole = self.run_suite("whole")
        every = {entry["id"] for entry in json.loads(self.succeed("list", "techniques", "--json")) if not entry["named_only"]}
        ok = {row["technique"] for row in whole.values() if row["status"] == "ok"}
        self.assertEqual(ok, every)
        self.assertEqual({row["status"] for row in whole.values()} - {"ok", "unsupported"}, set())

        with self.subTest("alone"):
            # So many shards that each row is one by itself. What is unsupported runs nothing that others could have left anything to:
            # it is compared with the shards below. Their pictures are compared there, too: here it is a hundred programs that would load
            # what writes them.
            ran = [job for job, row in whole.items() if row["status"] == "ok"]
            numbers = {job: int(job[:8], 16) for job in whole}
            count = next(n for n in range(len(whole), 10**6) if len({number % n for number in numbers.values()}) == len(whole))
            with ThreadPoolExecutor(2) as pool:
                alone = pool.map(lambda job: self.run_suite(job, "--pictures", "none", "--shard", f"{numbers[job] % count}/{count}"), ran)
                for row, job in zip(alone, ran):
                    self.assert_same(row, {job: dict(whole[job], mask=None, error_picture=None, shaded_picture=None, pictures=[None] * 3)})

        with self.subTest("merged shards"):
            for k in range(2):
                self.run_suite(f"shard{k}", "--shard", f"{k}/2")
            self.succeed("merge", "shard0", "shard1", "--out", "merged")
            self.assert_same(self.rows("merged"), whole)

        with self.subTest("killed and resumed"):
            file = self.dir / "resumed/records.jsonl"
            run = self.start("run", self.suite, "--quiet", "--out", "resumed")
            end = time.monotonic() + 120
            while not file.exists() or not file.stat().st_size:
                self.assertIsNone(run.poll())
                self.assertLess(time.monotonic(), end)
                time.sleep(0.01)
            run.send_signal(signal.SIGKILL)
            run.communicate(timeout=60)
            lines = file.read_bytes().splitlines(keepends=True)
            self.assertLess(len(lines), len(whole))
            file.write_bytes(b"".join(lines[::2]))  # holes: the rows between these find other ones before them
            self.assert_same(self.run_suite("resumed", "--resume"), whole)


if __name__ == "__main__":
    unittest.main()
