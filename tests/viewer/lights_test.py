#!/usr/bin/python3 -IB
"""Several lights as one picture: what `gnomon render --light all+` makes of them, and one of them can still be moved."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from pictures import read_png  # noqa: E402
from rig import SCENE, STEP, ViewerTest  # noqa: E402

# Above half of the floor.
PANE = """
[[shape]]
kind = "plane"
center = [2, 0.5, 0]
normal = [0, 1, 0]
size = [2, 2]
transmission = [0, 0.5, 1]
"""


def names(saved):
    return [light["name"] for light in saved.lights]


class Together(ViewerTest):
    def test_the_window_shows_what_render_writes_and_a_moved_light_takes_part(self):
        viewer = self.view_scene("--light", "lamp+noon", "--technique", "shadow_map:resolution=64")
        start = viewer.save()
        self.assertEqual((names(start), start.window["light"], start.option("light")), (["lamp", "noon"], "lamp", "all+"))
        viewer.press("v", "n", "1", "5")
        moved = viewer.save()
        self.assertNotEqual(moved.lights[0]["position"], start.lights[0]["position"])
        self.assertEqual(moved.lights[1], start.lights[1])
        folder = self.assert_renders_alike(moved)
        self.assertEqual(moved.picture, read_png(folder / "shaded.png"))
        self.assertNotEqual(moved.picture, start.picture)
        self.assertEqual(len(moved.mask[2]), 2 * 480 * 400)  # a mask of each light
        for key, name in (("6", "mask"), ("9", "error")):
            viewer.press(key)
            ours, theirs = viewer.save().picture, read_png(folder / f"{name}.png")
            # Files have a legend below.
            self.assertEqual(ours.pixels[:3 * 480 * 399], theirs.pixels[:3 * 480 * 399])
        # Its handle is where it was moved to; dragged there, it takes part as well.
        at = moved.pixel_of(moved.lights[0]["position"])
        viewer.drag(viewer.at(moved, *at), viewer.at(moved, at[0] + 40, at[1]))
        dragged = viewer.save()
        self.assertGreater(dragged.lights[0]["position"][0], moved.lights[0]["position"][0])
        self.assertEqual((names(dragged), dragged.eye), (["lamp", "noon"], start.eye))

    def test_lights_that_a_technique_does_not_know_cast_no_shadows_and_the_window_says_so(self):
        viewer = self.view_scene("--light", "all+", "--technique", "center_ray", "--against", "unshadowed")
        saved = viewer.save()
        self.assertEqual(saved.sides["left"]["phase"], "done")
        self.assertIn("lamp, noon", saved.sides["left"]["words"])
        masks, pixels = saved.mask[2], 480 * 400
        dark = [sum(v < 0.5 for v in masks[k * pixels:(k + 1) * pixels]) for k in range(3)]
        self.assertEqual(dark[:2], [0, 0])
        self.assertGreater(dark[2], 100)  # below the triangle

    def test_a_key_and_the_list_go_to_all_lights_and_back_to_one(self):
        viewer = self.view_scene("--technique", "unshadowed", "--against", "unshadowed")
        viewer.press("b", "e")
        together = viewer.save()
        self.assertEqual((names(together), together.option("light")), (["lamp", "noon", "panel"], "all+"))
        self.assertEqual(together.window["together"], ["lamp", "noon", "panel"])
        viewer.press("e")
        alone = viewer.save()
        self.assertEqual((names(alone), alone.light), (["lamp"], together.lights[0]))  # where it was moved to
        self.assertEqual((alone.option("light"), alone.window["together"]), ("lamp", []))
        viewer.choose(alone, "light", "panel")
        panel = viewer.until(lambda s: names(s) == ["panel"], "the panel")
        viewer.choose(panel, "light", "all+")
        again = viewer.until(lambda s: len(s.lights) == 3, "all lights")
        self.assertEqual(again.window["light"], "panel")
        self.assertEqual(again.lights[0]["position"], [0.5, 2.25, 0.25])  # as the scene has it

    def test_a_light_behind_colored_glass_is_one_light_and_its_picture_is_in_color(self):
        self.write("pane.toml", SCENE + PANE)
        viewer = self.view("--scene", "pane.toml", "--size", "480x400", "--technique", "exact_rays")
        start = viewer.save()
        self.assertEqual((names(start), start.option("light")), (["lamp"], "lamp"))
        self.assertEqual(start.window["together"], ["lamp.red", "lamp.green", "lamp.blue"])
        viewer.press("b", "1", "5")
        moved = viewer.save()
        self.assert_near(moved.light["position"], [0.5 + STEP, 2.25, 0.25])
        folder = self.assert_renders_alike(moved)
        self.assertEqual(len(moved.mask[2]), 3 * 480 * 400)
        self.assertEqual(moved.picture, read_png(folder / "shaded.png"))
        # The floor is gray and the triangle red: behind the pane there is no red, half of the green and all blue.
        pixels = moved.picture.pixels
        colored = sum(r < g < b for r, g, b in zip(pixels[::3], pixels[1::3], pixels[2::3]))
        self.assertGreater(colored, 1000)
        # Its green alone stays where the light is, and is gray; then all lights, with it.
        viewer.choose(moved, "light", "lamp.green")
        green = viewer.until(lambda s: not s.window["together"], "the green channel")
        self.assertEqual((names(green), green.light, green.option("light")), (["lamp"], moved.light, "lamp.green"))
        self.assert_renders_alike(green)
        viewer.press("e")
        together = viewer.save()
        self.assertEqual((names(together), len(together.window["together"])), (["lamp", "noon", "panel"], 9))
        self.assertEqual((together.lights[0], together.option("light")), (moved.light, "all+"))
        viewer.press("e")
        alone = viewer.save()
        self.assertEqual((names(alone), alone.light, alone.option("light")), (["lamp"], moved.light, "lamp"))


if __name__ == "__main__":
    unittest.main()
