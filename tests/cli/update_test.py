#!/usr/bin/python3 -IB
"""Techniques from outside where geometry moves: programs, classes in Python and plugins, with an update of their own and without."""

import json
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, NUMBERS, PROGRAM_SHEET, SMALL, ProgramTest, records  # noqa: E402

SECOND = Path(FAULTS).with_name("gnomon_second.so")
FRAMES = 4
# Two boxes walk, each by half a meter from frame to frame; ground and columns, the meshes 0 and 1, stand still.
WALK = ["--scene", "walking_boxes:count=2", "--light", "sun", "--animation", "walk", "--frames", FRAMES, "--frame-rate", "4"]
STAGES = 'stages = ["setup", "build", "update", "relight", "resolve"]\n'

# A program of nothing but the protocol: lit everywhere. It keeps what it is told, and how its files lay in that moment.
TOLD = """
import json, os, struct, sys
HELLO = {}
for line in sys.stdin:
    r = json.loads(line)
    answer = {"protocol": 1, **HELLO} if r["do"] == "hello" else {}
    if "scene" in r:
        scene = json.load(open(r["scene"]["file"]))
        r["arrays"] = {}
        for name, array in scene["arrays"].items():
            data = open(array["file"], "rb").read()[array["offset"]:]
            r["arrays"][name] = [os.stat(array["file"]).st_ino, os.stat(array["file"]).st_mtime_ns, array["shape"]]
            if name == "position":
                r["position"] = list(struct.unpack("<%df" % (len(data) // 4), data))
        r["meshes"] = scene["meshes"]
    if r["do"] == "resolve":
        height, width = r["mask"]["shape"]
        with open(r["mask"]["file"], "r+b") as file:
            file.write(struct.pack("<f", 1.0) * (width * height))
    with open("told." + str(os.getpid()), "a") as file:
        file.write(json.dumps({key: r[key] for key in ("do", "changes", "arrays", "position", "meshes") if key in r}) + "\\n")
    print(json.dumps(answer), flush=True)
"""

# Shadow rays in numpy, made of the page's example: `build` computes every triangle, UPDATE what may come beside it.
RAYS = """
import numpy as np
from gnomon_technique import Technique, serve

class Rays(Technique):
    def build(self, scene):
        self.take(scene)
        self.worlds = [self.worlds_of(scene, m) for m in range(len(scene.meshes))]
    def take(self, scene):
        self.scene, self.offset = scene, 1e-6 * np.abs(scene.corners()).max(initial=0)
    def worlds_of(self, scene, m):
        mesh = scene.meshes[m]
        if not mesh.casts:
            return []
        corners = scene.position[scene.triangle[mesh.first_triangle : mesh.first_triangle + mesh.triangles]].astype(float)
        sides = [(a, b - a, c - a) for a, b, c in corners]
        return [(a, np.linalg.inv(np.column_stack((u, v, np.cross(u, v))))) for a, u, v in sides if np.cross(u, v).any()]
UPDATE
    def relight(self, light):
        self.light = light
    def resolve(self, gbuffer, mask):
        seen = gbuffer.faces(self.light, self.scene)
        point, way = gbuffer.position[seen].T.astype(float), gbuffer.to_light(self.light)[seen].T
        least = self.offset / np.sum(gbuffer.normal[seen].T * way, axis=0)
        most = np.inf if self.light.kind == "directional" else 1
        lit = np.ones(point.shape[1], bool)
        for corner, world in sum(self.worlds, []):
            x, y, z = world @ (point - corner[:, None])
            dx, dy, dz = world @ way
            t = -z / np.where(dz == 0, np.nan, dz)
            x, y = x + t * dx, y + t * dy
            lit &= ~((t > least) & (t < most) & (x >= 0) & (y >= 0) & (x + y <= 1))
        mask[...] = 1
        mask[seen] = lit

serve(Rays)
"""
# What may come beside it, by technique.
UPDATES = {
    "builds": "",
    "updates": """
    def update(self, scene, changes):
        self.take(scene)
        for change in changes:
            self.worlds[change.mesh] = self.worlds_of(scene, change.mesh)
            points = scene.position[change.vertices].astype(float)
            assert change.kind in ("rigid", "deformed") and (change.matrix is None) == (change.kind == "deformed")
            assert np.all(points >= change.after[0]) and np.all(points <= change.after[1])
""",
    "keeps_all": """
    def update(self, scene, changes):
        pass
""",
}


class Update(ProgramTest):
    def told(self, name, sheet="", hello="{}"):
        """The option of a program that keeps what it is told."""
        self.write(f"{name}.py", TOLD.replace("HELLO = {}", f"HELLO = {hello}"))
        return ["--program", self.write(f"{name}.toml", PROGRAM_SHEET.format(id=name) + sheet)]

    def heard(self):
        """What each process was told, in its order."""
        return [[json.loads(line) for line in file.read_text().splitlines()] for file in sorted(self.dir.glob("told.*"))]

    def rays(self, name):
        self.write(f"{name}.py", RAYS.replace("UPDATE", UPDATES[name]))
        return ["--program", self.write(f"{name}.toml", PROGRAM_SHEET.format(id=name).replace("-IB", "-B") + 'promise = "exact"\n')]

    def follow(self, *options, techniques, more=NUMBERS, out="out"):
        """Rows that follow the walk, by technique."""
        named = [word for technique in techniques for word in ("--technique", technique)]
        self.succeed(*options, "run", *WALK, *named, *more, "--out", out)
        rows = {row["technique"]: row for row in records(self.dir / out)}
        self.assertEqual({name: (row["status"], row["reason"]) for name, row in rows.items()}, {name: ("ok", "") for name in techniques})
        return rows

    def check_changes(self, request, before):
        """Of an update: what it lists is what differs from the positions before."""
        position, listed = request["position"], {change["mesh"]: change for change in request["changes"]}
        for m, mesh in enumerate(request["meshes"]):
            vertices = range(mesh["first_vertex"], mesh["first_vertex"] + mesh["vertices"])
            differ = [v for v in vertices if position[3 * v:3 * v + 3] != before[3 * v:3 * v + 3]]
            self.assertEqual(bool(differ), m in listed, m)
            if not differ:
                continue
            change = listed[m]
            self.assertGreater(m, 1)
            self.assertEqual((change["kind"], change["first"], change["count"]), ("rigid", differ[0], differ[-1] - differ[0] + 1))
            for key, points in (("before", before), ("after", position)):
                corners = [[extreme(points[3 * v + axis] for v in vertices) for axis in range(3)] for extreme in (min, max)]
                for got, wanted in zip(change[key], corners):
                    self.assertEqual([round(x, 5) for x in got], [round(x, 5) for x in wanted])
            for v in (differ[0], differ[-1]):
                old = [*before[3 * v:3 * v + 3], 1]
                for axis in range(3):
                    moved = sum(a * b for a, b in zip(change["matrix"][axis], old))
                    self.assertAlmostEqual(moved, position[3 * v + axis], places=5)

    def test_a_program_that_lists_update_is_told_what_moved(self):
        row = self.follow(*self.told("follows", STAGES), techniques=["follows"])["follows"]
        self.assertEqual(set(row["stages"]), {"setup", "build", "update", "relight", "resolve"})
        updates = 0
        for requests in self.heard():
            before, after = None, ""
            for request in requests:
                if after == "update":
                    self.assertEqual(request["do"], "relight")  # follows always
                after = request["do"]
                if request["do"] == "update":
                    self.check_changes(request, before["position"])
                    updates += 1
                    for name, facts in request["arrays"].items():  # of what stands still neither file nor content is another one
                        self.assertEqual(facts == before["arrays"][name], name != "position" or request["position"] == before["position"], name)
                if "position" in request:
                    before = request
        self.assertGreaterEqual(updates, FRAMES - 1)

    def test_a_program_adds_update_in_its_answer_to_hello(self):
        self.follow(*self.told("follows", hello='{"stages": ["update"]}'), techniques=["follows"])
        self.assertIn("update", [request["do"] for requests in self.heard() for request in requests])
        for hello, sheet, says in (('{"stages": ["relight"]}', "", 'hello was answered with stages = ["relight"]; update is the one'),
                                   ('{"stages": "update"}', "", 'hello was answered with stages = "update"; update is the one'),
                                   ('{"stages": ["update"]}', 'stages = ["resolve"]\n', "have no build, in whose place update stands")):
            with self.subTest(hello=hello, sheet=sheet):
                self.succeed(*self.told("odd", sheet, hello), "run", "--scene", "single_triangle", "--light", "sun", "--technique", "odd", *NUMBERS,
                             "--out", "odd", status=1)
                row = records(self.dir / "odd")[0]
                shutil.rmtree(self.dir / "odd")
                self.assertEqual(row["status"], "failed")
                self.assertIn(says, row["reason"])

    def test_a_program_that_does_not_is_told_to_build(self):
        row = self.follow(*self.told("builds"), techniques=["builds"])["builds"]
        self.assertIn("update", row["stages"])
        verbs = [request["do"] for requests in self.heard() for request in requests]
        self.assertNotIn("update", verbs)
        poses = {tuple(request["position"]) for requests in self.heard() for request in requests if request["do"] == "build"}
        self.assertEqual(len(poses), FRAMES)

    def test_a_still_row_has_no_update(self):
        options = self.told("follows", STAGES)
        self.succeed(*options, "run", "--scene", "walking_boxes:count=2", "--light", "sun", "--technique", "follows", *NUMBERS, "--out", "out")
        self.assertNotIn("update", records(self.dir / "out")[0]["stages"])
        self.assertNotIn("update", [request["do"] for requests in self.heard() for request in requests])

    def test_a_class_in_python_updates_where_it_has_the_method_and_has_the_masks_of_one_that_builds(self):
        rows = self.follow(*self.rays("builds"), *self.rays("updates"), techniques=["builds", "updates", "unshadowed"],
                           more=[*SMALL[:-1], "64x36"])
        for key in ("metrics", "frames", "classes"):
            self.assertEqual(rows["builds"][key], rows["updates"][key], key)
        self.assertNotEqual(rows["builds"]["frames"], rows["unshadowed"]["frames"])
        masks = [(self.dir / "out" / rows[name]["mask"]).read_bytes() for name in ("builds", "updates")]
        self.assertEqual(*masks)

    def test_an_update_that_keeps_too_much_fails_its_rule(self):
        rule = ("--rule", "update_equals_build", "--json")
        self.assertEqual(json.loads(self.succeed(*self.rays("updates"), "check", "updates", *rule))["rules"][0]["verdict"], "holds")
        told = json.loads(self.succeed(*self.rays("keeps_all"), "check", "keeps_all", *rule, status=1))["rules"][0]
        self.assertEqual((told["name"], told["verdict"]), ("update_equals_build", "fails"))

    def test_a_plugin_follows_with_an_update_of_its_own_and_without(self):
        self.environment["UPDATED_RAYS"] = str(self.write("told", ""))
        rows = self.follow("--plugin", SECOND, techniques=["updated_rays", "always_lit", "embree_rays"])
        for row in rows.values():
            self.assertEqual(set(row["stages"]), {"setup", "build", "update", "relight", "resolve"})
        self.assertLess(max(rows["updated_rays"]["frames"]["wrong_rate"]), 0.002)
        self.assertGreater(min(rows["always_lit"]["frames"]["wrong_rate"]), 0.002)
        lines = (self.dir / "told").read_text().splitlines()
        self.assertIn("build", lines)
        self.assertGreaterEqual(lines.count("update 2"), FRAMES - 1)  # two boxes
        text = self.succeed("--plugin", SECOND, "check", "updated_rays", "--rule", "update_equals_build")
        self.assertRegex(text, r"(?m)^update_equals_build +holds$")

    def test_a_program_says_which_stages_it_has(self):
        options = self.told("follows", STAGES)
        self.assertRegex(self.succeed(*options, "describe", "follows"), r"(?m)^stages +setup, build, update, relight, resolve$")
        self.assertEqual(json.loads(self.succeed(*options, "describe", "follows", "--json"))["stages"], ["setup", "build", "update", "relight", "resolve"])
        listed = {entry["id"]: entry for entry in json.loads(self.succeed(*self.told("builds"), "list", "techniques", "--json"))}
        self.assertEqual(listed["builds"]["stages"], ["setup", "build", "relight", "resolve"])
        self.assertNotIn("stages", listed["shadow_map"])

    def test_odd_descriptions_are_refused(self):
        parameter = '[[parameter]]\nname = "a"\nvalue = 1\nmin = 0\nmax = 2\nstage = "update"\nsentence = "S."\n'
        for sheet, says in ((parameter, ["'update'", "is not one of setup, build, relight, resolve"]),
                            ('stages = ["update", "resolve"]\n', ["a list with build beside update"]),
                            ("update_error = 2\n", ["program.update_error = 2 is not within 0 .. 1"]),
                            ("update_error = -0.5\n", ["program.update_error = -0.5 is not within 0 .. 1"])):
            with self.subTest(sheet):
                self.refuse(*self.told("bad", sheet), "list", says=says)


if __name__ == "__main__":
    unittest.main()
