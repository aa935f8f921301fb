#!/usr/bin/python3 -I
"""Rows on a path: measured at every frame, and the reference never flickers against itself."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, ProgramTest, records

SUITE = """
width = 160
height = 90
processes = 1
repetitions = 1
[[group]]
scenes = ["contact"]
lights = ["point"]
paths = ["camera_slide", "light_slide"]
techniques = ["embree_rays", "shadow_map:resolution=64"]
[[group]]
scenes = ["contact"]
lights = ["point"]
techniques = ["embree_rays", "shadow_map:resolution=64"]
"""

SCENE = """
[[mesh]]
file = "box.obj"
[[light]]
name = "lamp"
kind = "point"
position = [2, 4, 1]
[[view]]
name = "front"
eye = [0, 2, 6]
target = [0, 0, 0]
[[path]]
name = "orbit"
moves = "light"
positions = [[2, 4, 1], [1, 4, 2], [-1, 5, 1]]
frames = 5
"""

BOX = "v -3 0 -3\nv -3 0 3\nv 3 0 3\nv 3 0 -3\nv -1 1 0\nv 1 1 0\nv 0 1 1\nf 1 2 3 4\nf 5 6 7\n"


class Motion(ProgramTest):
    def test_metrics_are_means_over_the_frames_and_the_reference_never_flickers(self):
        suite = self.write("small.toml", SUITE)
        self.succeed("run", suite, "--out", "out", "--quiet")
        rows = {(r["path"], r["technique"]): r for r in records(self.dir / "out")}
        self.assertEqual(len(rows), 6)
        for path in ("camera_slide", "light_slide"):
            reference, shadow_map = rows[path, "embree_rays"], rows[path, "shadow_map"]
            self.assertEqual(reference["frames"]["instability"][0], None)
            self.assertEqual(set(reference["frames"]["instability"][1:]), {0})
            self.assertEqual(reference["metrics"]["shape"]["instability"], 0)
            self.assertEqual([reference["metrics"]["shape"][f"flicker_1_{part}"] for part in (60, 15, 4)], [0, 0, 0])
            self.assertGreater(shadow_map["metrics"]["shape"]["flicker_1_60"], 0)
            rates = shadow_map["frames"]["wrong_rate"]
            self.assertEqual(len(rates), 16)
            self.assertAlmostEqual(sum(rates) / 16, shadow_map["metrics"]["shape"]["wrong_rate"], places=12)
            still = rows["", "shadow_map"]
            # The first frame is the still picture, and class counts are sums over frames of the same size.
            self.assertEqual(rates[0], still["metrics"]["shape"]["wrong_rate"])
            self.assertEqual(sum(shadow_map["classes"].values()), 16 * sum(still["classes"].values()))
        # The map is fitted to scene and light, not to the view: what the light does makes it flicker.
        self.assertGreater(rows["light_slide", "shadow_map"]["metrics"]["shape"]["instability"], 0)

    def test_a_path_of_the_scene_is_followed(self):
        self.write("box.obj", BOX)
        self.write("scene.toml", SCENE)
        self.write("suite.toml", '[[group]]\nscenes = ["scene.toml"]\npaths = ["orbit"]\ntechniques = ["unshadowed"]\n')
        self.succeed("run", "suite.toml", "--out", "out", "--processes", "1", "--repetitions", "1", "--size", "96x54", "--quiet")
        (row,) = records(self.dir / "out")
        rates = row["frames"]["wrong_rate"]
        self.assertEqual(len(rates), 5)
        self.assertGreater(len(set(rates)), 2, "the shadow moves, so its size in pixels changes")

    def follow(self, moves, positions, *arguments, technique="unshadowed", frames=5):
        """Arguments of a run on a path of the scene above."""
        self.write("box.obj", BOX)
        path = f'[[path]]\nname = "way"\nmoves = "{moves}"\npositions = {positions}\nframes = {frames}\n'
        sun = '[[light]]\nname = "sun"\nkind = "directional"\ndirection = [0, -1, 0]\n'
        self.write("scene.toml", SCENE + path + sun)
        self.write("suite.toml", f'[[group]]\nscenes = ["scene.toml"]\npaths = ["way"]\ntechniques = ["{technique}"]\n')
        return ["run", "suite.toml", "--out", "out", "--processes", "1", "--repetitions", "1", "--size", "96x54", "--quiet", *arguments]

    def test_frames_that_cannot_be_drawn_are_refused_before_anything_runs(self):
        for moves, positions, says in (
                ("camera", [[0, 0, 6], [0, 0, -6]], ["view 'front': eye = (0, 0, 0) is at its target", "path way, frame 2"]),
                # A third of the way from 0.2 to -0.4: rounding leaves a little of it.
                ("camera", [[0, 0, 0.2], [0, 0, -0.4]], ["is at its target", "frame 2"]),
                ("camera", [[-1, 4, 0], [1, 4, 0]], ["up = (0, 1, 0) lies along the line of sight", "frame 2"]),
                ("light", [[0, -1, 0], [0, 3, 0]], ["light 'sun': direction = (0, 0, 0) is not a direction", "path way, frame 1"])):
            call = self.follow(moves, positions, frames=7 if 0.2 in positions[0] else 5)
            self.refuse(*call, says=["scene.toml, path way, frame ", *says])
            self.assertFalse((self.dir / "out").exists())
        # What a path does to lights that are not requested has no effect.
        self.succeed(*self.follow("light", [[0, -1, 0], [0, 3, 0]], "--light", "lamp", "--dry-run"))

    def test_a_mean_over_some_of_the_frames_is_none(self):
        # The lamp sinks below the floor: there is no pixel to test in the last frame.
        self.succeed(*self.follow("light", [[2, 4, 1], [2, -1, 1]], "--light", "lamp", frames=4))
        (row,) = records(self.dir / "out")
        rates = row["frames"]["wrong_rate"]
        self.assertEqual([rate is None for rate in rates], [False, False, False, True])
        self.assertIsNone(row["metrics"]["shape"]["wrong_rate"])

    def test_support_is_asked_at_every_frame(self):
        for positions, status, support, reason in (
                ([[3, 4, 1], [-1, 4, 1]], "unsupported", "unsupported", "at frame 4: the light is at the left"),
                ([[3, 4, 1], [0, 4, 1]], "ok", "approximate", "at frame 3: the light is near the middle"),
                ([[3, 4, 1], [2, 4, 1]], "ok", "full", "")):
            call = self.follow("light", positions, "--light", "lamp", "--out", f"out{positions[1][0]}", technique="picky")
            call.remove("--out"), call.remove("out")
            self.succeed("--plugin", FAULTS, *call)
            (row,) = records(self.dir / f"out{positions[1][0]}")
            self.assertEqual((row["status"], row["support"], row["reason"]), (status, support, reason))
            self.assertEqual(bool(row["frames"]), status == "ok")
            if status != "ok":
                self.assertEqual((row["metrics"], row["mask"], row["causes"], row["stop"]), ({}, None, None, ""))

    def test_a_path_that_is_not_there_is_refused(self):
        self.write("suite.toml", '[[group]]\nscenes = ["contact"]\npaths = ["orbit"]\ntechniques = ["unshadowed"]\n')
        self.refuse("run", "suite.toml", "--out", "out", says=["scene contact has no path orbit", "camera_slide, light_slide, camera_jump, light_jump"])


if __name__ == "__main__":
    unittest.main()
