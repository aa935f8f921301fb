"""Filament as a shadow technique: the maps of its suns and spots, drawn by gnomon_filament (renderer.cpp), a program beside gnomon.

The material is white and lit by the one light: the frame with shadows over the one without is the mask. Frames are drawn to a
texture of floats of the picture's size, without what Filament does to pictures afterwards.
"""

import numpy as np
from gnomon_engine import Awaited, Child, Engine, require_version
from gnomon_technique import serve

REACH = 1.25  # of a spot, in distances to the corner farthest from it: its map ends there
CONE_MARGIN = 1.01  # of a spot's tangent, so that light is on all of its rim's pixels


class Filament(Engine):
    needs_display = True

    def supports(self, scene, light, view):
        if light.kind == "point":
            return "unsupported", "Filament 1.9 draws no shadows of point lights; it supports directional and spot"
        why = ["frames of an engine: its own primary visibility"]
        if self.settings.filter == "vsm" and light.kind == "spot" and any(mesh.receives and not mesh.casts for mesh in scene.meshes):
            why.append("what receives is drawn into the variance map of a spot, and so casts")
        return "approximate", "; ".join(why)

    def start(self):
        self.child = Child("gnomon_filament", ["gnomon_filament"])
        version = self.child.ask(do="hello")["version"]
        require_version("Filament", version, "1.9")
        self.maker = f"Filament {version}"

    def load(self, scene):
        normals = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.where(length > 0, normals / np.maximum(length, 1e-30), [0, 1, 0])  # a triangle without area is seen by nobody
        meshes = [{"corners": 3 * (end - first), "casts": mesh.casts, "receives": mesh.receives} for mesh, (first, end) in zip(scene.meshes, self.ranges)]
        self.child.ask(do="load", position=self.file("position", self.corners), normal=self.file("normal", np.repeat(normals, 3, axis=0).astype(np.float32)), meshes=meshes)

    def place_light(self, light):
        placed = {"kind": light.kind, "direction": (light.direction / np.linalg.norm(light.direction)).tolist()}
        if light.kind == "spot":
            placed["position"] = light.position.tolist()
            placed["reach"] = REACH * float(np.linalg.norm(self.corners.reshape(-1, 3) - light.position, axis=1).max(initial=1e-3))
            placed["angle"] = float(np.arctan(CONE_MARGIN * np.tan(np.radians(light.outer_degrees))))
        self.child.ask(do="relight", light=placed)

    def frame(self, camera, width, height, shadows):
        eye = {"eye": camera.eye.tolist(), "target": (camera.eye + camera.forward).tolist(), "up": camera.up.tolist()}
        lens = {"fov_y_degrees": camera.fov_y_degrees, "aspect": camera.aspect, "near": float(camera.near), "far": float(camera.far)}
        picture = Awaited(self.folder, "filament_picture")
        answer = self.child.ask(do="frame", width=width, height=height, shadows=shadows, settings=vars(self.settings), picture=str(picture.path), **eye, **lens)
        return picture.array(np.float32, height, width), answer["ms"]


serve(Filament)
