#!/usr/bin/python3 -IB
"""The cache of frames: what it lists, checks, clears, and that it keeps below its limit."""

import json
import os
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, ProgramTest, records  # noqa: E402


class Cache(ProgramTest):
    def setUp(self):
        super().setUp()
        self.environment = dict(self.environment, GNOMON_CACHE=str(self.dir / "cache"))
        self.frames = self.dir / "cache/frames"

    def render(self, size="64x36"):
        self.succeed("render", "--scene", "single_triangle", "--light", "sun", "--technique", "unshadowed", "--size", size, "--out", f"out{size}")

    def listed(self):
        return json.loads(self.succeed("cache", "--json"))

    def test_it_lists_what_is_there_and_clears_it(self):
        self.assertEqual(self.listed()["files"]["scene"], {"count": 0, "bytes": 0})
        self.render()
        listed = self.listed()
        self.assertEqual(listed["folder"], str(self.frames))
        self.assertEqual({kind: listed["files"][kind]["count"] for kind in listed["files"]}, {"scene": 1, "gbuffer": 1, "reference": 1})
        self.assertEqual(listed["files"]["gbuffer"]["bytes"], 64 * 36 * 32 + 32)
        self.assertIn("gbuffer", self.succeed("cache", "list"))
        (self.frames / "a_file_of_somebody").write_text("kept")
        self.assertIn("3 files", self.succeed("cache", "clear"))
        self.assertEqual([path.name for path in self.frames.iterdir()], ["a_file_of_somebody"])

    def test_damaged_files_are_found_and_made_again(self):
        self.render()
        self.assertIn("3 files, 0 damaged", self.succeed("cache", "check"))
        for ending in ("gbuffer", "reference", "scene"):
            file = next(self.frames.glob(f"*.{ending}"))
            content = bytearray(file.read_bytes())
            content[len(content) // 2] ^= 1
            file.write_bytes(content)
            self.assertIn("1 damaged", self.succeed("cache", "check", status=1))
            self.assertFalse(file.exists())
        self.render("64x36")
        self.assertIn("3 files, 0 damaged", self.succeed("cache", "check"))

    def test_what_was_used_longest_ago_goes_first_and_nothing_of_the_last_hour(self):
        self.render("64x36")
        old = sorted(self.frames.iterdir())
        for file in old:
            os.utime(file, (time.time() - 7200,) * 2)
        self.environment["GNOMON_CACHE_LIMIT"] = "0"
        self.render("32x18")  # the scene's file is used, the frames of the other size are not
        left = {path.suffix for path in old if path.exists()}
        self.assertEqual(left, {".scene"})
        self.assertEqual(self.listed()["files"]["reference"]["count"], 1)
        self.assertEqual(self.listed()["limit_bytes"], 0)

    RUN = ["run", "--scene", "single_triangle", "--light", "point,sun", "--technique", "unshadowed", "--technique", "exact_rays",
           "--processes", "2", "--repetitions", "1", "--size", "64x36", "--quiet"]

    def test_two_programs_at_once_share_it(self):
        both = [self.start(*self.RUN, "--out", out) for out in ("a", "b")]
        for run in both:
            out, error = run.communicate(timeout=PATIENCE)
            self.assertEqual(run.returncode, 0, out + error)
        self.assertRegex(self.succeed("cache", "check"), "[1-9][0-9]* files, 0 damaged")
        masks = [{path.name: path.read_bytes() for path in (self.dir / out / "masks").iterdir()} for out in ("a", "b")]
        self.assertEqual(*masks)
        self.assertEqual([path.name for path in self.frames.iterdir() if path.is_dir()], [])

    def test_a_run_goes_on_when_its_cache_is_cleared(self):
        run = self.start(*self.RUN, "--out", "out")
        while run.poll() is None:
            self.succeed("cache", "clear")
        out, error = run.communicate()
        self.assertEqual(run.returncode, 0, out + error)
        self.assertEqual({row["status"] for row in records(self.dir / "out")}, {"ok"})

    def test_bad_words_are_refused(self):
        self.refuse("cache", "burn", says=["burn", "list, check, clear"])
        self.refuse("cache", "clear", "--json", says=["--json", "list"])
        self.environment["GNOMON_CACHE_LIMIT"] = "much"
        for arguments in (["cache"], ["render", "--scene", "single_triangle", "--technique", "unshadowed", "--out", "bad"], [*self.RUN, "--out", "bad"]):
            self.refuse(*arguments, says=["GNOMON_CACHE_LIMIT = much", "megabytes"])


if __name__ == "__main__":
    unittest.main()
