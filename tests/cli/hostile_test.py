#!/usr/bin/python3 -IB
"""Input made to harm: refused at once, in one line, without taking memory for what is not there."""

import os
import resource
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import SANITIZED, ProgramTest  # noqa: E402

ANY = ["--scene", "single_triangle", "--technique", "unshadowed"]
SECONDS = 20 if SANITIZED else 2  # of processor time, which other work on the machine does not lengthen by much
MEGABYTES = 2000 if SANITIZED else 500  # that are resident, of the program or of a process that it started


def png(width, height):
    """The head of a picture of this size, and nothing behind it."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")


class Hostile(ProgramTest):
    def gnomon(self, *arguments, **options):
        """As ever, and measures what it took, with all processes that it started."""
        with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as complaint:
            run = subprocess.Popen(self.command(*arguments), cwd=self.dir, env=self.environment, stdout=output, stderr=complaint,
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (240, 240)), **options)
            _, status, self.used = os.wait4(run.pid, 0)
            run.returncode = os.waitstatus_to_exitcode(status)
            output.seek(0)
            complaint.seek(0)
            return subprocess.CompletedProcess(run.args, run.returncode, output.read(), complaint.read())

    def assert_little_was_used(self):
        self.assertLess(self.used.ru_utime + self.used.ru_stime, SECONDS)
        self.assertLess(self.used.ru_maxrss, MEGABYTES * 1000)

    def refuse_at_once(self, *arguments, says):
        with self.subTest(" ".join(map(str, arguments))[:200]):
            self.refuse(*arguments, says=says)
            self.assert_little_was_used()

    def test_keys_and_brackets_that_nest_without_end(self):
        deep = self.write("deep.toml", "ambient = 0.1\n" + ".".join(["a"] * 35_000) + " = 1\n")
        self.refuse_at_once("render", "--scene", deep, "--technique", "unshadowed", "--out", "out", says=["deep.toml:2", "101 parts"])
        self.refuse_at_once("run", deep, "--out", "out", says=["deep.toml:2", "101 parts"])
        header = self.write("header.toml", "[" + ".".join(["a"] * 35_000) + "]\n")
        self.refuse_at_once("run", header, "--out", "out", says=["header.toml:1", "101 parts"])
        (self.dir / "run").mkdir()
        self.write("run/records.jsonl", "[" * 60_000 + "]" * 60_000 + "\n")
        self.refuse_at_once("table", "run", says=["records.jsonl:1", "nest deeper than 200"])

    def test_dots_in_texts_and_comments_are_no_keys(self):
        dots = "." * 500
        file = self.write("dots.toml", f"name = '{dots}'  # {dots}\nscene = \"single_triangle\" # \"{dots}\n")
        self.succeed("render", "--scene", file, "--technique", "unshadowed", "--size", "16x16", "--light", "point", "--out", "out")

    def test_places_beyond_what_can_be_traced(self):
        for what in ("position = [0, 2e18, 0]", "position = [0, 2e17, 0]", "position = [0, -1e30, 0]"):
            far = self.write("far.toml", f'scene = "single_triangle"\n[[light]]\nname = "far"\nkind = "point"\n{what}\n')
            self.refuse_at_once("render", "--scene", far, "--technique", "unshadowed", "--out", "out", says=["far.toml:", "position = ", "1e17"])

    def test_places_as_far_as_they_may_be(self):
        eye = '[[view]]\nname = "v"\neye = [9e16, 8e16, 9e16]\ntarget = [0, 0, 0]\n'
        point = '[[light]]\nname = "a"\nkind = "point"\nposition = [-9e16, 9e16, 9e16]\n'
        sun = '[[light]]\nname = "b"\nkind = "directional"\ndirection = [-9e16, -9e16, 9e16]\n'
        ball = '[[shape]]\nkind = "sphere"\ncenter = [9e16, -9e16, 9e16]\nradius = 9e16\n'
        floor = '[[shape]]\nkind = "plane"\ncenter = [0, -9e16, 0]\nnormal = [0, 1, 0]\nsize = [9e16, 9e16]\n'
        scene = self.write("large.toml", ball + floor + point + sun + eye)
        for technique in ("embree_rays", "exact_rays", "unshadowed"):
            for light in "ab":
                done = self.gnomon("render", "--scene", scene, "--technique", technique, "--light", light, "--size", "32x18",
                                   "--out", f"{technique}_{light}")
                self.assertIn(done.returncode, (0, 2), f"{technique} {light}\n{done.stdout}{done.stderr}")
        self.assertIn(self.gnomon("certify", "--scene", scene, "--size", "32x18").returncode, (0, 1, 2))

    def test_filters_that_double_with_every_letter(self):
        done = self.gnomon("run", "quick", "--dry-run", "--filter", "(.*)*x$")
        self.assertIn(done.returncode, (0, 2), done.stderr)
        self.assert_little_was_used()
        self.refuse_at_once("run", *ANY, "--out", "out", "--filter", "(" * 30_000, says=["--filter", "30000", "1000"])

    def test_braces_that_double_with_every_brace(self):
        self.refuse_at_once("run", "--scene", "single_triangle", "--technique", "shadow_map:" + "{a,b}" * 30, "--out", "out",
                            says=["1073741824", "100000"])

        one = self.write("one.toml", '[[group]]\nscenes = ["single_triangle"]\ntechniques = ["shadow_map:' + "{a}" * 100_000 + '"]\n')
        self.refuse_at_once("run", one, "--out", "out", says=["one.toml:3", "300011 characters", "2000"])
        alike = "shadow_map:resolution={" + ",".join(["512"] * 300) + "},depth_bias={" + ",".join(["0"] * 300) + "}"
        self.refuse_at_once("run", "--scene", "none", "--technique", alike, "--out", "out", says=["scene none"])

    def test_names_and_tables_without_number(self):
        long = self.write("long.toml", "a" * 2_000_000 + " = 1\n")
        self.refuse_at_once("run", long, "--out", "out", says=["suite has no key", " ... ", "long.toml:1"])
        light = '[[light]]\nname = "a{}"\nkind = "point"\nposition = [0, 1, 0]\n'
        lights = self.write("lights.toml", "".join(light.format(k) for k in range(20_000)))
        self.refuse_at_once("describe", lights, says=["lights.toml", "20000 tables", "10000"])

    def test_a_kind_that_is_no_text(self):
        for what in ("shape", "light"):
            scene = self.write("kind.toml", f"[[{what}]]\nkind = 1\n")
            self.refuse_at_once("describe", scene, says=[f"{what}.kind = a number is not a text", "kind.toml:2"])

    def test_what_a_message_quotes_does_nothing_to_the_terminal(self):
        self.refuse_at_once("run", "--scene", "single_triangle", "--technique", "bad\x1b[31m\nname", "--out", "out",
                            says=["bad\\x1b[31m\\x0aname"])
        (self.dir / "run").mkdir()
        self.write("run/records.jsonl", "{}}\n")
        self.refuse_at_once("table", "run", says=["records.jsonl:1"])
        self.assertNotIn("json.exception", self.gnomon("table", "run").stderr)

    def test_numbers_that_no_integer_holds(self):
        for shard in ("0/99999999999999", "99999999999999/99999999999999", "0/", "/2", "0/2x", " 0/2", ""):
            self.refuse_at_once("run", *ANY, "--out", "out", f"--shard={shard}" if shard else "--shard=x", says=["--shard", "I/N"])

    def test_files_with_a_dot_that_are_not_ours_stay(self):
        arguments = ["run", *ANY, "--light", "sun", "--processes", "1", "--repetitions", "1", "--size", "16x16", "--out", "out"]
        self.succeed(*arguments)
        mine = [self.write(f"out/masks/{name}", "mine") for name in (".notes", ".part", ".git")]
        left = self.write("out/masks/.123.part.exr", "half a picture")
        self.succeed(*arguments, "--resume")
        self.assertTrue(all(file.exists() for file in mine))
        self.assertFalse(left.exists())

    def test_what_never_ends(self):
        os.mkfifo(self.dir / "pipe.toml")
        os.mkfifo(self.dir / "pipe.exr")
        pipe = self.dir / "pipe.toml"
        self.refuse_at_once("run", pipe, "--out", "out", says=["pipe.toml", "is not a file"])
        self.refuse_at_once("render", "--scene", pipe, "--technique", "unshadowed", "--out", "out", says=["pipe.toml", "is not a file"])
        for file in (self.dir / "pipe.exr", "/dev/zero"):
            self.refuse_at_once("score", "--scene", "single_triangle", "--mask", file, says=[str(file), "is not a file"])

    def test_pictures_that_claim_more_than_they_hold(self):
        self.refuse_at_once("score", "--scene", "single_triangle", "--light", "point", "--mask", self.write("large.png", png(16384, 16384)),
                            says=["large.png", "16384x16384", "truncated"])
        self.refuse_at_once("score", "--scene", "single_triangle", "--light", "point", "--mask", self.write("huge.png", png(200_000, 2)),
                            says=["huge.png", "200000x2", "1 .. 16384"])

    def test_indices_that_no_vertex_has(self):
        for index in (-1, 3, 4294967296):
            mesh = self.write("index.off", f"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 {index}\n")
            self.refuse_at_once("render", "--scene", mesh, "--technique", "unshadowed", "--out", "out",
                                says=["index.off:6", f"vertex {index}", "0 .. 2"])

    def refuse_mesh(self, name, content, says):
        self.refuse_at_once("describe", self.write(name, content), says=[name, *says])

    def test_indices_of_ply_that_no_vertex_has(self):
        head = ("ply\nformat {} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                "element face 1\nproperty list uchar {} vertex_indices\nend_header\n")
        for index in (-1, 3, 4294967296):
            text = head.format("ascii", "int") + f"0 0 0\n1 0 0\n0 1 0\n3 0 1 {index}\n"
            self.refuse_mesh("a.ply", text, ["a.ply:13", "face 0", f"vertex {index}", "0 .. 2"])
        corners = (0, 0, 0, 1, 0, 0, 0, 1, 0)
        for order, letter in (("little", "<"), ("big", ">")):
            for kind, format_of, index in (("int", "i", -1), ("int", "i", 3), ("uint", "I", 4294967295), ("double", "d", 4294967296.0),
                                           ("short", "h", -1), ("uchar", "B", 255)):
                body = struct.pack(f"{letter}9fB3{format_of}", *corners, 3, *map(type(index), (0, 1)), index)
                binary = head.format(f"binary_{order}_endian", kind).encode() + body
                self.refuse_mesh("b.ply", binary, ["face 0", f"vertex {index:.0f}", "0 .. 2"])
        self.succeed("describe", self.write("good.ply", head.format("ascii", "int") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"))
        missing = head.format("ascii", "int") + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n"
        self.refuse_mesh("m.ply", missing, ["m.ply:11", "vertex 1 ends after 2 numbers"])

    def test_indices_of_3ds_and_obj_that_no_vertex_has(self):
        def chunk(name, body):
            return struct.pack("<HI", name, 6 + len(body)) + body

        def triangle(last, vertices=3):
            mesh = (chunk(0x4110, struct.pack("<H9f", vertices, 0, 0, 0, 1, 0, 0, 0, 1, 0)) +
                    chunk(0x4120, struct.pack("<H4H", 1, 0, 1, last, 7)))
            return chunk(0x4d4d, chunk(0x3d3d, chunk(0x4000, b"tri\0" + chunk(0x4100, mesh))))
        self.succeed("describe", self.write("good.3ds", triangle(2)))
        self.refuse_mesh("index.3ds", triangle(60000), ["mesh 'tri'", "face 0", "vertex 60000", "0 .. 2"])
        self.refuse_mesh("short.3ds", triangle(2, 60000), ["60000 items", "truncated"])
        corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
        for index in (4, 0, -4, 4294967297, -9223372036854775808, 9223372036854775808):
            self.refuse_mesh("index.obj", corners + f"f 1 2 {index}\n", ["index.obj:4", f"vertex {index}", "1 .. 3"])

    def test_meshes_that_name_what_never_ends(self):
        os.mkfifo(self.dir / "pipe.mtl")
        mesh = self.write("a.obj", "mtllib pipe.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.succeed("describe", mesh)
        self.assert_little_was_used()

    def test_faces_of_more_corners_than_can_be_split(self):
        count = 300_000
        ring = "".join(f"{k} {k * k % 1000} 0\n" for k in range(count))
        mesh = self.write("ring.off", f"OFF\n{count} 1 0\n{ring}{count} {' '.join(map(str, range(count)))}\n")
        self.refuse_at_once("render", "--scene", mesh, "--technique", "unshadowed", "--out", "out", says=["300000 corners", "10000"])

    def test_meshes_that_claim_more_than_they_hold(self):
        head = "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n"
        for name, body in [("none.ply", "end_header\n"), ("one.ply", "property float x\nend_header\n")]:
            mesh = self.write(name, head + body)
            self.refuse_at_once("render", "--scene", mesh, "--technique", "unshadowed", "--out", "out",
                                says=[name, "18446744073709551615", "truncated"])
        for name, element, says in [("lists.ply", b"tag", "truncated"), ("faces.ply", b"face", "vertex_indices")]:
            lists = self.write(name, b"ply\nformat binary_little_endian 1.0\nelement " + element + b" 2\nproperty list uint double v\n"
                               b"end_header\n" + b"\xff\xff\xff\xff" + b"0" * 8)
            self.refuse_at_once("render", "--scene", lists, "--technique", "unshadowed", "--out", "out", says=[name, says])


if __name__ == "__main__":
    unittest.main()
