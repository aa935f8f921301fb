#!/usr/bin/python3 -IB
"""Stills of scenes that move: every command takes a time, rows of stills are found again, and a second implementation poses glTF alike."""

import json
import re
import shutil
import sys
import unittest
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[k]) for k in (0, 1)]
from export_reader import read_exr  # noqa: E402
from moving_gltf import write_moving_gltf  # noqa: E402
from pose_again import MovingFile  # noqa: E402
from program import NUMBERS, SMALL, ProgramTest, measured, records, what  # noqa: E402

SIZE = SMALL[-2:]
BLOCK = "\n".join([*(f"v {x} {y} {z}" for y in (0.5, 1.5) for z in (0, 1) for x in (0, 1)),
                   "f 1 2 4 3", "f 5 7 8 6", "f 1 5 6 2", "f 3 4 8 7", "f 1 3 7 5", "f 2 6 8 4"]) + "\n"
STILL = """
[[mesh]]
file = "block.obj"
name = "block"
{}
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [12, 12]
[[light]]
name = "lamp"
kind = "point"
position = [-1, 5, 2]
[[view]]
name = "front"
eye = [2, 4, 9]
target = [1, 0, 0]
"""
# Along x by 4 m in 2 s, or up by 1 m in 1 s.
MOVING = STILL.format("") + """
[[path]]
name = "slide"
moves = "mesh"
mesh = "block"
times = [0, 2]
positions = [[0, 0, 0], [4, 0, 0]]
[[path]]
name = "lift"
moves = "mesh"
mesh = "block"
times = [0, 1]
positions = [[0, 0, 0], [0, 1, 0]]
"""
SUITE = """
width = 160
height = 90
processes = 1
repetitions = 1
warmups = 1
[[group]]
scenes = ["{scene}"]
time = {times}
techniques = ["unshadowed", "embree_rays"]
"""


def exported(folder):
    """The corners of the triangles of each mesh, n x 3 x 3."""
    scene = json.loads((folder / "scene.json").read_text())
    position, triangle = (np.load(folder / scene["arrays"][name]["file"]).astype(kind)
                          for name, kind in (("position", float), ("triangle", int)))
    return {mesh["name"]: position[triangle[mesh["first_triangle"]:mesh["first_triangle"] + mesh["triangles"]]] for mesh in scene["meshes"]}


class Time(ProgramTest):
    def write_scenes(self):
        self.write("block.obj", BLOCK)
        self.write("moving.toml", MOVING)
        self.write("apart.toml", STILL.format("translate = [1, 0, 0]"))

    def suite(self, times, scene="moving.toml", name="stills.toml"):
        return self.write(name, SUITE.format(scene=scene, times=times))

    def test_a_still_is_the_scene_that_stands_there(self):
        self.write_scenes()
        masks = {}
        for name, scene in (("rest", ["moving.toml"]), ("start", ["moving.toml", "--time", "0"]), ("apart", ["apart.toml"]),
                            ("posed", ["moving.toml", "--time", "0.5"]), ("named", ["moving.toml@slide=0.50"]),
                            ("lifted", ["moving.toml", "--animation", "lift", "--time", "0.5"])):
            self.succeed("render", "--scene", *scene, "--technique", "embree_rays", *SIZE, "--out", name)
            masks[name] = read_exr(self.dir / name / "mask.exr")["lamp.V"]
        for one, other, are_equal in (("rest", "start", True), ("posed", "apart", True), ("named", "apart", True),
                                      ("rest", "apart", False), ("lifted", "rest", False), ("lifted", "apart", False)):
            self.assertEqual(np.array_equal(masks[one], masks[other]), are_equal, (one, other))
        rows = {name: json.loads((self.dir / name / "record.json").read_text())[0] for name in masks}
        self.assertEqual({name: row["scene"] for name, row in rows.items()},
                         {"rest": "moving.toml", "start": "moving.toml@0", "apart": "apart.toml", "posed": "moving.toml@0.5",
                          "named": "moving.toml@slide=0.5", "lifted": "moving.toml@lift=0.5"})
        self.assertEqual({row["context"]["scene_file"] for row in rows.values()}, {"../moving.toml", "../apart.toml"})
        self.assertEqual(rows["posed"]["metrics"], rows["apart"]["metrics"])

    def test_export_score_certify_and_describe_take_a_time(self):
        self.write_scenes()
        still = ["--scene", "moving.toml", "--time", "1.5", "--animation", "slide"]
        told = self.succeed("export", *still, *SIZE, "--out", "made")
        self.assertIn("gnomon score --scene moving.toml@slide=1.5 --mask", told)
        self.assertEqual(json.loads((self.dir / "made/frame.json").read_text())["scene"], "moving.toml@slide=1.5")
        self.assertEqual(exported(self.dir / "made")["block"].min((0, 1)).tolist(), [3, 0.5, 0])
        scored = json.loads(self.succeed("score", *still, "--mask", "made/reference.exr", "--json"))[0]
        self.assertEqual((scored["scene"], scored["metrics"]["wrong_rate"]), ("moving.toml@slide=1.5", 0))
        self.succeed("score", "--scene", "moving.toml@slide=1.5", "--mask", "made/reference.exr", "--label", "Mine", "--out", "mine")
        self.assertEqual(records(self.dir / "mine")[0]["scene"], "moving.toml@slide=1.5")
        certificate = json.loads(self.succeed("certify", *still, "--size", "48x27", "--json"))[0]
        self.assertEqual(certificate["scene"], "moving@slide=1.5")
        described = json.loads(self.succeed("describe", "moving.toml@slide=1.5", "--json"))
        self.assertEqual(sorted(mesh["triangles"] for mesh in described["meshes"]), [2, 12])

    def test_rows_of_a_suite_are_stills_with_names_of_their_own(self):
        self.write_scenes()
        self.succeed("run", self.suite([0, 0.5, 2]), "--quiet", "--out", "out")
        rows = records(self.dir / "out")
        self.assertEqual([row["scene"] for row in rows], [f"moving.toml@{time}" for time in ("0", "0.5", "2") for _ in range(2)])
        self.assertEqual({row["status"] for row in rows}, {"ok"})
        self.assertEqual({row["context"]["scene_file"] for row in rows}, {"../moving.toml"})
        self.assertEqual(len({row["context"]["scene_hash"] for row in rows}), 3)
        wrong = [row["metrics"]["shape"]["wrong_rate"] for row in rows if row["technique"] == "unshadowed"]
        self.assertEqual(len(set(wrong)), 3, wrong)
        names = {file.name for file in (self.dir / "out/masks").iterdir()}
        self.assertEqual(len(names), 6)
        for name in names:
            self.assertRegex(name, r"^moving-(0|0\.5|2)-lamp-[a-z_]+-[0-9a-f]{8}\.exr$")
        text = self.succeed("table", "out", "--format", "md")
        for time in ("0", "0.5", "2"):
            self.assertIn(f"| moving.toml@{time} | lamp |", text)
        self.assertIn(r"moving.toml@0.5", (self.dir / "out/table.tex").read_text())
        kept = [measured(row) for row in rows]
        self.succeed("table", "out", "--rescore")
        self.assertEqual([row["metrics"] for row in records(self.dir / "out")], [row["metrics"] for row in kept])
        listed = self.succeed("run", self.suite([0, 0.5, 2]), "--dry-run", "--animation", "lift", "--time", "0.25,1", "--filter", "unshadowed")
        self.assertEqual(re.findall(r"(?m)^[0-9a-f]{16}  (\S+)", listed), ["moving.toml@lift=0.25", "moving.toml@lift=1"])

    def test_stills_are_resumed_from_elsewhere_with_more_times(self):
        self.write_scenes()
        self.succeed("run", self.suite([0, 1]), *NUMBERS, "--quiet", "--out", "out")
        before = records(self.dir / "out")
        (self.dir / "elsewhere").mkdir()
        shutil.move(self.dir / "out", self.dir / "elsewhere/out")
        scene = str(self.dir / "moving.toml")
        # The folder has moved, so that the path to the scene is another: as after a move of both, the records are told.
        for row in before:
            row["context"]["scene_file"] = "../../moving.toml"
        (self.dir / "elsewhere/out/records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in before))
        grown = self.suite([0, 1, 1.5], scene=scene)
        left = self.succeed("run", grown, *NUMBERS, "--dry-run", "--resume", "--out", "elsewhere/out")
        self.assertEqual(re.findall(r"(?m)^[0-9a-f]{16}  (\S+) lamp", left), ["moving.toml@1.5"] * 2)
        self.succeed("run", grown, *NUMBERS, "--quiet", "--resume", "--out", "elsewhere/out")
        after = records(self.dir / "elsewhere/out")
        self.assertEqual([what(row) for row in after[:4]], [what(row) for row in before])
        self.assertEqual([row["scene"] for row in after[4:]], ["moving.toml@1.5"] * 2)
        self.write("moving.toml", MOVING.replace("[4, 0, 0]", "[5, 0, 0]"))
        self.refuse("run", grown, *NUMBERS, "--quiet", "--resume", "--out", "elsewhere/out", says=["gnomon: moving.toml@1 has changed since"])

    def test_shards_of_stills_join_and_two_runs_of_them_compare(self):
        self.write_scenes()
        stills = ["run", self.suite([0, 0.5, 2]), *NUMBERS, "--quiet"]
        self.succeed(*stills, "--out", "whole")
        for k in range(2):
            self.succeed(*stills, "--shard", f"{k}/2", "--out", f"part{k}")
        self.succeed("merge", "part0", "part1", "--out", "joined")
        self.assertEqual([measured(row) for row in records(self.dir / "joined")], [measured(row) for row in records(self.dir / "whole")])
        compared = json.loads(self.succeed("compare", "whole", "joined", "--all", "--threshold", "1000", "--format", "json"))
        self.assertEqual(compared["counts"]["matched"], 6)

    def test_what_is_no_time_of_a_scene_is_refused(self):
        self.write_scenes()
        render = ["render", "--technique", "unshadowed", "--out", "out", "--scene"]
        for words, says in ((["moving.toml@"], ["'' behind the @ is neither SECONDS nor ANIMATION=SECONDS"]),
                            (["moving.toml@-1"], ["'-1' behind the @"]),
                            (["moving.toml@walk=1"], ["moving", "walk", "slide", "lift"]),
                            (["apart.toml@1"], ["scene apart has no animation"]),
                            (["contact", "--time", "1"], ["scene contact has no animation"]),
                            (["moving.toml@1", "--time", "2"], ["moving.toml@1 has a time already"]),
                            (["moving.toml", "--time=-1"], ["--time", "0 or more"]),
                            (["moving.toml", "--time", "nan"], ["--time"]),
                            (["moving.toml", "--animation", "slide"], ["--animation", "--time"]),
                            (["moving.toml", "--time", "1", "--animation", "Slide"], ["'Slide' is not a name"])):
            self.refuse(*render, *words, says=says)
        self.assertFalse((self.dir / "out").exists())
        self.refuse("run", self.suite([0, -2]), "--out", "out", says=["group.time = -2 is not seconds, 0 or more", "stills.toml:9"])
        self.refuse("run", self.suite([1], scene="apart.toml"), "--out", "out", says=["scene apart has no animation"])
        self.refuse("run", self.suite([1], scene="moving.toml@2"), "--out", "out", says=["moving.toml@2 has a time already"])

    def test_a_second_implementation_poses_gltf_alike(self):
        """Positions, rounded to float32 once, within 1e-6 of the largest coordinate; at keys, between, before and behind them."""
        random = np.random.default_rng(45)
        for seed in range(5):
            file = self.dir / f"moving{seed}.gltf"
            write_moving_gltf(file, seed)
            again = MovingFile(file)
            keys = np.concatenate([again.numbers(sampler["input"])[:, 0] for sampler in again.json["animations"][0]["samplers"]])
            for name, time in ((None, 0), ("walk", float(random.uniform(0, keys.max()))), ("walk", float(random.choice(keys))),
                               ("fly", float(random.uniform(0, 1.2 * keys.max())))):
                scene = str(file) if name is None else f"{file}@{name}={time!r}"
                out = self.dir / f"{seed}_{name}_{time}"
                self.succeed("export", "--scene", scene, "--light", "sun", "--size", "16x9", "--out", out)
                here, there = exported(out), again.meshes(name, time)
                self.assertEqual(set(here), set(there))
                extent = max(np.abs(corners).max() for corners in there.values())
                for mesh, corners in there.items():
                    self.assertEqual(here[mesh].shape, corners.shape, (scene, mesh))
                    self.assertLessEqual(np.abs(here[mesh] - corners).max(), 1e-6 * extent, (scene, mesh))


if __name__ == "__main__":
    unittest.main()
