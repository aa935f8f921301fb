"""glTF files that move in every way: chains of nodes, skins of one and two sets of joints, morph targets, all interpolations, floats and
normalized integers. What moves how is drawn at random."""

import base64
import json

import numpy as np

FLOAT, U8, U16, U32, I8, I16 = 5126, 5121, 5123, 5125, 5120, 5122
KINDS = {FLOAT: np.float32, U8: np.uint8, U16: np.uint16, U32: np.uint32, I8: np.int8, I16: np.int16}
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Writer:
    """A file that grows: each array is an accessor of its own."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)
        self.bytes = bytearray()
        self.json = {"asset": {"version": "2.0"}, "nodes": [], "meshes": [], "skins": [], "accessors": [], "bufferViews": [], "animations": []}

    def add(self, key, item):
        self.json[key].append(item)
        return len(self.json[key]) - 1

    def array(self, values, component=FLOAT, normalized=False):
        """An accessor of count x width numbers; integers that stand for shares are rounded to the nearest."""
        values = np.asarray(values, float)
        values = values.reshape(len(values), -1)
        kind = KINDS[component]
        stored = np.rint(values * np.iinfo(kind).max) if normalized else values
        self.bytes += bytes(-len(self.bytes) % 4)
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": stored.size * np.dtype(kind).itemsize})
        self.bytes += stored.astype(kind).tobytes()
        accessor = {"bufferView": view, "componentType": component, "count": len(values), "type": TYPES[values.shape[1]]}
        if normalized:
            accessor["normalized"] = True
        elif component == FLOAT:
            accessor.update(min=stored.astype(kind).min(0).astype(float).tolist(), max=stored.astype(kind).max(0).astype(float).tolist())
        return self.add("accessors", accessor)

    def write(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        path.write_text(json.dumps({**{key: value for key, value in self.json.items() if value},
                                    "buffers": [{"byteLength": len(self.bytes), "uri": uri}]}))

    # --- what files are made of ---

    def rotation(self):
        q = self.random.normal(size=4)
        return q / np.linalg.norm(q)

    def node(self, name, **more):
        """A node somewhere."""
        return self.add("nodes", {"name": name, "translation": self.random.uniform(-1, 1, 3).tolist(), "rotation": self.rotation().tolist(),
                                  "scale": self.random.uniform(0.5, 2, 3).tolist(), **more})

    def fixed_node(self, name, **more):
        """A node with a matrix, which shears."""
        matrix = np.eye(4)
        matrix[:3, :4] += self.random.uniform(-0.4, 0.4, (3, 4))
        return self.add("nodes", {"name": name, "matrix": matrix.T.ravel().tolist(), **more})

    def mesh(self, name, target_count=0, joint_count=0, sets=0, component=FLOAT):
        """Triangles that share no corner: 9 of 27 vertices."""
        vertices = 27
        attributes = {"POSITION": self.array(self.random.uniform(-1, 1, (vertices, 3)))}
        weights = self.random.uniform(0, 1, (vertices, 4 * sets))
        weights[self.random.uniform(size=weights.shape) < 0.2] = 0  # these name a joint that does not count
        weights[:, :1] += 0.1
        weights /= weights.sum(1, keepdims=True) if sets else 1
        for k in range(sets):
            part = slice(4 * k, 4 * k + 4)
            attributes[f"JOINTS_{k}"] = self.array(self.random.integers(0, joint_count, (vertices, 4)), U16 if k else U8)
            attributes[f"WEIGHTS_{k}"] = self.array(weights[:, part], component, component != FLOAT)
        primitive = {"attributes": attributes, "indices": self.array(np.arange(vertices), U16)}
        mesh = {"name": name, "primitives": [primitive]}
        if target_count:
            primitive["targets"] = [{"POSITION": self.array(self.random.uniform(-1, 1, (vertices, 3)))} for _ in range(target_count)]
            mesh["weights"] = self.random.uniform(-0.5, 1, target_count).tolist()
        return self.add("meshes", mesh)

    def skin(self, joints, has_matrices=True):
        skin = {"joints": joints}
        if has_matrices:
            matrices = np.tile(np.eye(4), (len(joints), 1, 1))
            matrices[:, :3, :] += self.random.uniform(-0.5, 0.5, (len(joints), 3, 4))
            skin["inverseBindMatrices"] = self.array(matrices.transpose(0, 2, 1).reshape(-1, 16))
        return self.add("skins", skin)

    def keys(self, path, count, width, is_cubic):
        """Values of `count` keys, and what they may be stored as."""
        if path == "rotation":
            values = np.array([self.rotation() for _ in range(count)])
            for k in range(1, count if is_cubic else 0):  # not through zero between two keys
                values[k] *= 1 if values[k] @ values[k - 1] > 0 else -1
            return values, [FLOAT, I8, I16]
        low, high = {"translation": (-2, 2), "scale": (0.5, 2), "weights": (0, 1)}[path]
        return self.random.uniform(low, high, (count, width)), [FLOAT, U8, U16, I16] if path == "weights" else [FLOAT]

    def channel(self, animation, node, path, width):
        count = int(self.random.integers(1, 7))
        times = np.cumsum(self.random.uniform(0.1, 1, count)) - self.random.choice([0, 0.1])
        interpolation = str(self.random.choice(["STEP", "LINEAR", "CUBICSPLINE"]))
        values, components = self.keys(path, count, width, interpolation == "CUBICSPLINE")
        if interpolation == "CUBICSPLINE":
            tangents = self.random.uniform(0, 0.4, (2, *values.shape))
            values = np.stack([tangents[0], values, tangents[1]], 1)
        component = int(self.random.choice(components))
        # Weights are an array of single numbers.
        output = self.array(values.reshape(-1, 1 if path == "weights" else width), component, component != FLOAT)
        sampler = {"input": self.array(times[:, None]), "output": output, "interpolation": interpolation}
        if interpolation == "LINEAR" and self.random.uniform() < 0.5:
            del sampler["interpolation"]
        animation["samplers"].append(sampler)
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}})

    def animate(self, name, nodes, morphing):
        """An animation that moves some properties of nodes, and the weights of some of `morphing`: node and number of targets."""
        animation = {"name": name, "channels": [], "samplers": []}
        for node in nodes:
            for path, width in (("translation", 3), ("rotation", 4), ("scale", 3)):
                if self.random.uniform() < 0.6:
                    self.channel(animation, node, path, width)
        for node, count in morphing:
            if self.random.uniform() < 0.8:
                self.channel(animation, node, "weights", count)
        if not animation["channels"]:
            self.channel(animation, nodes[0], "translation", 3)
        self.add("animations", animation)


def write_moving_gltf(path, seed):
    """A rigid mesh at the end of a chain, a morphing one, and two with skins, one of which has two sets of joints and morphs; the animations
    `walk` and `fly`."""
    writer = Writer(seed)
    rigid = writer.node("rigid", mesh=writer.mesh("rigid"))
    fixed = writer.fixed_node("fixed", children=[rigid])
    chain = writer.node("chain", children=[fixed])
    morph = writer.node("morph", mesh=writer.mesh("morph", target_count=3), weights=writer.random.uniform(-0.5, 1, 3).tolist())
    tip = writer.node("tip")
    middle = writer.node("middle", children=[tip])
    base = writer.node("base", children=[middle])
    skin = writer.skin([tip, base, middle])
    bent = writer.node("bent", mesh=writer.mesh("bent", joint_count=3, sets=1), skin=skin)
    twigs = [writer.node(f"twig{k}") for k in range(3)]
    branch = writer.fixed_node("branch", children=twigs)
    component = int(writer.random.choice([FLOAT, U8, U16]))
    tree = writer.add("nodes", {"name": "tree", "mesh": writer.mesh("tree", target_count=2, joint_count=5, sets=2, component=component),
                                "skin": writer.skin([branch, *twigs, base], has_matrices=bool(writer.random.uniform() < 0.7))})
    top = writer.node("top", children=[chain, base, branch, bent])
    writer.json["scenes"] = [{"nodes": [top, morph, tree]}]
    writer.json["scene"] = 0
    writer.animate("walk", [top, chain, rigid, morph, tip, middle, base, *twigs], [(morph, 3), (tree, 2)])
    writer.animate("fly", [chain, middle, twigs[0]], [(morph, 3)])
    writer.write(path)
