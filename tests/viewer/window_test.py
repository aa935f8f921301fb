#!/usr/bin/python3 -IB
"""The window itself: resized, on a screen of many dots, closed, killed, and where there is none."""

import os
import signal
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from pictures import read_png  # noqa: E402
from rig import FAULTS, PATIENCE, Display, ViewerTest  # noqa: E402


class Size(ViewerTest):
    def test_the_picture_follows_the_window_and_the_mouse_the_picture(self):
        viewer = self.view_scene()
        for width, height in [(901, 703), (700, 560), (1203, 811)]:
            viewer.resize(width, height)
            saved = viewer.until(lambda s, size=(width - 320, height - 220): s.size == size, "the size")
            window = read_png(saved.folder / "window.png")
            self.assertEqual((window.width, window.height), (width, height))
            place = saved.place
            self.assertEqual((place["width"], place["height"]), saved.size)
            x, y = place["width"] - 3, place["height"] - 2
            viewer.click(*viewer.at(saved, x, y))
            picked = viewer.until(lambda s, at=[x, y]: s.picked == at, "the pick")
            viewer.press("Escape", "1")
            # What is on the screen there is that pixel; the light's handle and names lie elsewhere.
            saved = viewer.until(lambda s: s.picked is None, "no pick")
            window = read_png(saved.folder / "window.png").crop(place["x"], place["y"], place["width"], place["height"])
            for at in [(x, y), (5, y), (x, place["height"] // 2), (place["width"] // 3, y - 20)]:
                self.assertEqual(window.at(*at), saved.picture.at(*at), at)
            viewer.press("3")
            self.assertEqual(picked.eye, [0, 3, 6])
        self.assert_renders_alike(saved)


class ManyDots(ViewerTest):
    resources = "Xft.dpi: 192\n"

    def test_everything_is_twice_as_large_and_clicks_still_hit(self):
        viewer = self.view_scene()
        saved = viewer.save()
        self.assertEqual(saved.window["window"], {"width": 480 + 640, "height": 400 + 440, "scale": 2.0})
        self.assertEqual(saved.size, (480, 400))
        self.assertGreaterEqual(saved.window["controls"]["save"]["height"], 36)
        viewer.resize(1120, 1200)
        saved = viewer.until(lambda s: s.size == (480, 760), "the size")
        viewer.choose(saved, "left.technique", "svbsp")
        saved = viewer.until(lambda s: s.technique == "svbsp", "the technique")
        viewer.click(*viewer.at(saved, 123, 321))
        viewer.until(lambda s: s.picked == [123, 321], "the pick")
        x, y = saved.light_pixel()
        viewer.drag(viewer.at(saved, x, y), viewer.at(saved, x - 50, y + 60))
        saved = viewer.save()
        self.assert_near(saved.light_pixel(), (x - 50, y + 60), 0.6)
        self.assert_renders_alike(saved)


class Ends(ViewerTest):
    def scratch(self, viewer):
        return [Path(root) / f"gnomon-view-{viewer.process.pid}" for root in ("/dev/shm", os.environ.get("TMPDIR", "/tmp"))]

    def started(self):
        viewer = self.view_scene("--against", "svbsp")
        viewer.save()
        self.assertEqual(len(self.workers()), 3)  # the viewer, and a worker a side
        self.assertTrue(any(path.is_dir() for path in self.scratch(viewer)))
        return viewer

    def test_ctrl_q_the_window_s_button_and_signals_end_it_without_a_trace(self):
        for how in ("ctrl+q", "button", signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            with self.subTest(str(how)):
                viewer = self.started()
                if how == "ctrl+q":
                    viewer.press(how)
                elif how == "button":
                    viewer.ask_to_close()
                else:
                    viewer.process.send_signal(how)
                self.assertEqual(viewer.process.wait(PATIENCE), 0, viewer.words())
                self.assert_gone()
                self.assertEqual([path for path in self.scratch(viewer) if path.exists()], [])
                self.assertEqual(viewer.words(), "")
                self.assertEqual([name for name in self.names(viewer.out) if "part" in name], [])

    def test_a_stop_is_heard_while_a_technique_computes(self):
        viewer = self.view_scene("--technique", "hangs", "--timeout", 2 * PATIENCE, options=["--plugin", FAULTS])
        viewer.wait(lambda: len(self.workers()) > 1, "the technique's worker")
        viewer.process.send_signal(signal.SIGTERM)
        self.assertEqual(viewer.process.wait(PATIENCE), 0, viewer.words())
        self.assert_gone()

    def test_killed_it_leaves_no_worker_and_the_next_one_clears_its_files_away(self):
        viewer = self.started()
        viewer.process.kill()
        viewer.process.wait(PATIENCE)
        self.assert_gone()
        next_one = self.view_scene()
        next_one.save()
        self.assertEqual([path for path in self.scratch(viewer) if path.exists()], [])

    def test_when_the_display_goes_so_does_it(self):
        display = Display()
        self.addCleanup(display.close)
        viewer = self.view_scene(display=display)
        viewer.save()
        display.close()
        self.assertNotEqual(viewer.process.wait(PATIENCE), 0)
        self.assert_gone()


class Refused(ViewerTest):
    def test_without_a_display_it_says_so_and_exits_with_2(self):
        self.environment.pop("WAYLAND_DISPLAY", None)
        self.environment.pop("DISPLAY", None)
        self.refuse("view", says=["no display", "DISPLAY is not set", "gnomon render"])
        self.environment["DISPLAY"] = ":4711"
        self.refuse("view", says=["no display", "DISPLAY is :4711"])
        self.assertEqual(self.names(self.dir), [])

    def test_what_is_wrong_with_the_arguments_is_said_before_any_window(self):
        self.environment.pop("DISPLAY", None)  # with a window it would be refused for that
        self.write("broken.toml", "[[shape]]\nkind = 1\n")
        for words, says in [
            (["--technique", "shadow_mop"], ["shadow_mop", "did you mean shadow_map"]),
            (["--technique", "shadow_map:resolution=7"], ["resolution", "7", "64 .. 8192"]),
            (["--technique", "shadow_map:resolution={64,128}"], ["--technique", "sweep", "a side shows one"]),
            (["--against", "shadow_map:resolution={64,128}"], ["--against", "sweep"]),
            (["--scene", "bunn"], ["bunn"]),
            (["--scene", "broken.toml"], ["broken.toml:"]),
            (["--light", "moon"], ["moon", "point"]),
            (["--view", "back"], ["back", "view"]),
            (["--size", "10"], ["--size", "10"]),
            (["--truth", "lie"], ["--truth lie"]),
            (["--keys", "k Ctrl+Z"], ["Ctrl+Z", "Ctrl+S"]),
            (["--keys", "k left.resolution=7"], ["left.resolution=7", "64 .. 8192"]),
            (["--keys", "right.resolution=64"], ["right.resolution=64", "embree_rays"]),
            (["--keys", "resolution=64"], ["no parameter resolution", "left."]),
            (["--keys", "scene.="], ["scene.=", "no value"]),
            (["--screenshot", "window.jpg"], ["window.jpg", ".png"]),
            (["--timeout", "0"], ["--timeout", "0"]),
            (["--threads", "-1"], ["--threads -1"]),
            (["--sene", "fence"], ["--sene", "did you mean --scene"]),
        ]:
            with self.subTest(words):
                self.refuse("view", *words, says=says)
        self.assertEqual(self.names(self.dir), ["broken.toml"])


if __name__ == "__main__":
    unittest.main()
