#!/usr/bin/python3 -IB
"""The mouse, in the picture and on the controls, by what it does to the state that is saved after it."""

import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from rig import ViewerTest, cross, dot, minus, unit  # noqa: E402

HEIGHT = 400  # of the picture


class Picture(ViewerTest):
    def test_a_left_drag_turns_the_eye_about_the_target(self):
        viewer = self.view_scene()
        start = viewer.save()
        # 40 pixels of 400 to the right: the scene follows, so the eye goes a tenth of half a turn to the left.
        viewer.drag(viewer.at(start, 100, 300), viewer.at(start, 140, 300))
        saved = viewer.save()
        self.assertEqual(saved.target, start.target)
        angle = math.radians(-18)
        self.assert_near(minus(saved.eye, saved.target), [6 * math.sin(angle), 2.5, 6 * math.cos(angle)])
        viewer.drag(viewer.at(start, 100, 300), viewer.at(start, 60, 300))
        self.assert_near(viewer.save().eye, start.eye)
        viewer.drag(viewer.at(start, 100, 200), viewer.at(start, 100, 240))  # down: the eye goes up
        arm = minus(viewer.save().eye, start.target)
        self.assertAlmostEqual(math.degrees(math.asin(arm[1] / 6.5)), math.degrees(math.asin(2.5 / 6.5)) + 18, delta=1e-3)

    def test_pan_moves_eye_and_target_so_that_the_target_follows_the_mouse(self):
        viewer = self.view_scene()
        for how in ({"button": 2}, {"key": "shift"}):
            start = viewer.save()
            viewer.drag(viewer.at(start, 100, 300), viewer.at(start, 150, 270), **how)
            saved = viewer.save()
            shift = minus(saved.eye, start.eye)
            self.assert_near(shift, minus(saved.target, start.target), 1e-5)
            pixel = 2 * math.tan(math.radians(45) / 2) / HEIGHT * 6.5
            right, forward = [1, 0, 0], unit(minus(start.target, start.eye))
            up = cross(right, forward)
            self.assert_near([dot(shift, right), dot(shift, up), dot(shift, forward)], [-50 * pixel, -30 * pixel, 0])

    def test_a_right_drag_turns_the_target_about_the_eye(self):
        viewer = self.view_scene()
        start = viewer.save()
        viewer.drag(viewer.at(start, 300, 300), viewer.at(start, 260, 300), button=3)
        saved = viewer.save()
        self.assertEqual(saved.eye, start.eye)
        arm = minus(saved.target, saved.eye)
        self.assertAlmostEqual(math.sqrt(dot(arm, arm)), 6.5, delta=1e-4)
        self.assertAlmostEqual(arm[1], -2.5, delta=1e-4)
        self.assertGreater(arm[0], 0.3)  # what was in the middle is left of it now

    def test_the_wheel_comes_nearer_by_a_tenth_and_back(self):
        viewer = self.view_scene()
        start = viewer.save()
        viewer.move(*viewer.at(start, 100, 300))
        viewer.xdo("click", 4, "click", 4)
        self.assert_near(minus(viewer.save().eye, start.target), [0, 0.81 * 2.5, 0.81 * 6])
        viewer.xdo("click", 5)
        self.assert_near(minus(viewer.save().eye, start.target), [0, 0.9 * 2.5, 0.9 * 6])
        viewer.move(50, 300)  # over the controls it scrolls those
        viewer.xdo("click", 4)
        self.assert_near(minus(viewer.save().eye, start.target), [0, 0.9 * 2.5, 0.9 * 6])

    def test_the_light_is_dragged_by_its_handle_and_stays_under_the_mouse(self):
        viewer = self.view_scene()
        start = viewer.save()
        x, y = start.light_pixel()
        self.assertTrue(14 < x < 466 and 14 < y < 386, (x, y))
        viewer.drag(viewer.at(start, x, y), viewer.at(start, x - 60, y + 50))
        saved = viewer.save()
        self.assertEqual((saved.eye, saved.target), (start.eye, start.target))
        self.assert_near(saved.light_pixel(), (x - 60, y + 50), 0.6)  # the mouse goes in whole pixels
        forward = unit(minus(start.target, start.eye))
        moved = minus(saved.light["position"], start.light["position"])
        self.assertAlmostEqual(dot(moved, forward), 0, delta=1e-4)  # across the line of sight
        x, y = saved.light_pixel()
        viewer.drag(viewer.at(saved, x, y), viewer.at(saved, x + 30, y - 40), key="shift")
        raised = viewer.save()
        moved = minus(raised.light["position"], saved.light["position"])
        self.assertEqual((moved[0], moved[2]), (0, 0))
        self.assertGreater(moved[1], 0.2)

    def test_the_divider_is_dragged(self):
        viewer = self.view_scene("--technique", "unshadowed")
        start = viewer.save()
        self.assertEqual(start.window["divider"], 0.5)
        viewer.drag(viewer.at(start, 240, 350), viewer.at(start, 120, 350))
        saved = viewer.save()
        self.assertAlmostEqual(saved.window["divider"], 0.25, delta=1 / 480)
        self.assertEqual(saved.eye, start.eye)
        viewer.press("1")
        left = viewer.save().picture
        viewer.press("2")
        right = viewer.save().picture
        self.assertEqual(saved.picture.columns(0, 116), left.columns(0, 116))
        self.assertEqual(saved.picture.columns(124, 480), right.columns(124, 480))

    def test_a_click_picks_the_pixel_under_the_mouse_and_escape_drops_it(self):
        viewer = self.view_scene()
        saved = viewer.save()
        self.assertIsNone(saved.picked)
        for x, y in [(100, 300), (0, 0), (479, 399), (300, 220)]:
            viewer.click(*viewer.at(saved, x, y))
            self.assertEqual(viewer.until(lambda s, at=[x, y]: s.picked == at, "the pick").eye, saved.eye)
        viewer.click(4, 615)  # beside the picture
        self.assertEqual(viewer.save().picked, [300, 220])
        viewer.press("Escape")
        self.assertIsNone(viewer.save().picked)


class Controls(ViewerTest):
    def test_techniques_are_chosen_from_the_list_of_each_side(self):
        viewer = self.view_scene()
        viewer.choose(viewer.save(), "left.technique", "svbsp")
        saved = viewer.until(lambda s: s.technique == "svbsp", "the technique")
        self.assertEqual(saved.sides["right"]["technique"], "embree_rays")
        viewer.resize(800, 1100)
        saved = viewer.until(lambda s: s.has("right.technique"), "a taller window")
        viewer.choose(saved, "right.technique", "unshadowed")
        saved = viewer.until(lambda s: s.sides["right"]["technique"] == "unshadowed", "the technique")
        self.assertEqual(saved.technique, "svbsp")

    def test_a_slider_sets_a_parameter_of_the_command(self):
        viewer = self.view_scene()
        saved = viewer.save()
        place = saved.window["controls"]["left.resolution"]
        middle = place["y"] + place["height"] / 2
        viewer.drag(saved.control("left.resolution"), (place["x"] + 1, middle))
        saved = viewer.until(lambda s: s.technique != "shadow_map", "the parameter")
        self.assertEqual(saved.technique, "shadow_map:resolution=64")  # the left end of its range
        self.assert_renders_alike(saved)
        viewer.drag((place["x"] + 2, middle), (place["x"] + place["width"] / 3, middle))
        saved = viewer.until(lambda s: s.technique != "shadow_map:resolution=64", "the parameter")
        self.assertRegex(saved.technique, r"^shadow_map:resolution=\d+$")
        self.assertTrue(64 < int(saved.technique.split("=")[1]) < 1024, saved.technique)

    def test_a_choice_and_a_flag_are_set_and_reset_puts_all_back(self):
        viewer = self.view_scene()
        viewer.resize(800, 1100)
        saved = viewer.until(lambda s: s.has("left.reset"), "a taller window")
        viewer.choose(saved, "left.filter", "pcf")
        saved = viewer.until(lambda s: s.technique == "shadow_map:filter=pcf", "the choice")
        viewer.use(saved, "left.reset")
        saved = viewer.until(lambda s: s.technique == "shadow_map", "the defaults")
        self.assertEqual(saved.sides["left"]["settings"], "")
        viewer.choose(saved, "left.technique", "svbsp")
        saved = viewer.until(lambda s: s.technique == "svbsp" and s.has("left.merge"), "another technique")
        viewer.use(saved, "left.merge")
        saved = viewer.until(lambda s: "merge=false" in s.technique, "the flag")
        viewer.use(saved, "left.reset")
        self.assertEqual(viewer.until(lambda s: s.technique == "svbsp", "the defaults").sides["left"]["settings"], "")

    def test_scene_light_and_view_are_chosen_from_lists(self):
        viewer = self.view_scene()
        viewer.choose(viewer.save(), "light", "noon")
        saved = viewer.until(lambda s: s.light["name"] == "noon", "the light")
        viewer.choose(saved, "view", "side")
        saved = viewer.until(lambda s: s.view["name"] == "side", "the view")
        self.assertEqual(saved.eye, [6, 2, 1])
        viewer.choose(saved, "scene", "fence")
        saved = viewer.until(lambda s: s.scene == "fence", "the scene")
        self.assertEqual(saved.option("scene"), f"{saved.folder.relative_to(self.dir)}/scene.toml")
        self.assert_renders_alike(saved)

    def test_a_scene_file_is_opened_by_its_path_and_a_broken_one_is_not(self):
        viewer = self.view("--scene", "composite", "--size", "480x400")
        self.write("pier.toml", '[[shape]]\nkind = "plane"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [2, 2]\n')
        self.write("pipe.toml", "[[shape]]\nkind = 1\n")
        saved = viewer.save()

        def type_path(path):
            viewer.use(saved, "scene.file")
            viewer.until(lambda s: s.window["typing"], "the field")  # what is typed before that are keys
            viewer.xdo("type", path)
            viewer.press("Return")

        type_path("pier.toml")
        viewer.until(lambda s: s.scene.endswith("pier.toml"), "the scene")
        type_path("pipe.toml")
        refused = viewer.until(lambda s: "pipe.toml" in s.window["scene_error"], "the error")
        self.assertTrue(refused.scene.endswith("pier.toml"), refused.scene)  # the scene stays as it is
        type_path("pier.toml")
        opened = viewer.until(lambda s: not s.window["scene_error"], "the scene")
        self.assertTrue(opened.scene.endswith("pier.toml"), opened.scene)
        self.assert_renders_alike(viewer.save())

    def test_text_typed_faster_than_pictures_are_drawn_is_kept(self):
        viewer = self.view_scene()
        self.write("pier.toml", '[[shape]]\nkind = "plane"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [2, 2]\n')
        viewer.use(viewer.save(), "scene.file")
        viewer.until(lambda s: s.window["typing"], "the field")
        with viewer.stopped():
            viewer.xdo("type", "pier.toml")
            viewer.xdo("key", "Return", "keydown", "ctrl")  # the Control of the next Ctrl+S
        viewer.until(lambda s: s.scene.endswith("pier.toml"), "the scene")


if __name__ == "__main__":
    unittest.main()
