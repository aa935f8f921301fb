#!/usr/bin/python3 -IB
"""export --sequence: the frames of a row as picture files, and what is refused."""

import json
import sys
import unittest
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[k]) for k in (0, 1)]
from export_reader import T, read_exr  # noqa: E402
from program import FAULTS, ProgramTest, records  # noqa: E402

SIZE = ["--size", "96x54"]
KINDS = {"gbuffer": "exr", "mask": "exr", "reference": "exr", "error": "exr", "shaded": "png", "shaded_reference": "png"}
SCENE = """scene = "fence"
view = [{ name = "front", eye = [2.6, 2.1, 5.0], target = [0.2, 0.2, 0.6], fov_y_degrees = 40 }]
path = [{ name = "way", moves = "camera", positions = [[2.6, 2.1, 5.0], [3.2, 2.1, 5.0]], frames = 4 },
        { name = "dusk", moves = "light", positions = [[-1.5, 2.5, -3.5], [-1.0, 2.5, -3.5]], frames = 4 }]
"""
WALK = ["--scene", "walking_boxes:count=4", "--animation", "walk", "--frames", "4", "--frame-rate", "10", "--start", "0.5"]
MAP = "shadow_map:resolution=64"
ONCE = ["--processes", "1", "--repetitions", "1", "--warmups", "1", "--pictures", "none", "--quiet"]


class ExportSequence(ProgramTest):
    def row(self, motion):
        """Options of the row on `way`, `dusk` or `walk`."""
        if motion == "walk":
            return [*WALK, "--light", "point", *SIZE]
        self.write("fence.toml", SCENE)
        return ["--scene", "fence.toml", "--path", motion, "--light", "point", *SIZE]

    def sequence(self, *arguments, out="out"):
        """What is printed, and sequence.json."""
        text = self.succeed("export", "--sequence", *arguments, "--out", out)
        return text, json.loads((self.dir / out / "sequence.json").read_text())

    def test_frames_are_those_of_the_row_and_errors_are_mask_less_reference(self):
        for motion, moves, rate, start in (("way", "camera", 60, 0), ("dusk", "light", 60, 0), ("walk", "geometry", 10, 0.5)):
            with self.subTest(motion):
                row, out = [*self.row(motion), "--technique", MAP], self.dir / motion
                _, told = self.sequence(*row, out=motion)
                self.assertEqual(self.names(out), sorted(["sequence.json", *(f"{kind}_{n:04}.{ending}" for kind, ending in KINDS.items()
                                                                               for n in range(4))]))
                self.assertEqual([told[key] for key in ("path", "moves", "frame_rate", "start", "frame_count", "width", "height")],
                                 [motion, moves, rate, start, 4, 96, 54])
                self.assertEqual((told["technique"], told["settings"], told["light"]), ("shadow_map", "resolution=64", "point"))
                self.assertEqual(told["classes"]["T"], T)
                self.succeed("run", *row, *ONCE, "--out", f"run_{motion}")
                (record,) = records(self.dir / f"run_{motion}")
                errors = []
                for n, frame in enumerate(told["frames"]):
                    self.assertEqual((frame["frame"], frame["files"]["mask"]), (n, f"mask_{n:04}.exr"))
                    self.assertAlmostEqual(frame["seconds"], start + n / rate)
                    mask, reference, error = (read_exr(out / frame["files"][kind]) for kind in ("mask", "reference", "error"))
                    self.assertEqual((set(mask), set(reference), set(error)), ({"point.V"}, {"point.V", "point.class"}, {"point.V"}))
                    tested = reference["point.class"] == T
                    ours, theirs = (of["point.V"].astype(np.float32) for of in (mask, reference))
                    np.testing.assert_array_equal(error["point.V"], np.where(tested, ours - theirs, 0))
                    self.assertAlmostEqual(np.abs(error["point.V"][tested]).mean(), frame["error"], places=6)
                    self.assertIn("position.X", read_exr(out / frame["files"]["gbuffer"]))
                    errors.append(frame["error"])
                self.assertEqual(errors, record["frames"]["error"])
                self.assertGreater(len(set(errors)), 1)

    def test_what_moves_is_in_each_frame(self):
        for motion, moves in (("way", "view"), ("dusk", "lights")):
            _, told = self.sequence(*self.row(motion), "--technique", "unshadowed", out=motion)
            for what in ("view", "lights"):
                self.assertEqual(len({json.dumps(frame[what]) for frame in told["frames"]}), 4 if what == moves else 1, (motion, what))
        first, *_, last = told["frames"]
        self.assertEqual((first["lights"][0]["position"], last["lights"][0]["position"]), ([-1.5, 2.5, -3.5], [-1, 2.5, -3.5]))

    def test_a_right_mask_has_the_pictures_of_the_reference(self):
        _, told = self.sequence(*self.row("way"), "--technique", "embree_rays")
        for frame in told["frames"]:
            self.assertEqual(frame["error"], 0)
            ours, theirs = ((self.dir / "out" / frame["files"][kind]).read_bytes() for kind in ("shaded", "shaded_reference"))
            self.assertEqual(ours, theirs)
        self.assertGreater(told["exposure"], 0)

    def test_the_command_line_of_another_metric_is_printed(self):
        text, told = self.sequence(*self.row("walk"), "--technique", MAP, out="it's")
        line = "cvvdp --test 'it'\\''s/shaded_%04d.png' --ref 'it'\\''s/shaded_reference_%04d.png' --fps 10 --display standard_4k"
        self.assertEqual(told["color_video_vdp"], line)
        self.assertIn(f"{line}\n", text)
        self.assertIn("version", text)
        self.assertEqual(told["files"], {kind: f"{kind}_%04d.{ending}" for kind, ending in KINDS.items()})

    def test_lights_together_are_one_row_and_the_first_light_is_the_default(self):
        self.write("fence.toml", SCENE)
        row = ["--scene", "fence.toml", "--path", "way", *SIZE, "--technique", MAP]
        _, told = self.sequence(*row, "--light", "*hard+", out="all")
        lights = [light["name"] for light in told["frames"][0]["lights"]]
        self.assertGreater(len(lights), 1)
        self.assertEqual(set(read_exr(self.dir / "all/mask_0003.exr")), {f"{name}.V" for name in lights})
        _, told = self.sequence(*row, out="first")
        self.assertEqual([light["name"] for light in told["frames"][0]["lights"]], lights[:1])

    def test_what_is_no_sequence_is_refused_before_anything_is_written(self):
        row = self.row("way")
        still = ["--scene", "fence.toml", "--light", "point", *SIZE]
        full = self.dir / "full"
        full.mkdir()
        (full / "mask_0000.exr").write_text("mine")
        for words, says in (([*still, "--technique", MAP], ["--sequence needs a motion", "--path", "--animation", "camera_slide"]),
                            (row, ["--sequence needs --technique"]),
                            ([*row, "--technique", MAP, "--animation", "walk"], ["--path way and --animation walk are two motions"]),
                            ([*row, "--technique", "shadow_map:resolution={64,128}"], ["is a sweep of 2"]),
                            ([*row, "--technique", "shadow_mop"], ["shadow_mop", "shadow_map"]),
                            ([*row, "--technique", MAP, "--view", "frant"], ["frant", "front"]),
                            ([*row, "--technique", MAP, "--light", "sun"], ["is of one row, and the options name 2", "point", "sun"]),
                            ([*row, "--technique", MAP, "--frames", "3"], ["--frames 3 is for rows that follow an animation"]),
                            ([*still, "--technique", MAP, "--path", "wey"], ["has no path wey"]),
                            ([*still, "--technique", MAP, "--animation", "walk"], ["has no animation"]),
                            ([*WALK, "--light", "lomp", "--technique", MAP], ["no light lomp"])):
            self.refuse("export", "--sequence", *words, "--out", "out", says=says)
            self.assertFalse((self.dir / "out").exists())
        self.refuse("export", "--sequence", *row, "--technique", MAP, "--out", "full", says=["full has files already"])
        self.assertEqual((full / "mask_0000.exr").read_text(), "mine")

    def test_a_technique_that_does_not_support_the_row_leaves_nothing(self):
        self.refuse("export", "--sequence", "--scene", "single_triangle", "--path", "camera_slide", "--light", "lamp", *SIZE,
                    "--technique", MAP, "--out", "out", says=["shadow_map", "does not support", "lamp at frame 0", "area"])
        self.assertEqual(self.names(self.dir), [])

    def test_a_worker_that_ends_is_named_by_its_technique_and_frame(self):
        done = self.gnomon("--plugin", FAULTS, "export", "--sequence", *self.row("way"), "--technique", "crashes", "--out", "out")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"(?m)^gnomon: crashes: crashed in \w+: Segmentation fault \(signal 11\) \(at frame 0\)$")
        self.assertFalse((self.dir / "out").exists())

    def test_options_of_a_sequence_need_it(self):
        for words in (["--technique", MAP], ["--path", "camera_slide"], ["--frames", "3"], ["--timeout", "9"]):
            self.refuse("export", "--scene", "fence", *words, "--out", "out", says=[words[0], "--sequence"])
        self.refuse("export", "--scene", "walking_boxes:count=4", "--animation", "walk", "--out", "out",
                    says=["--animation walk needs --time", "--sequence"])


if __name__ == "__main__":
    unittest.main()
