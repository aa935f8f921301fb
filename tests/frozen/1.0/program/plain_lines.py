"""A technique that speaks version 1 of the protocol by itself: Python's own library alone, every request, every optional answer.

Frozen at version 1.0: every 1.x must speak with it as it is.
"""

import array
import json
import math
import sys

READ = {"float32": "f", "uint32": "I"}


def numbers(entry):
    """An array of the request: numbers from a byte of a file on."""
    values = array.array(READ[entry["type"]])
    with open(entry["file"], "rb") as file:
        file.seek(entry["offset"])
        values.frombytes(file.read(4 * math.prod(entry["shape"])))
    return values


def minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


class PlainLines:
    def __init__(self):
        self.triangles, self.scale, self.light, self.facing = [], 1.0, None, []

    def read(self, file):
        """Corner and sides of each triangle that casts."""
        with open(file, encoding="utf-8") as text:
            scene = json.load(text)
        place, corner, mesh = (numbers(scene["arrays"][name]) for name in ("position", "triangle", "mesh"))
        points = [tuple(place[3 * k:3 * k + 3]) for k in range(len(place) // 3)]
        self.receives = [one["receives"] for one in scene["meshes"]]
        casts = [one["casts"] for one in scene["meshes"]]
        self.triangles = []
        for k, of in enumerate(mesh):
            a, b, c = (points[corner[3 * k + i]] for i in range(3))
            if casts[of]:
                self.triangles.append((a, minus(b, a), minus(c, a)))
        self.scale = max((abs(x) for point in points for x in point), default=1.0)

    def way_to_light(self, point):
        """The way from a point to the light, and whether it ends there."""
        if self.light["kind"] == "directional":
            return tuple(-x for x in self.light["direction"]), False
        return minus(self.light["position"], point), True

    def is_hidden(self, point, way, ends):
        for a, u, v in self.triangles:
            side = cross(way, v)
            determinant = dot(u, side)
            if determinant == 0:
                continue
            off = minus(point, a)
            x = dot(off, side) / determinant
            turned = cross(off, u)
            y = dot(way, turned) / determinant
            t = dot(v, turned) / determinant
            if x >= 0 and y >= 0 and x + y <= 1 and t > 0 and (t < 1 or not ends):
                return True
        return False

    def answer(self, request):
        return getattr(self, request["do"])(request)

    def hello(self, request):
        assert request["protocol"] == 1 and request["technique"] == "plain_lines" and request["threads"] >= 1, request
        return {"protocol": 1, "stages": ["update"]}

    def supports(self, request):
        if request["settings"]["lift"] > 0.5:
            return {"support": "approximate", "why": "rays start far from their surface"}
        return {"support": "full"} if request["light"]["name"] and request["view"]["name"] else {"support": "unsupported", "why": "nameless"}

    def setup(self, request):
        assert set(request["settings"]) == {"lift", "both", "kind"}, request
        return {"ms": 0.0, "maker": "plain_lines 1"}

    def build(self, request):
        self.read(request["scene"]["file"])
        return {"ms": 0.0, "counts": [{"name": "triangles_kept", "value": len(self.triangles), "unit": ""}]}

    def update(self, request):
        for change in request["changes"]:
            assert change["kind"] in ("rigid", "deformed") and change["count"] > 0 and len(change["after"]) == 2, change
        return self.build(request)

    def relight(self, request):
        self.light = request["light"]
        return {"ms": 0.0}

    def resolve(self, request):
        assert {"eye", "target", "up", "fov_y_degrees"} <= set(request["view"]), request
        buffer = request["gbuffer"]
        size = buffer["width"] * buffer["height"]
        position, normal, mesh = (numbers(buffer["arrays"][name]) for name in ("position", "normal", "mesh"))
        mask = array.array("f", [1.0]) * size
        lift = request["settings"]["lift"] * 1e-4 * self.scale
        self.facing = [False] * size
        for k in range(size):
            if mesh[k] == 4294967295 or not self.receives[mesh[k]]:
                continue
            up = normal[k], normal[size + k], normal[2 * size + k]
            point = tuple(position[i * size + k] for i in range(3))
            if dot(up, self.way_to_light(point)[0]) <= 0:
                continue
            self.facing[k] = True
            start = tuple(x + lift * n for x, n in zip(point, up))
            if self.is_hidden(start, *self.way_to_light(start)):
                mask[k] = 0.0
        assert request["mask"]["format"] == "float32" and request["mask"]["shape"] == [buffer["height"], buffer["width"]], request
        with open(request["mask"]["file"], "r+b") as file:
            mask.tofile(file)
        self.mask = mask
        return {"counts": [{"name": "rays", "value": sum(self.facing), "unit": ""}, {"name": "bytes", "value": 72 * len(self.triangles), "unit": "byte"}]}

    def explain(self, request):
        return {"explanations": [{"bias": 0.0, "cause": "lifted"} if self.facing[k] else {"covered": True} for k in request["pixels"]]}


technique = PlainLines()
for line in sys.stdin:
    try:
        said = technique.answer(json.loads(line))
    except Exception as problem:  # a row that fails has its reason
        said = {"error": f"{type(problem).__name__}: {problem}"}
    print(json.dumps(said), flush=True)
