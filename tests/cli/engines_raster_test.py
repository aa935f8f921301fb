#!/usr/bin/python3 -IB
"""EEVEE and Godot: lit where nothing casts, shadows where the reference has them, and their own settings count."""

import os
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from engines_browser_test import run_on  # noqa: E402
from program import ProgramTest  # noqa: E402

GROUND = """
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [6, 6]
[[light]]
name = "sun"
kind = "directional"
direction = [0.3, -1, 0.2]
[[light]]
name = "point"
kind = "point"
position = [1, 3, 1]
[[light]]
name = "spot"
kind = "spot"
position = [1, 3, 1]
direction = [-0.2, -1, -0.2]
inner_degrees = 15
outer_degrees = 30
[[view]]
name = "view"
eye = [1, 5, 4]
target = [0, 0, 0]
fov_y_degrees = 45
"""
# A card one meter above the ground, large beside any bias.
CARD = """
[[shape]]
kind = "plane"
center = [0, 1, 0]
normal = [0, 1, 0]
size = [1.5, 1.5]
"""
PROGRAMS = {"eevee:samples=1": "blender", "godot": "godot3-runner"}
ENGINES = tuple(technique for technique, program in PROGRAMS.items() if shutil.which(program))


@unittest.skipUnless(ENGINES, "there is neither Blender nor Godot")
class EngineRaster(ProgramTest):
    def setUp(self):
        super().setUp()
        self.environment["PATH"] = os.environ["PATH"]

    def errors(self, scene, *techniques, lights=("sun", "point", "spot")):
        """The mean error of each technique under each light; all rows must be there."""
        words = [word for light in lights for word in ("--light", light)]
        rows = run_on(self, scene, *techniques, more=(*words, "--truth", "mesh", "--timeout", "300"))
        self.assertEqual(len(rows), len(lights) * len(techniques))
        for row in rows:
            self.assertEqual(row["status"], "ok", row)
        return {(row["technique"], row["light"]): row["metrics"]["mesh"]["error"] for row in rows}

    def test_a_ground_alone_is_lit(self):
        for place, error in self.errors(self.write("ground.toml", GROUND), *ENGINES).items():
            self.assertLessEqual(error, 1e-3, place)  # some acne at Godot's own bias

    def test_a_card_casts_its_shadow(self):
        found = self.errors(self.write("card.toml", GROUND + CARD), "unshadowed", *ENGINES)
        lit = {light: error for (technique, light), error in found.items() if technique == "unshadowed"}
        for (technique, light), error in found.items():
            self.assertGreater(lit[light], 0.01)
            if technique != "unshadowed":
                self.assertLess(error, lit[light] / 4, (technique, light))

    def test_a_bias_of_more_than_the_gap_leaves_no_shadow(self):
        settings = {"eevee:samples=1": "eevee:samples=1,bias=100", "godot": "godot:bias=16,sun_bias=16"}
        scene = self.write("card.toml", GROUND + CARD)
        for engine in ENGINES:
            found = self.errors(scene, "unshadowed", settings[engine], lights=("point",))
            self.assertAlmostEqual(found[settings[engine].split(":")[0], "point"], found["unshadowed", "point"], delta=0.01)


if __name__ == "__main__":
    unittest.main()
