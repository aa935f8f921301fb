#!/usr/bin/python3 -IB
"""Eyes next to what they see, scenes of a millimeter, directions of any length: tests/data/cases/near_plane_* and direction_length."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import DATA, NUMBERS, SMALL, ProgramTest, records  # noqa: E402

CASES = DATA / "cases"
DIRECTION = CASES / "direction_length"
# Three that draw as the eye sees, and one that does not.
TECHNIQUES = [word for name in ("stencil_volume", "planar_projected", "sphere_volume", "svbsp") for word in ("--technique", name)]


class CasesNear(ProgramTest):
    def assert_right(self, scene, *arguments):
        """No row is wrong at more pixels than its snapping floor, and all have shadows to be wrong at. The rows."""
        self.succeed("run", "--scene", scene, *TECHNIQUES, *arguments, *NUMBERS, "--out", scene.stem)
        rows = records(self.dir / scene.stem)
        for row in rows:
            with self.subTest(technique=row["technique"], light=row["light"]):
                self.assertEqual((row["status"], row["support"]), ("ok", "full"))
                of = row["metrics"]["shape"]
                self.assertLessEqual(of["wrong_rate"], of["snapping_floor"])
        return rows

    def test_an_eye_half_a_millimeter_over_the_floor_sees_its_shadow(self):
        rows = self.assert_right(CASES / "near_plane_macro/macro.toml")
        self.assertEqual(len(rows), 8)

    def test_scenes_of_a_millimeter_and_of_a_micrometer(self):
        for name in ("tiny4", "tiny"):
            rows = self.assert_right(CASES / f"near_plane_tiny/{name}.toml")
            self.assertEqual(len(rows), 8)

    def test_a_direction_of_any_length_is_that_of_usual_length(self):
        usual = self.write("usual.toml", (DIRECTION / "odd_dir_x_1e-38.toml").read_text().replace("[-1e-38,-3e-38,-1e-38]", "[-1,-3,-1]"))
        techniques = ["--technique", "composite_planar", "--technique", "shadow_map", *TECHNIQUES]
        rows = {}
        for scene in (usual, *sorted(DIRECTION.glob("*.toml"))):
            self.succeed("run", "--scene", scene, *techniques, *SMALL, "--pictures", "masks", "--out", scene.stem)
            found = records(self.dir / scene.stem)
            same = ("technique", "status", "support", "counts", "classes", "metrics", "causes", "scene_facts")
            rows[scene.stem] = [({key: row[key] for key in same}, (self.dir / scene.stem / row["mask"]).read_bytes()) for row in found]
            self.assertEqual([row["metrics"]["mesh"]["wrong_rate"] for row in found if row["technique"] == "svbsp"], [0])
        self.assertEqual(len(rows), 4)
        for name, found in rows.items():
            self.assertEqual(found, rows["usual"], name)

    def test_what_is_no_direction_is_refused_with_its_line(self):
        text = (DIRECTION / "odd_dir_x_1e-38.toml").read_text()
        for direction, says in (("[0,0,0]", "[0, 0, 0] is not a direction"), ("[0,inf,0]", "inf is not within"), ("[nan,1,0]", "nan is not within")):
            scene = self.write("scene.toml", text.replace("[-1e-38,-3e-38,-1e-38]", direction))
            self.refuse("run", "--scene", scene, "--technique", "unshadowed", *SMALL, "--out", "out", says=["direction", says, "scene.toml:13"])


if __name__ == "__main__":
    unittest.main()
