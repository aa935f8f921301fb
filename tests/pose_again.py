"""Poses of glTF 2.0 files a second time: in float64, from the formulas of its specification (sections 3.7.3 and 3.11, appendix C), with no code
of the program. It reads what tests/moving_gltf.py writes: one buffer in the text, one primitive a mesh, no sparse accessors."""

import base64
import json

import numpy as np

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def blend_of_rotations(a, b, t):
    """Along the shorter arc between unit quaternions."""
    cosine = float(a @ b)
    angle = np.arccos(min(abs(cosine), 1.0))
    sign = -1.0 if cosine < 0 else 1.0
    if angle < 1e-6:
        mixed = (1 - t) * a + t * sign * b
        return mixed / np.linalg.norm(mixed)
    return (np.sin((1 - t) * angle) * a + sign * np.sin(t * angle) * b) / np.sin(angle)


def unit(q):
    return q / np.linalg.norm(q)


def sampled(times, values, interpolation, is_rotation, t):
    """`values` is keys x width, for CUBICSPLINE keys x 3 x width: in-tangent, value, out-tangent."""
    points = values[:, 1] if interpolation == "CUBICSPLINE" else values
    if is_rotation:
        points = np.array([unit(q) for q in points])
    if t <= times[0]:
        return points[0]
    if t >= times[-1]:
        return points[-1]
    k = max(i for i in range(len(times)) if times[i] <= t)
    step = times[k + 1] - times[k]
    s = (t - times[k]) / step
    if interpolation == "STEP" or s == 0:
        return points[k]
    if interpolation == "LINEAR":
        return blend_of_rotations(points[k], points[k + 1], s) if is_rotation else (1 - s) * points[k] + s * points[k + 1]
    leaving, entering = values[k, 2], values[k + 1, 0]
    value = ((2 * s**3 - 3 * s**2 + 1) * points[k] + step * (s**3 - 2 * s**2 + s) * leaving +
             (3 * s**2 - 2 * s**3) * points[k + 1] + step * (s**3 - s**2) * entering)
    return unit(value) if is_rotation else value


def turn(q):
    """The 3 x 3 matrix of a unit quaternion x, y, z, w."""
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


class MovingFile:
    def __init__(self, path):
        self.json = json.loads(path.read_text())
        uri = self.json["buffers"][0]["uri"]
        self.buffer = base64.b64decode(uri[uri.index(",") + 1:])
        self.parents = {child: n for n, node in enumerate(self.json["nodes"]) for child in node.get("children", [])}

    def numbers(self, index):
        """count x width, normalized integers as the numbers that they stand for."""
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind, width = np.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        raw = np.frombuffer(self.buffer, kind, accessor["count"] * width, view.get("byteOffset", 0))
        numbers = raw.astype(float).reshape(-1, width)
        return np.maximum(numbers / np.iinfo(kind).max, -1.0) if accessor.get("normalized") else numbers

    def channels(self, animation, t):
        """What the animation sets at that time, by node and property."""
        values = {}
        for channel in animation["channels"]:
            sampler, target = animation["samplers"][channel["sampler"]], channel["target"]
            times, numbers = self.numbers(sampler["input"])[:, 0], self.numbers(sampler["output"])
            interpolation = sampler.get("interpolation", "LINEAR")
            parts = 3 if interpolation == "CUBICSPLINE" else 1
            # Of morph weights an element is one number, and a part of a key is as many as there are targets.
            numbers = numbers.reshape(len(times), parts, -1) if parts == 3 else numbers.reshape(len(times), -1)
            values[target["node"], target["path"]] = sampled(times, numbers, interpolation, target["path"] == "rotation", t)
        return values

    def meshes(self, name=None, t=0.0):
        """The corners of the triangles of each mesh by its node's name, n x 3 x 3; without an animation as the nodes are in the file."""
        moved = {}
        if name is not None:
            moved = self.channels(next(one for one in self.json["animations"] if one["name"] == name), t)
        worlds = {}

        def local(n):
            node = self.json["nodes"][n]
            if "matrix" in node:
                return np.array(node["matrix"], float).reshape(4, 4).T
            def part(key, usual):
                return np.asarray(moved.get((n, key), node.get(key, usual)), float)
            matrix = np.eye(4)
            matrix[:3, :3] = turn(unit(part("rotation", [0, 0, 0, 1]))) * part("scale", [1, 1, 1])
            matrix[:3, 3] = part("translation", [0, 0, 0])
            return matrix

        def world(n):
            if n not in worlds:
                worlds[n] = world(self.parents[n]) @ local(n) if n in self.parents else local(n)
            return worlds[n]

        return {node["name"]: self.corners(n, node, moved, world) for n, node in enumerate(self.json["nodes"]) if "mesh" in node}

    def corners(self, n, node, moved, world):
        mesh = self.json["meshes"][node["mesh"]]
        primitive = mesh["primitives"][0]
        points = self.numbers(primitive["attributes"]["POSITION"])
        targets = primitive.get("targets", [])
        weights = moved.get((n, "weights"), node.get("weights", mesh.get("weights", [0] * len(targets))))
        for weight, target in zip(weights, targets):
            points = points + weight * self.numbers(target["POSITION"])
        points = np.hstack([points, np.ones((len(points), 1))])
        if "skin" in node:
            points = np.einsum("vij,vj->vi", self.skin_matrices(node["skin"], primitive, world), points)
        else:
            points = points @ world(n).T
        return points[self.numbers(primitive["indices"]).astype(int).reshape(-1, 3), :3]

    def skin_matrices(self, index, primitive, world):
        """The matrix of each vertex; the node of the mesh does not count."""
        skin = self.json["skins"][index]
        joints = np.array([world(n) for n in skin["joints"]])
        if "inverseBindMatrices" in skin:
            joints = joints @ self.numbers(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        total, k = 0, 0
        while f"JOINTS_{k}" in primitive["attributes"]:
            chosen = joints[self.numbers(primitive["attributes"][f"JOINTS_{k}"]).astype(int)]
            total = total + np.einsum("vk,vkij->vij", self.numbers(primitive["attributes"][f"WEIGHTS_{k}"]), chosen)
            k += 1
        return total
