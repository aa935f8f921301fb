#!/usr/bin/python3 -IB
"""Masks of engines in a browser: lit where nothing casts, dark where the reference is, of every kind; records say who drew them."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from engines_browser_test import BOX, IS_HERE, PACKAGES, run_on  # noqa: E402
from program import PATIENCE, ProgramTest  # noqa: E402

KINDS = (
    "babylon_js:shadows={poisson,pcf,contact_hardening,exponential,blurred_exponential,close_exponential,blurred_close_exponential,cascaded}",
    "playcanvas:shadows={pcf1,pcf5,vsm,pcss}",
    "three_js:shadows={basic,vsm,planar}",
    "three_js:shadows=pcf_soft,version=r170",
)
WAITS = ("--timeout", PATIENCE // 2)  # of the whole run's


@unittest.skipUnless(IS_HERE, "an engine's modules, Node.js or Chromium are not there")
class MasksOfABrowser(ProgramTest):
    def test_what_casts_nothing_leaves_all_lit(self):
        scene = self.write("lit.toml", BOX.replace("CASTS", "false"))
        for technique in PACKAGES:
            for record in run_on(self, scene, technique, more=WAITS):
                with self.subTest(f"{technique} {record['light']}"):
                    self.assertEqual(record["status"], "ok", record)
                    self.assertEqual(record["metrics"]["mesh"]["error"], 0)

    def test_each_kind_draws_under_a_sun(self):
        scene = self.write("box.toml", BOX.replace("CASTS", "true"))
        for record in (row for kinds in KINDS for row in run_on(self, scene, kinds, more=("--light", "sun", *WAITS))):
            with self.subTest(f"{record['technique']} {record['settings']}"):
                self.assertEqual(record["status"], "ok", record)
                if record["technique"] == "three_js":
                    version = "r170" if "version=r170" in record["settings"] else "r187"
                    self.assertRegex(record["context"]["plugin"]["maker"], rf"^three\.js {version} in Chromium ")

    def test_shadows_are_where_the_reference_has_them(self):
        scene = self.write("box.toml", BOX.replace("CASTS", "true"))
        wrong = lambda record: record["metrics"]["mesh"]["wrong_rate"]
        lit = {record["light"]: wrong(record) for record in run_on(self, scene, "unshadowed")}
        for record in (row for technique in PACKAGES for row in run_on(self, scene, technique, more=WAITS)):
            with self.subTest(f"{record['technique']} {record['light']}"):
                self.assertEqual(record["status"], "ok", record)
                self.assertLess(wrong(record), lit[record["light"]] / 8)


if __name__ == "__main__":
    unittest.main()
