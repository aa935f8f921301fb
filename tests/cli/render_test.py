#!/usr/bin/python3 -IB
"""render and certify: one technique on one scene, and how far the reference may be trusted."""

import json
import re
import struct
import sys
import unittest
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / room) for room in ("cli", "viewer")]
from pictures import read_png  # noqa: E402
from program import DATA, SMALL, ProgramTest, records  # noqa: E402

SIZE = SMALL[-2:]


def png_size(file):
    head = file.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n" and head[12:16] == b"IHDR", file
    return struct.unpack(">II", head[16:24])


def exr_header(file):
    """The bytes before the first scan line: magic number, then attributes."""
    data = file.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01", file
    return data[:1000]


class Render(ProgramTest):
    def test_a_light_that_is_not_supported_is_left_out(self):
        call = ["render", "--scene", "single_triangle", "--technique", "shadow_map:resolution=128", *SIZE, "--out", "out"]
        for lights, left in ((["point", "lamp", "sun"], ["point", "sun"]), (["lamp", "sun"], ["sun"])):
            with self.subTest(lights=lights):
                done = self.gnomon(*call, "--light", ",".join(lights))
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertRegex(done.stderr, r"(?m)^note: lamp is left out: .*area")
                made = json.loads((self.dir / "out/record.json").read_text())
                self.assertEqual([record["light"] for record in made], left)
                self.assertEqual([record["error_picture"] for record in made], ["error.png", "error_sun.png"][:len(left)])
                self.assertEqual(self.names(self.dir / "out").count("mask.png"), 1)
        self.refuse(*call[:-1], "none", "--light", "lamp", says=["shadow_map", "does not support", "lamp", "area"])
        self.assertFalse((self.dir / "none").exists())

    def test_render_writes_mask_pictures_and_record(self):
        out = self.dir / "deep/er/out"
        text = self.succeed("render", "--scene", "soup:count=50", "--technique", "shadow_map:resolution=256", *SIZE, "--out", out)
        self.assertEqual(self.names(out), ["error.png", "error_sun.png", "mask.exr", "mask.png", "mask_sun.png", "record.json",
                                           "shaded.png", "shaded_sun.png"])
        for name in ("mask", "mask_sun", "shaded", "shaded_sun"):
            self.assertEqual(png_size(out / f"{name}.png"), (160, 90))
        self.assertEqual(png_size(out / "error.png")[0], 160)
        self.assertGreater(png_size(out / "error.png")[1], 90)  # a legend is below the picture
        self.assertIn("mask.exr", text)
        point, sun = json.loads((out / "record.json").read_text())
        self.assertEqual((point["light"], sun["light"]), ("point", "sun"))
        for record in (point, sun):
            self.assertEqual((record["status"], record["settings"], record["width"]), ("ok", "resolution=256", 160))
            self.assertEqual([len(record["stages"][s]) for s in ("setup", "build", "relight", "resolve")], [1, 1, 1, 1])
            self.assertTrue((out / record["mask"]).is_file() and (out / record["error_picture"]).is_file())

    def test_the_mask_of_a_light_with_area_has_a_legend(self):
        self.succeed("render", "--scene", "single_triangle", "--technique", "embree_rays", "--light", "point", "--light", "lamp",
                     *SIZE, "--out", "out")
        self.assertEqual(png_size(self.dir / "out/mask.png"), (160, 90))
        width, height = png_size(self.dir / "out/mask_lamp.png")
        self.assertEqual(width, 160)
        self.assertGreaterEqual(height, 90 + 30)  # a line of 20 pixels, and its margin, at least

    def test_the_mask_has_one_channel_for_each_light(self):
        self.succeed("render", "--scene", "single_triangle", "--technique", "embree_rays", *SIZE, "--out", "both")
        header = exr_header(self.dir / "both/mask.exr")
        self.assertIn(b"point.V\0", header)
        self.assertIn(b"sun.V\0", header)
        self.succeed("render", "--scene", "single_triangle", "--technique", "embree_rays", "--light", "sun", *SIZE, "--out", "one")
        header = exr_header(self.dir / "one/mask.exr")
        self.assertNotIn(b"point.V\0", header)
        self.assertIn(b"sun.V\0", header)
        self.assertEqual([r["light"] for r in json.loads((self.dir / "one/record.json").read_text())], ["sun"])

    def test_the_reference_is_never_wrong(self):
        self.succeed("render", "--scene", "sphere_over_plane", "--technique", "embree_rays", *SIZE, "--out", "out")
        for record in json.loads((self.dir / "out/record.json").read_text()):
            self.assertEqual(record["metrics"]["shape"]["wrong_rate"], 0)
            self.assertGreater(record["classes"]["T"], 1000)

    def test_a_second_render_replaces_the_first(self):
        arguments = ["render", "--scene", "single_triangle", "--light", "sun", *SIZE, "--out", "out", "--technique"]
        self.succeed(*arguments, "unshadowed")
        first = (self.dir / "out/mask.png").read_bytes()
        self.succeed(*arguments, "embree_rays")
        self.assertNotEqual((self.dir / "out/mask.png").read_bytes(), first)
        self.assertEqual([p.name for p in self.dir.iterdir()], ["out"])

    def test_a_debug_layer_has_its_legend_below(self):
        heights = {}
        for layer in ("crossings", "depth"):
            self.succeed("render", "--scene", "single_triangle", "--technique", "crow_counting", "--light", "sun", *SIZE,
                         "--debug", layer, "--out", layer)
            width, heights[layer] = png_size(self.dir / layer / f"{layer}.png")
            self.assertEqual(width, 160)
            # Three lines of the sentence and two of colors at least, each of 20 pixels.
            self.assertGreaterEqual(heights[layer], 90 + 10 + 5 * 20)
            self.assertEqual((heights[layer] - 90) % 20, 10)
        self.refuse("render", "--scene", "single_triangle", "--technique", "crow_counting", *SIZE, "--debug", "crossing",
                    "--out", "none", says=["did you mean crossings"])
        self.assertFalse((self.dir / "none").exists())

    def test_layers_show_the_parts_of_an_error(self):
        """Without memory the noise differs from pixel to pixel, and nothing is stale. The legend below has few colors of its own."""
        def colors(layer):
            self.succeed("render", "--scene", "straight_penumbra", "--light", "panel", *SIZE, "--technique", "denoised_rays",
                         "--debug", layer, "--out", layer)
            picture = read_png(self.dir / layer / f"{layer}.png")
            return {picture.at(x, y) for x in range(160) for y in range(90)}

        self.assertGreater(len(colors("residual_noise")), 20)
        self.assertLessEqual(len(colors("stale_history")), 2)  # no difference, and pixels that do not face the light

    def render_sun(self, scene, out):
        """The mask, which holds no date: equal bytes are equal pixels. A filtered map has values between 0 and 1."""
        self.succeed("render", "--scene", scene, "--technique", "shadow_map:resolution=256,filter=pcf", "--light", "sun", *SIZE,
                     "--out", out)
        return (self.dir / out / "mask.exr").read_bytes()

    def test_a_description_that_starts_from_a_scene_gives_the_masks_of_that_scene(self):
        # The sun and the view as the scenes themselves have them; a mesh more makes it another picture.
        sun = '[[light]]\nname = "sun"\nkind = "directional"\ndirection = {}\n'
        view = '[[view]]\nname = "view"\neye = {}\ntarget = {}\nfov_y_degrees = {}\n'
        mesh = f'[[mesh]]\nfile = "{DATA / "tetrahedron.obj"}"\ntranslate = [1, 0, 1]\n'
        for base, light, seen in [
            ("composite:object=sphere", sun.format([-4, -9, -0.0]), view.format([-6.5, 5.5, 9], [-1, 1.65, 0], 34)),
            ("snowman", sun.format([-1, -1.1, -0.6]), view.format([1.6, 3.6, 8], [0.3, 1.62, 0], 31)),
        ]:
            with self.subTest(base):
                name = base.split(":")[0]
                self.write(f"{name}.toml", f'scene = "{base}"\n{light}{seen}')
                whole = self.render_sun(base, f"{name}_base")
                self.assertEqual(self.render_sun(f"{name}.toml", f"{name}_same"), whole)
                self.write(f"{name}_more.toml", f'scene = "{name}.toml"\n{mesh}')
                self.assertNotEqual(self.render_sun(f"{name}_more.toml", f"{name}_more"), whole)

    def test_a_record_is_the_same_as_that_of_run(self):
        self.succeed("render", "--scene", "single_triangle", "--technique", "shadow_map", "--light", "sun", *SIZE, "--out", "a")
        self.succeed("run", "--scene", "single_triangle", "--technique", "shadow_map", "--light", "sun", *SMALL, "--out", "b")
        rendered = json.loads((self.dir / "a/record.json").read_text())[0]
        ran = records(self.dir / "b")[0]
        self.assertEqual(rendered.keys(), ran.keys())
        for key in ("job", "classes", "parameters", "counts"):
            self.assertEqual(rendered[key], ran[key])
        self.assertEqual(rendered["metrics"]["shape"], ran["metrics"]["shape"])


class Certify(ProgramTest):
    def test_no_answer_of_the_reference_differs_from_the_exact_one(self):
        text = self.succeed("certify", "--scene", "soup:count=50", *SIZE)
        self.assertEqual(len(re.findall(r"(?m)^soup:count=50 / (?:point|sun) / view: certified$", text)), 2, text)
        asked = re.findall(r"outside U +(\d+) queries, 0 disagreements", text)
        self.assertEqual([int(count) > 100 for count in asked], [True, True], text)

    def test_one_light_as_json(self):
        certificates = json.loads(self.succeed("certify", "--scene", "single_triangle", "--light", "sun", *SIZE, "--json"))
        self.assertEqual(len(certificates), 1)


if __name__ == "__main__":
    unittest.main()
