#!/usr/bin/python3 -IB
"""What the viewer shows at rest is what `gnomon render` makes: masks to the pixel, pictures to the byte, however one came there."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from pictures import read_png  # noqa: E402
from rig import ViewerTest  # noqa: E402


class Equal(ViewerTest):
    def check(self, viewer):
        """The command gives the mask that is saved, and with the left side alone the pictures are those of the render."""
        viewer.press("1", "5")
        shaded = viewer.save()
        folder = self.assert_renders_alike(shaded)
        self.assertEqual(shaded.picture, read_png(folder / "shaded.png"))
        viewer.press("6")
        masked = viewer.save()
        width, height, mask = masked.mask
        self.assertEqual(mask, shaded.mask[2])
        gray = bytes(int(255 * min(max(value, 0), 1) + 0.5) for value in mask for _ in range(3))
        self.assertEqual((masked.picture.width, masked.picture.height), (width, height))
        self.assertEqual(masked.picture.pixels, gray)
        self.assertEqual(masked.picture, read_png(folder / "mask.png"))
        return shaded

    def walk(self, *arguments, light=None):
        """By keys and mouse to somewhere between the steps."""
        viewer = self.view(*arguments, "--size", "480x300")
        viewer.press("d", "s", "y", "v", "m", "Up")
        saved = viewer.save()
        viewer.drag(viewer.at(saved, 90, 250), viewer.at(saved, 119, 237))
        viewer.drag(viewer.at(saved, 90, 250), viewer.at(saved, 97, 255), button=2)
        viewer.xdo("click", 4)
        moved = self.check(viewer)
        self.assertNotEqual(moved.eye, saved.eye)
        lit = sum(moved.mask[2]) / len(moved.mask[2])
        self.assertTrue(0.02 < lit < 0.999, f"a mask that tells something, not {lit}")
        return viewer

    def test_shadow_map(self):
        viewer = self.walk("--scene", "composite", "--technique", "shadow_map:resolution=256,filter=pcf")
        # Another technique, scene and light on the way do not stay.
        viewer.press("period", "period", "comma", "comma", "k", "b", "n")
        self.check(viewer)

    def test_stencil_volume(self):
        self.walk("--scene", "fence", "--technique", "stencil_volume", "--light", "sun")

    def test_svbsp(self):
        self.walk("--scene", "box_city:count=20", "--technique", "svbsp")

    def test_composite_planar(self):
        viewer = self.walk("--scene", "composite", "--technique", "composite_planar:form=printed")
        viewer.press("u")
        self.check(viewer)

    def test_the_reference_itself(self):
        self.walk("--scene", "table", "--technique", "embree_rays")

    def test_mesh_truth_and_another_view(self):
        viewer = self.walk("--scene", "composite", "--technique", "svbsp", "--truth", "mesh", "--view", "shadow")
        self.assertEqual(viewer.save().option("truth"), "mesh")


if __name__ == "__main__":
    unittest.main()
