#!/usr/bin/python3 -IB
"""score: a mask from a file against the reference."""

import json
import struct
import sys
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import SMALL, ProgramTest, records  # noqa: E402

SIZE = SMALL[-2:]


def gray_png(file):
    """Width, height and the first channel of a PNG of eight bits and no interlacing."""
    data, at, packed = file.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", data[at + 8:at + 18])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    channels = {0: 1, 2: 3}[color]
    assert depth == 8
    raw, before, gray = zlib.decompress(packed), bytearray(width * channels), bytearray()
    for y in range(height):
        kind, row = raw[y * (width * channels + 1)], bytearray(raw[y * (width * channels + 1) + 1:(y + 1) * (width * channels + 1)])
        for x in range(len(row)):
            left, up = row[x - channels] if x >= channels else 0, before[x]
            corner = before[x - channels] if x >= channels else 0
            nearest = min((left, up, corner), key=lambda v, of=left + up - corner: abs(of - v))
            row[x] = (row[x] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
        gray += row[::channels]
        before = row
    return width, height, bytes(gray)


def write_gray_png(file, width, height, rows):
    """`rows`: each with its filter, 0, before it."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


SCENE = ("--scene", "sphere_over_plane")


class Score(ProgramTest):
    def render(self, technique):
        self.succeed("render", *SCENE, "--technique", technique, *SIZE, "--out", "made")
        return self.dir / "made/mask.exr", json.loads((self.dir / "made/record.json").read_text())

    def test_a_mask_scores_as_the_technique_that_made_it(self):
        mask, records = self.render("shadow_map:resolution=128")
        scores = json.loads(self.succeed("score", *SCENE, "--mask", mask, "--json"))
        self.assertEqual([s["light"] for s in scores], ["point", "sun"])
        for score, record in zip(scores, records):
            self.assertEqual((score["width"], score["height"], score["truth"]), (160, 90, "shape"))
            self.assertGreater(score["metrics"]["wrong_rate"], 0)
            for name, value in record["metrics"]["shape"].items():
                self.assertEqual(score["metrics"][name], None if "seam_" in name else value, name)  # a mask has no images
            self.assertEqual(score["classes"], record["classes"])
            self.assertEqual(sum(score["causes"].values()), sum(record["causes"].values()))

    def test_the_reference_is_never_wrong(self):
        mask, _ = self.render("embree_rays")
        text = self.succeed("score", *SCENE, "--mask", mask, "--light", "sun")
        self.assertIn("light sun, view view, 160 x 90, shape truth", text)
        self.assertRegex(text, r"(?m)^wrong_rate +0 +%")
        self.assertNotIn("cause.", text)
        self.assertNotIn("light point", text)

    def test_pictures_and_other_channels(self):
        # A gray picture of the point light's mask: its channels are R, G and B.
        mask, records = self.render("unshadowed")
        picture = self.dir / "made/mask.png"
        scores = json.loads(self.succeed("score", *SCENE, "--mask", picture, "--light", "point", "--channel", "G", "--json",
                                         "--out", "one"))
        self.assertEqual(scores[0]["metrics"]["wrong_rate"], records[0]["metrics"]["shape"]["wrong_rate"])
        self.assertEqual(self.names(self.dir / "one"), ["error.png", "shaded.png"])
        self.succeed("score", *SCENE, "--mask", mask, "--out", "both")
        self.assertEqual(self.names(self.dir / "both"), ["error_point.png", "error_sun.png", "shaded_point.png", "shaded_sun.png"])

    def test_a_picture_with_a_legend_is_no_mask(self):
        # Under a light with area the picture of the mask has a legend, and so have the pictures of errors: more rows than pixels.
        scene = ("--scene", "single_triangle", "--light", "lamp")
        self.succeed("render", *scene, "--technique", "center_ray", *SIZE, "--out", "soft")
        for name in ("mask.png", "error.png"):
            self.refuse("score", *scene, "--mask", self.dir / "soft" / name, "--channel", "R", says=(name, "legend", "mask.exr"))
        self.succeed("score", *scene, "--mask", self.dir / "soft/mask.exr")

    def test_what_cannot_be_scored_is_said(self):
        mask, _ = self.render("unshadowed")
        picture = self.dir / "made/mask.png"
        broken = self.dir / "broken.exr"
        broken.write_bytes(mask.read_bytes()[:100])
        for arguments, words in (
            (("--mask", self.dir / "none.exr"), ("none.exr", "cannot be read")),
            (("--mask", broken), ("broken.exr",)),
            (("--mask", mask, "--light", "moon"), ("no light moon", "point, sun")),
            (("--mask", mask, "--view", "below"), ("no view below",)),
            (("--mask", mask, "--light", "sun", "--channel", "Z"), ("no channel Z", "point.V", "sun.V")),
            (("--mask", picture), ("no channel LIGHT.V", "R, G, B", "--channel")),
            (("--mask", picture, "--light", "sun"), ("no channel sun.V", "R, G, B", "with --channel")),
            (("--mask", picture, "--channel", "R"), ("--channel R", "2 are asked for", "--light")),
        ):
            self.refuse("score", *SCENE, *arguments, says=words)


    def test_a_mask_that_is_changed_as_a_whole_is_said_to_be(self):
        # One pixel to the right; the rim repeats. A gray PNG is what other programs write.
        mask, _ = self.render("embree_rays")
        width, height, gray = gray_png(self.dir / "made/mask.png")
        moved = bytearray()
        for y in range(height):
            row = gray[y * width:(y + 1) * width]
            moved += bytes([0]) + row[:1] + row[:-1]
        shifted = self.dir / "shifted.png"
        write_gray_png(shifted, width, height, bytes(moved))
        score, = json.loads(self.succeed("score", *SCENE, "--mask", shifted, "--light", "point", "--json"))
        self.assertEqual((score["whole_mask"]["change"], score["whole_mask"]["pixels"]), ("shift", [1, 0]))
        self.assertGreater(score["whole_mask"]["explained"], 0.95)
        self.assertGreater(score["causes"]["mask_shift"], 0.95 * sum(score["causes"].values()))
        text = self.succeed("score", *SCENE, "--mask", shifted, "--light", "point")
        self.assertRegex(text, r"\nthe whole mask is shifted by 1 px right, which makes \d+ % of its error\n")
        score, = json.loads(self.succeed("score", *SCENE, "--mask", self.dir / "made/mask.png", "--channel", "R", "--light", "point", "--json"))
        self.assertNotIn("whole_mask", score)
        # It is told of the row, too.
        self.succeed("score", *SCENE, "--mask", shifted, "--light", "point", "--label", "Other", "--out", "rows")
        record, = records(self.dir / "rows")
        self.assertIn("Other: the whole mask is shifted by 1 px right", record["notes"][-1])
        self.assertGreater(record["causes"]["mask_shift"], 0)


class Rows(ProgramTest):
    """A mask of another program becomes a row of a run: --label."""

    FENCE = ("--scene", "fence")  # flat: one truth
    RUN = ("run", *FENCE, "--light", "point,sun", "--technique", "embree_rays", "--technique", "shadow_map:resolution=128", *SMALL, "--quiet",
           "--out", "out")

    def mask(self):
        """Of a technique that runs here, too, so that what a run says of it is known."""
        self.succeed("render", *self.FENCE, "--light", "point,sun", "--technique", "shadow_map:resolution=128", *SIZE, "--out", "made")
        return self.dir / "made/mask.exr"

    def score(self, mask, *words):
        return self.succeed("score", *self.FENCE, "--mask", mask, "--label", "Foreign map 3.7", "--out", "out", *words)

    def rows(self, **wanted):
        return [row for row in records(self.dir / "out") if all(row[key] == value for key, value in wanted.items())]

    def test_a_row_says_what_a_run_says_of_the_same_mask(self):
        mask = self.mask()
        self.succeed(*self.RUN)
        text = self.score(mask)
        self.assertIn("fence sun foreign_map_3_7", text)
        own, foreign = self.rows(technique="shadow_map"), self.rows(technique="foreign_map_3_7")
        self.assertEqual([row["light"] for row in foreign], ["point", "sun"])
        for a, b in zip(own, foreign):
            for key in ("scene", "light", "light_kind", "view", "width", "height", "truth", "suite", "status", "classes", "scene_facts"):
                self.assertEqual(a[key], b[key], key)
            for truth, metrics in a["metrics"].items():  # a mask has no images, whose seams could be seen
                for name, value in metrics.items():
                    self.assertEqual(b["metrics"][truth][name], None if "seam_" in name else value, name)
            self.assertEqual(sum(a["causes"].values()), sum(b["causes"].values()))
            self.assertEqual((b["label"], b["role"], b["support"]), ("Foreign map 3.7", "contender", None))
            self.assertEqual([b["stages"], b["counts"], b["bytes"]], [{s: [] for s in b["stages"]}, [], None])
            self.assertEqual(b["context"]["foreign"]["channel"], b["light"] + ".V")
            for picture in ("mask", "error_picture", "shaded_picture"):
                self.assertTrue((self.dir / "out" / b[picture]).is_file())
        self.assertEqual(sorted(row["place"] for row in records(self.dir / "out")), list(range(6)))

    def test_the_row_stands_wherever_the_others_do(self):
        mask = self.mask()
        self.succeed(*self.RUN)
        self.score(mask, "--ms", "resolve=12.5,build=3")
        before = self.rows(technique="foreign_map_3_7")
        table = self.succeed("table", "out", "--format", "md")
        self.assertIn("Foreign map 3.7", table)
        self.assertIn("times told, not measured: build, resolve", table)
        self.assertIn("Foreign map 3.7", (self.dir / "out/table.md").read_text())
        self.assertIn("Foreign map 3.7", self.succeed("analyze", "out", "front"))
        self.succeed("table", "out", "--rescore", "--save")
        self.assertEqual([row["metrics"] for row in self.rows(technique="foreign_map_3_7")], [row["metrics"] for row in before])
        self.assertEqual([row["causes"] for row in self.rows(technique="foreign_map_3_7")], [row["causes"] for row in before])
        self.succeed("report", "out")
        self.assertIn("Foreign map 3.7", (self.dir / "out/report.html").read_text())
        self.succeed("compare", "out", "out")
        self.succeed("merge", "out", "--out", "merged")
        self.assertEqual(len(records(self.dir / "merged")), 6)
        # A run goes on and keeps the row; another question becomes a row beside it.
        text = self.succeed(*self.RUN, "--technique", "unshadowed", "--resume")
        self.assertIn("2 ok", text)
        self.assertNotIn("are not in suite", text)
        self.assertEqual(len(self.rows(technique="foreign_map_3_7")), 2)
        self.assertEqual(len(records(self.dir / "out")), 8)

    def test_the_same_again_takes_its_place_and_another_label_does_not(self):
        mask = self.mask()
        self.score(mask)
        first = self.rows()
        self.assertEqual({row["suite"] for row in first}, {"score"})
        self.score(mask, "--light", "sun", "--ms", "resolve=1")
        self.assertEqual([row["job"] for row in self.rows()], [row["job"] for row in first])
        self.assertEqual([row["stages"].get("resolve") for row in self.rows()], [None, [[1]]])
        self.succeed("score", *self.FENCE, "--mask", mask, "--label", "Other", "--technique", "foreign_map_3_7", "--out", "out")
        self.assertEqual(len(self.rows()), 4)

    def test_a_scene_of_curved_shapes_has_both_truths(self):
        self.succeed("render", *SCENE, "--light", "sun", "--technique", "embree_rays", *SIZE, "--out", "made")
        self.succeed("score", *SCENE, "--mask", "made/mask.exr", "--technique", "rays", "--out", "out")
        row = self.rows()[0]
        self.assertEqual((row["label"], row["metrics"]["shape"]["wrong_rate"]), ("rays", 0))
        self.assertGreater(row["metrics"]["mesh"]["wrong_rate_all"], 0)  # the answer is of spheres
        self.succeed("table", "out", "--rescore", "--save")
        self.assertEqual(self.rows()[0]["metrics"], row["metrics"])

    def test_what_can_be_no_row_is_refused(self):
        mask = self.mask()
        self.succeed(*self.RUN[:-1], "run")
        for words, says in (
            (("--label", "", "--out", "out"), ("--label", "empty")),
            (("--label", "x"), ("--out",)),
            (("--label", "...", "--out", "out"), ("'...'", "--technique")),
            (("--label", "x", "--technique", "a b", "--out", "out"), ("'a b'", "no id")),
            (("--label", "Shadow map", "--out", "out"), ("shadow_map", "--technique")),
            (("--label", "x", "--ms", "resolve", "--out", "out"), ("--ms resolve", "setup, build, update, relight, resolve")),
            (("--label", "x", "--ms", "draw=1", "--out", "out"), ("--ms draw=1",)),
            (("--label", "x", "--ms", "build=-1", "--out", "out"), ("--ms build=-1",)),
            (("--label", "x", "--ms", "build=1,build=2", "--out", "out"), ("build twice",)),
            (("--ms", "build=1"), ("--label",)),
            (("--out", "run"), ("--out run", "--label")),
            (("--label", "x", "--truth", "mesh", "--out", "run"), ("truth shape, not mesh",)),
        ):
            self.refuse("score", *self.FENCE, "--mask", mask, *words, says=says)
        self.assertFalse((self.dir / "out").exists())
        self.assertEqual(len(records(self.dir / "run")), 4)


if __name__ == "__main__":
    unittest.main()
