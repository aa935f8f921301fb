#!/usr/bin/python3 -IB
"""Rows of several lights together: requested, measured, resumed, rescored, in tables, and what is refused."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, NUMBERS, SMALL, ProgramTest, records  # noqa: E402

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
name = "bulb"
kind = "point"
position = [2, 4, 1]

[[light]]
name = "sun"
kind = "directional"
direction = [1, -2, 0.5]

[[light]]
name = "lamp"
kind = "disc"
center = [-2, 3, 1]
normal = [2, -3, -1]
radius = 0.4
intensity = 0.5

[[view]]
name = "main"
eye = [4, 3, 5]
target = [0, 0.5, 0]
"""


class Lights(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.dir / "three.toml"
        self.scene.write_text(SCENE)

    def run_rows(self, out, *arguments):
        return self.gnomon("run", "--scene", str(self.scene), "--out", str(out), *SMALL, *arguments)

    def test_a_row_of_several_lights_sums_costs_and_keeps_each_light(self):
        out = self.dir / "run"
        done = self.run_rows(out, "--light", "bulb,sun,bulb+sun", "--technique", "shadow_map:resolution=64", "--technique", "svbsp")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = {(r["technique"], r["light"]): r for r in records(out)}
        self.assertEqual({light for _, light in rows}, {"bulb", "sun", "bulb+sun"})
        for technique in ("shadow_map", "svbsp"):
            both = rows[technique, "bulb+sun"]
            self.assertEqual(both["status"], "ok")
            self.assertEqual(both["light_kind"], "point+directional")
            self.assertTrue(both["shares_build"])
            self.assertEqual([light["name"] for light in both["lights"]], ["bulb", "sun"])
            for light in both["lights"]:
                alone = rows[technique, light["name"]]
                self.assertEqual(light["metrics"]["wrong_rate"], alone["metrics"]["shape"]["wrong_rate"])
                self.assertEqual(light["causes"], alone["causes"])
                self.assertEqual(light["classes"], alone["classes"])
                self.assertEqual((alone["answer"], both["answer"]), ("binary", "received"))
                self.assertEqual(alone["lights"], [{key: light[key] for key in alone["lights"][0]}])
            # What is shared counts once.
            self.assertLess(both["bytes"], sum(rows[technique, light]["bytes"] for light in ("bulb", "sun")))
            # Each pixel's share errs by a mean of what both err, weighed by what they give it.
            self.assertLessEqual(both["metrics"]["shape"]["error"], sum(light["metrics"]["error"] for light in both["lights"]))
        self.assertGreater(rows["shadow_map", "bulb+sun"]["metrics"]["shape"]["error"], 0)
        self.assertEqual(rows["svbsp", "bulb+sun"]["metrics"]["shape"]["error"], 0)

    def test_a_light_without_shadows_is_said_and_never_silent(self):
        out = self.dir / "run"
        done = self.run_rows(out, "--light", "all+", "--technique", "shadow_map:resolution=64", "--technique", "area_rays:samples=4")
        self.assertEqual(done.returncode, 0, done.stderr)
        by_id = {r["technique"]: r for r in records(out)}
        maps = by_id["shadow_map"]
        self.assertEqual((maps["status"], maps["support"]), ("ok", "approximate"))
        self.assertIn("no shadows of lamp: ", maps["reason"])
        self.assertEqual([light["support"] for light in maps["lights"]], ["full", "full", "unsupported"])
        lamp = maps["lights"][2]
        self.assertGreater(lamp["metrics"]["error"], 0)
        self.assertGreater(lamp["causes"]["beyond_coverage"], 0)
        self.assertIn("no shadows of bulb, sun: ", by_id["area_rays"]["reason"])
        done = self.run_rows(self.dir / "none", "--light", "bulb+sun", "--technique", "area_rays")
        row = records(self.dir / "none")[0]
        self.assertEqual(row["status"], "unsupported")
        self.assertEqual(row["reason"], "bulb, sun: the light has no area: its shadows are hard, see embree_rays")

    def test_a_technique_that_shares_nothing_or_fails_is_said_for_its_own_row(self):
        out = self.dir / "run"
        done = self.gnomon("--plugin", FAULTS, "run", "--scene", self.scene, "--light", "bulb+sun", "--technique", "sleeps",
                           "--technique", "returns_nan", "--technique", "svbsp", "--out", out, *NUMBERS)
        self.assertEqual(done.returncode, 1, done.stderr)
        by_id = {r["technique"]: r for r in records(out)}
        self.assertEqual((by_id["sleeps"]["status"], by_id["sleeps"]["shares_build"]), ("ok", False))
        self.assertEqual((by_id["svbsp"]["status"], by_id["svbsp"]["shares_build"]), ("ok", True))
        self.assertEqual(by_id["returns_nan"]["status"], "failed")
        self.assertRegex(by_id["returns_nan"]["reason"], r"mask value nan at pixel \d+ under light [12] of 2 is outside 0 \.\. 1")

    def test_tables_have_several_lights_apart(self):
        out = self.dir / "run"
        self.run_rows(out, "--light", "bulb,all+", "--technique", "unshadowed", "--technique", "embree_rays")
        table = self.gnomon("table", str(out)).stdout
        self.assertIn("light all+ (point+directional+disc)", table)
        self.assertIn("worst light", table)
        csv = self.gnomon("table", str(out), "--format", "csv").stdout.splitlines()
        count = csv[0].split(",").index("light_count")
        self.assertEqual({line.split(",")[count] for line in csv[1:]}, {"1", "3"})
        grown = self.gnomon("analyze", str(out), "growth", "--x", "lights", "--error", "received_error_rms")
        self.assertEqual(grown.returncode, 0, grown.stderr)

    def test_resume_and_rescore_know_them(self):
        out = self.dir / "run"
        wanted = ("--light", "all+", "--light", "bulb+lamp", "--technique", "shadow_map:resolution=64")
        self.run_rows(out, *wanted)
        before = records(out)
        self.assertEqual([r["light"] for r in before], ["all+", "bulb+lamp"])
        again = self.run_rows(out, *wanted, "--resume")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(records(out), before)
        text = self.gnomon("table", str(out), "--rescore", "--format", "json")
        self.assertEqual(text.returncode, 0, text.stderr)
        self.assertNotIn("keeps its", text.stderr)
        rows = json.loads(text.stdout)["rows"]
        for row, record in zip(rows, before):
            self.assertAlmostEqual(row["error"], record["metrics"]["shape"]["error"], places=12)

    def test_render_writes_all_together_and_each(self):
        out = self.dir / "pictures"
        done = self.gnomon("render", "--scene", str(self.scene), "--technique", "shadow_map:resolution=64", "--light", "all+",
                           "--size", "64x36", "--out", str(out))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"all\+ +3 lights, error .* %, light received .* % \(rms\), FLIP")
        self.assertIn("no shadows of lamp", done.stderr)
        names = {file.name for file in out.iterdir()}
        self.assertTrue({"mask.png", "shaded.png", "error.png", "mask_bulb.png", "mask_sun.png", "mask.exr", "record.json"} <= names)
        self.assertNotIn("mask_lamp.png", names)

    def test_what_cannot_be_is_refused_before_anything_runs(self):
        out = self.dir / "none"
        for light, words in (
            ("bulb+moon", ["no light moon", "bulb, sun, lamp"]),
            ("bulb+bulb", ["bulb is named twice"]),
            ("bulb+", None),
            ("+", ["a name is missing"]),
            ("*x+", ["no light whose name is like *x"]),
            ("all+4", ["4 is outside 1 .. 3"]),
        ):
            done = self.run_rows(out, "--light", light, "--technique", "unshadowed", "--dry-run")
            self.assertEqual(done.returncode, 0 if words is None else 2, light)
            for word in words or []:
                self.assertIn(word, done.stderr)
        self.assertFalse(out.exists())
        path = self.run_rows(out, "--light", "all+", "--technique", "unshadowed", "--path", "light_slide")
        if "no option --path" not in path.stderr:
            self.assertEqual(path.returncode, 2)
            self.assertIn("a row on such a path has one", path.stderr)

    def test_a_name_with_a_plus_is_refused_where_scenes_are_read(self):
        self.scene.write_text(SCENE.replace('name = "lamp"', 'name = "a+b"'))
        done = self.run_rows(self.dir / "none", "--light", "all+", "--technique", "unshadowed")
        self.assertEqual(done.returncode, 2)
        self.assertIn("a+b", done.stderr)

    def test_copies_of_a_light_stand_in_a_ring_and_a_thousand_are_refused_together(self):
        ring = SCENE.replace('name = "bulb"', 'name = "ring"\ncopies = 1000')
        self.scene.write_text(ring)
        done = self.run_rows(self.dir / "none", "--light", "ring_*+", "--technique", "unshadowed")
        self.assertEqual(done.returncode, 2)
        self.assertIn("1000; a row has at most 256", done.stderr)
        done = self.run_rows(self.dir / "ring", "--light", "ring_*+8", "--technique", "shadow_map:resolution=64")
        self.assertEqual(done.returncode, 0, done.stderr)
        row = records(self.dir / "ring")[0]
        self.assertEqual([light["name"] for light in row["lights"]], [f"ring_{1 + 125 * k}" for k in range(8)])
        for bad, word in (("copies = 1", "2 .. 1024"), ("copies = 2000", "2 .. 1024"), ("about = [0, 0, 0]", "copies")):
            self.scene.write_text(SCENE.replace('name = "bulb"', f'name = "bulb"\n{bad}'))
            done = self.run_rows(self.dir / "none", "--technique", "unshadowed")
            self.assertEqual(done.returncode, 2, bad)
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main()
