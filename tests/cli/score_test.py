#!/usr/bin/python3 -IB
"""score: a mask from a file against the reference."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import SMALL, ProgramTest  # noqa: E402

SIZE = SMALL[-2:]
SCENE = ("--scene", "sphere_over_plane")


class Score(ProgramTest):
    def render(self, technique):
        self.succeed("render", *SCENE, "--technique", technique, *SIZE, "--out", "made")
        return self.dir / "made/mask.exr", json.loads((self.dir / "made/record.json").read_text())

    def test_a_mask_scores_as_the_technique_that_made_it(self):
        mask, records = self.render("shadow_map:resolution=128")
        scores = json.loads(self.succeed("score", *SCENE, "--mask", mask, "--json"))
        self.assertEqual([s["light"] for s in scores], ["point", "sun"])
        for score, record in zip(scores, records):
            self.assertEqual((score["width"], score["height"], score["truth"]), (160, 90, "shape"))
            self.assertGreater(score["metrics"]["wrong_rate"], 0)
            for name, value in record["metrics"]["shape"].items():
                self.assertEqual(score["metrics"][name], value, name)
            self.assertEqual(score["classes"], record["classes"])
            self.assertEqual(sum(score["causes"].values()), sum(record["causes"].values()))

    def test_the_reference_is_never_wrong(self):
        mask, _ = self.render("embree_rays")
        text = self.succeed("score", *SCENE, "--mask", mask, "--light", "sun")
        self.assertIn("light sun, view view, 160 x 90, shape truth", text)
        self.assertRegex(text, r"(?m)^wrong_rate +0 +%")
        self.assertNotIn("cause.", text)
        self.assertNotIn("light point", text)

    def test_pictures_and_other_channels(self):
        # A gray picture of the point light's mask: its channels are R, G and B.
        mask, records = self.render("unshadowed")
        picture = self.dir / "made/mask.png"
        scores = json.loads(self.succeed("score", *SCENE, "--mask", picture, "--light", "point", "--channel", "G", "--json",
                                         "--out", "one"))
        self.assertEqual(scores[0]["metrics"]["wrong_rate"], records[0]["metrics"]["shape"]["wrong_rate"])
        self.assertEqual(self.names(self.dir / "one"), ["error.png", "shaded.png"])
        self.succeed("score", *SCENE, "--mask", mask, "--out", "both")
        self.assertEqual(self.names(self.dir / "both"), ["error_point.png", "error_sun.png", "shaded_point.png", "shaded_sun.png"])

    def test_a_picture_with_a_legend_is_no_mask(self):
        # Under a light with area the picture of the mask has a legend, and so have the pictures of errors: more rows than pixels.
        scene = ("--scene", "single_triangle", "--light", "lamp")
        self.succeed("render", *scene, "--technique", "center_ray", *SIZE, "--out", "soft")
        for name in ("mask.png", "error.png"):
            self.refuse("score", *scene, "--mask", self.dir / "soft" / name, "--channel", "R", says=(name, "legend", "mask.exr"))
        self.succeed("score", *scene, "--mask", self.dir / "soft/mask.exr")

    def test_what_cannot_be_scored_is_said(self):
        mask, _ = self.render("unshadowed")
        picture = self.dir / "made/mask.png"
        broken = self.dir / "broken.exr"
        broken.write_bytes(mask.read_bytes()[:100])
        for arguments, words in (
            (("--mask", self.dir / "none.exr"), ("none.exr", "cannot be read")),
            (("--mask", broken), ("broken.exr",)),
            (("--mask", mask, "--light", "moon"), ("no light moon", "point, sun")),
            (("--mask", mask, "--view", "below"), ("no view below",)),
            (("--mask", mask, "--light", "sun", "--channel", "Z"), ("no channel Z", "point.V", "sun.V")),
            (("--mask", picture), ("no channel LIGHT.V", "R, G, B")),
            (("--mask", picture, "--channel", "R"), ("--channel R", "2 are asked for", "--light")),
        ):
            self.refuse("score", *SCENE, *arguments, says=words)


if __name__ == "__main__":
    unittest.main()
