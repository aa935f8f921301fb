"""Engines that draw in a browser as shadow techniques: what their adapters share.

Headless Chromium draws (page.mjs with the page of an engine); a process of Node.js drives it (renderer.mjs). A frame is a float target
of the picture's size with one light over white, flat-shaded meshes of both sides: the frame with shadows over the one without is the
mask. package.json has the versions.
"""

import json
import os
import shutil
from pathlib import Path

import numpy as np
from gnomon_engine import Awaited, Child, Engine, require_version

HERE = Path(__file__).parent
LEAST_NEAR = 1e-3  # of the far plane of a light's camera: what is nearer to the light casts nothing
OWN_VISIBILITY = "frames of an engine: its own primary visibility"


def pinned_version(module):
    """Of a module of npm, by package.json: "0.170.0" of "npm:three@0.170.0"."""
    return json.loads((HERE / "package.json").read_text())["dependencies"][module].rsplit("@", 1)[-1]


def square(vectors):
    """The squared length of each."""
    return np.einsum("...i,...i", vectors, vectors)


def nearest_distance(point, corners):
    """From a point to the nearest of triangles x 3 x 3."""
    least = np.inf
    edges = np.roll(corners, -1, axis=1) - corners
    for start, edge in zip(np.moveaxis(corners, 1, 0), np.moveaxis(edges, 1, 0)):
        share = np.clip(np.einsum("ij,ij->i", point - start, edge) / np.maximum(square(edge), 1e-300), 0, 1)
        least = min(least, square(start + share[:, None] * edge - point).min())
    normal = np.cross(edges[:, 0], edges[:, 1])
    sides = [np.einsum("ij,ij->i", np.cross(edges[:, k], point - corners[:, k]), normal) for k in range(3)]
    above = np.all(np.array(sides) > 0, axis=0)
    if above.any():
        height = np.einsum("ij,ij->i", point - corners[above, 0], normal[above])
        least = min(least, (height**2 / square(normal[above])).min())
    return float(np.sqrt(least))


class BrowserEngine(Engine):
    """What an adapter of an engine in a browser derives from."""

    title = ""
    page = ""  # the file of the engine's page, beside this one
    renderer = None

    def module(self):
        """The name of its package in package.json."""
        raise NotImplementedError

    def imports(self):
        """What its page imports: names, and paths below node_modules."""
        raise NotImplementedError

    def wanted_version(self):
        return pinned_version(self.module())

    def part_facts(self):
        """Of each mesh further facts for the page."""
        return [{}] * len(self.ranges)

    def start(self):
        if self.renderer:
            self.renderer.end()
        # What Chromium writes goes with the folder. One of it is a socket, whose name may have no more than 107 letters.
        short_name = f"/proc/{os.getpid()}/fd/{os.open(self.folder, os.O_RDONLY)}"
        self.renderer = Child(self.title, ["node", str(HERE / "renderer.mjs")], TMPDIR=short_name, HOME=self.folder)
        facts = self.renderer.ask(do="start", folder=self.folder, program=shutil.which("chromium"), gl=self.settings.gl, page=self.page,
                                  imports=self.imports())
        require_version(self.title, facts["version"], self.wanted_version())
        self.maker = f"{self.title} {facts['version']} in Chromium {facts['browser']}: {facts['gl']}"

    def load(self, scene):
        self.parts = [
            {"first": first, "end": end, "casts": bool(self.casts[first]), "receives": bool(self.receives[first]), **facts}
            for (first, end), facts in zip(self.ranges, self.part_facts())
            if end > first
        ]

    def place_light(self, light):
        """The winding of each triangle is turned to the light, and its normal with it: what looks at the lit side is bright, also of
        open meshes, and look-ups move to the light's side."""
        corners = self.corners.astype(float)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        to_light = -light.direction if light.kind == "directional" else light.position - corners[:, 0]
        away = np.einsum("ij,ij->i", normal, np.broadcast_to(to_light, normal.shape)) < 0
        normal[away] *= -1
        turned = np.where(away[:, None, None], self.corners[:, (0, 2, 1)], self.corners)
        np.concatenate((turned, np.repeat(normal[:, None], 3, axis=1))).astype(np.float32).tofile(Path(self.folder, "geometry"))
        facts = {key: getattr(light, key).tolist() for key in ("position", "direction") if hasattr(light, key)}
        if light.kind == "spot":
            facts |= {"inner": np.radians(light.inner_degrees), "outer": np.radians(light.outer_degrees)}
        near, far = self.depths(light, corners)
        self.renderer.ask(do="relight", file="geometry", parts=self.parts, kind=light.kind, **facts, near=near, far=far, settings=vars(self.settings))

    @staticmethod
    def depths(light, corners):
        """Near and far plane of a light's camera that hold all the scene; those of the sun are counted along its rays from the origin."""
        if corners.size == 0:
            return LEAST_NEAR, 1.0
        if light.kind == "directional":
            along = corners.reshape(-1, 3) @ (light.direction / np.linalg.norm(light.direction))
            margin = 1e-3 * np.ptp(along) + 1e-6 * np.abs(along).max()
            return along.min() - margin, along.max() + margin
        far = 1.001 * np.sqrt(square(corners - light.position).max())
        lean = np.tan(np.radians(light.outer_degrees)) if light.kind == "spot" else 1.0  # of the pyramid's sides
        return max(0.999 * nearest_distance(light.position, corners) / np.sqrt(1 + 2 * lean**2), LEAST_NEAR * far), far

    def frame(self, camera, width, height, shadows):
        world = np.vstack((camera.right, camera.up, -camera.forward, camera.eye))  # columns of the camera's matrix
        world = np.column_stack((world, (0, 0, 0, 1))).ravel().tolist()
        eye = {"world": world, "fov_y_degrees": camera.fov_y_degrees, "near": camera.near, "far": camera.far}
        picture = Awaited(self.folder, "picture")
        done = self.renderer.ask(do="frame", width=width, height=height, camera=eye, shadows=shadows, settings=vars(self.settings), file="picture")
        return picture.array(np.float16, height, width)[::-1].astype(np.float32), done["ms"]
