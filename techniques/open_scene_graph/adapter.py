"""OpenSceneGraph as a shadow technique: the shadow maps of osgShadow, drawn by gnomon_open_scene_graph (renderer.cpp), a program beside gnomon.

Meshes are white, their normals point to the one light, and there is no ambient light: so all that is lit is alike. osgShadow multiplies the light's color by what a map says: shadows
are black. The mask is the ratio of the frame with shadows to one without. Frames are drawn to a texture of the picture's size.
"""

import numpy as np
from gnomon_engine import Awaited, Child, Engine, is_closed, require_version
from gnomon_technique import serve

OF_MESHES = ("first_vertex", "vertices", "triangles", "casts", "receives")
ALL_ROUND_DEGREES = 180  # OpenGL's cutoff of a light without a cone


class OpenSceneGraphShadows(Engine):
    needs_display = True

    def supports(self, scene, light, view):
        if self.settings.shadows == "parallel_split" and light.kind != "directional":
            return "unsupported", f"ParallelSplitShadowMap supports no {light.kind} lights; it supports directional"
        why = ["frames of an engine: its own primary visibility"]
        if light.kind == "point":
            why.append("one frustum from the light, beyond which all is lit or in a mirrored shadow")
        return "approximate", "; ".join(why)

    def start(self):
        self.child = Child("gnomon_open_scene_graph", ["gnomon_open_scene_graph"])
        version = self.child.ask(do="hello")["version"]
        require_version("OpenSceneGraph", version, "3.6")
        self.maker = f"OpenSceneGraph {version}"

    def load(self, scene):
        self.triangle, self.vertices = np.asarray(scene.triangle), len(scene.position)
        meshes = [
            {key: getattr(mesh, key) for key in OF_MESHES} | {"is_closed": end > first and is_closed(self.corners[first:end])}
            for mesh, (first, end) in zip(scene.meshes, self.ranges)
        ]
        self.child.ask(do="load", position=self.file("position", scene.position), triangle=self.file("triangle", scene.triangle), meshes=meshes)

    def place_light(self, light):
        normal = np.zeros((self.vertices, 3), np.float32)
        normal[self.triangle] = self.to_light()
        placed = {"kind": light.kind, "cutoff_degrees": light.outer_degrees if light.kind == "spot" else ALL_ROUND_DEGREES}
        if light.kind != "directional":
            placed["position"] = light.position.tolist()
        aim = light.direction if light.kind != "point" else self.center() - light.position
        length = np.linalg.norm(aim)
        placed["aim"] = (aim / length).tolist() if length > 0 else [0, -1, 0]
        self.child.ask(do="relight", light=placed, normal=self.file("normal", normal))

    def center(self):
        """Of the box around all casters, at which osgShadow aims by itself where it is given no direction."""
        points = self.corners[self.casts].reshape(-1, 3).astype(float)
        return (points.min(axis=0) + points.max(axis=0)) / 2 if len(points) else np.zeros(3)

    def frame(self, camera, width, height, shadows):
        eye = {"eye": camera.eye.tolist(), "target": (camera.eye + camera.forward).tolist(), "up": camera.up.tolist()}
        lens = {"fov_y_degrees": camera.fov_y_degrees, "aspect": camera.aspect, "near": float(camera.near), "far": float(camera.far)}
        picture = Awaited(self.folder, "open_scene_graph_picture")
        # osgShadow measures light_margin along the light's axis, past the light where it is near.
        settings = vars(self.settings) | ({} if self.light.kind == "directional" else {"light_margin": 0})
        answer = self.child.ask(do="frame", width=width, height=height, shadows=shadows, settings=settings, picture=str(picture.path), **eye, **lens)
        return picture.array(np.uint8, height, width)[::-1], answer["ms"]


serve(OpenSceneGraphShadows)
