#!/usr/bin/python3 -IB
"""Casters with holes in POV-Ray and Cycles: each says before it renders what it cannot do, and draws the rest as the reference has it."""

import base64
import json
import os
import shutil
import struct
import sys
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, ProgramTest, records  # noqa: E402

WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071}  # of a sampler of glTF
SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))  # uv of a card's corners
FAKE = "#!/bin/bash\ntouch \"$GNOMON_FAKE_PLACE/started\"\nexit 1\n"


def png(rows):
    """Gray and alpha of 8 bits: alpha is 255 where a row has a #."""
    data = b"".join(b"\0" + bytes(value for texel in row for value in (255, 255 if texel == "#" else 0)) for row in rows)
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 4, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(data)) + chunk(b"IEND", b"")


def gltf(*cards, rows=("#..", "##.", ".##", "#.#", "###"), glass=None):
    """Cards above a ground under a sun; each is a name, the wraps of its textures, and the uv of its four corners. Each has the mask
    of `rows`, unless there are none, and lets through what the PNG `glass` says, if it is given."""
    data, views, accessors, meshes, nodes, materials, textures, samplers = bytearray(), [], [], [], [], [{}], [], []

    def stored(values, kind, component=5126):
        flat = [float(x) for value in values for x in value] if component == 5126 else list(values)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 4 * len(flat)})
        data.extend(struct.pack(f"<{len(flat)}{'f' if component == 5126 else 'I'}", *flat))
        limits = {name: [pick(axis) for axis in zip(*values)] for name, pick in (("min", min), ("max", max))} if kind == "VEC3" else {}
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(values), "type": kind, **limits})
        return len(accessors) - 1

    def mesh(name, corners, uv=None, material=0):
        attributes = {"POSITION": stored(corners, "VEC3")} | ({"TEXCOORD_0": stored(uv, "VEC2")} if uv else {})
        triangles = stored((0, 1, 2, 0, 2, 3), "SCALAR", 5125)
        meshes.append({"name": name, "primitives": [{"attributes": attributes, "indices": triangles, "material": material}]})
        nodes.append({"mesh": len(meshes) - 1, "name": name})

    def material(texture):
        masked = {"alphaMode": "MASK", "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": texture}}}
        clear = {"KHR_materials_transmission": {"transmissionFactor": 1, "transmissionTexture": {"index": texture + 1}}}
        return (masked if rows else {"pbrMetallicRoughness": {"metallicFactor": 0}}) | ({"extensions": clear} if glass else {})

    half = len(cards) / 2 + 1
    mesh("ground", ((-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)))
    for k, (name, wrap_u, wrap_v, uv) in enumerate(cards):
        samplers.append({"wrapS": WRAPS[wrap_u], "wrapT": WRAPS[wrap_v]})
        textures.extend({"source": source, "sampler": k} for source in (0, 1))
        materials.append(material(2 * k))
        left, right = k - len(cards) / 2 + 0.0625, k - len(cards) / 2 + 0.9375
        mesh(name, ((left, 0.5, 0.4375), (right, 0.5, 0.4375), (right, 0.75, -0.4375), (left, 0.75, -0.4375)), uv, k + 1)
    sun, back = {"type": "directional", "intensity": 1}, {"rotation": [-0.6, 0.1, 0, 0.8], "extensions": {"KHR_lights_punctual": {"light": 0}}}
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    images = [{"uri": "data:image/png;base64," + base64.b64encode(image).decode()} for image in (png(rows or ("#",)), glass or png("#"))]
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes) + 1))}], "nodes": [*nodes, back], "meshes": meshes,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data), "uri": uri}], "materials": materials,
        "textures": textures, "samplers": samplers, "images": images,
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_transmission"],
        "extensions": {"KHR_lights_punctual": {"lights": [sun]}}})


class EngineMasks(ProgramTest):
    def setUp(self):
        super().setUp()
        (self.dir / "bin").mkdir()
        for name in ("povray", "blender"):
            (self.dir / "bin" / name).write_text(FAKE)
            (self.dir / "bin" / name).chmod(0o755)
        self.fakes = dict(self.environment, PATH=f"{self.dir}/bin:/usr/bin:/bin", GNOMON_FAKE_PLACE=str(self.dir))

    def run_on(self, technique, scene, *more, status=0):
        """The one row's record."""
        out = self.dir / "run"
        shutil.rmtree(out, ignore_errors=True)
        self.succeed("run", "--scene", scene, "--technique", technique, "--truth", "mesh", *NUMBERS, *more, "--quiet", "--out", out, status=status)
        (record,) = records(out)
        return record

    def test_what_cannot_be_drawn_is_unsupported_and_nothing_starts(self):
        self.environment = self.fakes
        sound = ("sound", "repeat", "repeat", SQUARE)
        for technique, card, says in (
            ("cycles", ("u_only", "clamp", "repeat", SQUARE), "the alpha mask of mesh 'u_only' has wrap clamp along u and repeat along v"),
            ("cycles", ("v_only", "mirror", "clamp", SQUARE), "the alpha mask of mesh 'v_only' has wrap mirror along u and clamp along v"),
            # 5462 copies of 3 texels are 16386 pixels, from copy -1 to before copy 5461.
            ("pov_ray", ("wide", "clamp", "repeat", ((-0.5, 0), (5460.5, 0), (5460.5, 1), (-0.5, 1))),
             "the alpha mask of mesh 'wide' has 3 texels along u and wrap clamp; POV-Ray needs a picture of 16386 pixels"),
            # 3277 copies of 5 texels are 16385 pixels.
            ("pov_ray", ("tall", "repeat", "clamp", ((0, 0), (0, 3276.5), (1, 3276.5), (1, 0))),
             "the alpha mask of mesh 'tall' has 5 texels along v and wrap clamp; POV-Ray needs a picture of 16385 pixels"),
            ("pov_ray", ("line", "repeat", "repeat", ((0, 0), (1, 1), (0, 1), (0, 0.5))), "the uv of triangle 1 of mesh 'line' lie on a line"),
            ("pov_ray", ("bent", "repeat", "repeat", ((0, 0), (1, 1), (0, 1), (0.25, 0.75))), None),  # starts, and fails as the fake does
        ):
            with self.subTest(f"{technique} {card}"):
                record = self.run_on(technique, self.write("cards.gltf", gltf(sound, card)), status=0 if says else 1)
                self.assertEqual(record["status"], "unsupported" if says else "failed", record)
                self.assertIn(says or "POV-Ray of unknown version", record["reason"])
                self.assertEqual((self.dir / "started").exists(), not says)
                (self.dir / "started").unlink(missing_ok=True)

    def test_the_rest_is_drawn_as_the_reference_has_it(self):
        self.environment["PATH"] = os.environ["PATH"]
        wide = ((-1.25, -1.5), (2.25, -1.5), (2.25, 1.75), (-1.25, 1.75))
        cards = [(f"{u}_{v}", u, v, wide) for u, v in (("repeat", "repeat"), ("repeat", "mirror"), ("mirror", "mirror"), ("clamp", "clamp"))]
        # All of a card is in one texel: of row 0 the first is solid, the second is a hole. v = 0 is the upper border of row 0, and
        # clamp continues the row beyond it.
        cards.append(("solid", "mirror", "repeat", ((0.5 / 3, 0.5 / 5),) * 4))
        border = ("border", "repeat", "clamp", ((0.5, 0),) * 4)
        for technique, program, some in (("pov_ray", "povray", [*cards, border]), ("cycles", "blender", cards)):
            if not shutil.which(program):
                continue
            with self.subTest(technique):
                scene = self.write("cards.gltf", gltf(*some))
                wrong = self.run_on(technique, scene)["metrics"]["mesh"]["wrong_rate"]
                # Of 14400 pixels none may be wrong but two at edges of texels, where float32 decides.
                self.assertLessEqual(wrong, 2e-4)
                lit = self.run_on("unshadowed", scene)["metrics"]["mesh"]["wrong_rate"]
                self.assertGreater(lit, 0.02)

    @unittest.skipUnless(shutil.which("blender"), "there is no Blender")
    def test_light_passes_300_holes_in_cycles(self):
        # 300 cards, one above the other, are solid on the left and open on the right: light and view pass all of them there.
        self.environment["PATH"] = os.environ["PATH"]
        self.write("half.png", png(["#."]))
        self.write("half.mtl", "newmtl card\nmap_d half.png\n")
        ground, square = ((-3, -3), (3, -3), (3, 3), (-3, 3)), ((-1, -1), (1, -1), (1, 1), (-1, 1))
        points = [(x, 0, z) for x, z in ground] + [(x, 1 + k / 1000, z) for k in range(300) for x, z in square]
        lines = ["mtllib half.mtl", *(f"v {x} {y} {z}" for x, y, z in points), "vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "o ground", "f 1 2 3 4",
                 "o cards", "usemtl card", *(f"f {k}/1 {k + 1}/2 {k + 2}/3 {k + 3}/4" for k in range(5, len(points), 4))]
        record = self.run_on("cycles", self.write("stack.obj", "\n".join(lines) + "\n"), "--light", "sun")
        self.assertEqual(record["metrics"]["mesh"]["wrong_rate"], 0)


if __name__ == "__main__":
    unittest.main()
