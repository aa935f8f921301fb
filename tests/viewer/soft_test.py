#!/usr/bin/python3 -IB
"""What there is to look at under a light with area: its size, signed differences, contours, and profiles along a line."""

import csv
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from pictures import read_png  # noqa: E402
from rig import ViewerTest  # noqa: E402


def colors_of(picture):
    return [picture.at(x, y) for x in range(picture.width) for y in range(picture.height)]


def hue(color):
    """What is left of a color that is blended with gray."""
    low, high = min(color), max(color)
    return tuple(round((part - low) / (high - low), 1) for part in color)


class LightSize(ViewerTest):
    # The rectangle is 1 m wide, 3 m over the floor: half_u goes 0.5 m to the right in the picture, half_v 0.5 m toward the eye.

    def test_a_handle_of_the_outline_sets_a_length_and_leaves_the_rest(self):
        viewer = self.view_scene("--light", "panel", "--technique", "center_ray")
        start = viewer.save()
        middle, side = start.pixel_of([0.5, 3, 0]), start.pixel_of([1, 3, 0])
        # Twice as far from the center, along its row, for it is level in the picture.
        viewer.drag(viewer.at(start, *side), viewer.at(start, 2 * side[0] - middle[0], side[1]))
        wide = viewer.save()
        self.assert_near(wide.light["half_u"], [1, 0, 0], 0.01)  # the mouse goes in whole pixels
        self.assertEqual((wide.light["half_v"], wide.light["center"]), ([0, 0, 0.5], [0.5, 3, 0]))
        self.assertEqual((wide.eye, wide.target), (start.eye, start.target))
        # The handle on the other side, back by half.
        left = wide.pixel_of([-0.5, 3, 0])
        viewer.drag(viewer.at(wide, *left), viewer.at(wide, (left[0] + middle[0]) / 2, left[1]))
        self.assert_near(viewer.save().light["half_u"], [0.5, 0, 0], 0.01)

    def test_the_panel_sets_lengths_and_the_saved_command_renders_that_light(self):
        viewer = self.view_scene("--light", "panel", "--technique", "center_ray", "--against", "unshadowed")
        viewer.drag(viewer.save().control("light.half_v"), (350, 300))
        saved = viewer.until(lambda s: s.light["half_v"] != [0, 0, 0.5], "the length")
        self.assertEqual((saved.light["half_v"][:2], saved.light["half_u"]), ([0, 0], [0.5, 0, 0]))
        self.assertGreater(saved.light["half_v"][2], 0.5)
        self.assert_renders_alike(saved)

    def test_its_outline_is_in_the_window_and_a_point_light_has_none(self):
        viewer = self.view_scene("--light", "panel", "--technique", "unshadowed", "--against", "unshadowed")
        viewer.press("1")
        viewer.xdo("mousemove", "--window", viewer.window, 2, 2)
        saved = viewer.save()
        corner = viewer.at(saved, *saved.pixel_of([0, 3, 0]))  # the middle of its left side
        window = read_png(saved.folder / "window.png")
        around = {window.at(round(corner[0]) + x, round(corner[1]) + y) for x in (-1, 0, 1) for y in (-1, 0, 1)}
        self.assertIn((255, 214, 102), around)
        viewer.choose(saved, "light", "lamp")
        saved = viewer.until(lambda s: s.light["name"] == "lamp", "the lamp")
        window = read_png(saved.folder / "window.png")
        self.assertNotEqual(window.at(round(corner[0]), round(corner[1])), (255, 214, 102))


class Comparing(ViewerTest):
    def test_a_profile_is_drawn_with_control_and_saved_with_its_values(self):
        viewer = self.view_scene("--light", "panel", "--technique", "center_ray")
        start = viewer.save()
        self.assertIsNone(start.window["profile"])
        self.assertFalse((start.folder / "profile.csv").exists())
        viewer.drag(viewer.at(start, 60, 280), viewer.at(start, 360, 280), key="ctrl")
        saved = viewer.until(lambda s: s.window["profile"], "the profile")
        self.assertEqual(saved.window["profile"], [60, 280, 360, 280])
        self.assertEqual((saved.eye, saved.picked), (start.eye, None))
        with (saved.folder / "profile.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["distance_pixels", "column", "row", "left", "right", "reference", "standard_error"])
        self.assertEqual([float(row["distance_pixels"]) for row in rows], list(range(301)))
        width, _, mask = saved.mask
        for row in rows:
            at = int(row["row"]) * width + int(row["column"])
            if row["left"]:
                self.assertAlmostEqual(float(row["left"]), mask[at], delta=1e-6)
                self.assertEqual(row["right"], row["reference"])  # the right side shows it
        known = [row for row in rows if row["left"]]
        self.assertGreater(len(known), 200)  # of the floor
        shares = [float(row["reference"]) for row in known]
        self.assertTrue(any(0.1 < share < 0.9 for share in shares), "a penumbra")
        self.assertTrue(all(0 <= float(row["standard_error"]) < 0.01 for row in known))
        viewer.press("Escape")
        self.assertIsNone(viewer.save().window["profile"])
        viewer.press("p")
        self.assertEqual(viewer.save().window["profile"], [0.5, 200, 479.5, 200])
        viewer.press("p")
        self.assertIsNone(viewer.save().window["profile"])

    def test_differences_are_signed_and_their_scale_is_chosen(self):
        viewer = self.view_scene("--light", "panel", "--technique", "center_ray", "--against", "unshadowed")
        viewer.press("1", "7")
        whole = viewer.save()
        self.assertEqual(whole.window["difference"], {"against": "reference", "full_scale": 1, "plain": False})
        viewer.use(whole, "plain")
        plain = viewer.until(lambda s: s.window["difference"]["plain"], "plain colors")
        viewer.choose(plain, "full_scale", "0.03")
        fine = viewer.until(lambda s: s.window["difference"]["full_scale"] == 0.03, "the scale")
        # The center's ray is too dark by up to a half within the hard shadow, too light beside it: both ends of the small
        # scale occur, and not those of the whole one.
        ends = {(110, 38, 0), (8, 45, 100)}
        self.assertEqual(ends & set(colors_of(fine.picture)), ends)
        self.assertFalse(ends & set(colors_of(plain.picture)))
        viewer.use(fine, "against.other_side")
        other = viewer.until(lambda s: s.window["difference"]["against"] == "other_side", "the other side")
        # The other side is lit everywhere: nothing is lighter than that.
        self.assertEqual(ends & set(colors_of(other.picture)), {(110, 38, 0)})

    def test_error_against_samples_is_measured_at_a_button_and_goes_with_the_next_change(self):
        viewer = self.view_scene("--light", "panel", "--technique", "area_rays:samples=4,pattern=random")
        viewer.resize(800, 860)  # as tall as the controls
        start = viewer.until(lambda s: s.has("left.curve"), "the button")
        self.assertIsNone(start.window["curve"])
        viewer.use(start, "left.curve")
        saved = viewer.until(lambda s: s.window["curve"], "the curve")  # saved when it is complete
        curve = saved.window["curve"]
        self.assertTrue(curve["complete"])
        self.assertEqual(curve["samples"], [4 ** k for k in range(len(curve["samples"]))])
        self.assertGreater(len(curve["samples"]), 3)
        for coarse, fine in zip(curve["error"], curve["error"][1:]):
            self.assertLess(fine, coarse)
        self.assertEqual((saved.technique, saved.mask), (start.technique, start.mask))
        self.assertNotEqual(read_png(saved.folder / "window.png"), read_png(start.folder / "window.png"))
        viewer.press("v")
        self.assertIsNone(viewer.save().window["curve"])

    def test_causes_of_a_techniques_own_are_those_of_a_row(self):
        viewer = self.view_scene("--light", "panel", "--technique", "denoised_rays")
        viewer.press("1", "9")
        saved = viewer.save()
        hues = [hue(color) for color in colors_of(saved.picture) if max(color) - min(color) > 25]
        # residual_noise and over_blur in the place of the common causes, false_sample and noise.
        for own in ((0, 180, 204), (252, 252, 120)):
            self.assertGreater(hues.count(hue(own)), 10)
        for common in ((139, 178, 133), (200, 226, 242)):
            self.assertNotIn(hue(common), hues)

    def test_a_save_that_comes_with_a_click_shows_what_was_clicked(self):
        viewer = self.view_scene("--light", "panel", "--technique", "center_ray")
        viewer.press("1", "6")
        without = viewer.save()
        viewer.press("i")
        first = viewer.save()
        for k in range(4):
            viewer.move(*first.control("contours"))
            folder = viewer.next_folder()
            with viewer.stopped():
                viewer.xdo("click", 1)
                viewer.xdo("key", "ctrl+s")
            saved = viewer.saved(folder)
            wanted = first if saved.window["contours"] else without
            self.assertEqual(saved.picture, wanted.picture, k)

    def test_contours_come_and_go(self):
        viewer = self.view_scene("--light", "panel", "--technique", "center_ray")
        viewer.press("1", "6")
        plain = viewer.save().picture
        viewer.press("i")
        saved = viewer.save()
        self.assertTrue(saved.window["contours"])
        yellow = sum(r > 180 and g > 150 and b < 90 for r, g, b in colors_of(saved.picture))
        self.assertGreater(yellow, 50, "the side's own")
        self.assertNotEqual(saved.picture, plain)
        viewer.use(saved, "contours")
        self.assertEqual(viewer.until(lambda s: not s.window["contours"], "no contours").picture, plain)


if __name__ == "__main__":
    unittest.main()
