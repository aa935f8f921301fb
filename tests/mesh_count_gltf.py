"""Reader of glTF 2.0 and GLB for mesh_count.py: see mesh_count_plain.py for what it gives.

Nodes of the scene that `scene` names; a file without it shows all nodes that are nobody's children, and what is below them. Meshes stand
as the nodes do in the file; animations are checked and move nothing: morph weights applied, and a skinned vertex is the weighted sum of (joint in the world *
its inverse bind matrix) * vertex. Rotations are taken as unit quaternions, whatever their digits are. What the file requires and is not
in SUPPORTED is refused, and so is glTF 1.0.
"""

import base64
import json
import struct
from urllib.parse import unquote

import numpy as np

# Those that say where vertices are, and beginnings of those that say nothing of it.
SUPPORTED = ("KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_materials_", "KHR_lights_punctual", "KHR_texture_", "EXT_texture_", "MSFT_texture_")
COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
PATH_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3, "weights": 1}  # of weights as many as there are morph targets
POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = range(7)


def chunks_of(data):
    """The JSON of a file, and the binary chunk of a GLB."""
    if data[:4] != b"glTF":
        return json.loads(data.decode("utf-8")), None
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise ValueError(f"it is GLB {version}")
    if length > len(data):
        raise ValueError("it is shorter than its head says")
    text = binary = None
    at = 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<II", data, at)
        chunk = data[at + 8:at + 8 + size]
        if len(chunk) < size:
            raise ValueError("a chunk is cut off")
        if kind == 0x4E4F534A and text is None:
            text = chunk
        elif kind == 0x004E4942 and binary is None:
            binary = chunk
        at += 8 + size
    return json.loads(text.decode("utf-8")), binary


def item(items, index, what):
    """An item by its index; a negative one, or none at all, names nothing."""
    if type(index) is not int or not 0 <= index < len(items):
        raise ValueError(f"it names {what} {index}, which is not there")
    return items[index]


class Document:
    def __init__(self, file, data):
        self.json, self.binary = chunks_of(data)
        self.file, self.buffers = file, {}
        asset = self.json.get("asset", {})
        version = str(asset.get("version", "missing"))
        if version.split(".")[0] != "2" or asset.get("minVersion", "2.0") != "2.0":
            raise ValueError(f"its version is {version}, of its readers at least {asset.get('minVersion', version)}")
        if unknown := [name for name in self.json.get("extensionsRequired", []) if not name.startswith(SUPPORTED)]:
            raise ValueError(f"it requires {', '.join(unknown)}")
        self.nodes = self.json.get("nodes", [])
        self.parents = {}
        for place, node in enumerate(self.nodes):
            for child in node.get("children", []):
                item(self.nodes, child, "node")
                if child in self.parents:
                    raise ValueError(f"node {child} has two parents")
                self.parents[child] = place

    # --- numbers -----------------------------------------------------------------------------------------------------------

    def buffer(self, index):
        if index not in self.buffers:
            entry = item(self.json.get("buffers", []), index, "buffer")
            uri = entry.get("uri")
            if uri is None:
                if index != 0 or self.binary is None:
                    raise ValueError(f"buffer {index} has no uri")
                data = self.binary
            elif uri.startswith("data:"):
                data = base64.b64decode(uri.split(",", 1)[1] if ";base64," in uri else "", validate=True)
            else:
                data = (self.file.parent / unquote(uri)).read_bytes()
            if len(data) < entry["byteLength"]:
                raise ValueError(f"buffer {index} is shorter than it says")
            self.buffers[index] = data[:entry["byteLength"]]
        return self.buffers[index]

    def raw(self, view_index, offset, count, width, component):
        """(count, width) numbers that a view holds from `offset` on."""
        view = item(self.json.get("bufferViews", []), view_index, "buffer view")
        kind = np.dtype(COMPONENTS[component])
        buffer, begin, size = self.buffer(view["buffer"]), view.get("byteOffset", 0), view["byteLength"]
        stride = view.get("byteStride", width * kind.itemsize)
        need = offset + stride * (count - 1) + width * kind.itemsize if count else 0
        if min(begin, size, offset, count, stride) < 0 or begin + size > len(buffer) or need > size:
            raise ValueError("an accessor reaches beyond its buffer")
        return np.ndarray((count, width), kind, buffer, begin + offset, (stride, kind.itemsize)) if count else np.zeros((0, width), kind)

    def accessor(self, index):
        """(count, width) numbers: float32 as doubles, integers as they are unless they are normalized."""
        entry = item(self.json.get("accessors", []), index, "accessor")
        count, width, component = entry["count"], WIDTHS[entry["type"]], entry["componentType"]
        kind = np.dtype(COMPONENTS[component])
        if width > 4 and kind.itemsize < 4:
            raise ValueError("a matrix of small integers is padded")
        if type(count) is not int or not 0 <= count <= 1 << 28:
            raise ValueError(f"an accessor has {count} elements")
        if "bufferView" in entry:
            values = self.raw(entry["bufferView"], entry.get("byteOffset", 0), count, width, component)
        else:
            values = np.zeros((count, width), kind)
        if sparse := entry.get("sparse"):
            values = values.copy()
            places, new = sparse["indices"], sparse["values"]
            where = self.raw(places["bufferView"], places.get("byteOffset", 0), sparse["count"], 1, places["componentType"])[:, 0]
            values[where.astype("i8")] = self.raw(new["bufferView"], new.get("byteOffset", 0), sparse["count"], width, component)
        if kind.kind == "f":
            return values.astype("f8")
        if not entry.get("normalized"):
            return values.astype("i8")
        return np.maximum(values.astype("f8") / np.iinfo(kind).max, -1)

    # --- nodes -------------------------------------------------------------------------------------------------------------

    def world(self, index):
        """The matrix of a node in the world."""
        matrix, above = np.eye(4), 0
        while index is not None:
            matrix = local_matrix(self.nodes[index]) @ matrix
            index = self.parents.get(index)
            above += 1
            if above > len(self.nodes):
                raise ValueError("its nodes go in a circle")
        return matrix

    def shown(self):
        """Indices of all nodes of the scene."""
        if "scene" in self.json:
            waiting = list(item(self.json.get("scenes", []), self.json["scene"], "scene").get("nodes", []))
        else:
            waiting = [place for place in range(len(self.nodes)) if place not in self.parents]
        seen = set()
        while waiting:
            index = waiting.pop(0)
            children = item(self.nodes, index, "node").get("children", [])
            if index in seen:
                raise ValueError(f"node {index} is in its scene twice")
            seen.add(index)
            waiting += children
        return sorted(seen)


def local_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], "f8").reshape(4, 4).T
    return composed(node.get("translation", [0, 0, 0]), node.get("rotation", [0, 0, 0, 1]), node.get("scale", [1, 1, 1]))


def composed(translation, rotation, scale):
    x, y, z, w = np.array(rotation, "f8") / np.linalg.norm(rotation)
    matrix = np.eye(4)
    matrix[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                      [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                      [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    matrix[:3, :3] *= np.array(scale, "f8")
    matrix[:3, 3] = translation
    return matrix


def moved(matrix, points):
    with np.errstate(invalid="ignore"):
        return points @ matrix[:3, :3].T + matrix[:3, 3]


def skinned(document, skin, attributes, points):
    """Each point by its joints; None where the primitive has none."""
    if "JOINTS_0" not in attributes or "WEIGHTS_0" not in attributes:
        return None
    joints = skin["joints"]
    bind = document.accessor(skin["inverseBindMatrices"]) if "inverseBindMatrices" in skin else np.tile(np.eye(4).reshape(16), (len(joints), 1))
    matrices = np.array([document.world(joint) @ bind[place].reshape(4, 4).T for place, joint in enumerate(joints)])
    result = np.zeros_like(points)
    for part in range(len(attributes)):
        if f"JOINTS_{part}" not in attributes:
            break
        names, weights = document.accessor(attributes[f"JOINTS_{part}"]), document.accessor(attributes[f"WEIGHTS_{part}"])
        for k in range(4):
            matrix = matrices[names[:, k]]
            result += weights[:, k:k + 1] * (np.einsum("nij,nj->ni", matrix[:, :3, :3], points) + matrix[:, :3, 3])
    return result


def instances(document, node):
    """Matrices below the node, one for each time that it shows its mesh."""
    entry = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
    if entry is None:
        return [np.eye(4)]
    given = {name: document.accessor(index) for name, index in entry["attributes"].items() if name in ("TRANSLATION", "ROTATION", "SCALE")}
    count = min((len(values) for values in given.values()), default=0)
    return [composed(given["TRANSLATION"][k] if "TRANSLATION" in given else [0, 0, 0], given["ROTATION"][k] if "ROTATION" in given else [0, 0, 0, 1],
                     given["SCALE"][k] if "SCALE" in given else [1, 1, 1]) for k in range(count)]


def faces(mode, indices):
    """The faces of a primitive as rows of corners."""
    count = len(indices)
    if not (count and count % {LINES: 2, TRIANGLES: 3}.get(mode, 1) == 0 and count >= {LINE_LOOP: 2, LINE_STRIP: 2}.get(mode, 3 if mode > 4 else 1)):
        raise ValueError(f"{count} vertices make no primitive of mode {mode}")
    if mode in (POINTS, LINES, TRIANGLES):
        return indices.reshape(-1, {POINTS: 1, LINES: 2, TRIANGLES: 3}[mode])
    if mode in (LINE_STRIP, LINE_LOOP):
        return np.stack([indices, np.roll(indices, -1)], -1)[:count if mode == LINE_LOOP else -1]
    if mode == TRIANGLE_STRIP:
        return np.stack([indices[:-2], indices[1:-1], indices[2:]], -1)
    if mode == TRIANGLE_FAN:
        return np.stack([np.full(count - 2, indices[0]), indices[1:-1], indices[2:]], -1)
    raise ValueError(f"a primitive has the mode {mode}")


def primitive_indices(document, primitive, vertex_count):
    if "indices" not in primitive:
        return np.arange(vertex_count)
    indices = document.accessor(primitive["indices"])[:, 0]
    if (indices == np.iinfo(COMPONENTS[document.json["accessors"][primitive["indices"]]["componentType"]]).max).any():
        raise ValueError("an index restarts its primitive")
    return indices


def check_animations(document):
    """Refuses keys that make no sense. Channels without a node, those of extensions among them, may be anything."""
    for animation in document.json.get("animations", []):
        moved = set()
        for channel in animation.get("channels", []):
            target = channel["target"]
            path = target.get("path")
            if path == "pointer" or "node" not in target:
                continue
            node = item(document.nodes, target["node"], "node")
            if path not in PATH_WIDTHS or ("matrix" in node and path != "weights") or (target["node"], path) in moved:
                raise ValueError(f"an animation moves the {path} of node {target['node']}, which it may not, or not twice")
            moved.add((target["node"], path))
            width = PATH_WIDTHS[path]
            if path == "weights":
                primitives = item(document.json["meshes"], node["mesh"], "mesh")["primitives"] if "mesh" in node else []
                width = next((len(primitive["targets"]) for primitive in primitives if primitive.get("targets")), 0)
            if width:
                check_keys(document, item(animation.get("samplers", []), channel.get("sampler"), "sampler"), path, width)


def check_keys(document, sampler, path, width):
    parts = {"LINEAR": 1, "STEP": 1, "CUBICSPLINE": 3}.get(sampler.get("interpolation", "LINEAR"))
    times, values = document.accessor(sampler["input"]).ravel(), document.accessor(sampler["output"])
    if not (parts and len(times) and np.isfinite(times).all() and times[0] >= 0 and (np.diff(times) >= 0).all()):
        raise ValueError("an animation has times that do not ascend, or no interpolation that there is")
    if values.shape != (len(times) * parts * (width if path == "weights" else 1), 1 if path == "weights" else width) or not np.isfinite(values).all():
        raise ValueError("an animation has values that are not finite, or not as many as its times")
    if path == "rotation" and not values.reshape(-1, parts, 4)[:, parts // 2].any(1).all():
        raise ValueError("an animation has a rotation of length 0")


def read(file, data):
    document = Document(file, data)
    check_animations(document)
    for index in document.shown():
        node = document.nodes[index]
        if "mesh" not in node:
            continue
        mesh = item(document.json.get("meshes", []), node["mesh"], "mesh")
        weights = node.get("weights", mesh.get("weights", []))
        for primitive in mesh["primitives"]:
            attributes = primitive["attributes"]
            if "POSITION" not in attributes:
                continue
            points = document.accessor(attributes["POSITION"]).astype("f8")
            for weight, target in zip(weights, primitive.get("targets", [])):
                if "POSITION" in target:
                    points = points + float(weight) * document.accessor(target["POSITION"])
            rows = faces(primitive.get("mode", TRIANGLES), primitive_indices(document, primitive, len(points)))
            counts, corners = [rows.shape[1]] * len(rows), rows.reshape(-1)
            placed = skinned(document, item(document.json["skins"], node["skin"], "skin"), attributes, points) if "skin" in node else None
            if placed is not None:
                yield placed, counts, corners
                continue
            world = document.world(index)
            for instance in instances(document, node):
                yield moved(world @ instance, points), counts, corners
