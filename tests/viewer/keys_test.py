#!/usr/bin/python3 -IB
"""Every key that moves something, by what it does to the state that is saved after it."""

import json
import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from pictures import read_png  # noqa: E402
from rig import STEP, Saved, ViewerTest, dot, minus, unit  # noqa: E402


def turned(arm, degrees_right, degrees_up):
    """An arm from the target to the eye after the eye went to its right and up, around the y axis."""
    length, azimuth = math.sqrt(dot(arm, arm)), math.atan2(arm[0], arm[2]) + math.radians(degrees_right)
    height = math.asin(arm[1] / length) + math.radians(degrees_up)
    return [length * math.cos(height) * math.sin(azimuth), length * math.sin(height),
            length * math.cos(height) * math.cos(azimuth)]


class Keys(ViewerTest):
    def test_k_l_t_u_choose_the_object_of_composite_also_from_another_scene(self):
        viewer = self.view_scene()
        for key, kind in [("k", "circle"), ("l", "triangle"), ("t", "sphere"), ("u", "cone")]:
            viewer.press(key)
            saved = viewer.save()
            self.assertEqual(saved.scene, f"composite:object={kind}")
            self.assert_near(saved.eye, [-6.5, 5.5, 9])  # as that scene has it
        viewer.press("d", "v", "t")  # a light and a view that were moved stay where they are
        moved = viewer.save()
        self.assertEqual(moved.scene, "composite:object=sphere")
        self.assertNotAlmostEqual(moved.eye[0], -6.5, places=1)
        self.assertLess(moved.light["position"][0], 4)

    def test_camera_keys_orbit_by_5_degrees_and_come_nearer_by_a_tenth(self):
        viewer = self.view_scene()
        arm = [0, 2.5, 6]
        for key, right, up in [("a", -5, 0), ("d", 5, 0), ("s", 0, 5), ("x", 0, -5)]:
            viewer.press(key)
            saved = viewer.save()
            self.assert_near(minus(saved.eye, saved.target), turned(arm, right, up))
            self.assert_near(saved.target, [0, 0.5, 0])
            viewer.press("Home")
        viewer.press("y")
        self.assert_near(minus(viewer.save().eye, [0, 0.5, 0]), [0.9 * x for x in arm])
        viewer.press("c", "c")
        self.assert_near(minus(viewer.save().eye, [0, 0.5, 0]), [x / 0.9 for x in arm])
        viewer.press("Home")
        self.assertEqual(viewer.save().eye, [0, 3, 6])

    def test_keys_that_come_together_act_in_their_order(self):
        viewer = self.view_scene()
        viewer.save()
        with viewer.stopped():
            viewer.xdo("key", "v", "n", "End")
        self.assertEqual(viewer.save().light["position"], [0.5, 2.25, 0.25])
        with viewer.stopped():
            viewer.xdo("key", "d", "Home")
        self.assertEqual(viewer.save().eye, [0, 3, 6])

    def test_light_keys_go_along_x_and_y_by_a_fiftieth_of_the_diagonal(self):
        viewer = self.view_scene()
        place = [0.5, 2.25, 0.25]
        for key, axis, sign in [("v", 0, -1), ("b", 0, 1), ("n", 1, -1), ("m", 1, 1)]:
            viewer.press(key)
            place[axis] += sign * STEP
            saved = viewer.save()
            self.assert_near(saved.light["position"], place)
            self.assertEqual(saved.eye, [0, 3, 6])
        viewer.press("v", "n", "n")
        self.assert_near(viewer.save().light["position"], [place[0] - STEP, place[1] - 2 * STEP, place[2]])
        viewer.press("End")
        self.assertEqual(viewer.save().light["position"], [0.5, 2.25, 0.25])

    def test_light_keys_turn_the_sun_the_way_its_handle_goes(self):
        viewer = self.view_scene("--light", "noon")
        start = unit(viewer.save().light["direction"])
        # The handle at the side that light comes from goes to -x: light travels more to +x. Down: the sun stands lower.
        for key, axis in [("v", 0), ("n", 1)]:
            viewer.press(key)
            direction = unit(viewer.save().light["direction"])
            self.assertGreater(direction[axis], start[axis] + 1e-3)
            viewer.press("End")

    def test_arrows_and_page_keys_fly_eye_and_target_alike(self):
        viewer = self.view_scene()
        forward = unit([0, -2.5, -6])
        for key, way in [("Up", forward), ("Down", [-x for x in forward]), ("Left", [-1, 0, 0]), ("Right", [1, 0, 0]),
                         ("Prior", [0, 1, 0]), ("Next", [0, -1, 0])]:
            viewer.press(key)
            saved = viewer.save()
            self.assert_near(minus(saved.eye, [0, 3, 6]), [STEP * x for x in way])
            self.assert_near(minus(saved.eye, saved.target), [0, 2.5, 6])
            viewer.press("Home")

    def test_a_held_key_goes_on_until_it_is_let_go(self):
        viewer = self.view_scene()
        viewer.xdo("keydown", "Right", "sleep", 3, "keyup", "Right")
        rest = viewer.save()
        # One step at once, and 20 a second from a third of a second on: 54 or so. It may be more where the machine is busy, and is
        # less where it keeps pictures waiting: each is 5 steps at most.
        self.assertGreater(rest.eye[0], 10 * STEP)
        self.assertEqual(viewer.save().eye, rest.eye)

    def test_layouts_and_paints_by_key(self):
        viewer = self.view_scene("--technique", "shadow_map:resolution=64")
        pictures = {}
        for key, paint in zip("567890", ["shaded", "mask", "difference", "kinds", "causes", "classes"]):
            for layout_key, layout in zip("123", ["left", "right", "split"]):
                viewer.press(key, layout_key)
                saved = viewer.save()
                self.assertEqual((saved.window["layout"], saved.window["paint"]), (layout, paint))
                pictures[layout, paint] = saved.picture
            left, right, split = (pictures[layout, paint] for layout in ("left", "right", "split"))
            # The divider covers four columns in the middle.
            self.assertEqual(split.columns(0, 236), left.columns(0, 236))
            self.assertEqual(split.columns(244, 480), right.columns(244, 480))
        # The right side is the reference itself: it is wrong nowhere, and the sides differ where the left one is.
        self.assertEqual(len({pictures["left", paint].pixels for _, paint in pictures if paint != "difference"}), 5)
        self.assertEqual(pictures["right", "kinds"], pictures["right", "causes"])
        self.assertNotEqual(pictures["left", "kinds"], pictures["right", "kinds"])

    def test_flicker_shows_both_sides_in_turn(self):
        viewer = self.view_scene("--technique", "unshadowed")
        viewer.press("1")
        left = viewer.save().picture
        viewer.press("2")
        right = viewer.save().picture
        self.assertNotEqual(left, right)
        viewer.press("4")
        for wanted in (left, right, left):
            viewer.until(lambda saved: saved.picture == wanted, "the other side")

    def test_comma_and_period_step_through_the_techniques_and_tab_swaps_the_sides(self):
        # One whose neighbors in the alphabet support point lights, too: what is unsupported has no mask to save.
        ids = [entry["id"] for entry in json.loads(self.succeed("list", "techniques", "--json"))]
        viewer = self.view_scene("--technique", "stencil_volume", "--against", "unshadowed")
        viewer.press("period")
        after = viewer.save().technique
        viewer.press("comma", "comma")
        before = viewer.save().technique
        here = ids.index("stencil_volume")
        self.assertEqual((before, after), (ids[here - 1], ids[here + 1]))
        viewer.press("Tab")
        saved = viewer.save()
        self.assertEqual((saved.technique, saved.sides["right"]["technique"]), ("unshadowed", before))

    def test_g_goes_through_the_debug_layers_and_o_draws_silhouettes(self):
        viewer = self.view_scene("--technique", "stencil_volume")
        viewer.press("1")
        seen, layers = [viewer.save()], []
        while len(seen) < 2 or seen[-1].sides["left"]["layer"]:
            viewer.press("g")
            seen.append(viewer.save())
            layers.append(seen[-1].sides["left"]["layer"])
        self.assertGreaterEqual({"volumes", "counts", ""}, set(layers[:2]) | {""})
        pictures = [saved.picture for saved in seen]
        self.assertEqual(pictures[0], pictures[-1])
        self.assertEqual(len({picture.pixels for picture in pictures}), len(layers))
        # Overlays are the window's, not the picture's.
        plain = read_png(seen[-1].folder / "window.png")
        viewer.press("o")
        viewer.until(lambda saved: read_png(saved.folder / "window.png").crop(320, 0, 480, 400) != plain.crop(320, 0, 480, 400),
                     "silhouettes")

    def test_w_and_q_choose_a_parameter_and_signs_change_it(self):
        viewer = self.view_scene("--technique", "shadow_map:resolution=64", "--against", "shadow_map:resolution=64")
        viewer.press("w")
        chosen = viewer.save()
        self.assertEqual((chosen.window["parameter"], chosen.technique), ("left.resolution", "shadow_map:resolution=64"))
        viewer.press("equal")
        larger = viewer.save()
        self.assertEqual(larger.technique, "shadow_map:resolution=128")
        self.assertNotEqual(larger.mask, chosen.mask)
        self.assert_renders_alike(larger)
        viewer.press("w", "equal", "q", "minus")
        saved = viewer.save()
        self.assertEqual(saved.sides["left"]["settings"].split(",")[0], "resolution=64")
        self.assertIn("bias=", saved.sides["left"]["settings"])
        self.assertEqual(saved.sides["right"]["settings"], "resolution=64")

    def test_help_panels_and_magnifier_come_and_go(self):
        viewer = self.view_scene()
        viewer.xdo("mousemove", "--window", viewer.window, 560, 200)
        plain = viewer.save()
        for key in ("F1", "h"):
            viewer.press(key)
            helped = viewer.until(lambda saved: read_png(saved.folder / "window.png") != read_png(plain.folder / "window.png"), "help")
            viewer.press("Escape")
        self.assertEqual(helped.picture, plain.picture)
        viewer.press("F2")
        bare = viewer.save()
        self.assertEqual(bare.place, {"x": 0, "y": 0, "width": 800, "height": 620})
        self.assertEqual(bare.size, (800, 620))
        self.assertEqual(bare.window["controls"], {})
        viewer.press("F2")
        self.assertEqual(viewer.save().place, plain.place)

    def test_copy_writes_the_command_and_f12_the_window(self):
        viewer = self.view_scene()
        saved = viewer.save()
        viewer.press("b", "ctrl+c")
        viewer.wait((viewer.out / "02/command.txt").is_file, "the command")
        self.assertEqual((viewer.out / "02/command.txt").read_text().rstrip("\n"), saved.command.replace("out/01", "out/02"))
        self.assertEqual(self.names(viewer.out / "02"), ["command.txt", "scene.toml"])
        viewer.press("F12")
        file = viewer.out / "window-01.png"
        viewer.wait(file.is_file, "the screenshot")
        window = read_png(file)
        self.assertEqual((window.width, window.height), (800, 620))
        self.assertGreater(len({window.at(x, y) for x in range(0, 800, 7) for y in range(0, 620, 7)}), 20)


class Scripted(ViewerTest):
    def test_keys_then_a_screenshot_then_it_ends(self):
        self.environment = self.display.environment(self.environment)
        self.succeed("view", "--scene", "composite", "--size", "480x300", "--keys", "k V v Ctrl+S page up Ctrl+S",
                     "--screenshot", "window.png", "--out", "out")
        self.assertEqual(self.names(self.dir / "out"), sorted(f"{k}/{name}" for k in ("01", "02") for name in (
            "command.txt", "mask.exr", "picture.png", "scene.toml", "window.json", "window.png")))
        window = read_png(self.dir / "window.png")
        self.assertEqual((window.width, window.height), (800, 520))
        self.assertGreater(len({window.at(x, y) for x in range(0, 800, 7) for y in range(0, 520, 7)}), 20)
        self.assertEqual(self.workers(), [])

    def test_parameters_among_the_keys_are_set_in_their_order(self):
        self.environment = self.display.environment(self.environment)
        self.succeed("view", "--scene", "sphere_over_plane", "--size", "480x300", "--out", "out", "--keys",
                     "left.resolution=77 Ctrl+S Tab right.resolution=99 scene.radius=0.5 Ctrl+S")
        first, second = (Saved(self.dir / "out" / k) for k in ("01", "02"))
        self.assertEqual((first.technique, first.scene), ("shadow_map:resolution=77", "sphere_over_plane"))
        self.assertEqual((second.sides["right"]["settings"], second.scene), ("resolution=99", "sphere_over_plane:radius=0.5"))

    def test_without_a_screenshot_too(self):
        self.environment = self.display.environment(self.environment)
        self.succeed("view", "--scene", "composite", "--size", "480x300", "--keys", "Ctrl+S", "--out", "out")
        self.assertTrue((self.dir / "out/01/mask.exr").is_file())


if __name__ == "__main__":
    unittest.main()
