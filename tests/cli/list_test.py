#!/usr/bin/python3 -IB
"""What the program says about itself: lists, descriptions, help, the pages of the documentation."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import DATA, ROOT, ProgramTest  # noqa: E402

COMMANDS = ["list", "describe", "check", "render", "run", "table", "certify", "docs"]


class Lists(ProgramTest):
    def test_every_list_names_what_there_is_as_text_and_as_json(self):
        for what, key, some in [("techniques", "id", "shadow_map"), ("scenes", "id", "single_triangle"), ("suites", "id", "quick"),
                                ("metrics", "name", "wrong_rate"), ("causes", "name", "acne"),
                                ("rules", "name", "same_mask")]:
            with self.subTest(what):
                self.assertRegex(self.succeed("list", what), rf"(?m)^{some} ")
                entries = json.loads(self.succeed("list", what, "--json"))
                self.assertIn(some, [entry[key] for entry in entries])

    def test_a_scene_is_described_with_all_numbers_of_its_lights_and_views(self):
        scene = self.write("lit.toml", """
            scene = "single_triangle"
            [[light]]
            name = "lamp"
            kind = "disc"
            center = [0.1, 2, 0.3]
            normal = [0, -1, 0]
            radius = 0.25
            one_sided = true
            intensity = 3
            [[light]]
            name = "cone"
            kind = "spot"
            position = [1, 5, 2]
            direction = [0, -1, 0]
            inner_degrees = 10
            outer_degrees = 12.5
            [[view]]
            name = "above"
            eye = [0, 7, 0.5]
            target = [0, 0, 0]
            up = [0, 0, -1]
            fov_y_degrees = 33
        """)
        described = json.loads(self.succeed("describe", scene, "--json"))
        lights = {light["name"]: light for light in described["lights"]}
        self.assertEqual(lights["lamp"], {"name": "lamp", "kind": "disc", "center": [0.1, 2, 0.3], "normal": [0, -1, 0], "radius": 0.25,
                                          "one_sided": True, "intensity": 3})
        self.assertEqual(lights["cone"], {"name": "cone", "kind": "spot", "position": [1, 5, 2], "direction": [0, -1, 0],
                                          "inner_degrees": 10, "outer_degrees": 12.5, "intensity": 1})
        self.assertIn({"name": "above", "eye": [0, 7, 0.5], "target": [0, 0, 0], "up": [0, 0, -1], "fov_y_degrees": 33}, described["views"])
        text = self.succeed("describe", scene)
        self.assertRegex(text, r"(?m)^lamp +disc +center 0.1 2 0.3, normal 0 -1 0, radius 0.25, one_sided true, intensity 3$")
        self.assertRegex(text, r"(?m)^above +eye 0 7 0.5, target 0 0 0, up 0 0 -1, fov_y_degrees 33$")
        generated = json.loads(self.succeed("describe", "fence:width=0.2", "--json"))
        self.assertEqual([p["name"] for p in generated["parameters"]], ["width", "spacing"])
        self.assertEqual(generated["meshes"][0], {"name": "ground", "triangles": 2, "shape": "plane", "casts": True, "receives": True,
                                                  "closed": False, "boundary_edges": 4, "nonmanifold_edges": 0, "misoriented_edges": 0,
                                                  "dropped_triangles": 0})

    def test_the_keys_of_a_described_scene_stay(self):
        # As docs/scenes.md has them: programs read them.
        kinds = {
            "point": {"position": "[0, 5, 0]"},
            "spot": {"position": "[0, 5, 0]", "direction": "[0, -1, 0]", "inner_degrees": "10", "outer_degrees": "20"},
            "directional": {"direction": "[0, -1, 0]"},
            "rect": {"center": "[0, 5, 0]", "half_u": "[1, 0, 0]", "half_v": "[0, 0, 1]", "one_sided": "false"},
            "disc": {"center": "[0, 5, 0]", "normal": "[0, -1, 0]", "radius": "0.5", "one_sided": "true"},
            "sphere": {"center": "[0, 5, 0]", "radius": "0.5"},
        }
        text = 'scene = "single_triangle"\n'
        for kind, keys in kinds.items():
            text += f'[[light]]\nname = "a_{kind}"\nkind = "{kind}"\n' + "".join(f"{key} = {value}\n" for key, value in keys.items())
        described = json.loads(self.succeed("describe", self.write("all.toml", text), "--json"))
        self.assertEqual(list(described), ["scene", "triangles", "bounds", "notes", "summary", "parameters", "lights", "views", "meshes",
                                           "animations"])
        self.assertEqual({light["kind"]: list(light) for light in described["lights"]},
                         {kind: ["name", "kind", *keys, "intensity"] for kind, keys in kinds.items()})
        for light in described["lights"]:
            for key, value in kinds[light["kind"]].items():
                self.assertEqual(light[key], json.loads(value), (light["kind"], key))
        self.assertEqual([list(view) for view in described["views"]],
                         [["name", "eye", "target", "up", "fov_y_degrees"]] * len(described["views"]))
        self.assertEqual({tuple(mesh) for mesh in described["meshes"]},
                         {("name", "triangles", "shape", "casts", "receives", "closed", "boundary_edges", "nonmanifold_edges",
                           "misoriented_edges", "dropped_triangles")})
        self.assertEqual(described["triangles"], sum(mesh["triangles"] for mesh in described["meshes"]))
        page = (ROOT / "docs/scenes.md").read_text()
        for key in [*described, *described["meshes"][0], *(key for keys in kinds.values() for key in keys)]:
            self.assertIn(f"`{key}`", page)

    def test_techniques_are_the_default(self):
        self.assertEqual(self.succeed("list"), self.succeed("list", "techniques"))

    def test_scenes_whose_files_are_not_fetched_are_listed_as_such(self):
        scenes = {entry["id"]: entry for entry in json.loads(self.succeed("list", "scenes", "--json"))}
        self.assertTrue(scenes["soup"]["available"])
        self.assertFalse(scenes["bunny"]["available"])  # the cache of this test is empty
        self.assertRegex(self.succeed("list", "scenes"), r"(?m)^bunny +not fetched ")


    def test_scenes_that_start_from_what_is_not_fetched_are_not_fetched(self):
        root = self.dir / "root"
        for folder in (root / "scenes", root / "bench/suites", root / "meshes"):
            folder.mkdir(parents=True)
        files = {
            "scan": '[[mesh]]\n  file = "cache:scan/scan.obj" # once fetched\n',
            "by_id": '# By id: a scan at night.\nscene = "scan"\n',
            "by_file": 'scene = "../meshes/placed.toml"\n',
            "by_mesh": 'scene = "cache:scan/scan.obj"\n',
            "by_settings": 'scene = "soup:count=5"\n',
            "by_itself": 'scene = "by_itself"\n',
        }
        for name, text in files.items():
            (root / f"scenes/{name}.toml").write_text(text)
        (root / "meshes/placed.toml").write_text('scene = "by_id"\n')
        self.environment = dict(self.environment, GNOMON_ROOT=str(root), GNOMON_CACHE=str(self.dir / "cache"))

        def available():
            scenes = json.loads(self.succeed("list", "scenes", "--json"))
            return {scene["id"]: scene["available"] for scene in scenes if not scene["generated"]}

        needy = {"scan", "by_id", "by_file", "by_mesh"}
        self.assertEqual(available(), {name: name not in needy for name in files})
        self.assertRegex(self.succeed("list", "scenes"), r"(?m)^by_id +not fetched +a scan at night\.$")
        self.refuse("describe", "by_file", says=["scene scan is not fetched: run scripts/fetch_scenes scan"])
        (self.dir / "cache/scenes/scan").mkdir(parents=True)
        (self.dir / "cache/scenes/scan/scan.obj").write_bytes((DATA / "tetrahedron.obj").read_bytes())
        self.assertEqual(available(), {name: True for name in files})
        self.assertIn("4 triangles", self.succeed("describe", "by_file"))


class Descriptions(ProgramTest):
    def test_a_technique_shows_its_source_and_every_parameter(self):
        text = self.succeed("describe", "shadow_map")
        parameters = json.loads(self.succeed("describe", "shadow_map", "--json"))["parameters"]
        self.assertIn("Williams 1978", text)
        self.assertGreaterEqual(len(parameters), 5)
        for parameter in parameters:
            self.assertIn(parameter["name"], text)

    def test_a_scene_shows_triangles_lights_views_parameters_and_facts(self):
        text = self.succeed("describe", "soup:count=50")
        self.assertIn("52 triangles", text)  # 50 and a ground of 2
        for line in ("point +point ", "sun +directional ", "seed ", "view +eye ", "ground +2 "):
            self.assertRegex(text, f"(?m)^{line}")


class Help(ProgramTest):
    def test_version_is_a_number_and_what_was_built(self):
        self.assertRegex(self.succeed("--version"), r"^\d+\.\d+\.\d+ \(commit ([0-9a-f]{10}(-dirty)?|unknown), build [0-9a-f]{16}\)\n$")

    def test_every_command_explains_itself(self):
        text = self.succeed("--help")
        for command in COMMANDS:
            with self.subTest(command):
                self.assertRegex(text, rf"(?m)^  {command} +\S")
                self.assertIn(f"gnomon {command}", self.succeed(command, "--help"))

    def test_hidden_commands_stay_hidden(self):
        commands = re.findall(r"(?m)^  ([a-z-]+) ", self.succeed("--help").split("Subcommands:")[1])
        self.assertEqual([c for c in commands if "worker" in c or "import" in c or "-rule" in c], [])
        self.assertGreaterEqual(set(commands), set(COMMANDS))


class Pages(ProgramTest):
    def test_docs_writes_a_page_for_each_technique_and_an_index(self):
        self.succeed("docs", "--out", "pages")
        pages = self.names(self.dir / "pages")
        ids = [entry["id"] for entry in json.loads(self.succeed("list", "--json"))]
        self.assertEqual([f"{i}.md" for i in ids], [p for p in pages if p[:-3] in ids])
        self.assertEqual(len(pages), len(ids) + 1)
        self.assertIn("## Example", (self.dir / "pages/shadow_map.md").read_text())

    def test_check_names_a_stale_page_and_exits_with_1(self):
        self.succeed("docs", "--out", "pages")
        self.assertEqual(self.succeed("docs", "--check", "--out", "pages"), "")
        self.write("pages/shadow_map.md", "old")
        self.assertEqual(self.succeed("docs", "--check", "--out", "pages", status=1), "stale: pages/shadow_map.md\n")

    def test_the_page_of_the_rules_is_written_and_checked_beside_the_others(self):
        self.assertEqual(self.succeed("docs", "--rules", "rules.md"), "rules.md\n")
        page = (self.dir / "rules.md").read_text()
        for rule in json.loads(self.succeed("list", "rules", "--json")):
            self.assertIn(f"| [{rule['name']}](#{rule['name']}) | {rule['asked_of']} |", page)
            self.assertIn(f"\n### {rule['name']}\n", page)
        self.assertEqual(self.succeed("docs", "--check", "--rules", "rules.md"), "")
        self.write("rules.md", "old")
        self.assertEqual(self.succeed("docs", "--check", "--rules", "rules.md", status=1), "stale: rules.md\n")


if __name__ == "__main__":
    unittest.main()
