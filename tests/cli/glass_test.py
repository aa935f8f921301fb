#!/usr/bin/python3 -IB
"""Glass, as a person meets it: a run, its records, table and report, score and export, and scene files that are refused."""

import json
import sys
import unittest
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

    def test_colored_glass_is_for_nobody_yet(self):
        self.write("scene.toml", PANE + "transmission = [0.9, 0.2, 0.1]\n" + FLOOR)
        self.gnomon("run", "--scene", "scene.toml", "--technique", "exact_rays", *SMALL, "--out", "out")
        row, = records(self.dir / "out")
        self.assertEqual(row["support"], "unsupported")
        self.assertIn("colored_transmission", row["reason"])


if __name__ == "__main__":
    unittest.main()
