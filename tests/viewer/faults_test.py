#!/usr/bin/python3 -IB
"""A technique that crashes, hangs or throws costs its side of the window, and the window says why."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from rig import FAULTS, HUNG, ViewerTest  # noqa: E402

REASONS = {
    "crashes": r"^crashed in resolve: Segmentation fault \(signal 11\)",
    "exits": r"^crashed in resolve: exit status 3",
    "hangs": rf"^hung in relight: no answer within {HUNG} s",
    "returns_nan": r"^mask value -?nan at pixel \d+ is outside 0 \.\. 1",
    "throws": r"^threw in build: the tree has no root",
}


class Faults(ViewerTest):
    def view_faulty(self, *arguments):
        return self.view_scene(*arguments, "--timeout", HUNG, options=["--plugin", FAULTS])

    def test_a_fault_on_the_right_leaves_the_left_as_it_is(self):
        for name, reason in REASONS.items():
            with self.subTest(name):
                viewer = self.view_faulty("--against", name)
                saved = viewer.save()
                self.assertEqual(saved.sides["right"]["phase"], "failed")
                self.assertRegex(saved.sides["right"]["words"], reason)
                self.assertEqual(saved.sides["left"]["phase"], "done")
                viewer.press("d")
                moved = viewer.save()
                self.assertNotEqual(moved.eye, saved.eye)
                self.assert_renders_alike(moved)
                self.assertEqual(viewer.close(), 0)
                self.assertEqual(self.workers(), [])
                viewer.out.rename(self.dir / f"out_{name}")

    def test_a_fault_on_the_left_has_no_mask_to_save_until_it_is_swapped_away(self):
        viewer = self.view_faulty("--technique", "crashes", "--against", "svbsp")
        viewer.press("ctrl+c")
        viewer.wait((viewer.out / "01/command.txt").is_file, "the command")
        self.assertEqual(self.names(viewer.out), ["01/command.txt", "01/scene.toml"])
        viewer.press("ctrl+s", "Tab")
        saved = viewer.save()
        self.assertEqual((saved.technique, saved.sides["left"]["phase"]), ("svbsp", "done"))
        self.assertRegex(saved.sides["right"]["words"], REASONS["crashes"])
        self.assert_renders_alike(saved)

    def test_what_is_not_supported_is_said_and_is_no_failure(self):
        viewer = self.view_scene("--technique", "unshadowed", "--against", "stencil_volume", "--light", "panel")
        saved = viewer.save()
        self.assertEqual(saved.sides["right"]["phase"], "unsupported")
        self.assertGreater(len(saved.sides["right"]["words"]), 10)


if __name__ == "__main__":
    unittest.main()
