#!/usr/bin/python3 -IB
"""Bad words on the command line and bad files: one clear line, exit status 2, and nothing written."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import DATA, NUMBERS, ProgramTest, records, scene_toml  # noqa: E402

ANY = ["--scene", "single_triangle", "--technique", "unshadowed"]


class Words(ProgramTest):
    def refuse_run(self, *arguments, says):
        """Refused before the output folder exists."""
        with self.subTest(" ".join(map(str, arguments))):
            self.refuse("run", *arguments, "--out", "out", says=says)
            self.assertFalse((self.dir / "out").exists())

    def test_unknown_names_come_with_the_nearest_known_one(self):
        for arguments, says in [
            (["rnder"], ["no command rnder", "did you mean render?", "certify"]),
            (["list", "sceens"], ["sceens", "did you mean scenes?", "metrics"]),
            (["table", ".", "--format", "tek"], ["tek", "did you mean tex?", "csv"]),
            (["describe", "shadow_mop"], ["shadow_mop", "did you mean shadow_map?"]),
            (["certify", "--scene", "single_triangle", "--light", "pint"], ["light pint", "did you mean point?"]),
            (["certify", "--scene", "single_triangle", "--view", "vew"], ["view vew", "did you mean view?"]),
            (["run", *ANY, "--siz", "64x64"], ["no option --siz", "did you mean --size?"]),
            (["--versio"], ["no option --versio", "did you mean --version?"]),
            (["table", ".", "surplus"], ["'surplus'", "gnomon table --help"]),
            ([], ["a command is wanted", "render"]),
        ]:
            with self.subTest(" ".join(arguments)):
                self.refuse(*arguments, says=says)
        self.refuse_run("--scene", "single_triangl", "--technique", "unshadowed",
                        says=["single_triangl ", "did you mean single_triangle?"])
        self.refuse_run("--scene", "soup:cout=5", "--technique", "unshadowed", says=["cout", "did you mean count?", "seed"])
        self.refuse_run("--scene", "soup", "--technique", "shadow_mop", says=["shadow_mop", "did you mean shadow_map?"])
        for names in (["unshadowed", "svbsp"], ["shadow_map:resolution={64,128},filter=pcf", "svbsp:order=tiles"], ["unshadowed", "svbps"], ["*", "cycles"]):
            self.refuse_run("--scene", "soup", "--technique", ",".join(names),
                            says=["2 techniques", "is repeated: " + " ".join(f"--technique {name}" for name in names)])
        self.refuse_run("--scene", "soup", "--technique", "shadow_map:filtr=pcf", says=["filtr", "did you mean filter?"])
        self.refuse_run(*ANY, "--light", "pint", says=["single_triangle", "light pint", "did you mean point?", "sun"])
        self.refuse_run("quik", says=["suite quik", "did you mean quick?", "standard"])

    def test_unknown_columns_come_with_the_nearest_known_one(self):
        self.succeed("run", *ANY, "--light", "sun", *NUMBERS, "--out", "out")
        self.refuse("table", "out", "--columns", "wrong_rat", says=["wrong_rat", "did you mean wrong_rate?"])

    def test_values_out_of_range_say_what_is_allowed(self):
        for technique in ("shadow_map:resolution=5", "shadow_map:resolution=nan", "shadow_map:resolution=", "shadow_map:resolution=512.5",
                          "shadow_map:resolution=99999999999999999999"):
            self.refuse_run("--scene", "soup", "--technique", technique, says=["shadow_map.resolution = ", "64 .. 8192 texel"])
        self.refuse_run("--scene", "soup", "--technique", "shadow_map:filter=box", says=["shadow_map.filter = box", "nearest | pcf"])
        self.refuse_run("--scene", "soup", "--technique", "shadow_map:pass=mesh", says=["shadow_map.pass = mesh", "fragment | compute"])
        # A blend wider than a slice.
        for value in ("1.5", "-0.1"):
            self.refuse_run("--scene", "soup", "--technique", f"cascaded_map:blend={value}",
                            says=[f"cascaded_map.blend = {value} is outside 0 .. 1"])
        self.refuse_run("--scene", "soup", "--technique", "shadow_map:resolution", says=["'resolution'", "parameter=value"])
        self.refuse_run("--scene", "soup", "--technique", "shadow_map:resolution=64,resolution=128", says=["resolution", "twice"])
        self.refuse_run("--scene", "soup", "--technique", "shadow_map:resolution={64,128", says=["opens a brace"])
        self.refuse_run("--scene", "soup:count=-5", "--technique", "unshadowed", says=["soup.count = -5", "1 .. 1000000"])

    def test_sizes_are_two_numbers_of_pixels(self):
        for size in ("0x0", "100000x100000", "12", "axb", "12x", "-4x4", "4x4x4"):
            self.refuse_run(*ANY, "--size", size, says=[f"--size {size}", "1 .. 16384"])
        for command in ("render", "certify"):
            rest = [*ANY[2:], "--out", "out"] if command == "render" else []
            self.refuse(command, *ANY[:2], *rest, "--size", "0x5", says=["--size 0x5", "1 .. 16384"])

    def test_numbers_of_threads_repetitions_shards_and_seconds(self):
        self.refuse_run(*ANY, "--threads", "10000", says=["--threads 10000", "cores"])
        self.refuse_run(*ANY, "--threads", "-1", says=["--threads -1", "cores"])
        self.refuse_run(*ANY, "--threads", "few", says=["--threads", "few"])
        self.refuse_run(*ANY, "--repetitions", "0", says=["--repetitions", "0"])
        self.refuse_run(*ANY, "--processes", "1000000", says=["--processes", "1000000", "1000"])
        for shard in ("3/2", "2/2", "-1/2", "0/0", "1", "1/2/3"):
            self.refuse_run(*ANY, "--shard", shard, says=[f"--shard {shard}", "0 <= I < N"])
        for timeout in ("0", "-5", "nan", "soon"):
            self.refuse_run(*ANY, "--timeout", timeout, says=["--timeout", timeout, "above 0"])

    def test_words_that_do_not_go_together(self):
        self.refuse_run(says=["needs a suite", "quick", "--scene"])
        self.refuse_run("--scene", "soup", says=["--technique"])
        self.refuse_run("quick", *ANY, says=["not both"])
        self.refuse("run", *ANY, "--resume", says=["--resume needs --out"])
        self.refuse_run(*ANY, "--truth", "shap", says=["--truth shap", "shape", "mesh"])
        self.refuse_run(*ANY, "--filter", "(", says=["--filter (", "no regular expression"])
        self.refuse_run(*ANY, "--filter", "moon", says=["--filter moon", "matches no row", "single_triangle point unshadowed"])
        self.refuse("render", *ANY, says=["--out"])
        self.refuse("table", "nowhere", says=["nowhere", "records.jsonl"])
        self.refuse("--plugin", "nowhere.so", "list", says=["nowhere.so"])

    def test_render_refuses_and_leaves_no_folder(self):
        for arguments, says in [
            ([*ANY, "--light", "pint"], ["light pint", "did you mean point?"]),
            ([*ANY, "--view", "vew"], ["view vew", "did you mean view?"]),
            ([*ANY, "--debug", "x"], ["unshadowed", "debug layer x"]),
            ([*ANY[:2], "--technique", "shadow_map:resolution={256,512}"], ["sweep of 2", "render takes one"]),
        ]:
            with self.subTest(" ".join(arguments)):
                self.refuse("render", *arguments, "--out", "deep/out", says=says)
                self.assertFalse((self.dir / "deep/out").exists())

    def test_render_of_what_is_not_supported_gives_the_reason_and_no_files(self):
        scene = self.write("lamp.toml", scene_toml('[[light]]\nname = "lamp"\nkind = "sphere"\ncenter = [0, 2, 0]\nradius = 0.5\n',
                                                  '[[view]]\nname = "eye"\neye = [0, 5, 9]\ntarget = [0, 0, 0]\n'))
        self.refuse("render", "--scene", scene.name, "--technique", "shadow_map", "--size", "64x64", "--out", "out",
                    says=["shadow_map does not support", "lamp", "area"])
        self.assertEqual([p.name for p in self.dir.iterdir()], ["lamp.toml"])
        self.succeed("run", "--scene", scene.name, "--technique", "shadow_map", *NUMBERS, "--out", "row")  # there it is an answer
        row = records(self.dir / "row")[0]
        self.assertEqual((row["status"], "area" in row["reason"]), ("unsupported", True))


class Files(ProgramTest):
    def refuse_scene(self, name, says):
        with self.subTest(name):
            self.refuse("run", "--technique", "unshadowed", "--out", "out", "--scene", name, says=says)
            self.assertFalse((self.dir / "out").exists())

    def test_files_that_are_not_there(self):
        for name in ("gone.ply", "gone.toml", "./gone"):
            self.refuse_scene(name, [name, "does not exist"])
        for command in (["render", "--technique", "unshadowed", "--out", "out"], ["certify"]):
            self.refuse(*command, "--scene", "gone.ply", says=["gone.ply", "does not exist"])
        self.refuse("describe", "gone.ply", says=["gone.ply", "does not exist"])
        self.assertFalse((self.dir / "out").exists())
        self.write("scene.toml", '[[mesh]]\nfile = "gone.ply"\n')
        self.refuse_scene("scene.toml", ["gone.ply", "does not exist", "scene.toml:2"])
        self.refuse("run", "gone.toml", says=["gone.toml"])

    def test_truncated_meshes(self):
        for ending in ("ply", "stl", "glb", "gltf", "off"):
            whole = (DATA / f"tetrahedron.{ending}").read_bytes()
            for share in (0.5, 0.93):
                name = self.write(f"cut{int(100 * share)}.{ending}", whole[:int(share * len(whole))]).name
                self.refuse_scene(name, [name])
        self.refuse_scene(self.write("empty.obj", b"").name, ["empty.obj", "empty"])

    def test_numbers_that_are_none_and_indices_of_nothing(self):
        obj, ply = ((DATA / f"tetrahedron.{ending}").read_text() for ending in ("obj", "ply"))
        self.write("nan.obj", obj.replace("\nv 1 0 0", "\nv nan 0 0"))
        self.refuse_scene("nan.obj", ["nan.obj", "vertex", "nan"])
        self.write("huge.ply", ply.replace("\n1 0 0", "\n1e39 0 0"))
        self.refuse_scene("huge.ply", ["huge.ply", "vertex 1"])
        self.write("index.ply", ply.replace("\n3 0 1 3", "\n3 0 1 4"))
        self.refuse_scene("index.ply", ["index.ply", "4"])
        self.write("index.obj", obj.replace("\nf 2 3 4", "\nf 2 3 5"))
        self.refuse_scene("index.obj", ["index.obj", "index", "range"])
        self.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        self.refuse_scene("flat.obj", ["flat.obj", "no geometry"])

    def test_descriptions_name_file_line_and_the_nearest_key(self):
        light, view = '[[light]]\nname = "l"\n', '[[view]]\nname = "v"\n'  # lines 8, 9 and on: the floor takes 1 .. 5
        for name, text, says in [
            ("key.toml", scene_toml(light + 'kind = "point"\npositon = [0, 1, 0]\n'),
             ["positon", "did you mean 'position'?", "key.toml:10"]),
            ("kind.toml", scene_toml(light + 'kind = "pint"\n'), ["pint", "did you mean point?", "kind.toml:9"]),
            ("zero.toml", scene_toml(light + 'kind = "disc"\ncenter = [0, 1, 0]\nnormal = [0, 1, 0]\nradius = 0\n'),
             ["radius = 0", "zero.toml:12"]),
            ("area.toml", scene_toml(light + 'kind = "rect"\ncenter = [0, 1, 0]\nhalf_u = [1, 0, 0]\nhalf_v = [2, 0, 0]\n'),
             ["half_u and half_v", "area.toml:7"]),
            ("eye.toml", scene_toml("", view + "eye = [1, 1, 0]\ntarget = [1, 1, 0]\n"), ["eye = target = (1, 1, 0)", "eye.toml:8"]),
            ("type.toml", scene_toml(light + 'kind = "point"\nposition = "up"\n'), ["position", "a text", "type.toml:10"]),
            ("nothing.toml", 'name = "nothing"\n', ["no geometry", "nothing.toml"]),
            ("syntax.toml", "name = = 3\n", ["syntax.toml:1"]),
        ]:
            self.write(name, text)
            self.refuse_scene(name, says)

    def test_descriptions_that_start_from_a_scene_that_cannot_be(self):
        self.write("a.toml", 'scene = "b.toml"\n')
        self.write("b.toml", '\nscene = "a.toml"\n')
        self.write("typo.toml", scene_toml('[[light]]\nname = "l"\nkind = "pint"\n'))
        for name, text, says in [
            ("type.toml", "scene = true\n", ["scene.scene = a truth value is not a text", "type.toml:1"]),
            ("id.toml", '\nscene = "single_triangl"\n', ["did you mean single_triangle?", "(named in id.toml:2)"]),
            ("value.toml", 'scene = "soup:count=-5"\n', ["soup.count = -5", "1 .. 1000000", "(named in value.toml:1)"]),
            ("gone.toml", 'scene = "none.ply"\n', ["none.ply", "does not exist", "(named in gone.toml:1)"]),
            ("below.toml", 'scene = "typo.toml"\n', ["did you mean point?", "typo.toml:9", "(named in below.toml:1)"]),
            ("chain.toml", 'scene = "a.toml"\n', ["a.toml names b.toml names a.toml", "(named in b.toml:2)"]),
        ]:
            self.write(name, text)
            self.refuse_scene(name, says)

    def test_suites_name_file_line_and_the_nearest_key(self):
        group = '[[group]]\nscenes = ["soup"]\n'
        for text, says in [
            ("widht = 5\n" + group + 'techniques = ["unshadowed"]\n', ["widht", "did you mean 'width'?", "s.toml:1"]),
            ("width = 0\n" + group + 'techniques = ["unshadowed"]\n', ["width = 0", "1 .. 16384", "s.toml:1"]),
            (group + 'techniques = ["unshadoved"]\n', ["unshadoved", "did you mean unshadowed?", "s.toml:3"]),
            (group + 'techniques = [{ use = "shadow_map", lable = "x" }]\n', ["lable", "did you mean 'label'?", "s.toml:3"]),
            (group, ["techniques", "s.toml:1"]),
            ("", ["s.toml", "[[group]]"]),
        ]:
            with self.subTest(text):
                self.write("s.toml", text)
                self.refuse("run", "s.toml", "--out", "out", says=says)
                self.assertFalse((self.dir / "out").exists())

    def test_records_that_are_broken_name_file_and_line(self):
        self.succeed("run", *ANY, "--light", "sun", *NUMBERS, "--out", "out")
        line = (self.dir / "out/records.jsonl").read_text()
        self.write("out/records.jsonl", line + "not a record\n" + line)
        self.refuse("table", "out", says=["out/records.jsonl:2"])


if __name__ == "__main__":
    unittest.main()
