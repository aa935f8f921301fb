#!/usr/bin/python3 -IB
"""Lights with area from the command line: rows, pictures, certificates, what is refused, and rows of old runs."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, ProgramTest, records  # noqa: E402

SCENE = """
[[shape]]
kind = "box"
min = [-0.5, 0, -0.5]
max = [0.5, 1, 0.5]

[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [8, 8]

[[light]]
name = "lamp"
kind = "KIND"
SHAPE

[[light]]
name = "bulb"
kind = "point"
position = [2, 4, 1]

[[view]]
name = "main"
eye = [4, 3, 5]
target = [0, 0.5, 0]
"""
KINDS = {
    "rect": "center = [2, 4, 1]\nhalf_u = [0.5, 0, 0]\nhalf_v = [0, 0, 0.5]",
    "disc": "center = [2, 4, 1]\nnormal = [0, -1, 0]\nradius = 0.5",
    "sphere": "center = [2, 4, 1]\nradius = 0.5",
}


# A light that cannot be, and what is said of it.
REFUSED = (
    ("rect", "center = [2, 4, 1]\nhalf_u = [0.5, 0, 0]\nhalf_v = [1, 0, 0]", ["lamp", "no area"]),
    ("rect", "center = [2, 4, 1]\nhalf_u = [0.5, 0, 0]\nhalf_v = [-1, 0, 1e-9]", ["lamp", "no area"]),
    ("rect", "center = [2, 4, 1]\nhalf_u = [0, 0, 0]\nhalf_v = [0, 0, 0.5]", ["half_u = [0, 0, 0]"]),
    ("rect", "center = [2, 4, 1]\nhalf_u = [nan, 0, 0]\nhalf_v = [0, 0, 0.5]", ["half_u = nan"]),
    ("rect", "center = [2, 4, 1]\nhalf_u = [0.5, 0, 0]\nhalf_v = [0, inf, 0.5]", ["half_v = inf"]),
    ("rect", "center = [2, 4, nan]\nhalf_u = [0.5, 0, 0]\nhalf_v = [0, 0, 1]", ["center = nan"]),
    ("rect", "center = [2, 4, 1]\nhalf_u = [1e18, 0, 0]\nhalf_v = [0, 0, 1]", ["lamp", "the length of half_u", "1e-30 .. 1e+17 m"]),
    ("rect", "center = [2, 4, 1]\nhalf_u = [1e-42, 0, 0]\nhalf_v = [0, 0, 1]", ["lamp", "the length of half_u", "1e-30 .. 1e+17 m"]),
    ("rect", "center = [2, 4, 1]\nhalf_u = [0.5, 0, 0]", ["half_v"]),
    ("disc", "center = [2, 4, 1]\nnormal = [0, -1, 0]\nradius = 0", ["radius = 0", "above 0"]),
    ("disc", "center = [2, 4, 1]\nnormal = [0, -1, 0]\nradius = -1", ["radius = -1", "above 0"]),
    ("disc", "center = [2, 4, 1]\nnormal = [0, -1, 0]\nradius = nan", ["radius = nan"]),
    ("disc", "center = [2, 4, 1]\nnormal = [0, -1, 0]\nradius = 1e18", ["radius = 1e+18", "1e-30 .. 1e+17 m"]),
    ("disc", "center = [2, 4, 1]\nnormal = [0, 0, 0]\nradius = 1", ["normal = [0, 0, 0]"]),
    ("sphere", "center = [2, 4, 1]\nradius = -0.5", ["radius = -0.5", "above 0"]),
    ("sphere", "center = [2, 4, inf]\nradius = 0.5", ["center = inf"]),
    ("sphere", "center = [2, 4, 1]\nradius = 1e-40", ["radius = 1e-40", "1e-30 .. 1e+17 m"]),
    ("sphere", "center = [2, 4, 1]\nradius = 0.5\nintensity = nan", ["intensity = nan"]),
)
# A light that can be, and whether it leaves a pixel to test. The floor is y = 0, the box a meter around x = z = 0.
ODD = (
    ("around_everything", "sphere", "center = [0, 0, 0]\nradius = 100", False),
    ("around_the_box", "sphere", "center = [0, 0.5, 0]\nradius = 1.2", True),
    ("in_the_box", "sphere", "center = [0, 0.5, 0]\nradius = 0.2", True),
    ("through_the_floor", "sphere", "center = [2, 0, 1]\nradius = 0.5", True),
    ("resting_on_the_floor", "sphere", "center = [2, 0.5, 1]\nradius = 0.5", True),
    ("in_the_floor", "rect", "center = [0, 0, 0]\nhalf_u = [3, 0, 0]\nhalf_v = [0, 0, 3]", False),
    ("a_rounding_over_the_floor", "rect", "center = [2, 1e-5, 1]\nhalf_u = [1, 0, 0]\nhalf_v = [0, 0, 1]", True),
    ("half_below_the_floor", "disc", "center = [2, 0, 1]\nnormal = [1, 0.2, 0]\nradius = 0.5", True),
    ("below_the_floor", "disc", "center = [0, -5, 0]\nnormal = [0, 1, 0]\nradius = 1", True),  # the box has a bottom
    ("shining_away", "rect", "center = [0, 5, 0]\nhalf_u = [0, 0, 1]\nhalf_v = [1, 0, 0]\none_sided = true", False),
    ("on_the_box", "rect", "center = [0, 1, 0]\nhalf_u = [0.5, 0, 0]\nhalf_v = [0, 0, 0.5]", True),
    ("on_a_side_of_the_box", "rect", "center = [0.5, 0.5, 0]\nhalf_u = [0, 0.5, 0]\nhalf_v = [0, 0, 0.5]", True),
    ("touching_an_edge", "rect", "center = [1.5, 1.5, 0]\nhalf_u = [1, 0.5, 0]\nhalf_v = [0, 0, 0.5]", True),
    ("through_the_box", "rect", "center = [0, 0.7, 0]\nhalf_u = [1.5, 0, 0]\nhalf_v = [0, 0.2, 1.5]", True),
    ("a_million_times_as_far", "disc", "center = [0, 4e6, 0]\nnormal = [0, -1, 0]\nradius = 4e6", False),
    ("a_million_times_as_large", "rect", "center = [0, 4, 0]\nhalf_u = [4e6, 0, 0]\nhalf_v = [0, 0.2, 4e6]", False),
    ("as_large_as_can_be", "sphere", "center = [0, 9.5e16, 0]\nradius = 9e16", False),
    ("a_needle", "rect", "center = [2, 4, 1]\nhalf_u = [1e-3, 0, 0]\nhalf_v = [0, 0, 2]", True),
    ("a_millionth", "disc", "center = [2, 4, 1]\nnormal = [0, -1, 0]\nradius = 1e-6", True),
    ("as_small_as_can_be", "sphere", "center = [2, 4, 1]\nradius = 1e-30", True),
)


class AreaLight(ProgramTest):
    def scene(self, kind="disc"):
        return self.write(f"{kind}.toml", SCENE.replace("KIND", kind).replace("SHAPE", KINDS[kind]))

    def test_run_scores_against_the_share_of_the_lights_area(self):
        techniques = [word for name in ("area_rays:samples=16", "exact_area", "center_ray", "unshadowed") for word in ("--technique", name)]
        for kind in KINDS:
            with self.subTest(kind):
                self.succeed("run", "--scene", self.scene(kind), "--light", "lamp", *techniques, *NUMBERS, "--out", kind)
                rows = {row["technique"]: row for row in records(self.dir / kind)}
                for row in rows.values():
                    self.assertEqual((row["light_kind"], row["status"]), (kind, "ok"))
                    # What the causes hold adds up to the error, and nothing is left without a name.
                    self.assertAlmostEqual(sum(row["cause_errors"].values()), row["metrics"]["mesh"]["error"], delta=1e-9)
                    self.assertEqual(row["cause_errors"].keys(), row["causes"].keys())
                    self.assertEqual(row["causes"]["unexplained"], 0)
                    self.assertEqual(row["lights"][0]["reference"]["estimates"], "area")
                    self.assertEqual((row["lights"][0]["reference"]["target"], row["lights"][0]["reference"]["cap"]), (0.002, 8192))
                    self.assertGreater(row["lights"][0]["reference"]["rays"], 100000)
                    self.assertLessEqual(row["lights"][0]["reference"]["error_mean"], 0.002)
                error = {name: row["metrics"]["mesh"]["error"] for name, row in rows.items()}
                for technique, cause in (("area_rays", "noise"), ("exact_area", "reference_error"), ("center_ray", "hard_shadow"),
                                         ("unshadowed", "missing_caster")):
                    self.assertGreater(rows[technique]["cause_errors"][cause], 0.9 * error[technique], technique)
                self.assertLess(error["exact_area"], 3e-4)
                self.assertLess(error["exact_area"], error["area_rays"])
                self.assertLess(error["area_rays"], error["center_ray"])
                self.assertLess(error["center_ray"], error["unshadowed"])

    def test_a_run_says_how_well_it_wants_to_know(self):
        suite = self.write("s.toml", 'reference_error = 0.01\nreference_rays = 2048\nwidth = 64\nheight = 36\nprocesses = 1\nrepetitions = 1\n'
                           f'[[group]]\nscenes = ["{self.scene()}"]\nlights = ["lamp"]\ntechniques = ["unshadowed"]\n')
        self.succeed("run", suite, "--out", "out")
        row = records(self.dir / "out")[0]
        self.assertEqual((row["lights"][0]["reference"]["target"], row["lights"][0]["reference"]["cap"]), (0.01, 2048))
        self.succeed("table", "out", "--rescore", "--save", "--format", "json")
        for key in ("metrics", "causes", "cause_errors"):
            self.assertEqual(records(self.dir / "out")[0][key], row[key])
        for line, says in (("reference_error = 0", ["reference_error = 0", "0.00001 .. 0.1"]), ("reference_rays = 1", ["reference_rays = 1", "64"])):
            bad = self.write("bad.toml", line + f'\n[[group]]\nscenes = ["{self.scene()}"]\ntechniques = ["unshadowed"]\n')
            self.refuse("run", bad, "--out", "bad", says=says)

    def test_a_star_leaves_out_what_supports_no_light_of_its_group(self):
        suite = self.write("s.toml", 'width = 64\nheight = 36\nprocesses = 1\nrepetitions = 1\n'
                           f'[[group]]\nscenes = ["{self.scene()}"]\nlights = ["lamp"]\ntechniques = ["*"]\n')
        text = self.succeed("run", suite, "--out", "out")
        names = {row["technique"] for row in records(self.dir / "out")}
        self.assertTrue({"area_rays", "center_ray", "exact_area", "embree_rays", "unshadowed"} <= names)
        self.assertNotIn("shadow_map", names)
        self.assertIn("shadow_map: a shadow map has one center", " ".join(text.split()))

    def test_a_techniques_own_reason_comes_first(self):
        self.succeed("run", "--scene", self.scene(), "--light", "lamp", "--technique", "shadow_map", *NUMBERS, "--out", "out")
        row = records(self.dir / "out")[0]
        self.assertEqual((row["status"], row["reason"]), ("unsupported", "a shadow map has one center: lights with area have none"))

    def test_render_score_and_certify_answer(self):
        scene = self.scene("rect")
        said = self.succeed("render", "--scene", scene, "--technique", "area_rays", "--size", "64x36", "--light", "lamp", "--out", "out")
        self.assertRegex(said, r"(?m)^lamp +error 0\.\d{4} % over \d+ tested pixels, best constant mask \d+\.\d{4} %, "
                               r"floor 0\.\d{4} %, wrong 0\.0000 %$")
        said = self.succeed("render", "--scene", scene, "--technique", "shadow_map", "--size", "64x36", "--light", "bulb", "--out", "hard")
        self.assertRegex(said, r"(?m)^bulb +error \d\.\d{4} % over \d+ tested pixels, best constant mask \d+\.\d{4} %, "
                               r"wrong \d\.\d{4} %, false dark \d+, false lit \d+$")
        scored = json.loads(self.succeed("score", "--scene", scene, "--light", "lamp", "--mask", self.dir / "out/mask.exr", "--json"))
        self.assertLess(scored[0]["metrics"]["error"], 0.01)
        self.assertAlmostEqual(sum(scored[0]["cause_errors"].values()), scored[0]["metrics"]["error"], delta=1e-9)
        certificates = json.loads(self.succeed("certify", "--scene", scene, "--light", "lamp", "--size", "96x54", "--json"))
        self.assertTrue(certificates[0]["holds"])
        self.assertEqual(len(certificates[0]["comparisons"]), 4)

    def test_lights_that_cannot_be_are_refused(self):
        for kind, shape, says in REFUSED:
            with self.subTest(shape):
                self.write("bad.toml", SCENE.replace("KIND", kind).replace("SHAPE", shape))
                self.refuse("render", "--scene", "bad.toml", "--technique", "area_rays", "--out", "bad", says=[*says, "bad.toml:"])
                self.assertFalse((self.dir / "bad").exists())

    def test_hostile_lights_have_an_answer_that_the_witness_confirms(self):
        techniques = [word for name in ("area_rays:samples=256", "center_ray", "exact_area", "embree_rays", "unshadowed")
                      for word in ("--technique", name)]
        for name, kind, shape, is_tested in ODD:
            with self.subTest(name):
                scene = self.write(f"{name}.toml", SCENE.replace("KIND", kind).replace("SHAPE", shape))
                self.succeed("run", "--scene", scene, "--light", "lamp", *techniques, "--processes", "1", "--repetitions", "1", "--size", "96x54",
                             "--out", name)
                rows = {row["technique"]: row for row in records(self.dir / name)}
                self.assertEqual({row["status"] for row in rows.values()}, {"ok"})
                self.assertEqual(rows["exact_area"]["classes"]["T"] > 0, is_tested, rows["exact_area"]["classes"])
                metrics = {technique: row["metrics"]["mesh"] for technique, row in rows.items()}
                if is_tested:
                    self.assertLess(metrics["exact_area"]["error"], 0.002)
                    self.assertLess(metrics["area_rays"]["error"], 0.01)
                    self.assertEqual(metrics["embree_rays"]["error"], 0)
                else:
                    self.assertEqual({metric["error"] for metric in metrics.values()}, {None})
                text = self.succeed("certify", "--scene", scene, "--light", "lamp", "--size", "96x54", status=0 if is_tested else 1)
                self.assertIn(": certified" if is_tested else "NOT certified: no pixel is of class T", text)


if __name__ == "__main__":
    unittest.main()
