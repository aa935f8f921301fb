"""three.js as a shadow technique: the shadow maps of its WebGLRenderer, and the ShadowMesh of its add-ons.

Headless Chromium draws with three.js (page.mjs); a process of Node.js drives it (renderer.mjs). A frame is a float target of the
picture's size with one light over white, flat-shaded meshes of both sides: the frame with shadows over the one without is the mask.
"""

import os
import shutil
from pathlib import Path

import numpy as np
from gnomon_engine import Awaited, Child, Engine, require_version
from gnomon_technique import serve

VERSION = "187"
LEAST_SHARE = 0.01  # of the receiving area: what a flat mesh has that a user would give planar shadows
OF_FRAMES = ("map_size", "bias", "normal_bias", "radius", "blur_samples", "plane_offset")


def receiver_planes(scene):
    """Of each mesh its plane, [nx, ny, nz, n.p], if it receives and is flat and large; else None."""
    corners = scene.corners(casters_only=False)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double_area = np.linalg.norm(normals, axis=1)
    receives = np.array([mesh.receives for mesh in scene.meshes], bool)[scene.mesh]
    least = max(LEAST_SHARE * double_area[receives].sum(), 1e-30)

    def plane(mesh):
        own = slice(mesh.first_triangle, mesh.first_triangle + mesh.triangles)
        if not mesh.receives or double_area[own].sum() < least:
            return None
        largest = own.start + np.argmax(double_area[own])
        normal = normals[largest] / double_area[largest]
        constant = normal @ corners[largest, 0]
        is_flat = np.abs(corners[own] @ normal - constant).max() <= 1e-5 * np.abs(corners[own]).max()
        return [*normal.tolist(), float(constant)] if is_flat else None

    return [plane(mesh) for mesh in scene.meshes]


class ThreeJs(Engine):
    renderer = None

    def supports(self, scene, light, view):
        shadows, why = self.settings.shadows, ["frames of an engine: its own primary visibility"]
        if shadows == "vsm":
            if light.kind == "point":
                return "unsupported", "three.js has no variance maps for point lights"
            if any(mesh.receives and not mesh.casts for mesh in scene.meshes):
                why.append("what receives is drawn into the variance map, and so casts")
        if shadows == "planar":
            if not any(receiver_planes(scene)):
                return "unsupported", f"no flat mesh has {LEAST_SHARE:.0%} of the receiving area: a ShadowMesh lies in one plane"
            why.append("shadows lie in the planes of flat meshes, beyond their edges, too, and nowhere else")
        return "approximate", "; ".join(why)

    def start(self):
        if self.renderer:
            self.renderer.end()
        # What Chromium writes goes with the folder. One of it is a socket, whose name may have no more than 107 letters.
        short_name = f"/proc/{os.getpid()}/fd/{os.open(self.folder, os.O_RDONLY)}"
        command = ["node", str(Path(__file__).with_name("renderer.mjs"))]
        self.renderer = Child("three.js", command, TMPDIR=short_name, HOME=self.folder)
        facts = self.renderer.ask(do="start", folder=self.folder, program=shutil.which("chromium"), gl=self.settings.gl)
        require_version("three.js", facts["three"], VERSION)
        self.maker = f"three.js r{facts['three']} in Chromium {facts['browser']}: {facts['gl']}"

    def load(self, scene):
        self.corners.tofile(Path(self.folder, "corners"))
        parts = [
            {"first": first, "end": end, "casts": bool(self.casts[first]), "receives": bool(self.receives[first]), "plane": plane}
            for (first, end), plane in zip(self.ranges, receiver_planes(scene))
            if end > first
        ]
        self.renderer.ask(do="build", file="corners", parts=parts)

    def place_light(self, light):
        facts = {key: getattr(light, key).tolist() for key in ("position", "direction") if hasattr(light, key)}
        if light.kind == "spot":
            facts |= {"inner": np.radians(light.inner_degrees), "outer": np.radians(light.outer_degrees)}
        self.renderer.ask(do="relight", shadows=self.settings.shadows, kind=light.kind, **facts)

    def frame(self, camera, width, height, shadows):
        world = np.vstack((camera.right, camera.up, -camera.forward, camera.eye))  # columns of the camera's matrix
        world = np.column_stack((world, (0, 0, 0, 1))).ravel().tolist()
        eye = {"world": world, "fov_y_degrees": camera.fov_y_degrees, "near": camera.near, "far": camera.far}
        settings = {name: getattr(self.settings, name) for name in OF_FRAMES}
        picture = Awaited(self.folder, "picture")
        done = self.renderer.ask(do="frame", width=width, height=height, camera=eye, shadows=shadows, settings=settings, file="picture")
        return picture.array(np.float16, height, width)[::-1].astype(np.float32), done["ms"]


serve(ThreeJs)
