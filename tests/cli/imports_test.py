#!/usr/bin/python3 -IB
"""Scenes from files: meshes as they come, and descriptions that name them."""

import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import DATA, NUMBERS, SMALL, ProgramTest, records, scene_toml  # noqa: E402


class Imports(ProgramTest):
    def test_every_format_gives_the_same_tetrahedron(self):
        for ending in ("obj", "ply", "stl", "off", "gltf", "glb"):
            with self.subTest(ending):
                text = self.succeed("describe", DATA / f"tetrahedron.{ending}")
                self.assertRegex(text, r"(?m): 1 mesh, 4 triangles$")
                self.assertRegex(text, r"(?m)^bounds  0 0 0 \.\. 1 1 1 m$")
                self.assertRegex(text, r"(?m)^\S+ +4 +- +yes +0 +0 +0 +0$")  # closed: no edge is open, shared or turned

    def test_a_mesh_runs_under_the_framing_default_and_says_so(self):
        text = self.succeed("run", "--scene", DATA / "tetrahedron.obj", "--technique", "unshadowed", *NUMBERS, "--out", "out")
        self.assertRegex(text, r"note: .*tetrahedron\.obj: no view given: view 'view' frames the whole scene")
        self.assertRegex(text, r"note: .*tetrahedron\.obj: no light given: ")
        rows = records(self.dir / "out")
        self.assertEqual([(r["light"], r["view"], r["status"]) for r in rows], [("point", "view", "ok"), ("sun", "view", "ok")])
        for row in rows:
            self.assertEqual(len(row["notes"]), 2)
            self.assertGreater(row["classes"]["T"], 1000)  # it fills the picture

    def test_a_description_finds_files_beside_itself(self):
        (self.dir / "deep/models").mkdir(parents=True)
        shutil.copy(DATA / "tetrahedron.ply", self.dir / "deep/models/t.ply")
        mesh = scene_toml() + '\n[[mesh]]\nfile = "models/t.ply"\nscale = 2\ntranslate = [0, 1, 0]\n'
        self.write("deep/scene.toml", mesh)
        text = self.succeed("describe", "deep/scene.toml")  # from another folder than the file's
        self.assertRegex(text, r"(?m): 2 meshes, 6 triangles$")
        self.assertRegex(text, r"(?m)^bounds  -4 0 -4 \.\. 4 3 4 m$")
        self.succeed("run", "--scene", "deep/scene.toml", "--technique", "embree_rays", *NUMBERS, "--out", "out")
        self.assertEqual([r["scene"] for r in records(self.dir / "out")], ["deep/scene.toml"] * 2)

    def test_a_scene_is_found_again_from_anywhere(self):
        here, project = self.dir, self.dir / "project"
        (project / "models").mkdir(parents=True)
        shutil.copy(DATA / "tetrahedron.ply", project / "models/t.ply")
        (project / "scene.toml").write_text(scene_toml() + '\n[[mesh]]\nfile = "models/t.ply"\n')
        row = ["run", "--light", "point", "--technique", "unshadowed", *SMALL, "--scene"]
        self.dir = project
        self.succeed(*row, "scene.toml", "--out", "runs/out")
        self.dir = here
        project.rename(here / "moved")
        out = here / "moved/runs/out"
        self.assertEqual([r["context"]["scene_file"] for r in records(out)], ["../../scene.toml"])
        # From another folder, and under another path, it is the same scene: its row is done, and a new one has the same name.
        text = self.succeed(*row, "moved/scene.toml", "--technique", "embree_rays", "--resume", "--out", "moved/runs/out")
        self.assertIn("1 was done before", text)
        self.assertEqual([r["scene"] for r in records(out)], ["scene.toml"] * 2)
        done = self.gnomon("table", "moved/runs/out", "--rescore", "--save")
        self.assertIn("2 rows rescored", done.stdout + done.stderr)
        (here / "scene.toml").write_text(scene_toml(mesh='[[shape]]\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'))
        done = self.gnomon("report", "moved/runs/out", "--out", "page.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("scene", done.stdout + done.stderr)  # a note would say that it is not the one that was measured
        self.refuse(*row, "scene.toml", "--resume", "--out", "moved/runs/out", says=["scene.toml has changed"])

    def test_an_import_leaves_no_process_and_no_file(self):
        self.succeed("describe", DATA / "tetrahedron.stl")
        self.assertEqual(list(self.dir.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
