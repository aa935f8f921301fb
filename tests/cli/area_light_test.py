#!/usr/bin/python3 -IB
"""A light with area has no reference yet: every way to a score says so, and none gives a number."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import SMALL, ProgramTest, records  # noqa: E402

WHY = "the reference has no answer: one ray per pixel cannot see part of an area light"

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


class AreaLight(ProgramTest):
    def scene(self, kind="disc"):
        return self.write(f"{kind}.toml", SCENE.replace("KIND", kind).replace("SHAPE", KINDS[kind]))

    def test_run_gives_an_unsupported_row_with_the_reason(self):
        for kind in KINDS:
            self.succeed("run", "--scene", self.scene(kind), "--technique", "unshadowed", *SMALL, "--out", kind)
            lamp, bulb = records(self.dir / kind)
            self.assertEqual((lamp["light_kind"], lamp["status"], lamp["support"]), (kind, "unsupported", "unsupported"))
            self.assertEqual(lamp["reason"], WHY)
            for key in ("metrics", "classes", "causes", "mask", "error_picture"):
                self.assertFalse(lamp[key], key)
            self.assertEqual((bulb["status"], bulb["reason"]), ("ok", ""))
            table = self.succeed("table", kind, "--format", "json")
            self.assertIn("unsupported", table)

    def test_a_techniques_own_reason_comes_first(self):
        self.succeed("run", "--scene", self.scene(), "--light", "lamp", "--technique", "shadow_map", *SMALL, "--out", "out")
        row = records(self.dir / "out")[0]
        self.assertEqual((row["status"], row["reason"]), ("unsupported", "a shadow map has one center: lights with area have none"))

    def test_render_score_and_certify_refuse(self):
        scene = self.scene()
        self.refuse("render", "--scene", scene, "--technique", "unshadowed", "--light", "lamp", "--size", "64x36", "--out", "out",
                    says=["unshadowed", "lamp", WHY])
        self.assertFalse((self.dir / "out").exists())
        self.succeed("render", "--scene", scene, "--technique", "unshadowed", "--light", "bulb", "--size", "64x36", "--out", "bulb")
        mask = self.dir / "bulb/mask.exr"
        self.refuse("score", "--scene", scene, "--light", "lamp", "--channel", "bulb.V", "--mask", mask, says=["lamp", WHY])
        self.succeed("score", "--scene", scene, "--light", "bulb", "--mask", mask)
        # All lights are asked for, and nothing is printed of the one that could be certified.
        self.refuse("certify", "--scene", scene, "--size", "64x36", says=["lamp", WHY])

    def test_numbers_of_old_runs_are_withdrawn(self):
        scene = self.scene()
        self.succeed("run", "--scene", scene, "--technique", "unshadowed", *SMALL, "--out", "out")
        file = self.dir / "out/records.jsonl"
        lamp, bulb = (json.loads(line) for line in file.read_text().splitlines())
        # As it was written when the center was taken for the light: with the numbers of a point light.
        for forgets_kind in (False, True):
            old = dict(bulb, light="lamp", light_kind="" if forgets_kind else "disc", job=lamp["job"],
                       context=dict(bulb["context"], frames=5))
            file.write_text("".join(json.dumps(row) + "\n" for row in (old, bulb)))
            if not forgets_kind:
                for format in ("json", "md", "csv"):
                    text = self.succeed("table", "out", "--format", format)
                    self.assertIn("hard shadow of the light's center", text)
                self.succeed("report", "out", "--out", "report.html")
                self.assertIn("hard shadow of the light's center", (self.dir / "report.html").read_text())
            # Rescoring looks at the scene, whatever the record says. The mask has a channel for the bulb only.
            self.succeed("table", "out", "--rescore", "--save", "--format", "json")
            row = records(self.dir / "out")[0]
            self.assertEqual((row["light"], row["status"]), ("lamp", "unsupported"))
            self.assertFalse(row["metrics"])
            self.assertEqual(records(self.dir / "out")[1]["status"], "ok")


if __name__ == "__main__":
    unittest.main()
