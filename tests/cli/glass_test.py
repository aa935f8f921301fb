#!/usr/bin/python3 -IB
"""Glass, as a person meets it: a run, its records, table and report, score and export, and scene files that are refused."""

import json
import sys
import unittest
from array import array
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import SMALL, ProgramTest, records  # noqa: E402

SCENE = ("--scene", "glass_stack", "--light", "sun", "--view", "near")
TECHNIQUES = ("embree_rays", "exact_rays", "stencil_volume", "transmittance_map:resolution=256", "shadow_map", "shadow_map:glass=none", "svbsp")
PANE = '[[shape]]\nkind = "plane"\ncenter = [0, 1, 0]\nnormal = [0, 1, 0]\nsize = [2, 2]\n'
FLOOR = '[[shape]]\nkind = "plane"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [8, 8]\n[[light]]\nname = "sun"\nkind = "directional"\ndirection = [0, -1, 0]\n'


class Glass(ProgramTest):
    def run_all(self, out):
        self.succeed("run", *SCENE, *(word for t in TECHNIQUES for word in ("--technique", t)), *SMALL, "--out", out)
        return {row["technique"] + ":" + row["settings"]: row for row in records(self.dir / out)}

    def test_rows_are_transmitted_and_say_who_multiplies(self):
        rows = self.run_all("out")
        self.assertEqual(len(rows), len(TECHNIQUES))
        self.assertEqual({row["answer"] for row in rows.values()}, {"transmitted"})
        self.assertEqual(rows["svbsp:"]["support"], "unsupported")
        self.assertIn("does not state that it handles transmission", rows["svbsp:"]["reason"])
        self.assertEqual((rows["shadow_map:"]["support"], rows["shadow_map:"]["reason"]), ("approximate", "glass is taken for opaque"))
        metrics = {name: row["metrics"]["shape"] for name, row in rows.items() if row["status"] == "ok" and row["support"] != "unsupported"}
        self.assertEqual(metrics["embree_rays:"]["error"], 0)
        for bin_ in ("0", "1", "2", "3_4"):
            self.assertIsNotNone(metrics["embree_rays:"]["transmittance_error_" + bin_])
        # Three sheets are all there are.
        self.assertIsNone(metrics["embree_rays:"]["transmittance_error_5_up"])
        for name in ("exact_rays:", "stencil_volume:"):
            self.assertLess(metrics[name]["error"], 0.002, name)
        self.assertLess(metrics["transmittance_map:resolution=256"]["error"], 0.05)
        for name in ("shadow_map:", "shadow_map:glass=none"):
            self.assertGreater(metrics[name]["error"], 0.1, name)
            self.assertGreater(rows[name]["causes"]["no_product"], 0.8 * sum(rows[name]["causes"].values()))
        self.assertEqual(sum(row["causes"]["unexplained"] for row in rows.values() if row["causes"]), 0)
        self.succeed("report", "out")
        page = (self.dir / "out/report.html").read_text()
        self.assertIn("transmitted", page)
        table = self.succeed("table", "out", "--columns", "technique,error,transmittance_error_1")
        self.assertIn("transmittance_map", table)

    def test_a_mask_scores_as_the_technique_that_made_it(self):
        self.succeed("render", *SCENE, "--technique", "shadow_map:resolution=128", *SMALL[-2:], "--out", "made")
        made, = json.loads((self.dir / "made/record.json").read_text())
        scored, = json.loads(self.succeed("score", *SCENE, "--mask", "made/mask.exr", "--json"))
        self.assertAlmostEqual(scored["metrics"]["error"], made["metrics"]["shape"]["error"], places=7)

    def test_export_has_what_the_casters_let_through(self):
        self.succeed("export", *SCENE, *SMALL[-2:], "--out", "given")
        files = sorted(path.name for path in (self.dir / "given").rglob("*"))
        text = "".join(path.read_text() for path in (self.dir / "given").rglob("*.json"))
        self.assertIn('"transmission"', text, files)
        self.assertIn('"seen"', text)

    def test_scene_files_say_what_they_refuse(self):
        for line, says in (("transmission = 1.5", ["transmission", "1.5"]), ("transmission = -0.1", ["transmission", "-0.1"]),
                           ("transmission = nan", ["transmission", "nan"]), ("transmission = [0.5, 2, 1]", ["transmission", "2"]),
                           ("transmission = [0.5, 0.5]", ["transmission"]), ("seen = true", ["seen"]),
                           ('transmission = "nowhere.png"', ["nowhere.png"])):
            with self.subTest(line):
                self.write("scene.toml", PANE + line + "\n" + FLOOR)
                self.refuse("describe", "scene.toml", says=says)
        self.write("scene.toml", PANE + "transmission = 0.4\n" + FLOOR)
        self.assertIn("0.4", self.succeed("describe", "scene.toml"))

    def test_colored_glass_is_three_lights_and_one_row(self):
        self.write("scene.toml", PANE + "transmission = [0.9, 0.2, 0.1]\n" + FLOOR)
        self.succeed("run", "--scene", "scene.toml", "--technique", "exact_rays", *SMALL, "--out", "out")
        row, = records(self.dir / "out")
        self.assertEqual((row["light"], row["support"], row["answer"]), ("sun", "full", "transmitted"))
        self.assertEqual([light["name"] for light in row["lights"]], ["sun.red", "sun.green", "sun.blue"])
        self.assertLess(row["metrics"]["shape"]["error"], 1e-6)
        light, = json.loads(self.succeed("describe", "scene.toml", "--json"))["lights"]
        self.assertEqual(light["name"], "sun")
        certificates = json.loads(self.succeed("certify", "--scene", "scene.toml", "--light", "sun", "--size", "64x36", "--json"))
        self.assertEqual([one["light"] for one in certificates], ["sun.red", "sun.green", "sun.blue"])

    def test_masks_of_colored_light_are_exported_and_scored_as_one_row(self):
        self.write("scene.toml", PANE + "transmission = [0.9, 0.2, 0.1]\n" + FLOOR)
        scene = ("--scene", "scene.toml", "--light", "sun")
        channels = ["sun.red.V", "sun.green.V", "sun.blue.V"]
        self.succeed("export", *scene, *SMALL[-2:], "--out", "given")
        frame, facts = (json.loads((self.dir / "given" / name).read_text()) for name in ("frame.json", "scene.json"))
        light, = frame["lights"]
        self.assertEqual((light["name"], [one["name"] for one in facts["lights"]]), ("sun", ["sun"]))
        for name in ("visibility", "class"):
            self.assertEqual(light["reference"][name]["shape"], [3, 90, 160])
        scored, = json.loads(self.succeed("score", *scene[:2], "--mask", "given/reference.exr", "--json"))
        self.assertEqual((scored["light"], [one["channel"] for one in scored["lights"]]), ("sun", channels))
        self.assertEqual((scored["metrics"]["error"], scored["metrics"]["hue_error"]), (0, 0))

        # The same as a color picture: a byte is off by half a step at most.
        truth = array("f", (self.dir / "given" / light["reference"]["visibility"]["file"]).read_bytes()[128:])
        pixels = 90 * 160
        color = bytes(round(255 * truth[channel * pixels + i]) for i in range(pixels) for channel in range(3))
        self.write("mask.ppm", b"P6 160 90 255\n" + color)
        scored, = json.loads(self.succeed("score", *scene, "--mask", "mask.ppm", "--json", "--out", "pictures"))
        self.assertEqual([one["channel"] for one in scored["lights"]], ["R", "G", "B"])
        self.assertLess(scored["metrics"]["error"], 0.5 / 255 + 1e-6)
        self.assertEqual(self.names(self.dir / "pictures"), ["error.png", "shaded.png"])
        self.succeed("score", *scene, "--mask", "mask.ppm", "--label", "Mine", "--out", "rows")
        row, = records(self.dir / "rows")
        self.assertEqual((row["light"], row["context"]["foreign"]["channel"], len(row["lights"])), ("sun", "R, G, B", 3))
        self.assertEqual(row["metrics"]["shape"]["error"], scored["metrics"]["error"])
        red, = json.loads(self.succeed("score", *scene[:2], "--light", "sun.red", "--mask", "mask.ppm", "--channel", "R", "--json"))
        self.assertEqual((red["light"], red["channel"]), ("sun.red", "R"))
        self.assertEqual(red["metrics"]["error"], scored["lights"][0]["metrics"]["error"])

        # One channel says nothing of the other two.
        self.write("mask.pgm", b"P5 160 90 255\n" + color[::3])
        self.refuse("score", *scene, "--mask", "mask.pgm", says=("no channel sun.red.V", "--light and --channel"))
        self.refuse("score", *scene, "--mask", "mask.ppm", "--channel", "R", says=("3 are asked for", "--light sun.red"))


if __name__ == "__main__":
    unittest.main()
