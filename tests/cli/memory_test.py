#!/usr/bin/python3 -IB
"""Rows of a technique that remembers frames: a program whose answer is the number of pictures since it forgot."""

import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, PROGRAM_SHEET, ProgramTest, records  # noqa: E402

STILLS, SETTLED = 64, 16  # docs/method.md
FRAMES = 16  # of light_slide
# The first picture of a sequence is lit everywhere, the n-th after it has the visibility n / 128.
COUNTS = """
from gnomon_technique import Technique, serve

class Counts(Technique):
    count = 0
    def forget(self):
        self.count = 0
    def build(self, scene):
        self.scene = scene
    def relight(self, light):
        self.light = light
    def resolve(self, gbuffer, mask):
        mask[...] = 1
        if self.count:
            mask[gbuffer.faces(self.light, self.scene)] = self.count / 128
        self.count += 1

serve(Counts)
"""


def error(value, dark):
    """Of a mask of one value where the share `dark` of the tested pixels is dark."""
    return dark * value + (1 - dark) * (1 - value)


class Memory(ProgramTest):
    def run_rows(self, *options, remembers=True, last=None):
        """`last`: the number of a picture at which the program throws."""
        self.write("counts.py", COUNTS.replace("        mask[...] = 1\n", f"        mask[...] = 1\n        assert self.count != {last}, 'tired'\n"))
        sheet = PROGRAM_SHEET.format(id="counts").replace("-IB", "-B") + ("remembers = true\n" if remembers else "")
        program = ["--program", self.write("counts.toml", sheet)]
        self.succeed(*program, "run", "--scene", "box_city:count=12", "--light", "sun", "--technique", "unshadowed", "--technique", "counts",
                     *options, *NUMBERS, "--out", "out", status=0 if last is None else 1)
        return [next(row for row in records(self.dir / "out") if row["technique"] == name) for name in ("unshadowed", "counts")]

    def test_a_still_is_scored_cold(self):
        lit, row = self.run_rows()
        dark, metrics = lit["metrics"]["shape"]["error"], row["metrics"]["shape"]
        self.assertAlmostEqual(metrics["error"], dark, places=9)
        self.assertAlmostEqual(metrics["error_cold"], dark, places=9)
        middle = sum(range(STILLS - SETTLED, STILLS)) / SETTLED / 128
        self.assertAlmostEqual(metrics["error_settled"], error(middle, dark), places=6)
        self.assertNotIn("error_settled", lit["metrics"]["shape"])

    def test_a_path_begins_settled(self):
        lit, row = self.run_rows("--path", "light_slide")
        dark = lit["frames"]["error"]
        self.assertEqual(len(dark), FRAMES)
        for k, (of_frame, now) in enumerate(zip(dark, row["frames"]["error"])):
            self.assertAlmostEqual(now, error((STILLS - 1 + k) / 128, of_frame), places=6, msg=str(k))
        self.assertAlmostEqual(row["metrics"]["shape"]["error_cold"], dark[0], places=9)
        for name in ("error_settled", "ghost_half_life", "ghost_frames"):
            self.assertIsNone(lit["metrics"]["shape"][name])
        self.assertIsNone(row["metrics"]["shape"]["ghost_frames"])  # the light moves on and on

    def test_a_failure_says_at_which_frame_it_was(self):
        for last, options, where in ((40, (), "still frame 40"), (40, ("--path", "light_slide"), "still frame 40"),
                                     (STILLS + 2, ("--path", "light_slide"), "frame 3")):
            with self.subTest(where, options=options):
                reason = self.run_rows(*options, last=last)[1]["reason"]
                self.assertRegex(reason, rf"tired.* \(at {where}\)$")
                self.assertEqual(reason.count("(at "), 1)
                shutil.rmtree(self.dir / "out")

    def test_rescoring_keeps_what_one_mask_does_not_tell(self):
        _, row = self.run_rows()
        before = row["metrics"]["shape"]
        self.succeed("table", "out", "--rescore")
        after = next(r for r in records(self.dir / "out") if r["technique"] == "counts")["metrics"]["shape"]
        self.assertEqual([after[name] for name in ("error_cold", "error_settled")],
                         [before[name] for name in ("error_cold", "error_settled")])


if __name__ == "__main__":
    unittest.main()
