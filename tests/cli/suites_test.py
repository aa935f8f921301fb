#!/usr/bin/python3 -IB
"""The suites that come with the program: what they cover, and that they show each way of being wrong."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, ProgramTest, records  # noqa: E402

ROW = re.compile(r"^[0-9a-f]{16}  (\S+) (\S+) (\S+)", re.MULTILINE)


class Suites(ProgramTest):
    def rows(self, suite):
        text = self.succeed("run", suite, "--dry-run")
        return text, ROW.findall(text)

    def test_quick_is_five_scenes_two_lights_eight_settings(self):
        text, rows = self.rows("quick")
        scenes = {scene for scene, _, _ in rows}
        self.assertGreaterEqual(len(scenes), 5)
        for scene in scenes:
            for light in ("point", "sun"):
                self.assertGreaterEqual(len({t for s, l, t in rows if (s, l) == (scene, light)}), 8, (scene, light))
        self.assertRegex(text, r"(?m)^\d+ rows, 5 processes x 3 repetitions each, 640x360 pixels$")

    def test_soft_suites_have_every_kind_of_light_and_others_but_quick_have_none(self):
        kinds = {}
        for scene in json.loads(self.succeed("list", "scenes", "--json")):
            described = self.gnomon("describe", scene["id"], "--json").stdout  # nothing of a scene that is not fetched
            for light in json.loads(described)["lights"] if described else []:
                kinds[scene["id"], light["name"]] = light["kind"]
        soft = {}
        for suite in (entry["id"] for entry in json.loads(self.succeed("list", "suites", "--json"))):
            rows = self.rows(suite)[1]
            found = {kinds.get((scene.split(":")[0], light)) for scene, light, _ in rows} & {"rect", "disc", "sphere"}
            if found:
                soft[suite] = found
        self.assertEqual(set(soft), {"animation", "engines", "glass", "gpu", "memory", "questions", "quick", "radiosity", "soft",
                                     "soft_convergence", "soft_geometry", "soft_scale"})
        self.assertEqual(soft["soft"], {"rect", "disc", "sphere"})

    def test_standard_has_every_technique_for_its_lights_and_more_scenes(self):
        _, rows = self.rows("standard")
        listed = {entry["id"] for entry in json.loads(self.succeed("list", "techniques", "--json")) if not entry["named_only"]}
        here, soft = ({t.split(":")[0] for suite in suites for _, _, t in self.rows(suite)[1]}
                      for suites in (("standard",), ("soft", "soft_geometry", "radiosity")))
        self.assertLessEqual(listed, here | soft)
        # Those that it lacks are for lights with area alone.
        for technique in listed - here:
            done = self.gnomon("render", "--scene", "contact", "--light", "point", "--technique", technique, "--out", "out")
            self.assertEqual(done.returncode, 2, technique)
        self.assertGreater({s for s, _, _ in rows}, {s for s, _, _ in self.rows("quick")[1]})

    def test_rows_of_scenes_that_are_not_fetched_say_so(self):
        text = self.succeed("run", "quick", "--dry-run")  # the cache of this test is empty
        self.assertRegex(text, r"(?m)^\S+  bunny sun .*unsupported: scene bunny is not fetched: run scripts/fetch_scenes bunny$")
        done = self.gnomon("run", "quick", "--filter", "^bunny sun (unshadowed|shadow_map)$", "--quiet", "--out", "out")
        self.assertEqual(done.returncode, 1, done.stderr)  # nothing was measured
        self.assertEqual(done.stderr, "gnomon: 0 of 2 rows measured; not fetched: bunny. scripts/fetch_scenes --all fetches them\n")
        for row in records(self.dir / "out"):
            self.assertEqual(row["status"], "unsupported")
            self.assertIn("scripts/fetch_scenes bunny", row["reason"])

    def test_a_run_that_lacks_some_scenes_does_the_others_and_says_so(self):
        done = self.gnomon("run", "quick", "--filter", "^(bunny|contact) sun unshadowed$", "--quiet", *NUMBERS, "--out", "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "note: 1 of 2 rows measured; not fetched: bunny. scripts/fetch_scenes --all fetches them\n")

    def test_quick_and_standard_show_acne_peter_panning_and_unsupported(self):
        """The rows of both that are there to be wrong, and their neighbors with the default bias, at the suites' size.

        Acne: no bias at all, so that surfaces shadow themselves; more than 1 % false dark and ten times the default's.
        Peter-panning: a bias so large that contact shadows come off; false lit well above the default's, false dark not above.
        """
        bias = r"shadow_map(:bias=constant,depth_bias=\d+)?"
        chosen = ["--filter", rf"^(contact|soup:ground=false) (point|sun) ({bias}|planar_projected)$"]
        self.succeed("run", "quick", *chosen, "--processes", "1", "--repetitions", "1", "--out", "out")
        measured = {row["job"]: row for row in records(self.dir / "out")}
        self.assertEqual({(r["width"], r["height"]) for r in measured.values()}, {(640, 360)})
        for suite in ("quick", "standard"):
            with self.subTest(suite):
                jobs = re.findall(r"(?m)^([0-9a-f]{16})  ", self.succeed("run", suite, *chosen, "--dry-run"))
                self.assertLessEqual(set(jobs), set(measured))  # the rows of standard are rows of quick
                self.assert_shows_failures([measured[job] for job in jobs])

    def assert_shows_failures(self, rows):
        acne, panning, unsupported = [], [], []
        for row in rows:
            if row["status"] == "unsupported":
                unsupported.append(row)
                continue
            place = (row["scene"], row["light"])
            default = next(r for r in rows if (r["scene"], r["light"], r["technique"], r["settings"]) == (*place, "shadow_map", ""))
            error, usual = row["metrics"]["shape"], default["metrics"]["shape"]
            texels = re.search(r"depth_bias=(\d+)", row["settings"])
            if texels and texels[1] == "0":
                if error["false_dark_rate"] > max(0.01, 10 * usual["false_dark_rate"]):
                    acne.append(row)
            elif texels and error["false_lit_rate"] > max(0.002, 2 * usual["false_lit_rate"]):
                if error["false_dark_rate"] <= usual["false_dark_rate"]:
                    panning.append(row)
        rates = [(r["scene"], r["light"], r["settings"], *(r["metrics"]["shape"][f"false_{kind}_rate"] for kind in ("dark", "lit")))
                 for r in rows if r["status"] == "ok"]
        self.assertTrue(acne, rates)
        self.assertTrue(panning, rates)
        self.assertTrue(unsupported, rates)
        for row in unsupported:
            self.assertNotIn("not fetched", row["reason"])
            self.assertGreater(len(row["reason"]), 10)
            self.assertIsNone(row["mask"])


if __name__ == "__main__":
    unittest.main()
