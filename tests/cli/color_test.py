#!/usr/bin/python3 -IB
"""Glass that colors the light, as a person meets it: rows of three channels, their masks and pictures, and what is made of them."""

import json
import struct
import sys
import unittest
import zlib
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[k]) for k in (0, 1)]
from export_reader import read_exr  # noqa: E402
from program import SMALL, ProgramTest, measured, records, what  # noqa: E402

COLORS = ("red", "green", "blue")
FIRST, SECOND = np.array([0.9, 0.18, 0.09]), np.array([0.1, 0.8, 0.2])  # what the panes let through
PRODUCT = np.array([0.09, 0.144, 0.018])
GRAY = 0.7  # the floor

# Over a floor of 6 m a pane of |x + 0.5|, |z| below 1, and one of |x - 0.5|, |z| below 1.
SCENE = f"""
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [6, 6]
albedo = [{GRAY}, {GRAY}, {GRAY}]

[[shape]]
kind = "plane"
center = [-0.5, 2, 0]
normal = [0, 1, 0]
size = [2, 2]
transmission = {FIRST.tolist()}

[[shape]]
kind = "plane"
center = [0.5, 1, 0]
normal = [0, 1, 0]
size = [2, 2]
transmission = {SECOND.tolist()}

[[light]]
name = "sun"
kind = "directional"
direction = [0, -1, 0]

[[light]]
name = "lamp"
kind = "rect"
center = [0.2, 4, 0]
half_u = [0.5, 0, 0]
half_v = [0, 0, 0.5]
intensity = 4

[[view]]
name = "main"
eye = [0.3, 7, 1.5]
target = [0.1, 0, 0]
"""
GRAY_SCENE = SCENE.replace(str(FIRST.tolist()), "0.9").replace(str(SECOND.tolist()), "0.2")
TECHNIQUES = ("embree_rays", "exact_rays", "transmittance_map:resolution=256", "area_rays:samples=16")
SOUND = {("embree_rays", "sun"), ("embree_rays", "lamp"), ("exact_rays", "sun"), ("transmittance_map", "sun"), ("area_rays", "lamp")}


def channels(*lights):
    return [f"{light}.{color}" for light in lights for color in COLORS]


def read_png(path):
    """Height x width x channels, 8 bits each, without a palette."""
    data, at, packed = Path(path).read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            width, height, depth, color, _, _, interlaced = struct.unpack_from(">IIBBBBB", data, at + 8)
            assert depth == 8 and color in (0, 2, 6) and not interlaced, path
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += 12 + size
    step = {0: 1, 2: 3, 6: 4}[color]
    lines, rows = zlib.decompress(packed), [bytearray(width * step)]
    for y in range(height):
        start = y * (width * step + 1)
        row, above = bytearray(lines[start + 1:start + 1 + width * step]), rows[-1]
        for k in range(len(row)):
            a, b, c = row[k - step] if k >= step else 0, above[k], above[k - step] if k >= step else 0
            near = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]  # Paeth: left, up, upper left
            row[k] = row[k] + (0, a, b, (a + b) // 2, near)[lines[start]] & 255
        rows.append(row)
    return np.array([list(row) for row in rows[1:]]).reshape(height, width, step)


class Color(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("panes.toml", SCENE)
        self.write("gray.toml", GRAY_SCENE)

    def run_rows(self, out, *arguments, scene="panes.toml", techniques=TECHNIQUES):
        self.succeed("run", "--scene", scene, *(word for one in techniques for word in ("--technique", one)), *SMALL, *arguments,
                     "--quiet", "--out", out)
        return records(self.dir / out)

    def render(self, out, *arguments, scene="panes.toml", technique="exact_rays"):
        self.succeed("render", "--scene", scene, "--technique", technique, *SMALL[-2:], *arguments, "--out", out)
        return json.loads((self.dir / out / "record.json").read_text())

    def regions(self, size=SMALL[-1]):
        """Which pixels show the floor behind the first pane alone, the second alone, both, and none; 0.1 m off the panes' edges."""
        self.succeed("export", "--scene", "gray.toml", "--light", "sun", "--size", size, "--out", "points")
        x, _, z = np.load(self.dir / "points/gbuffer_position.npy").astype(float)
        floor = np.load(self.dir / "points/gbuffer_mesh.npy").astype(np.int64) == 0
        off = [np.maximum(abs(x - middle), abs(z)) - 1 for middle in (-0.5, 0.5)]  # below 0 under the pane
        under, beside = [one < -0.1 for one in off], [one > 0.1 for one in off]
        found = (under[0] & beside[1], beside[0] & under[1], under[0] & under[1], beside[0] & beside[1])
        for region in found:
            self.assertGreater((region & floor).sum(), 50)
        return [region & floor for region in found]

    def test_a_row_is_a_light_of_three_channels(self):
        rows = {(row["technique"], row["light"]): row for row in self.run_rows("out")}
        self.assertEqual({light for _, light in rows}, {"sun", "lamp"})
        self.assertEqual(len(rows), 2 * len(TECHNIQUES))
        self.assertEqual({key for key, row in rows.items() if row["status"] == "ok"}, SOUND)
        self.assertEqual({row["status"] for row in rows.values()}, {"ok", "unsupported"})
        for key in SOUND:
            with self.subTest(key):
                row, light = rows[key], key[1]
                self.assertEqual((row["support"], row["reason"]), ("full", ""))
                self.assertEqual([one["name"] for one in row["lights"]], channels(light))
                self.assertEqual({one["support"] for one in row["lights"]}, {"full"})
                self.assertEqual(row["light_kind"], {"sun": "directional", "lamp": "rect"}[light])
                answer = {"sun": "transmitted", "lamp": "fraction"}[light]
                self.assertEqual((row["answer"], {one["answer"] for one in row["lights"]}), (answer, {answer}))
                self.assertGreater(row["classes"]["T"], 5000)
                self.check_means(row)
        for key in (("embree_rays", "sun"), ("exact_rays", "sun"), ("embree_rays", "lamp")):
            self.assertEqual([rows[key]["metrics"]["shape"][name] for name in ("error", "hue_error")], [0, 0], key)
        for key in (("transmittance_map", "sun"), ("area_rays", "lamp")):
            shape = rows[key]["metrics"]["shape"]
            self.assertGreater(shape["error"], 0, key)
            self.assertGreater(shape["hue_error"], 0, key)
            self.assertGreater(sum(rows[key]["causes"].values()), 0, key)
        table = self.succeed("table", "out", "--columns", "technique,error,hue_error")
        self.assertIn("light sun (directional)", table)
        self.assertNotIn("sun.red", table)
        self.succeed("report", "out")

    def check_means(self, row):
        """What the row says of itself is the mean of what its channels say."""
        shape = row["metrics"]["shape"]
        for name in ("error", "constant_error", "wrong_rate", "ssim", "flip"):
            of_channels = [light["metrics"][name] for light in row["lights"]]
            if None in of_channels:
                self.assertIsNone(shape[name], name)
            else:
                self.assertAlmostEqual(shape[name], sum(of_channels) / 3, places=9, msg=name)
        self.assertIsNotNone(shape["error"])
        self.assertGreater(shape["constant_error"], 0.01)

    def test_masks_are_the_products_on_paper(self):
        regions = self.regions()
        for technique in ("exact_rays", "embree_rays"):
            record, = self.render(technique, "--light", "sun", technique=technique)
            self.assertEqual((record["light"], [one["name"] for one in record["lights"]]), ("sun", channels("sun")))
            masks = read_exr(self.dir / technique / "mask.exr")
            self.assertEqual(sorted(masks), sorted(f"{name}.V" for name in channels("sun")))
            for k, name in enumerate(channels("sun")):
                for region, expected in zip(regions, (FIRST, SECOND, PRODUCT, np.ones(3))):
                    # Up to three numbers rounded to float32.
                    self.assertLessEqual(abs(masks[f"{name}.V"][region] - expected[k]).max(), 2e-7 * expected[k], name)

    def test_pictures_are_colored_behind_the_panes(self):
        first, second, both, none = self.regions()
        self.render("out", "--light", "sun")
        self.assertLessEqual({"mask.png", "shaded.png", "error.png", "mask.exr", "record.json"}, set(self.names(self.dir / "out")))
        shaded = read_png(self.dir / "out/shaded.png")[:, :, :3]
        red, green, blue = np.moveaxis(shaded, -1, 0).astype(int)
        self.assertTrue((red[first] > green[first] + 30).all() and (green[first] > blue[first]).all(), shaded[first][:3])
        self.assertTrue((green[second] > blue[second] + 30).all() and (blue[second] > red[second]).all(), shaded[second][:3])
        self.assertTrue((green[both] > red[both]).all() and (red[both] > blue[both]).all(), shaded[both][:3])
        self.assertTrue((red[none] == green[none]).all() and (green[none] == blue[none]).all(), shaded[none][:3])
        # Light that no glass takes anything from is as bright as in the gray scene.
        self.render("gray", "--light", "sun", scene="gray.toml")
        self.assertLessEqual(abs(read_png(self.dir / "gray/shaded.png").astype(int)[none] - shaded[none]).max(), 1)

    def test_one_channel_alone_is_a_row_of_one_light(self):
        whole, = self.run_rows("whole", "--light", "sun", techniques=TECHNIQUES[2:3])
        for color, of_row in zip(COLORS, whole["lights"]):
            row, = self.run_rows(color, "--light", f"sun.{color}", techniques=TECHNIQUES[2:3])
            self.assertEqual((row["light"], len(row["lights"]), row["answer"], row["support"]), (f"sun.{color}", 1, "transmitted", "full"))
            self.assertEqual({name: row["metrics"]["shape"][name] for name in of_row["metrics"]}, of_row["metrics"])
            self.assertEqual((row["causes"], row["classes"]), (of_row["causes"], of_row["classes"]))
            self.assertIsNone(row["metrics"]["shape"]["hue_error"])
            masks, of_whole = (read_exr(self.dir / out / one["mask"]) for out, one in ((color, row), ("whole", whole)))
            self.assertEqual([name for name in masks if name.endswith(".V")], [f"sun.{color}.V"])
            self.assertTrue((masks[f"sun.{color}.V"] == of_whole[f"sun.{color}.V"]).all())

    def test_several_colored_lights_are_one_row(self):
        techniques = ("embree_rays", TECHNIQUES[2])
        rows = {row["technique"]: row for row in self.run_rows("out", "--light", "lamp+sun", techniques=techniques)}
        for row in rows.values():
            self.assertEqual((row["light"], row["status"], row["answer"]), ("sun+lamp", "ok", "received"))
            self.assertEqual([one["name"] for one in row["lights"]], channels("sun", "lamp"))
            self.assertEqual(row["light_kind"], "directional+rect")
        self.assertEqual([rows["embree_rays"]["metrics"]["shape"][name] for name in ("error", "hue_error")], [0, 0])
        maps = rows["transmittance_map"]
        self.assertEqual(maps["support"], "approximate")
        self.assertIn("no shadows of lamp", maps["reason"])
        self.assertEqual([one["support"] for one in maps["lights"]], 3 * ["full"] + 3 * ["unsupported"])
        self.assertGreater(maps["metrics"]["shape"]["hue_error"], 0)

    def test_resume_shards_and_merge_keep_the_rows(self):
        whole = self.run_rows("out")
        self.assertEqual(self.run_rows("out", "--resume"), whole)
        # What is lost is run again, and the other rows stay.
        lines = (self.dir / "out/records.jsonl").read_text().splitlines(keepends=True)
        (self.dir / "out/records.jsonl").write_text("".join(lines[1:]))
        again = self.run_rows("out", "--resume")
        self.assertEqual(sorted(map(what, again)), sorted(map(what, whole)))
        self.assertEqual({what(row): measured(row) for row in again}, {what(row): measured(row) for row in whole})
        parts = [f"part{k}" for k in range(2)]
        counts = [len(self.run_rows(part, "--shard", f"{k}/2")) for k, part in enumerate(parts)]
        self.assertEqual(sum(counts), len(whole))
        self.succeed("merge", *parts, "--out", "merged")
        merged = records(self.dir / "merged")
        self.assertEqual([measured(row) for row in merged], [measured(row) for row in whole])
        self.assertEqual({row["mask"] for row in merged}, {row["mask"] for row in whole})

    def test_rescored_numbers_are_those_of_the_run(self):
        def numbers():
            keys = ("metrics", "causes", "cause_errors", "classes", "lights")
            return {what(row): [row[key] for key in keys] for row in records(self.dir / "out")}

        self.run_rows("out", "--light", "sun,lamp,sun+lamp,sun.green")
        before = numbers()
        rows = records(self.dir / "out")
        for row in rows:
            for metrics in row["metrics"].values():
                metrics |= {name: 0.123 for name in ("error", "hue_error", "flip")}
        (self.dir / "out/records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        done = self.gnomon("table", "out", "--rescore", "--save", "--format", "json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("keeps its", done.stderr)
        self.assertEqual(numbers(), before)

    def test_a_mask_scores_as_the_technique_that_made_it(self):
        made, = self.render("made", "--light", "sun", technique=TECHNIQUES[2])
        scored, = json.loads(self.succeed("score", "--scene", "panes.toml", "--light", "sun", "--mask", "made/mask.exr", "--json"))
        for name in ("error", "hue_error"):
            self.assertAlmostEqual(scored["metrics"][name], made["metrics"]["shape"][name], places=7)

    def test_an_export_has_whole_lights_and_loads_as_the_same_scene(self):
        self.succeed("export", "--scene", "panes.toml", "--light", "sun", *SMALL[-2:], "--out", "given")
        self.assertEqual([one["name"] for one in json.loads((self.dir / "given/scene.json").read_text())["lights"]], ["sun", "lamp"])
        light, = json.loads((self.dir / "given/frame.json").read_text())["lights"]
        self.assertEqual(light["name"], "sun")
        truth = np.load(self.dir / "given" / light["reference"]["visibility"]["file"])
        self.assertEqual(truth.shape, (3, 90, 160))
        file = read_exr(self.dir / "given/reference.exr")
        self.assertEqual(sorted(file), sorted(f"{name}.V" for name in channels("sun")))
        for k, name in enumerate(channels("sun")):
            self.assertTrue((file[f"{name}.V"] == truth[k]).all(), name)
        # glTF has no lights with area.
        described = json.loads(self.succeed("describe", "given/scene.gltf", "--json"))
        self.assertEqual([one["name"] for one in described["lights"]], ["sun"])
        record, = self.render("again", "--light", "sun", scene="given/scene.gltf")
        self.assertEqual([one["name"] for one in record["lights"]], channels("sun"))
        self.render("first", "--light", "sun")
        first, again = (read_exr(self.dir / out / "mask.exr") for out in ("first", "again"))
        regions = self.regions()
        for name in first:
            for region in regions:  # the camera's place and the shares of the pane are rounded once more
                self.assertLessEqual(abs(first[name][region] - again[name][region]).max(), 1e-6)

    def test_a_gray_scene_has_its_lights_and_files_as_ever(self):
        rows = self.run_rows("out", scene="gray.toml")
        for row in rows:
            self.assertEqual([one["name"] for one in row["lights"]], [row["light"]])
            self.assertIn(row["light"], ("sun", "lamp"))
            if row["status"] == "ok":
                self.assertIsNone(row["metrics"]["shape"]["hue_error"])
                values = [name for name in read_exr(self.dir / "out" / row["mask"]) if name.endswith(".V")]
                self.assertEqual(values, [row["light"] + ".V"])
        self.assertEqual({(row["technique"], row["light"]) for row in rows if row["status"] == "ok"}, SOUND)
        self.render("made", scene="gray.toml", technique="embree_rays")
        self.assertEqual(self.names(self.dir / "made"), ["error.png", "error_lamp.png", "mask.exr", "mask.png", "mask_lamp.png",
                                                         "record.json", "shaded.png", "shaded_lamp.png"])
        self.refuse("run", "--scene", "gray.toml", "--light", "sun.red", "--technique", "exact_rays", "--out", "none",
                    says=["no light sun.red", "sun, lamp"])

    def test_refusals_name_whole_lights(self):
        for light, says in (("moon", ["no light moon", "sun, lamp"]), ("sun+sun", ["named twice"]), ("sun.yellow", ["no light sun.yellow"]),
                            ("all+3", ["3 is outside 1 .. 2"])):
            with self.subTest(light):
                self.refuse("run", "--scene", "panes.toml", "--light", light, "--technique", "exact_rays", "--out", "none", says=says)
        self.assertFalse((self.dir / "none").exists())


if __name__ == "__main__":
    unittest.main()
