#!/usr/bin/python3 -IB
"""A scene that moves: played, stepped and scrubbed; a time has one picture, and its command renders it again."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from rig import ViewerTest  # noqa: E402

BOXES = ("--scene", "walking_boxes", "--technique", "shadow_map:resolution=256", "--size", "480x500")
LAST = 120  # the walk lasts 2 s


class Animation(ViewerTest):
    def walk(self):
        return self.view(*BOXES, "--animation", "walk")

    def frame(self, saved):
        """The number of the frame that is shown, paused; what was saved names its time."""
        shown = saved.window["animation"]
        self.assertEqual((shown["name"], shown["frames"], shown["playing"]), ("walk", LAST + 1, False))
        self.assertAlmostEqual(shown["seconds"], shown["frame"] / 60, delta=1e-12)
        scene, seconds = saved.scene.split("@walk=")
        self.assertEqual((scene, float(seconds)), ("walking_boxes", shown["seconds"]))
        return shown["frame"]

    def test_opens_paused_and_steps_to_pictures_that_render_makes(self):
        viewer = self.walk()
        start = viewer.save()
        self.assertEqual((self.frame(start), start.scene), (0, "walking_boxes@walk=0"))
        self.assert_renders_alike(start)
        viewer.press("bracketleft")
        self.assertEqual(self.frame(viewer.save()), 0)
        viewer.press("bracketright", "bracketright", "bracketright")
        third = viewer.save()
        self.assertEqual((self.frame(third), third.scene), (3, "walking_boxes@walk=0.05"))
        self.assertNotEqual(third.picture, start.picture)
        self.assert_renders_alike(third)
        # Back at a time, its picture is there again.
        viewer.press("bracketleft", "bracketleft", "bracketleft")
        again = viewer.save()
        self.assertEqual(self.frame(again), 0)
        self.assertEqual((again.picture, again.mask), (start.picture, start.mask))

    def test_a_saved_time_opens_as_a_still(self):
        viewer = self.walk()
        viewer.press("bracketright", "bracketright")
        saved = viewer.save()
        viewer.close()
        still = self.view("--scene", saved.folder / "scene.toml", *BOXES[2:])
        again = still.save()
        self.assertEqual((again.picture, again.mask), (saved.picture, saved.mask))
        self.assertIsNone(again.window["animation"])
        self.assertFalse(again.has("play"))
        still.press("space")
        self.assertEqual(still.save().window["message"], "this scene has no animation")

    def test_the_slider_scrubs_and_the_list_goes_back_to_rest(self):
        viewer = self.walk()
        start = viewer.save()
        viewer.use(start, "frame")
        middle = viewer.until(lambda s: s.window["animation"]["frame"] > 0, "the slider")
        self.assertAlmostEqual(self.frame(middle), LAST / 2, delta=6)
        slider = middle.window["controls"]["frame"]
        y = slider["y"] + slider["height"] / 2
        viewer.drag(middle.control("frame"), (slider["x"] + slider["width"] - 2, y))
        end = viewer.until(lambda s: s.window["animation"]["frame"] == LAST, "the end")
        self.assertEqual(self.frame(end), LAST)
        self.assertEqual(end.scene, "walking_boxes@walk=2")
        viewer.choose(end, "animation", "rest")
        rest = viewer.until(lambda s: s.window["animation"] is None, "the rest")
        self.assertEqual(rest.scene, "walking_boxes")
        self.assert_renders_alike(rest)

    def test_plays_in_real_time_until_it_is_saved(self):
        viewer = self.walk()
        start = viewer.save()
        viewer.xdo("key", "space", "sleep", 1, "key", "ctrl+s")
        saved = viewer.saved(viewer.out / "02")
        # Of the second some is left where the machine is busy: the time is that of the last picture before the key.
        self.assertGreater(self.frame(saved), 10)
        self.assertNotEqual(saved.picture, start.picture)
        self.assert_renders_alike(saved)
        # It stays there, and the camera moves about that pose.
        viewer.press("d")
        turned = viewer.save()
        self.assertEqual(self.frame(turned), self.frame(saved))
        self.assertNotEqual(turned.eye, saved.eye)
        self.assert_renders_alike(turned)

    def test_keys_begin_the_first_animation_of_a_scene_at_rest(self):
        viewer = self.view(*BOXES)
        rest = viewer.save()
        self.assertEqual((rest.scene, rest.window["animation"]), ("walking_boxes", None))
        viewer.press("bracketright")
        self.assertEqual(self.frame(viewer.save()), 0)

    def test_a_scene_without_animations_says_so_and_nothing_else_is_new(self):
        viewer = self.view_scene()
        before = viewer.save()
        self.assertFalse(any(before.has(name) for name in ("animation", "frame", "play", "loop")))
        for key in ("space", "bracketleft", "bracketright"):
            viewer.press(key)
            saved = viewer.save()
            self.assertEqual(saved.window["message"], "this scene has no animation")
            self.assertEqual((saved.picture, saved.scene), (before.picture, before.scene))


class Scripted(ViewerTest):
    def test_a_script_plays_to_the_end_which_is_the_beginning_of_a_walk_around(self):
        self.environment = self.display.environment(self.environment)
        self.succeed("view", *BOXES, "--animation", "walk", "--keys", "Ctrl+S ] ] Ctrl+S [ Ctrl+S Space Ctrl+S", "--out", "out")
        folders = [self.dir / "out" / f"{k:02}" for k in range(1, 5)]
        times = [(folder / "scene.toml").read_text().split("@walk=")[1].split('"')[0] for folder in folders]
        self.assertEqual(times, ["0", "0.03333333333333333", "0.016666666666666666", "2"])
        first, second, _, last = ((folder / "mask.exr").read_bytes() for folder in folders)
        self.assertEqual(first, last)
        self.assertNotEqual(first, second)

    def test_what_cannot_be_played_is_refused_before_a_window_opens(self):
        self.refuse("view", "--scene", "walking_boxes", "--animation", "run", says=["walking_boxes", "run", "walk"])
        self.refuse("view", "--scene", "composite", "--animation", "walk", says=["composite", "no animation"])
        self.refuse("view", "--scene", "walking_boxes@0.5", "--animation", "walk", says=["walking_boxes@", "no animation"])


if __name__ == "__main__":
    unittest.main()
