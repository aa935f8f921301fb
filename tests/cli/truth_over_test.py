#!/usr/bin/python3 -IB
"""The truth over the pixel, from the command line: rows that ask for it, their tables and analyses, and its certificate."""

import csv
import io
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, SMALL, ProgramTest, records, scene_toml  # noqa: E402

FENCE = ["--scene", "fence", "--light", "sun"]
MAPS = ["--technique", "embree_rays", "--technique", "shadow_map:resolution=64,filter={nearest,pcf}"]
METRICS = ["coverage_error_mean", "coverage_error_rms", "coverage_error_mean_floor", "coverage_error_rms_floor",
           "coverage_constant_error"]
# A hard light and one with area over a box.
TWO_LIGHTS = scene_toml('[[light]]\nname = "sun"\nkind = "directional"\ndirection = [0.4, -1, 0.3]\n'
                        '[[light]]\nname = "panel"\nkind = "rect"\ncenter = [0, 4, 0]\nhalf_u = [0.5, 0, 0]\nhalf_v = [0, 0, 0.5]\n',
                        '[[view]]\nname = "eye"\neye = [1, 5, 6]\ntarget = [0, 0, 0]\n',
                        '[[shape]]\nkind = "plane"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [8, 8]\n'
                        '[[shape]]\nkind = "box"\nmin = [-1, 0.5, -1]\nmax = [1, 1.5, 1]\n')


class TruthOver(ProgramTest):
    def analyzed(self, *arguments):
        return list(csv.DictReader(io.StringIO(self.succeed("analyze", *arguments, "--format", "csv"))))

    def test_rows_that_ask_for_it_have_it_and_others_stay_as_they_were(self):
        self.succeed("run", *FENCE, *MAPS, *SMALL, "--out", "plain")
        self.succeed("run", *FENCE, *MAPS, *SMALL, "--truth-over", "both", "--out", "both")
        plain, both = records(self.dir / "plain"), records(self.dir / "both")
        self.assertEqual(len(plain), 3)
        for before, after in zip(plain, both):
            self.assertNotEqual(before["job"], after["job"])
            self.assertNotIn("truth_over", before)
            self.assertEqual(after["truth_over"], "both")
            self.assertNotIn("pixel_truth", before["lights"][0])
            facts = after["lights"][0]["pixel_truth"]
            self.assertEqual(facts["rays"], 64)
            self.assertTrue(0.5 < facts["kept"] <= 1, facts)
            self.assertTrue(0.7 * after["classes"]["T"] < facts["tested"] <= after["classes"]["T"], facts)
            self.assertTrue(1 / 64 <= facts["error_mean"] < facts["error_max"] < 0.5, facts)
            old, new = before["metrics"]["shape"], after["metrics"]["shape"]
            for name in METRICS:
                self.assertIsNone(old[name])
                self.assertGreater(new[name], 0)
            self.assertEqual({name: value for name, value in old.items() if name not in METRICS},
                             {name: value for name, value in new.items() if name not in METRICS})
            self.assertGreaterEqual(new["coverage_error_rms"], new["coverage_error_mean"])
        # The reference of centers is right at every center, and over the pixels that a shadow's edge cuts it is not.
        rays, nearest, _ = (row["metrics"]["shape"] for row in both)
        self.assertEqual(rays["error"], 0)
        self.assertGreater(rays["coverage_error_mean"], rays["coverage_error_mean_floor"])
        self.assertLess(rays["coverage_error_mean"], nearest["coverage_error_mean"])
        self.assertEqual(len({row["metrics"]["shape"]["coverage_constant_error"] for row in both}), 1)
        # It is traced once, and again from the kept masks comes what the rows have.
        self.succeed("table", "both", "--rescore", "--save")
        self.assertEqual([row["metrics"] for row in records(self.dir / "both")], [row["metrics"] for row in both])
        self.assertIn("coverage error mean", self.succeed("table", "both", "--format", "md"))
        self.assertNotIn("coverage error", self.succeed("table", "plain", "--format", "md"))

    def test_fronts_and_budgets_go_by_either(self):
        self.succeed("run", *FENCE, *MAPS, *NUMBERS, "--truth-over", "pixel", "--out", "run")
        for kind in ("front", "best"):
            asked = self.analyzed("run", kind, "--error", "coverage_error_mean")
            self.assertTrue(all("coverage_error_mean" in row for row in asked), asked)
            # Rows of the truth over the pixel are judged by it where no error is named; costs are not told apart by chance alone.
            judged = self.analyzed("run", kind)
            self.assertEqual(judged, asked)
            self.assertTrue(all("error" in row for row in self.analyzed("run", kind, "--error", "error")))

    def test_a_suite_asks_for_it_and_lights_with_area_say_that_they_have_none(self):
        self.write("two.toml", TWO_LIGHTS)
        self.write("suite.toml", 'truth_over = "both"\nwidth = 96\nheight = 54\nprocesses = 1\nrepetitions = 1\nwarmups = 1\n'
                   '[[group]]\nscenes = ["two.toml"]\nlights = ["sun", "panel", "sun+panel"]\ntechniques = ["unshadowed"]\n')
        self.succeed("run", "suite.toml", "--pictures", "none", "--out", "out")
        rows = {row["light"]: row for row in records(self.dir / "out")}
        value = {light: row["metrics"]["shape"]["coverage_error_mean"] for light, row in rows.items()}
        self.assertGreater(value["sun"], 0)
        self.assertNotIn("coverage", " ".join(rows["sun"]["notes"]))
        self.assertIsNone(value["panel"])
        self.assertIn("no coverage_error_mean: panel has area", " ".join(rows["panel"]["notes"]))
        self.assertNotIn("pixel_truth", rows["panel"]["lights"][0])
        # Together a light with area counts by its own truth.
        self.assertGreater(value["sun+panel"], 0)
        self.assertLess(value["sun+panel"], value["sun"] + rows["panel"]["metrics"]["shape"]["error"])
        self.assertIn("panel has area and counts by the truth at pixel centers", " ".join(rows["sun+panel"]["notes"]))
        self.assertEqual(["pixel_truth" in light for light in rows["sun+panel"]["lights"]], [True, False])

    def test_what_it_is_not_over_is_refused(self):
        self.refuse("run", *FENCE, *MAPS, "--truth-over", "corner", says=("--truth-over", "corner", "center", "pixel", "both"))
        self.write("bad.toml", 'truth_over = "corner"\n[[group]]\nscenes = ["fence"]\ntechniques = ["unshadowed"]\n')
        self.refuse("run", "bad.toml", says=("truth_over = corner", "center, pixel or both", "bad.toml:1"))

    def test_rays_are_certified_by_exact_shares(self):
        self.write("two.toml", TWO_LIGHTS)
        asked = ["certify", "--scene", "two.toml", "--size", "160x90"]
        centers, over = json.loads(self.succeed(*asked, "--light", "sun", "--truth-over", "both", "--json"))
        self.assertNotIn("truth_over", centers)
        self.assertEqual(over["truth_over"], "pixel")
        self.assertTrue(over["holds"], over)
        self.assertGreater(over["filled"], 1000)
        near, elsewhere = over["comparisons"]
        self.assertGreater(near["count"], 50)
        self.assertGreater(elsewhere["count"], 50)
        self.assertIn("over the pixel: certified", self.succeed(*asked, "--light", "sun", "--truth-over", "pixel"))
        done = self.gnomon(*asked, "--light", "panel", "--truth-over", "pixel")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("panel has area", done.stderr)
        done = self.gnomon("certify", "--scene", "leaf_cards", "--light", "sun", "--size", "32x18", "--truth-over", "pixel")
        self.assertEqual(done.returncode, 2)
        self.assertIn("scene leaf_cards has casters with holes (alpha masks), over the pixel only casters without", done.stderr)


if __name__ == "__main__":
    unittest.main()
