#!/usr/bin/python3 -IB
"""Rows that follow an animation: what they hold, that stills beside them do not change, and what is refused."""

import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, HUNG, NUMBERS, ProgramTest, measured, records  # noqa: E402

SCENE = "walking_boxes:count=4"
SMALL = ["--processes", "1", "--repetitions", "2", "--warmups", "1", "--size", "96x54", "--light", "point", "--quiet"]
WALK = ["--animation", "walk", "--frames", "5", "--frame-rate", "10"]
TECHNIQUES = ["embree_rays", "shadow_map", "stencil_volume", "unshadowed"]
SUITE = """
width = 96
height = 54
processes = 1
repetitions = 1
warmups = 1
"""
GROUP = """
[[group]]
scenes = ["{scene}"]
lights = ["point"]
techniques = ["embree_rays", "shadow_map:resolution=128"]
{keys}
"""


def asked(*techniques):
    return ["run", "--scene", SCENE, *(word for name in techniques for word in ("--technique", name)), *SMALL]


class Animation(ProgramTest):
    def suite(self, *groups, scene=SCENE):
        return self.write("rows.toml", SUITE + "".join(GROUP.format(scene=scene, keys=keys) for keys in groups))

    def test_a_row_has_every_frame_and_the_times_of_those_that_move(self):
        self.succeed(*asked(*TECHNIQUES), *WALK, "--pictures", "none", "--out", "out")
        rows = {row["technique"]: row for row in records(self.dir / "out")}
        self.assertEqual(sorted(rows), TECHNIQUES)
        for name, row in rows.items():
            with self.subTest(name):
                self.assertEqual((row["status"], row["path"], row["start"], row["frame_rate"]), ("ok", "walk", 0, 10))
                for stage in ("build", "relight", "resolve", "update"):
                    self.assertEqual([len(p) for p in row["stages"][stage]], [2], stage)
                self.assertEqual({stage: [len(p) for p in times] for stage, times in row["moving_stages"].items()},
                                 {"relight": [2], "resolve": [2]})
                self.assertGreaterEqual(row["iterations"]["update"], 1)
                rates = row["frames"]["wrong_rate"]
                self.assertEqual({len(values) for values in row["frames"].values()}, {5})
                self.assertAlmostEqual(sum(rates) / 5, row["metrics"]["shape"]["wrong_rate"], places=12)
        self.assertEqual(set(rows["embree_rays"]["frames"]["wrong_rate"]), {0})
        self.assertEqual(set(rows["embree_rays"]["frames"]["instability"][1:]), {0})
        # Each frame is the still at that time, and its reference is that of the still.
        self.succeed(*asked("unshadowed"), "--time", "0,0.1,0.2,0.3,0.4", "--animation", "walk", "--pictures", "none", "--out", "stills")
        stills = [row["metrics"]["shape"]["wrong_rate"] for row in records(self.dir / "stills")]
        self.assertEqual(rows["unshadowed"]["frames"]["wrong_rate"], stills)
        self.assertGreater(len(set(stills)), 3, stills)
        self.assertIn("walk", self.succeed("table", "out", "--format", "md"))

    def test_stills_beside_a_row_that_moves_are_those_without_it(self):
        lone, both = self.suite(""), self.dir / "both.toml"
        both.write_text(SUITE + GROUP.format(scene=SCENE, keys='animations = ["walk"]\nframes = 3\nframe_rate = 5')
                        + GROUP.format(scene=SCENE, keys=""))
        self.succeed("run", lone, "--quiet", "--out", "lone")
        self.succeed("run", both, "--quiet", "--out", "both")
        before = {row["job"]: row for row in records(self.dir / "lone")}
        after = {row["job"]: row for row in records(self.dir / "both")}
        self.assertEqual((len(before), len(after)), (2, 4))
        for job, row in before.items():
            self.assertEqual(dict(measured(row), place=0, suite=""), dict(measured(after[job]), place=0, suite=""))
            for picture in ("mask", "error_picture", "shaded_picture"):
                self.assertEqual((self.dir / "lone" / row[picture]).read_bytes(), (self.dir / "both" / after[job][picture]).read_bytes(), picture)
            for key in ("start", "frame_rate", "moving_stages"):
                self.assertNotIn(key, row)
            self.assertEqual(set(row["stages"]), {"setup", "build", "relight", "resolve"})
        moving = [row for row in after.values() if row["path"]]
        self.assertEqual(len({row["context"]["scene_hash"] for row in moving}), 1)
        self.assertNotIn(moving[0]["context"]["scene_hash"], {row["context"]["scene_hash"] for row in before.values()})
        for row in moving:
            self.assertTrue((self.dir / "both" / row["shaded_picture"]).exists())
        told = self.succeed("table", "both", "--rescore")
        self.assertEqual([measured(row)["metrics"] for row in records(self.dir / "both")], [row["metrics"] for row in after.values()], told)

    def test_rows_of_one_animation_with_other_frames_are_other_jobs(self):
        suite = self.suite('animations = "walk"\nframes = 3\nframe_rate = 10', 'animations = "*"\nframes = 3\nframe_rate = 5\nstart = 0.1')
        self.succeed("run", suite, "--pictures", "none", "--quiet", "--out", "out")
        rows = [row for row in records(self.dir / "out") if row["technique"] == "shadow_map"]
        self.assertEqual([(row["start"], row["frame_rate"]) for row in rows], [(0, 10), (0.1, 5)])
        self.assertEqual(len({row["job"] for row in rows}), 2)
        self.assertEqual(len({tuple(row["frames"]["wrong_rate"]) for row in rows}), 2)
        # Two processes find the rows of both.
        for k in range(2):
            self.succeed("run", suite, "--pictures", "none", "--quiet", "--shard", f"{k}/2", "--out", f"part{k}")
        self.succeed("merge", "part0", "part1", "--out", "joined")
        self.assertEqual([measured(row) for row in records(self.dir / "joined")], [measured(row) for row in records(self.dir / "out")])

    def test_a_resumed_run_has_the_same_rows(self):
        rows = [*asked("embree_rays", "shadow_map"), *WALK, "--pictures", "none"]
        self.succeed(*rows, "--out", "whole")
        self.succeed(*rows, "--filter", "embree_rays", "--out", "out")
        left = self.succeed(*rows, "--dry-run", "--resume", "--out", "out")
        self.assertEqual(re.findall(r"(?m)^[0-9a-f]{16}  \S+ point walk (\S+)", left), ["shadow_map"])
        self.succeed(*rows, "--resume", "--out", "out")
        self.assertEqual([measured(row) for row in records(self.dir / "out")], [measured(row) for row in records(self.dir / "whole")])
        # Other frames are other rows: none of the folder's is in that suite.
        other = [word if word != "5" else "4" for word in rows]
        self.refuse(*other, "--resume", "--out", "out", says=["none of its 2 rows is in suite adhoc"])

    def test_a_row_that_fails_on_its_way_costs_no_other(self):
        """Three frames, a warm-up and a sample call build five times before the walk does, by the default of update."""
        call = ["--plugin", FAULTS, "run", "--scene", SCENE, "--technique", "busy", "--technique", "unshadowed", "--light", "point",
                *NUMBERS, "--quiet", "--animation", "walk", "--frames", "3", "--timeout", HUNG]
        for variable, reason in (("GNOMON_TEST_THROWS_AT", "^threw in update: one too many"),
                                 ("GNOMON_TEST_HANGS_AT", f"^hung in update: no answer within {HUNG} s")):
            self.environment = dict(self.environment, GNOMON_TEST_BUSY_MS="5", **{variable: "8"})
            self.succeed(*call, "--out", variable, status=1)
            del self.environment[variable]
            rows = {row["technique"]: row for row in records(self.dir / variable)}
            self.assertEqual({name: row["status"] for name, row in rows.items()}, {"busy": "failed", "unshadowed": "ok"})
            self.assertRegex(rows["busy"]["reason"], reason)
            self.assertEqual((rows["busy"]["frames"], rows["busy"]["metrics"], rows["busy"].get("moving_stages", {})), ({}, {}, {}))
            self.assertEqual([len(p) for p in rows["unshadowed"]["stages"]["update"]], [1])
        self.assert_gone()

    def test_paths_of_the_command_line_are_followed(self):
        text = self.succeed(*asked("unshadowed"), "--path", "camera_slide,light_slide", "--animation", "*", "--frames", "2", "--dry-run")
        self.assertEqual(re.findall(r"(?m)^[0-9a-f]{16}  \S+ point (\S+) unshadowed", text), ["camera_slide", "light_slide", "walk"])

    def test_what_cannot_be_followed_is_refused_before_anything_runs(self):
        run = [*asked("unshadowed"), "--out", "out"]
        for words, says in ((["--animation", "wlak"], [f"scene {SCENE} has no animation wlak; did you mean walk?"]),
                            (["--animation", "light_slide"], ["light_slide is a path of scene", "name it in paths"]),
                            (["--path", "camera_slid"], ["no path camera_slid; did you mean camera_slide?"]),
                            (["--frames", "5"], ["--frames 5 is for rows that follow an animation", "--animation"]),
                            (["--start", "1"], ["--start 1 is for rows that follow an animation"]),
                            (["--time", "0", "--frames", "5"], ["--frames 5", "--time 0 is of stills"]),
                            (["--time", "0", "--animation", "walk,fly"], ["--time 0 is of stills of one animation"]),
                            (["--animation", "walk", "--frames", "1"], ["--frames"]),
                            (["--animation", "walk", "--frames", "10001"], ["--frames"]),
                            (["--animation", "walk", "--frame-rate", "0"], ["--frame-rate"]),
                            (["--animation", "walk", "--frame-rate", "nan"], ["--frame-rate"]),
                            (["--animation", "walk", "--start=-1"], ["--start"]),
                            (["--animation", "walk", "--start", "inf"], ["--start"])):
            self.refuse(*run, *words, says=says)
        self.refuse("run", "--scene", "contact", "--technique", "unshadowed", "--animation", "*", "--out", "out",
                    says=["scene contact has no animation"])
        self.refuse("run", "--scene", SCENE + "@1", "--technique", "unshadowed", "--animation", "walk", "--out", "out",
                    says=["has no animation: it is a still"])
        for keys, says in (("frames = 5", "group.frames is for rows that follow an animation"),
                           ('animation = "walk"', "group.animation = walk is of stills and needs group.time"),
                           ('animations = "walk"\ntime = 1', "group.time is of stills"),
                           ('animations = "walk"\nframes = 1', "group.frames = 1 is not within 2 .. 10000"),
                           ('animations = "walk"\nframe_rate = 0', "group.frame_rate = 0 is not frames per second, above 0"),
                           ('animations = "walk"\nstart = nan', "group.start = nan")):
            self.refuse("run", self.suite(keys), "--out", "out", says=[says, "rows.toml:"])
        self.assertFalse((self.dir / "out").exists())

    def test_a_start_behind_the_last_key_is_noted(self):
        self.succeed(*asked("unshadowed"), "--animation", "walk", "--frames", "2", "--start", "3", "--pictures", "none", "--out", "out")
        (row,) = records(self.dir / "out")
        self.assertIn("the row starts at 3 s, and the last key of walk is at 2 s: nothing moves", row["notes"])
        self.assertEqual(len(set(row["frames"]["wrong_rate"])), 1)


if __name__ == "__main__":
    unittest.main()
