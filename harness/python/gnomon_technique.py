"""Shadow techniques in Python, for Gnomon: a class with up to five stages, and `serve`. See docs/protocol.md.

    from gnomon_technique import Technique, serve

    class AllLit(Technique):
        def resolve(self, gbuffer, mask):
            mask[...] = 1

    serve(AllLit)
"""

import json
import os
import sys
import time
import traceback
from types import SimpleNamespace

import numpy as np

PROTOCOL = 1
NO_MESH = 0xFFFFFFFF  # of G-buffers: where the background is


class Technique:
    """What the testbed calls, in the order of a technique's life; each may be left out but `resolve`.

    `self.settings` holds the parameters by name (`self.settings.samples`), `self.counts` what was counted: {"rays": 12} or
    {"bytes": (1024, "byte")}; without it `bytes` are those of the arrays that the object keeps. `self.threads` is how many cores it may use.
    `self.folder` is for files that go with the process; `self.maker` may name what makes the masks: "POV-Ray 3.7.0.10".
    A stage takes what its method takes, or the milliseconds that the method leaves in `self.ms`, where another program did the work.
    """

    def setup(self):
        """Once in a process."""

    def build(self, scene):
        """Geometry: see Scene."""

    def update(self, scene, changes):
        """The vertices of the scene that build got have moved; all else is as it was. `scene` is a new Scene with their new
        positions; arrays of the one before still hold the old ones. `changes` has an entry for each mesh that moved, see Change.
        It may keep what no change spoils, and relight follows. A class that does not define it builds."""
        self.build(scene)

    def relight(self, light):
        """A light: `light.kind` is "point", "spot", "directional", "rect", "disc" or "sphere"; the rest are the keys of a scene
        file as arrays and numbers: `light.position`, `light.direction` (the way light travels), `light.radius`, ..."""

    def resolve(self, gbuffer, mask):
        """Writes every pixel of `mask`, height x width: 1 lit, 0 in shadow, and 1 where a pixel does not face the light."""
        raise NotImplementedError

    def forget(self):
        """The next `resolve` is the first of a sequence, as on a fresh object; every `resolve` after it is the next frame. Called
        where the description has remembers = true, which needs this method. What of the G-buffer is kept for the next frame is a
        copy, np.array(gbuffer.position): its bytes are counted."""
        raise NotImplementedError("the description has remembers = true, and the class has no method forget")

    def supports(self, scene, light, view):
        """"full", ("approximate", why) or ("unsupported", why); called where the description has answers = ["supports"]."""
        return "full"

    def explain(self, pixels):
        """For each pixel (row * width + column) None or a dictionary with the keys of an explanation; called where the
        description has answers = ["explain"]."""
        return [None] * len(pixels)


def _arrays(entries):
    """Read-only views of the files."""
    return {
        name: np.memmap(entry["file"], dtype=entry["type"], mode="r", offset=entry["offset"], shape=tuple(entry["shape"]))
        if 0 not in entry["shape"] else np.empty(entry["shape"], entry["type"])
        for name, entry in entries.items()
    }  # fmt: skip


def _values(facts):
    """Facts as attributes; lists of numbers as arrays of doubles."""
    is_numbers = lambda value: isinstance(value, list) and value and isinstance(value[0], (int, float))
    return SimpleNamespace(**{key: np.array(value, float) if is_numbers(value) else value for key, value in facts.items()})


class Scene:
    """`position` (vertices x 3, float32), `triangle` (triangles x 3, indices into position), `mesh` (of each triangle);
    `meshes`, `lights`, `views` with the keys of a scene file, of a mesh also name, casts, receives, first_triangle, triangles.
    Of a scene with holes also `uv` (vertices x 2, float32), `alpha_mask_bits`, and alpha_mask of a mesh; of one with glass `uv`,
    `transmission_values`, and transmission and seen of a mesh: docs/protocol.md.
    """

    def __init__(self, request):
        with open(request["file"], encoding="utf-8") as file:
            facts = json.load(file)
        self.name, self.ambient = facts["name"], facts["ambient"]
        self.meshes, self.lights, self.views = ([_values(item) for item in facts[key]] for key in ("meshes", "lights", "views"))
        self.gltf = request.get("gltf")
        for name, array in _arrays(facts.get("arrays", {})).items():
            setattr(self, name, array)

    def corners(self, casters_only=True):
        """The triangles' corners, triangles x 3 x 3 doubles; of all meshes, or of those that cast."""
        casts = np.array([mesh.casts for mesh in self.meshes], bool)
        chosen = casts[self.mesh] if casters_only else slice(None)
        return self.position[self.triangle[chosen]].astype(float)


class Change:
    """How a mesh moved: `mesh`, its number; `kind`, "rigid" or "deformed"; `first` and `count`, the vertices in the scene's `position`
    that hold all that differ; `before` and `after`, the least and the greatest corner of the whole mesh, 2 x 3, float32; `matrix`, 4 x 4, of
    a rigid one: position = matrix @ position before, but for rounding; None of another."""

    def __init__(self, facts):
        self.mesh, self.kind, self.first, self.count = facts["mesh"], facts["kind"], facts["first"], facts["count"]
        self.before, self.after = np.array(facts["before"], np.float32), np.array(facts["after"], np.float32)
        self.matrix = np.array(facts["matrix"], float) if "matrix" in facts else None

    @property
    def vertices(self):
        """A slice of `position`."""
        return slice(self.first, self.first + self.count)


class GBuffer:
    """What the eye sees: `position` and `normal` (height x width x 3, float32), `mesh` and `triangle` (height x width, uint32;
    mesh is NO_MESH on the background), `view`, `width`, `height`, `truth`, `is_background`."""

    def __init__(self, request, view):
        self.width, self.height, self.truth, self.view = request["width"], request["height"], request["truth"], view
        self.exr = request.get("exr")
        for name, array in _arrays(request.get("arrays", {})).items():
            setattr(self, name, np.moveaxis(array, 0, -1) if array.ndim == 3 else array)

    @property
    def is_background(self):
        return self.mesh == NO_MESH

    def to_light(self, light):
        """From each pixel's point to a light without area, doubles, not normalized: position - point, or -direction."""
        if light.kind == "directional":
            return np.broadcast_to(-light.direction, self.position.shape)
        return light.position - self.position.astype(float)

    def faces(self, light, scene):
        """Where a pixel must be decided at all: on a mesh that receives, turned to a light without area, in its cone."""
        receives = np.append(np.array([mesh.receives for mesh in scene.meshes], bool), False)
        way = self.to_light(light)
        seen = receives[np.minimum(self.mesh, len(scene.meshes))] & (np.einsum("ijk,ijk->ij", self.normal.astype(float), way) > 0)
        if light.kind == "spot":
            axis = light.direction / np.linalg.norm(light.direction)
            along = -way @ axis
            seen &= along >= np.linalg.norm(way, axis=-1) * np.cos(np.radians(light.outer_degrees))
        return seen


def _counts(counts):
    pairs = [(name, value if isinstance(value, tuple) else (value, "")) for name, value in counts.items()]
    return [{"name": name, "value": float(value), "unit": unit} for name, (value, unit) in pairs]


def _held_bytes(value, seen):
    """Of the arrays that an object keeps, each memory once; mapped files are not its own."""
    while isinstance(value, np.ndarray) and isinstance(value.base, np.ndarray):
        value = value.base
    if id(value) in seen or isinstance(value, (np.memmap, str, bytes)):
        return 0
    seen.add(id(value))
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, (list, tuple, set)):
        return sum(_held_bytes(item, seen) for item in value)
    if isinstance(value, dict):
        return sum(_held_bytes(item, seen) for item in value.values())
    return _held_bytes(vars(value), seen) if hasattr(value, "__dict__") else 0


class _Server:
    def __init__(self, make):
        self.make, self.technique, self.threads, self.folder = make, None, 1, None

    def fresh(self):
        self.technique = self.make()
        self.technique.counts, self.technique.threads, self.technique.folder, self.technique.maker = {}, self.threads, self.folder, ""

    def answer(self, request):
        doing = request["do"]
        if doing == "hello":
            self.threads, self.folder = request["threads"], request["folder"]
            self.fresh()
            updates = type(self.technique).update is not Technique.update
            return {"protocol": PROTOCOL} | ({"stages": ["update"]} if updates else {})
        technique = self.technique
        technique.settings = SimpleNamespace(**request["settings"])
        if doing == "supports":
            said = technique.supports(Scene(request["scene"]), _values(request["light"]), _values(request["view"]))
            support, why = (said, "") if isinstance(said, str) else said
            return {"support": support, "why": why}
        if doing == "forget":
            technique.forget()
            return {}
        if doing == "explain":
            return {"explanations": technique.explain(request["pixels"])}
        given, mask = self.given(doing, request)
        technique.ms = None
        start = time.perf_counter()
        getattr(technique, doing)(*given)
        if mask is not None:
            del given
        answer = {"ms": 1000 * (time.perf_counter() - start) if technique.ms is None else technique.ms}
        held = {"bytes": (_held_bytes(technique, set()), "byte")} if doing == "resolve" else {}
        return answer | {"counts": _counts(held | technique.counts)} | ({"maker": technique.maker} if technique.maker else {})

    @staticmethod
    def given(doing, request):
        """The arguments of a stage, and the mask among them."""
        if doing == "setup":
            return (), None
        if doing == "build":
            return (Scene(request["scene"]),), None
        if doing == "update":
            return (Scene(request["scene"]), [Change(facts) for facts in request["changes"]]), None
        if doing == "relight":
            return (_values(request["light"]),), None
        mask = np.memmap(request["mask"]["file"], dtype="float32", mode="r+", shape=tuple(request["mask"]["shape"]))
        return (GBuffer(request["gbuffer"], _values(request["view"])), mask), mask


def serve(make):
    """Answers the testbed's requests with an object of `make`, a class that derives from Technique, until there are no more."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what a technique prints goes to standard error, not between the answers
    server = _Server(make)
    for line in sys.stdin:
        try:
            answer = server.answer(json.loads(line))
        except Exception as problem:  # pylint: disable=broad-except
            traceback.print_exc()
            answer = {"error": f"{type(problem).__name__}: {problem}"}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
