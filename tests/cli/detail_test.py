#!/usr/bin/python3 -IB
"""render --detail: lit, half lit and shadowed polygons as Wavefront OBJ, read back and reckoned up."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, SMALL, ProgramTest  # noqa: E402

SIZE = SMALL[-2:]
FLOOR = [(-4, 0, -4), (-4, 0, 4), (4, 0, 4), (4, 0, -4)]
ROOF = [(-0.5, 2, -0.5), (0.25, 2, 0.5), (0.75, 2, -0.25)]
PANEL = 'kind = "rect"\ncenter = [0.25, 5, 0]\nhalf_u = [0.15, 0, 0]\nhalf_v = [0, 0, 0.15]\n'
LIGHTS = {"lamp": 'kind = "point"\nposition = [0.5, 5, 0.25]\n', "sun": 'kind = "directional"\ndirection = [0, -1, 0]\n'}


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def vector_area(polygon):
    """Along the normal, as long as the area."""
    fan = [cross(minus(b, polygon[0]), minus(c, polygon[0])) for b, c in zip(polygon[1:], polygon[2:])]
    return tuple(sum(part[k] for part in fan) / 2 for k in range(3))


def area(polygon):
    return dot(vector_area(polygon), vector_area(polygon)) ** 0.5


def read_obj(file):
    """{object: {material: [polygon]}}, library and comments; strict about everything else."""
    vertices, objects, library, comments = [], {}, None, []
    name = material = None
    for line in file.read_text().splitlines():
        word, _, rest = line.partition(" ")
        if word == "#":
            comments.append(rest)
        elif word == "mtllib":
            library = rest
        elif word == "o":
            assert rest not in objects and " " not in rest, line
            name, material = rest, None
            objects[name] = {}
        elif word == "usemtl":
            material = rest
            assert material in ("lit", "penumbra", "shadowed") and material not in objects[name], line
            objects[name][material] = []
        elif word == "v":
            vertices.append(tuple(map(float, rest.split(" "))))
            assert len(vertices[-1]) == 3, line
        elif word == "f":
            corners = [int(k) for k in rest.split(" ")]
            assert len(corners) >= 3 and len(set(corners)) == len(corners) and min(corners) >= 1, line
            objects[name][material].append([vertices[k - 1] for k in corners])
        else:
            raise AssertionError(line)
    return objects, library, comments


def write_obj(polygon):
    return "".join(f"v {x} {y} {z}\n" for x, y, z in polygon) + "f " + " ".join(str(k + 1) for k in range(len(polygon))) + "\n"


class Detail(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("floor.obj", write_obj(FLOOR))
        self.write("roof.obj", write_obj(ROOF))
        self.write("deaf.obj", write_obj([(x, y - 1, z) for x, y, z in FLOOR]))
        meshes = ['[[mesh]]\nfile = "floor.obj"\n', '[[mesh]]\nfile = "roof.obj"\n', '[[mesh]]\nfile = "deaf.obj"\nreceives = false\n']
        view = '[[view]]\nname = "v"\neye = [0, 6, 9]\ntarget = [0, 0, 0]\n'
        for name, all_lights in (("roof", LIGHTS), ("soft_roof", {"panel": PANEL})):
            lights = [f'[[light]]\nname = "{light}"\n{kind}' for light, kind in all_lights.items()]
            self.write(f"{name}.toml", "".join([*meshes, *lights, view]))

    def techniques(self, scene):
        """Ids of all that make surface detail under the lights of a scene: those that are built in, and the plugin's, which cuts triangles in two."""
        self.write("any.toml", f"""[[group]]\nscenes = ["{scene}"]\ntechniques = ["*"]\n""")
        rows = self.succeed("--plugin", FAULTS, "run", "any.toml", "--dry-run")
        ids = sorted(set(re.findall(r"(?m)^[0-9a-f]{16}  .* (\w+)$", rows)))
        return [i for i in ids if json.loads(self.succeed("--plugin", FAULTS, "describe", i, "--json"))["surface_detail"]]

    def render(self, technique, scene, file, *more):
        return self.succeed("--plugin", FAULTS, "render", "--scene", scene, "--technique", technique, *SIZE, "--out", "out",
                            "--detail", file, *more)

    def test_areas_under_a_roof_are_those_on_paper(self):
        techniques = self.techniques("roof.toml")
        self.assertIn("spoils_detail", techniques)
        for technique in techniques:
            with self.subTest(technique):
                self.render(technique, "roof.toml", f"{technique}.obj")
                for light, tail in (("lamp", ""), ("sun", "_sun")):
                    objects, library, comments = read_obj(self.dir / f"{technique}{tail}.obj")
                    self.assertEqual(library, f"{technique}{tail}.mtl")
                    self.assertEqual(re.findall(r"(?m)^newmtl (\w+)$", (self.dir / library).read_text()), ["lit", "penumbra", "shadowed"])
                    count = {m: sum(len(parts.get(m, [])) for parts in objects.values()) for m in ("lit", "shadowed")}
                    for says in ("scene: roof.toml", f"light: {light}, a ", f"technique: {technique}", "Units: meters",
                                 f"polygons: {count['lit']} lit, {count['shadowed']} shadowed"):
                        self.assertEqual(len([c for c in comments if says in c]), 1, (says, comments))
                    self.assertEqual(len(objects), 2)  # not the one that does not receive
                    (floor, lit_floor), (roof, lit_roof) = (self.reckon(parts, triangle)
                                                            for parts, triangle in zip(objects.values(), (FLOOR, ROOF)))
                    self.assertAlmostEqual(floor, 64, 7)
                    self.assertAlmostEqual(roof, area(ROOF), 8)
                    if technique == "spoils_detail":
                        self.assertAlmostEqual(lit_floor, 32, 7)
                        continue
                    # From 5 meters up, what is 2 meters up is 5 / 3 times as long on the floor; from infinity as long as it is.
                    scale = (5 / 3) ** 2 if light == "lamp" else 1
                    self.assertAlmostEqual(floor - lit_floor, scale * area(ROOF), 7)
                    self.assertAlmostEqual(lit_roof, roof, 8)

    def reckon(self, parts, triangle):
        """All area and lit area, after a look at every polygon: in the plane of its triangle, wound like it, convex."""
        normal = vector_area(triangle)
        length = dot(normal, normal) ** 0.5
        for polygon in sum(parts.values(), []):
            for corner in polygon:
                self.assertLess(abs(dot(minus(corner, triangle[0]), normal)) / length, 1e-8)
            for a, b, c in zip(polygon, polygon[1:] + polygon[:1], polygon[2:] + polygon[:2]):
                self.assertGreater(dot(cross(minus(b, a), minus(c, b)), normal), -1e-7)
        lit = sum(map(area, parts.get("lit", [])))
        return lit + sum(map(area, parts.get("shadowed", []))), lit

    def test_penumbra_and_umbra_under_a_roof_are_those_on_paper(self):
        techniques = [i for i in self.techniques("soft_roof.toml") if i != "spoils_detail"]
        self.assertGreater(len(techniques), 0)
        for technique in techniques:
            with self.subTest(technique):
                self.render(technique, "soft_roof.toml", f"{technique}.obj")
                objects, _, comments = read_obj(self.dir / f"{technique}.obj")
                floor, roof = objects.values()
                self.assertTrue(any("penumbra, " in c for c in comments), comments)
                self.assertAlmostEqual(sum(map(area, roof["lit"])), area(ROOF), 8)
                self.assertAlmostEqual(self.reckon(floor, FLOOR)[0] + sum(map(area, floor["penumbra"])), 64, 7)
                # From points p of the panel the roof R throws the shadows 5/3 R - 2/3 p: where any of them is, that triangle is wider by a
                # square of half side h; where all of them are, it is smaller by the same square and of the same shape.
                h, big = 2 / 3 * 0.15, (5 / 3) ** 2 * area(ROOF)
                wide = 5 / 3 * sum(max(c[k] for c in ROOF) - min(c[k] for c in ROOF) for k in (0, 2))
                umbra, penumbra = (sum(map(area, floor[kind])) for kind in ("shadowed", "penumbra"))
                self.assertAlmostEqual(umbra + penumbra, big + 2 * h * wide + 4 * h * h, 4)
                self.assertAlmostEqual(umbra, big * (1 - h * wide / big) ** 2, 4)

    def test_techniques_agree_about_a_soup(self):
        lit = {}
        for technique in self.techniques("soup:count=60"):
            if technique == "spoils_detail" or technique in self.techniques("soft_roof.toml"):
                continue
            self.render(technique, "soup:count=60", "soup.obj", "--light", "point")
            objects, _, _ = read_obj(self.dir / "soup.obj")
            lit[technique] = sum(area(p) for parts in objects.values() for p in parts.get("lit", []))
            self.assertGreater(sum(len(parts.get("shadowed", [])) for parts in objects.values()), 20)
        for technique, sum_of_areas in lit.items():
            self.assertAlmostEqual(sum_of_areas / next(iter(lit.values())), 1, 7, technique)

    def test_the_file_is_a_scene_again(self):
        self.render("spoils_detail", "soup:count=60", "again.obj", "--light", "point")
        self.succeed("render", "--scene", "again.obj", "--technique", "unshadowed", *SIZE, "--out", "back")

    def test_a_new_folder_is_made_and_nothing_else_is_left(self):
        self.render("spoils_detail", "single_triangle", "deep/er/x.obj", "--light", "sun")
        self.assertEqual(self.names(self.dir / "deep"), ["er/x.mtl", "er/x.obj"])
        self.render("spoils_detail", "single_triangle", "out/x.obj", "--light", "sun")  # beside the pictures
        self.assertTrue({"x.mtl", "x.obj", "mask.exr"} <= set(self.names(self.dir / "out")))
        self.assertEqual([p.name for p in self.dir.rglob(".*")], [])

    def test_what_cannot_be_done_is_refused_before_anything_runs(self):
        self.write("file", "")
        (self.dir / "folder.obj").mkdir()
        before = self.names(self.dir)
        for technique, file, says in [
            ("spoils_detail", "x.glb", ["--detail x.glb", ".obj"]),
            ("spoils_detail", "x", ["--detail x ", ".obj"]),
            ("spoils_detail", "", ["--detail", "empty"]),
            ("spoils_detail", "file/x.obj", ["file/x.obj cannot be written"]),
            ("spoils_detail", "/proc/x.obj", ["/proc/x.obj cannot be written"]),
            ("spoils_detail", "folder.obj", ["folder.obj cannot be written", "directory"]),
            ("unshadowed", "x.obj", ["unshadowed makes no surface detail", "x.obj"]),
        ]:
            with self.subTest(f"{technique} {file}"):
                self.refuse("--plugin", FAULTS, "render", "--scene", "single_triangle", "--technique", technique, *SIZE, "--out",
                            "out", "--detail", file, says=says)
                self.assertEqual(self.names(self.dir), before)
                self.assertFalse((self.dir / "out").exists())

    def test_only_surface_detail_is_replaced(self):
        """Neither the scene's own file nor its materials, nor anybody else's file of a further light; an older detail is."""
        self.write("mine_sun.mtl", "newmtl gold\n")
        before = {p: (self.dir / p).read_bytes() for p in self.names(self.dir)}
        for scene, file, says in [("floor.obj", "floor.obj", "floor.obj, which is the scene"), ("roof.toml", "roof.obj", "no surface detail"),
                                  ("roof.toml", "mine.obj", "mine_sun.mtl, which is no surface detail")]:
            with self.subTest(file):
                self.refuse("render", "--scene", scene, "--technique", "svbsp", *SIZE, "--out", "out", "--detail", file, says=[says])
                self.assertEqual({p: (self.dir / p).read_bytes() for p in self.names(self.dir)}, before)
        self.render("svbsp", "roof.toml", "new.obj")
        old = (self.dir / "new_sun.obj").read_text()
        self.render("two_pass_object", "roof.toml", "new.obj")
        self.assertNotEqual((self.dir / "new_sun.obj").read_text(), old)
        self.refuse("render", "--scene", "new.obj", "--technique", "svbsp", *SIZE, "--out", "out", "--detail", "new.obj",
                    says=["which is the scene"])

    def test_a_detail_that_does_not_fit_fails_and_leaves_no_file(self):
        before = self.names(self.dir)
        for spoilt, says in [("mesh", "is of mesh 99; the scene has "), ("corner", "has a corner at"), ("all", "gave no surface detail"),
                             ("order", "comes after")]:
            with self.subTest(spoilt):
                done = self.gnomon("--plugin", FAULTS, "render", "--scene", "roof.toml", "--technique",
                                   f"spoils_detail:spoilt={spoilt}", *SIZE, "--out", "out", "--detail", "x.obj")
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertRegex(done.stderr, r"^gnomon: threw in detail: ")
                self.assertIn(says, done.stderr)
                self.assertEqual(self.names(self.dir), before)


if __name__ == "__main__":
    unittest.main()
