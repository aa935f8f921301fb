#!/usr/bin/python3 -IB
"""Glass in POV-Ray and Cycles: each says before it renders what it cannot do, and multiplies the rest as the reference does."""

import os
import shutil
import struct
import sys
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from engines_masks_test import FAKE, SQUARE, gltf  # noqa: E402
from program import HARD, NUMBERS, ProgramTest, records  # noqa: E402

# What a card lets through, of 255: 7 x 3 texels.
TEXELS = ((255, 26, 128, 204, 51, 90, 0), (13, 230, 77, 153, 255, 179, 64), (102, 38, 242, 140, 5, 191, 115))
WIDE = ((-1.25, -1.5), (2.25, -1.5), (2.25, 1.75), (-1.25, 1.75))
WRAPS = (("repeat", "repeat"), ("repeat", "mirror"), ("mirror", "mirror"), ("clamp", "clamp"))
ENGINES = tuple(technique for technique, program in (("pov_ray", "povray"), ("cycles", "blender")) if shutil.which(program))
# A ground and a pane that the eye sees, with a pane above them that it does not.
PANES = """
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [6, 6]
[[shape]]
kind = "plane"
center = [0, 0.5, 0]
normal = [0, 1, 0]
size = [2, 1.5]
rotate_degrees = 20
transmission = 0.4
seen = true
[[shape]]
kind = "plane"
center = [0.3, 1.5, 0.2]
normal = [0.1, 1, 0.2]
size = [2, 2]
transmission = 0.7
[[light]]
name = "sun"
kind = "directional"
direction = [0.3, -1, 0.2]
[[view]]
name = "view"
eye = [1, 5, 4]
target = [0, 0, 0]
fov_y_degrees = 45
"""
OTHERS = ("babylon_js", "eevee", "filament", "godot", "ogre", "open_scene_graph", "playcanvas", "three_js")


def gray_png(rows):
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


class EngineGlass(ProgramTest):
    def setUp(self):
        super().setUp()
        self.environment["PATH"] = os.environ["PATH"]
        (self.dir / "bin").mkdir()
        for name in ("povray", "blender"):
            (self.dir / "bin" / name).write_text(FAKE)
            (self.dir / "bin" / name).chmod(0o755)
        self.fakes = dict(self.environment, PATH=f"{self.dir}/bin:/usr/bin:/bin", GNOMON_FAKE_PLACE=str(self.dir))

    def run_on(self, scenes, techniques, *more, status=0):
        """The records, one of each row."""
        out = self.dir / "run"
        shutil.rmtree(out, ignore_errors=True)
        names = [word for option, list_ in (("--scene", scenes), ("--technique", techniques)) for name in list_ for word in (option, name)]
        self.succeed("run", *names, "--truth", "mesh", *NUMBERS, *more, "--quiet", "--out", out, status=status)
        return records(out)

    def agree(self, rows):
        """Of the tested pixels at most 2e-4 are off by more than 1/20, and the mean is off by at most a thousandth."""
        for row in rows:
            with self.subTest(f"{row['technique']} {row['scene']} {row['light']}"):
                self.assertEqual(row["status"], "ok", row)
                self.assertLessEqual(row["metrics"]["mesh"]["error"], 1e-3, row["metrics"])
                self.assertLessEqual(row["metrics"]["mesh"]["wrong_rate"], 2e-4, row["metrics"])

    def test_what_cannot_be_drawn_is_unsupported_and_nothing_starts(self):
        self.environment = self.fakes
        sound = ("sound", "repeat", "repeat", SQUARE)
        for technique, card, holes, says in (
            ("cycles", ("u_only", "clamp", "repeat", SQUARE), None, "the transmission of mesh 'u_only' has wrap clamp along u and repeat along v"),
            # 2341 copies of 7 texels are 16387 pixels, from copy -1 to before copy 2340.
            ("pov_ray", ("wide", "clamp", "repeat", ((-0.5, 0), (2339.5, 0), (2339.5, 1), (-0.5, 1))), None,
             "the transmission of mesh 'wide' has 7 texels along u and wrap clamp; POV-Ray needs a picture of 16387 pixels"),
            # A copy of a mask of 2 texels and a glass of 7 has 14 pixels; 1171 copies are 16394.
            ("pov_ray", ("both", "clamp", "repeat", ((0, 0), (1170.5, 0), (1170.5, 1), (0, 1))), ("#.",),
             "the transmission of mesh 'both' has 7 texels along u and wrap clamp; POV-Ray needs a picture of 16394 pixels"),
            ("pov_ray", ("line", "repeat", "repeat", ((0, 0), (1, 1), (0, 1), (0, 0.5))), None, "the uv of triangle 1 of mesh 'line' lie on a line"),
        ):
            with self.subTest(f"{technique} {card}"):
                scene = self.write("cards.gltf", gltf(sound, card, rows=holes, glass=gray_png(TEXELS)))
                (record,) = self.run_on([scene], [technique])
                self.assertEqual(record["status"], "unsupported", record)
                self.assertIn(says, record["reason"])
                self.assertFalse((self.dir / "started").exists())

    def test_the_others_have_no_glass(self):
        for record in self.run_on(["glass_stack"], OTHERS, "--light", "sun"):
            self.assertEqual(record["status"], "unsupported", record)
            self.assertRegex(record["reason"], "does not state that it handles transmission|scripts/setup --engines")

    @unittest.skipUnless(ENGINES, "there is neither POV-Ray nor Blender")
    def test_stacks_and_smoke_are_multiplied(self):
        self.agree(self.run_on(["glass_stack", "smoke_cards"], ENGINES, *HARD))

    @unittest.skipUnless(ENGINES, "there is neither POV-Ray nor Blender")
    def test_texels_and_holes_are_those_of_the_reference(self):
        cards = [(f"{u}_{v}", u, v, WIDE) for u, v in WRAPS]
        cards.append(("even", "mirror", "repeat", ((3.5 / 7, 0.5 / 3),) * 4))  # all of it in one texel
        for holes in (None, ("#..", "##.", ".##", "#.#", "###")):  # 3 x 5 texels beside the 7 x 3 of the glass
            scene = self.write("cards.gltf", gltf(*cards, rows=holes, glass=gray_png(TEXELS)))
            self.agree(self.run_on([scene], ENGINES))
            (lit,) = self.run_on([scene], ["unshadowed"])
            self.assertGreater(lit["metrics"]["mesh"]["error"], 0.01)  # ten times what is allowed

    @unittest.skipUnless(ENGINES, "there is neither POV-Ray nor Blender")
    def test_glass_that_the_eye_sees_stops_it_and_receives(self):
        self.agree(self.run_on([self.write("panes.toml", PANES)], ENGINES))


if __name__ == "__main__":
    unittest.main()
