"""POV-Ray as a shadow technique: a run of povray for each picture; see pov_scene.py for how its picture is the mask.

The time of a resolve is what POV-Ray says that it traced for; reading the scene, which it does in each run, is the count `parse`.
"""

import re

import numpy as np
from gnomon_engine import FramePairs, pair_of, require_version
from gnomon_technique import Technique, serve
from pov_holes import Holes, is_painted, textures, why_not
from pov_scene import SCALE, SETTINGS, camera, grid_points, light_source, meshes_text, render, started


class PovRay(Technique):
    def supports(self, scene, light, view):
        for mesh in scene.meshes:
            if not is_painted(vars(mesh)):
                continue
            triangles = scene.triangle[mesh.first_triangle:mesh.first_triangle + mesh.triangles]
            why = why_not(vars(mesh), SCALE * scene.position[triangles].astype(float), scene.uv[triangles].astype(float))
            if why:
                return "unsupported", why
        return "full"

    def setup(self):
        found = re.search(r"POV-Ray ([0-9.]+[0-9])", started(["--version"], self.folder)[1])
        version = found[1] if found else ""
        require_version("POV-Ray", version, "3.7")
        self.maker = f"POV-Ray {version}"
        self.pairs = FramePairs()

    def build(self, scene):
        self.scene = scene
        self.corners = scene.corners(casters_only=False)
        self.meshes = [vars(mesh) for mesh in scene.meshes]
        self.has_glass = any(mesh["casts"] and mesh.get("transmission") for mesh in self.meshes)
        self.uv = scene.uv[scene.triangle].astype(float) if any(map(textures, self.meshes)) else None
        self.words, self.values = (None if array is None else np.array(array)
                                   for array in (getattr(scene, name, None) for name in ("alpha_mask_bits", "transmission_values")))
        self.texts = {}

    def relight(self, light):
        self.light = light

    def run(self, gbuffer, shadows):
        curved = gbuffer.truth == "shape"
        if curved not in self.texts:
            holes = None if self.uv is None else Holes(self.words, self.values, self.uv, self.folder)
            self.texts[curved] = meshes_text(self.meshes, self.corners, curved, holes)
        text = SETTINGS + camera(vars(gbuffer.view), gbuffer.width, gbuffer.height)
        if len(self.corners):
            text += light_source(vars(self.light), self.corners, self.settings.grid, shadows) + self.texts[curved]
        return render(text, gbuffer.width, gbuffer.height, self.folder, self.threads)

    def share_above(self, gbuffer):
        """The share of the light's points above each pixel's horizon."""
        normal = gbuffer.normal.astype(float)
        height = np.einsum("ijk,ijk->ij", normal, gbuffer.position.astype(float))
        points = grid_points(vars(self.light), self.settings.grid)
        return sum(normal @ point > height for point in points) / len(points)

    def resolve(self, gbuffer, mask):
        done, _ = self.pairs.draw(pair_of(self.light, gbuffer), lambda shadows: self.run(gbuffer, shadows))
        if self.light.kind == "rect":
            # what is below the horizon is hidden by the surface itself and counted by POV-Ray, but neither lit nor dark here
            above = self.share_above(gbuffer)
            mask[...] = np.where(above > 0, np.clip(done.picture / np.maximum(above, 1e-6) ** 2, 0, 1), 1)
        else:
            share = done.picture if self.has_glass else done.picture >= 0.5
            mask[...] = np.where(gbuffer.faces(self.light, self.scene), share, 1)
        self.ms = done.trace_ms
        self.counts = self.pairs.counts() | {"parse": (done.parse_ms, "ms"), "shadow_rays": done.shadow_rays}


serve(PovRay)
