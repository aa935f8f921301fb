#!/usr/bin/python3 -I
"""Tests of mesh_count.py: small files, each with a triangle or two that are known."""

import base64
import json
import struct
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import mesh_count

TRIANGLE = "0 0 0\n1 0 0\n0 2 0\n"
FLOATS = (0, 0, 0, 1, 0, 0, 0, 2, 0)
POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0], [1, 2, 0]], "f4")
COMPONENTS = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


def ply_head(form, elements):
    return f"ply\nformat {form} 1.0\ncomment x\n{elements}end_header\n"


VERTICES = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
FACE = "element face 1\nproperty list uchar uint vertex_indices\n"


def gltf(arrays, primitive, is_binary=False, mesh=None, **top):
    """A file of these accessors, each an array or one with more keys, and of one mesh that node 0 shows."""
    data, views, accessors = b"", [], []
    for array in arrays:
        array, keys = array if isinstance(array, tuple) else (array, {})
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        kind = TYPES[array.shape[1] if array.ndim > 1 else 1]
        accessors.append({"bufferView": len(views) - 1, "componentType": COMPONENTS[array.dtype.name], "count": len(array), "type": kind} | keys)
        data += array.tobytes() + b"\0" * (-array.nbytes % 4)
    entries = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "accessors": accessors, "bufferViews": views,
               "meshes": [{"primitives": [{"attributes": {"POSITION": 0}} | primitive]} | (mesh or {})], "buffers": [{"byteLength": len(data)}]} | top
    if not is_binary:
        entries["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        return json.dumps(entries)
    text = json.dumps(entries).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4s2I", b"glTF", 2, 28 + len(text) + len(data))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data


class MeshCount(unittest.TestCase):
    def check(self, suffix, content, triangles, largest):
        """How many triangles the file has, and the largest coordinates; (None, reason) where it is refused."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "a" + suffix)
            file.write_bytes(content if isinstance(content, bytes) else content.encode())
            found = mesh_count.count(file)
        if triangles is None:
            self.assertIn(largest, found.get("refused", "it is read"), content[:200])
        else:
            self.assertEqual((found.get("triangles"), found.get("bounds", {}).get("max")), (triangles, largest), f"{content[:200]} {found}")

    def test_off_in_all_its_variants(self):
        for text in ("OFF\n3 1 3\n" + TRIANGLE + "3 0 1 2\n", "OFF 3 1 3\n" + TRIANGLE + "3 0 1 2 # x\n", "OFF3 1 3\n" + TRIANGLE + "3 0 1 2 255 0 0\n",
                     "# x\n3 1\n" + TRIANGLE + "3 0 1 2", "OFF\n3 1\n3\n" + TRIANGLE + "3 0 1 2\n", "nOFF\n2\n3 1 3\n0 0\n1 0\n0 2\n3 0 1 2\n",
                     "STCN4OFF\n3 1 3\n0 0 0 2 0 0 1 1 1 1 1 0 0\n2 0 0 2 0 0 1 1 1 1 1 0 0\n0 4 0 2 0 0 1 1 1 1 1 0 0\n3 0 1 2\n",
                     "4nOFF\n4\n3 1 3\n0 0 0 9 2\n2 0 0 9 2\n0 4 0 9 2\n3 0 1 2\n", "OFF\n3 1 3 0 0 0\n1 0 0 0 2 0 3 0 1 2\n",
                     "COFF 3 1 3 0 0 0 1 1 1 1  1 0 0 1 1 1 1\n0 2 0 1 1 1 1 3 0 1 2\n"):
            self.check(".off", text, 1, [1, 2, 0])
        vertices = struct.pack(">21f", 0, 0, 0, 1, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 0, 2, 0, 1, 1, 1, 1)
        binary = b"COFF BINARY\n" + struct.pack(">3i", 3, 1, 0) + vertices + struct.pack(">5i", 3, 0, 1, 2, 2) + struct.pack(">2f", 1, 1)
        self.check(".off", binary, 1, [1, 2, 0])
        self.check(".off", "OFF\n3 1 3\n" + TRIANGLE + "3 0 1 3\n", None, "a vertex that is not there")

    def test_stl_as_text_and_as_bytes(self):
        text = "  SOLID x\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nvertex 0 2 0\nENDLOOP\nENDFACET\nENDSOLID\n"
        self.check(".stl", text, 1, [1, 2, 0])
        self.check(".stl", text.replace("ENDSOLID", ""), None, "no endsolid")
        self.check(".stl", b"solid" + b" " * 75 + struct.pack("<I12fH", 1, 0, 0, 0, *FLOATS, 0), 1, [1, 2, 0])
        self.check(".stl", bytes(80) + struct.pack("<I12fH", 2, 0, 0, 0, *FLOATS, 0), None, "shorter")

    def test_obj_with_all_that_a_line_may_have(self):
        text = "v 0 0 0\nv 1 0 0 # x\nv 0 2 0 0.5\nf -3/1 \\\n-2// -1/2/3\nl 1 2\np 1\nf 1 2\nf 1 1 2 3 3\n"
        self.check(".obj", text, 2, [1, 2, 0])
        self.check(".obj", text.encode("utf-16"), 2, [1, 2, 0])
        self.check(".obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 2 0\n", 1, [1, 2, 0])
        self.check(".obj", "v 0 0 0\nv 1 0 0\nf -3 -2 -1\nv 0 2 0\n", None, "a vertex that is not there")

    def test_ply_of_any_order_of_elements(self):
        faces_first = "element face 1\nproperty list uchar int vertex_index\nproperty float q\n"
        vertices = "element vertex 3\nproperty uchar r\nproperty double z\nproperty float x\nproperty float y\n"
        self.check(".ply", ply_head("ascii", faces_first + vertices) + "3 0 1 2 7\n1 0 0 0\n1 0 1 0\n1 0 0 2\n", 1, [1, 2, 0])
        self.check(".ply", ply_head("ascii", VERTICES + FACE).replace("\n", "\r\n") + TRIANGLE + "3 0 1 2", 1, [1, 2, 0])
        body = struct.pack("<9fB3I", *FLOATS, 3, 0, 1, 2)
        self.check(".ply", ply_head("binary_little_endian", VERTICES + FACE).replace("\n", "\r").encode() + body, 1, [1, 2, 0])
        self.check(".ply", ply_head("binary_little_endian", VERTICES + FACE).encode() + body[:-1], None, "buffer")

    def test_ply_of_both_orders_of_bytes_with_strips(self):
        others = "element edge 1\nproperty list uchar short a\nproperty int b\n"
        strips = "element tristrips 1\nproperty list int int vertex_indices\n"
        for order, name in (("<", "little"), (">", "big")):
            head = ply_head(f"binary_{name}_endian", VERTICES + others + FACE + strips).encode()
            body = struct.pack(order + "9f", *FLOATS) + struct.pack(order + "Bhhi", 2, 1, 1, 5) + struct.pack(order + "B3I", 3, 0, 1, 2)
            self.check(".ply", head + body + struct.pack(order + "8i", 7, 0, 1, 2, -1, 0, 1, 2), 3, [1, 2, 0])

    def test_gltf_lists_strips_and_fans(self):
        self.check(".gltf", gltf([POINTS[:3]], {}), 1, [1, 2, 0])
        moved = [{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}]
        self.check(".gltf", gltf([POINTS], {"mode": 6}, nodes=moved), 2, [6, 8, 7])
        turned = [{"children": [1], "translation": [1, 0, 0]}, {"mesh": 0, "rotation": [0, 0, 1, 0], "scale": [2, 1, 1]}]
        strip = [POINTS, np.array([0, 1, 2, 3], "u2")]
        self.check(".glb", gltf(strip, {"mode": 5, "indices": 1}, True, nodes=turned), 2, [1, 0, 0])
        self.check(".gltf", gltf([POINTS, np.array([0, 1, 2, 255], "u1")], {"mode": 5, "indices": 1}), None, "restarts")
        self.check(".gltf", gltf([POINTS], {}), None, "4 vertices make no")
        self.check(".glb", gltf([POINTS, np.array([0, 1, 4], "u1")], {"indices": 1}, True), None, "a vertex that is not there")

    def test_gltf_sparse_and_small_numbers(self):
        small = np.array([[0, 0, 0], [127, 0, 0], [0, 127, -128]], "i1")
        self.check(".gltf", gltf([(small, {"normalized": True})], {}, extensionsRequired=["KHR_mesh_quantization"]), 1, [1, 1, 0])
        sparse = {"count": 1, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 2}}
        self.check(".gltf", gltf([(POINTS[:3], {"sparse": sparse}), np.array([2], "u1"), np.array([[0, 9, 0]], "f4")], {}), 1, [1, 9, 0])

    def test_gltf_morphs_skins_and_instances(self):
        target = np.array([[0, 0, 0], [4, 0, 0], [0, 0, 0]], "f4")
        morphed = [{"mesh": 0, "weights": [0.5]}]
        self.check(".gltf", gltf([POINTS[:3], target], {"targets": [{"POSITION": 1}]}, mesh={"weights": [1]}, nodes=morphed), 1, [3, 2, 0])
        bind = np.array([np.eye(4), np.eye(4)], "f4")
        bind[0, 3, 0] = -1
        joints = np.array([[0, 1, 0, 0]] * 3, "u1")
        weights = np.array([[255, 0, 0, 0], [255, 0, 0, 0], [0, 255, 0, 0]], "u1")
        nodes = [{"children": [1, 2, 3]}, {"mesh": 0, "skin": 0, "translation": [100, 0, 0]}, {"translation": [1, 0, 3]}, {"translation": [0, 0, 5]}]
        arrays = [POINTS[:3], joints, (weights, {"normalized": True}), bind.reshape(2, 16)]
        primitive = {"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}
        self.check(".gltf", gltf(arrays, primitive, nodes=nodes, skins=[{"joints": [2, 3], "inverseBindMatrices": 3}]), 1, [1, 2, 5])
        places = [np.array([[0, 0, 0], [10, 0, 0]], "f4"), np.array([[1, 1, 1], [2, 2, 2]], "f4")]
        twice = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1, "SCALE": 2}}}
        self.check(".gltf", gltf([POINTS[:3], *places], {}, nodes=[{"mesh": 0, "translation": [0, 0, 1], "extensions": twice}]), 2, [12, 4, 1])

    def test_gltf_with_animations_stands_as_its_nodes_do(self):
        def animated(times, values, path="translation", **sampler):
            arrays = [POINTS[:3], np.array(times, "f4"), np.array(values, "f4")]
            channel = {"sampler": 0, "target": {"node": 0, "path": path}}
            return gltf(arrays, {}, animations=[{"samplers": [{"input": 1, "output": 2} | sampler], "channels": [channel]}])

        self.check(".gltf", animated([0, 1], [[0, 0, 0], [9, 9, 9]]), 1, [1, 2, 0])
        self.check(".gltf", animated([1, 0], [[0, 0, 0], [9, 9, 9]]), None, "do not ascend")
        self.check(".gltf", animated([0], [[0, 0, 0]], interpolation="SPLINE"), None, "no interpolation")
        self.check(".gltf", animated([0], [[0, 0, 0]], interpolation="CUBICSPLINE"), None, "as many as its times")
        self.check(".gltf", animated([0], [[0, np.inf, 0]]), None, "not finite")
        self.check(".gltf", animated([0], [[0, 0, 0, 0]], "rotation"), None, "length 0")
        self.check(".gltf", animated([0], [[0, 0, 0]], "color"), None, "color")

    def test_gltf_that_needs_more_is_refused(self):
        self.check(".gltf", gltf([POINTS], {}, extensionsRequired=["KHR_draco_mesh_compression"]), None, "requires KHR_draco")
        self.check(".gltf", gltf([POINTS], {}, asset={"version": "1.0"}), None, "version is 1.0")
        self.check(".gltf", gltf([POINTS], {}, scene=0, nodes=[{"mesh": 0, "children": [0]}]), None, "twice")

    def test_triangles_without_area_are_told_apart(self):
        text = "v 0 0 0\nv 1 1 1\nv 3 3 3\nv 0 1 0\nv 0.1 0.1 0.1\nv 1 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\nf 1 2 5\nf 1 2 3 4\nf 1 6 2 4\n"
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "a.obj")
            file.write_text(text)
            found = mesh_count.count(file)
        # In a line: 1 2 3, of 1 2 3 4 its first, and 1 2 5 although 0.1 is no float32. Two positions: 1 1 2.
        self.assertEqual([found[key] for key in ("triangles", "degenerate", "polygons")], [4, 4, 2])


if __name__ == "__main__":
    unittest.main()
