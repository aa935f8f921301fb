#!/usr/bin/python3 -IB
"""Runs of several machines side by side: table A B --by machine, and rows that leave masks alone."""

import json
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ProgramTest, records  # noqa: E402

ROWS = ("--scene", "fence", "--light", "sun", "--technique", "shadow_map", "--technique", "planar_projected", "--technique", "embree_rays",
        "--size", "64x36", "--processes", "1", "--repetitions", "1")


class Machines(ProgramTest):
    def two_runs(self):
        """Two runs of the same rows; in the second one the map's mask is that of the projected shadow."""
        self.succeed("run", *ROWS, "--pictures", "masks", "--out", "a")
        shutil.copytree(self.dir / "a", self.dir / "b")
        masks = {r["technique"]: r["mask"] for r in records(self.dir / "b")}
        shutil.copyfile(self.dir / "b" / masks["planar_projected"], self.dir / "b" / masks["shadow_map"])

    def test_masks_alone_are_left_where_they_are_asked_for(self):
        self.two_runs()
        self.assertFalse((self.dir / "a/errors").exists() or (self.dir / "a/shaded").exists())
        for record in records(self.dir / "a"):
            self.assertTrue((self.dir / "a" / record["mask"]).is_file())
            self.assertIsNone(record["error_picture"])
            self.assertIsNone(record["shaded_picture"])
        self.assertIn("3 rows rescored", self.gnomon("table", "a", "--rescore").stderr)

    def test_pixels_that_differ_are_counted_and_listed(self):
        self.two_runs()
        table = json.loads(self.succeed("table", "a", "b", "--by", "machine", "--pixels", "pixels.jsonl", "--format", "json"))
        differing = {row["setting"]: row["B.differing"] for row in table["rows"]}
        self.assertEqual((differing["planar_projected"], differing["embree_rays"]), (0, 0))
        self.assertGreater(differing["shadow_map"], 0)
        rays = {row["setting"]: row["A.rays_per_second"] for row in table["rows"]}
        self.assertIsNone(rays["shadow_map"])
        self.assertGreater(rays["embree_rays"], 1000)
        lists = {line["technique"]: line for line in map(json.loads, (self.dir / "pixels.jsonl").read_text().splitlines())}
        self.assertEqual({technique: line["count"] for technique, line in lists.items()}, differing)
        self.assertEqual(len(lists["shadow_map"]["pixels"]), differing["shadow_map"])
        for x, y, first, second in lists["shadow_map"]["pixels"]:
            self.assertTrue(0 <= x < 64 and 0 <= y < 36 and abs(first - second) > 1 / 510)

    def test_a_table_names_the_machines(self):
        self.two_runs()
        text = self.succeed("table", "a", "b", "--by", "machine")
        self.assertTrue(all(word in text for word in ("A: a, ", "B: b, ", "llvmpipe", "differs: pixels")), text)
        self.assertIn("C.ratio", self.succeed("table", "a", "b", "a", "--by", "machine", "--format", "csv"))

    def test_what_does_not_go_together_is_refused(self):
        self.two_runs()
        for arguments, says in ((("a", "b"), "'a', 'b' are given; several stand side by side with --by machine"), (("a", "b", "--by", "color"), "machine"),
                                (("a", "b", "--by", "machine", "--rescore"), "--by machine goes with --format, --filter, --pixels, --width and --wide alone"),
                                (("a", "b", "--by", "machine", "--format", "tex"), "--format tex is none of --by machine"),
                                (("a", "--by", "machine"), "--by machine takes 2 .. 26 folders of runs; 1 are given"),
                                (("a", "nowhere", "--by", "machine"), "nowhere"), (("a", "--pixels", "x"), "--by")):
            self.refuse("table", *arguments, says=[says])


if __name__ == "__main__":
    unittest.main()
