#!/usr/bin/python3 -IB
"""All light from the command line: its picture, and rows that are compared with the reference by light paths."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ProgramTest, records  # noqa: E402

SIZE = ("--size", "64x48")
BOX = ("--scene", "cornell_box", "--light", "ceiling", *SIZE)
ONCE = ("--processes", "1", "--repetitions", "1")

SUITE = """
width = 64
height = 48
processes = 1
repetitions = 1

[[group]]
scenes = ["cornell_box"]
lights = ["ceiling"]
techniques = ["path_rays:samples=64", "path_rays:samples=64,ending=bounces,bounces=0", "area_rays"]
global_samples = SAMPLES
"""


class GlobalLight(ProgramTest):
    def test_the_layer_shows_colors_that_walls_have_sent_on(self):
        self.succeed("render", *BOX, "--view", "front", "--technique", "path_rays", "--debug", "global", "--out", "out")
        self.assertIn("global.png", self.names(self.dir / "out"))
        self.refuse("render", *BOX, "--technique", "path_rays", "--debug", "globe", "--out", "none", says=("globe", "global", "error"))

    def test_bounces_that_are_left_out_are_an_error(self):
        (self.dir / "light.toml").write_text(SUITE.replace("SAMPLES", "256"))
        self.succeed("run", "light.toml", "--out", "out")
        rows = {row["settings"]: row for row in records(self.dir / "out") if row["technique"] == "path_rays"}
        error = {settings: row["metrics"]["shape"]["radiosity_error"] for settings, row in rows.items()}
        # 64 samples have noise of their own, some 5 %; direct light alone lacks about a quarter.
        self.assertLess(error[""], 0.1)
        self.assertGreater(error["ending=bounces,bounces=0"], 0.2)
        self.assertLess(error["ending=bounces,bounces=0"], 0.4)
        of_paths = rows[""]["lights"][0]["reference"]["global"]
        self.assertEqual(of_paths["samples"], 256)
        self.assertGreater(of_paths["rays"], 64 * 48 * 256)
        self.assertLess(of_paths["error"], 0.2)

    def test_radiosity_and_light_paths_agree_bounce_by_bounce(self):
        # Two ways to the same light: what the same number of bounces leaves out of the reference is the same.
        coarse = "patch_size=0.1,levels=2"
        self.succeed("run", *BOX, *ONCE, "--global-samples", "256", "--technique", f"radiosity:{coarse},bounces={{0,1,all}}",
                     "--technique", "path_rays:samples=1024,ending=bounces,bounces={0,1}", "--out", "out")
        error = {(row["technique"], str(row["parameters"]["bounces"])): row["metrics"]["shape"]["radiosity_error"]
                 for row in records(self.dir / "out")}
        self.assertGreater(error["path_rays", "0"], 0.2)
        self.assertGreater(error["path_rays", "1"], 0.1)
        for bounces in ("0", "1"):
            self.assertAlmostEqual(error["radiosity", bounces], error["path_rays", bounces], delta=0.03)
        self.assertLess(error["radiosity", "all"], 0.05)

    def test_it_is_asked_for_and_else_nothing_changes(self):
        without = ("run", *BOX, *ONCE, "--technique", "path_rays:samples=16", "--technique", "area_rays:samples=4")
        self.succeed(*without, "--out", "plain")
        self.succeed(*without, "--global-samples", "16", "--out", "asked")
        plain, asked = records(self.dir / "plain"), records(self.dir / "asked")
        for before, after in zip(plain, asked):
            self.assertNotEqual(before["job"], after["job"])
            self.assertIsNone(before["metrics"]["shape"]["radiosity_error"])
            self.assertIsNone(before["lights"][0]["reference"]["global"])
            self.assertEqual(before["metrics"]["shape"]["error"], after["metrics"]["shape"]["error"])
        by_technique = {row["technique"]: row for row in asked}
        self.assertIsNotNone(by_technique["path_rays"]["metrics"]["shape"]["radiosity_error"])
        self.assertIsNone(by_technique["area_rays"]["metrics"]["shape"]["radiosity_error"])
        self.assertIsNone(by_technique["area_rays"]["lights"][0]["reference"]["global"])
        # Masks are kept, pictures of all light are not: what was measured stays.
        self.succeed("table", "asked", "--rescore")
        again = {row["technique"]: row for row in records(self.dir / "asked")}
        for technique, row in by_technique.items():
            self.assertEqual(row["metrics"], again[technique]["metrics"])
        self.assertEqual(by_technique["path_rays"]["lights"], again["path_rays"]["lights"])

    def test_lights_add_up(self):
        (self.dir / "two.toml").write_text(TWO_LAMPS)
        self.succeed("run", "--scene", "two.toml", "--light", "all+", *SIZE, *ONCE, "--global-samples", "64", "--technique",
                     "path_rays:samples=1024", "--out", "out")
        (row,) = records(self.dir / "out")
        self.assertLess(row["metrics"]["shape"]["radiosity_error"], 0.05)
        self.assertEqual([light["reference"]["global"]["samples"] for light in row["lights"]], [64, 64])

    def test_a_scene_that_keeps_all_light_has_no_number_and_says_why(self):
        (self.dir / "bright.toml").write_text(TWO_LAMPS.replace("albedo = [0.5, 0.5, 0.5]", "albedo = [0.5, 1, 0.5]"))
        run = ("run", "--scene", "bright.toml", "--light", "left", *SIZE, *ONCE, "--global-samples", "16")
        self.succeed(*run, "--technique", "path_rays:ending=bounces", "--technique", "path_rays", "--out", "out")
        limited, endless = records(self.dir / "out")
        self.assertIsNone(limited["metrics"]["shape"]["radiosity_error"])
        self.assertIn("albedo of 1", " ".join(limited["notes"]))
        self.assertEqual(endless["status"], "unsupported")
        self.assertIn("albedo of 1", endless["reason"])

    def test_samples_out_of_range_are_refused(self):
        self.refuse("run", *BOX, "--technique", "path_rays", "--global-samples", "8", says=("--global-samples", "8", "16"))
        (self.dir / "few.toml").write_text(SUITE.replace("SAMPLES", "8"))
        self.refuse("run", "few.toml", says=("global_samples", "8", "16 .. 16384", "few.toml"))


TWO_LAMPS = """
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [8, 8]
albedo = [0.5, 0.5, 0.5]

[[shape]]
kind = "box"
min = [-0.5, 0, -0.5]
max = [0.5, 1, 0.5]

[[light]]
name = "left"
kind = "rect"
center = [-2, 3, 1]
half_u = [0.5, 0, 0]
half_v = [0, 0, 0.5]

[[light]]
name = "right"
kind = "sphere"
center = [2, 3, 1]
radius = 0.5

[[view]]
name = "main"
eye = [4, 3, 5]
target = [0, 0.5, 0]
"""


if __name__ == "__main__":
    unittest.main()
