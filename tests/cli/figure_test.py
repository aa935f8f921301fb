#!/usr/bin/python3 -IB
"""`gnomon figure`: gnuplot draws what a run measured; its program can be had without it."""

import os
import re
import shutil
import subprocess
import sys
import unittest
import xml.etree.ElementTree
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ROOT, ProgramTest  # noqa: E402

SHIPPED = ROOT / "results/quick"
HAS_GNUPLOT = shutil.which("gnuplot") is not None


class Figure(ProgramTest):
    @unittest.skipUnless(HAS_GNUPLOT, "there is no gnuplot")
    def test_figures_of_the_shipped_run(self):
        heads = {"svg": b"<?xml", "pdf": b"%PDF", "png": b"\x89PNG"}
        for kind in ("front", "stages", "map"):
            for ending, head in heads.items():
                with self.subTest(f"{kind}.{ending}"):
                    out = f"figures/{kind}.{ending}"
                    self.assertEqual(self.succeed("figure", SHIPPED, kind, "--filter", "bunny", "--out", out), "")
                    self.assertTrue((self.dir / out).read_bytes().startswith(head))
        self.assertEqual(len(self.names(self.dir)), 9)
        texts = " ".join(xml.etree.ElementTree.parse(self.dir / "figures/front.svg").getroot().itertext())
        for text in ("relight + resolve (ms)", "error (%)", "shadow_map pcf", "planar_projected", "embree_rays (reference)"):
            self.assertIn(text, texts)
        self.assertNotIn("unshadowed", texts)
        parts = xml.etree.ElementTree.parse(self.dir / "figures/front.svg").getroot().iter()
        titles = [part.text for part in parts if part.tag.endswith("title")]
        self.assertIn("error (%), mean against relight + resolve (ms)", titles[0])
        self.assertFalse([title for title in titles if "gnuplot" in title.lower()])
        self.assertIn("planar_projected", titles)

    @unittest.skipUnless(HAS_GNUPLOT, "there is no gnuplot")
    def test_a_sweep_holds_several_quantities(self):
        self.succeed("figure", SHIPPED, "sweep", "--x", "resolution", "--filter", "bunny", "--error", "false dark,cause.acne",
                     "--out", "sweep.svg", "--width", "8.5")
        texts = " ".join(xml.etree.ElementTree.parse(self.dir / "sweep.svg").getroot().itertext())
        for text in ("shadow_map: false dark", "shadow_map: acne"):
            self.assertIn(text, texts)

    @unittest.skipUnless(HAS_GNUPLOT, "there is no gnuplot")
    def test_a_sweep_names_its_settings_and_its_axes(self):
        self.succeed("figure", SHIPPED, "sweep", "--x", "resolution", "--filter", "bunny", "--out", "sweep.svg")
        texts = " ".join(xml.etree.ElementTree.parse(self.dir / "sweep.svg").getroot().itertext())
        for text in ("resolution (texel)", "error (%)", "bunny", "shadow_map"):
            self.assertIn(text, texts)

    @unittest.skipUnless(HAS_GNUPLOT, "there is no gnuplot")
    def test_the_printed_program_draws_the_same_figure(self):
        self.succeed("figure", SHIPPED, "stages", "--out", "figure.svg")
        script = self.succeed("figure", SHIPPED, "stages", "--out", "again.svg", "--script")
        self.assertEqual(self.names(self.dir), ["figure.svg"])
        subprocess.run(["gnuplot"], input=script, text=True, cwd=self.dir, check=True, timeout=60)
        # Names of the parts come from the program's comments: gnuplot cannot set them.
        drawn, again = (re.sub("<title>.*?</title>", "", (self.dir / name).read_text()) for name in ("figure.svg", "again.svg"))
        self.assertEqual(drawn, again)

    def test_without_gnuplot_the_package_is_named(self):
        (self.dir / "bin").mkdir()
        for tool in ("sh",):
            os.symlink(shutil.which(tool), self.dir / "bin" / tool)
        self.environment = dict(self.environment, PATH=str(self.dir / "bin"))
        self.refuse("figure", SHIPPED, "stages", "--out", "figure.svg", says=["gnuplot-nox", "--script"])
        self.assertEqual(self.names(self.dir), ["bin/sh"])
        self.assertIn("plot ", self.succeed("figure", SHIPPED, "stages", "--script"))

    def test_bad_words_are_named(self):
        self.refuse("figure", SHIPPED, "fornt", "--out", "f.svg", says=["there is no figure fornt; did you mean front?"])
        self.refuse("figure", SHIPPED, "front", "--out", "f.jpg", says=["f.jpg", ".svg, .pdf nor .png"])
        self.refuse("figure", SHIPPED, "front", says=["--out", "--script"])
        self.refuse("figure", SHIPPED, "motion", "--out", "f.svg", says=["no row of these records follows a path"])
        self.refuse("figure", SHIPPED, "sweep", "--x", "resolutoin", "--out", "f.svg", says=["did you mean resolution?"])
        self.refuse("figure", SHIPPED, "sweep", "--x", "slope_bias", "--out", "f.svg", says=["there is no sweep of slope_bias"])
        self.refuse("figure", SHIPPED, "front", "--error", "error,wrong_rate", "--out", "f.svg", says=["takes one quantity"])
        self.refuse("figure", SHIPPED, "sheet", "--out", "f.svg", says=["no row has an error picture", "--pictures all"])
        self.refuse("figure", SHIPPED, "growth", "--out", "f.svg",
                    says=["there is no growth with triangles", "two values of it"])
        self.assertEqual(self.names(self.dir), [])


if __name__ == "__main__":
    unittest.main()
