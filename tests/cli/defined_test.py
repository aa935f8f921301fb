#!/usr/bin/python3 -IB
"""Lights and scenes at the edge of sense: the answer is defined, so every technique gives one."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, PATIENCE, ProgramTest, records, scene_toml, small_maps  # noqa: E402

VIEW = '[[view]]\nname = "eye"\neye = [0, 5, 9]\ntarget = [0, 0, 0]\n'
FLOOR = '[[shape]]\nkind = "plane"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [8, 8]\n'
BOX = '[[shape]]\nkind = "box"\nmin = [-1, 0.5, -1]\nmax = [1, 1.5, 1]\n'
SUN = '[[light]]\nname = "sun"\nkind = "directional"\ndirection = [-1, -4, -1]\n'
SILENT = BOX + "casts = false\n"


def point(name, position):
    return f'[[light]]\nname = "{name}"\nkind = "point"\nposition = {position}\n'


class Defined(ProgramTest):
    def run_all(self, name, text, techniques=()):
        """One row for each light and technique, by default all; none fails."""
        self.write(f"{name}.toml", text)
        # A frame of EEVEE takes seconds: it has a test of its own.
        techniques = list(techniques) or [entry["id"] for entry in json.loads(self.succeed("list", "--json")) if entry["id"] != "eevee"]
        small = {technique.partition(":")[0]: technique for technique in small_maps()}  # the engines are as they are
        arguments = [word for technique in techniques for word in ("--technique", small.get(technique, technique))]
        self.succeed("run", "--scene", f"{name}.toml", *arguments, *NUMBERS, "--timeout", PATIENCE, "--out", name)
        rows = records(self.dir / name)
        self.assertEqual([r["technique"] for r in rows if r["light"] == rows[0]["light"]], techniques)
        self.assertEqual({r["status"] for r in rows} - {"ok", "unsupported"}, set())
        for row in rows:
            if row["status"] == "unsupported":
                self.assertNotEqual(row["reason"], "")
        return {(r["light"], r["technique"]): r for r in rows}

    def test_lights_inside_geometry_on_a_receiver_and_on_a_vertex(self):
        lights = (point("inside", [0, 1, 0]) + point("on_floor", [3, 0, 2]) + point("on_vertex", [1, 1.5, 1])
                  + point("below", [0, -2, 0]))
        rows = self.run_all("lights", scene_toml(lights, VIEW, FLOOR + BOX))
        for light in ("inside", "on_floor", "on_vertex", "below"):
            # Wherever the light is, the reference and the exact oracle agree about the pixels that can be decided.
            for technique in ("embree_rays", "exact_rays"):
                self.assertEqual(rows[light, technique]["metrics"]["mesh"]["wrong_rate"] or 0, 0, (light, technique))
        # A light in a closed box lights nothing outside it: on the floor, all that faces it is in umbra.
        inside = rows["inside", "unshadowed"]
        self.assertGreater(inside["classes"]["T"], 1000)
        self.assertGreater(inside["metrics"]["shape"]["false_lit_rate"], 0.95)
        # A light in the floor's own plane faces none of it, and only the outside of the box; one below it lights nothing at all.
        self.assertLess(rows["on_floor", "unshadowed"]["classes"]["T"], inside["classes"]["T"])

    def test_scenes_without_casters_are_lit(self):
        scene = lambda light: scene_toml(light, VIEW, FLOOR.replace("size", "casts = false\nsize") + SILENT)
        rows = self.run_all("silent", scene(point("lamp", [1, 4, 1])))
        others = [technique for (_, technique), row in rows.items() if row["status"] == "unsupported"]
        for (light, technique), row in (rows | self.run_all("silent_sun", scene(SUN), others)).items():
            with self.subTest(f"{technique} {light}"):
                if row["status"] == "ok":
                    self.assertEqual(row["metrics"]["shape"]["wrong_rate"], 0)
        self.assertGreater(rows["lamp", "unshadowed"]["classes"]["T"], 1000)

    def test_a_view_of_nothing_is_all_background(self):
        away = '[[view]]\nname = "eye"\neye = [0, 5, 9]\ntarget = [0, 10, 90]\n'
        rows = self.run_all("away", scene_toml(point("lamp", [1, 4, 1]), away, FLOOR + BOX))
        self.assertEqual({row["classes"]["B"] for row in rows.values() if row["status"] == "ok"}, {160 * 90})


if __name__ == "__main__":
    unittest.main()
