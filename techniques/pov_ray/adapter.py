"""POV-Ray as a shadow technique: a run of povray for each picture; see pov_scene.py for how its picture is the mask.

The time of a resolve is what POV-Ray says that it traced for; reading the scene, which it does in each run, is the count `parse`.
"""

import numpy as np
from gnomon_engine import FramePairs, pair_of, require_version, version_of
from gnomon_technique import Technique, serve
from pov_holes import Holes
from pov_scene import SETTINGS, camera, grid_points, light_source, meshes_text, render


class PovRay(Technique):
    def setup(self):
        version = version_of(["povray", "--version"], r"POV-Ray ([0-9.]+[0-9])")
        require_version("POV-Ray", version, "3.7")
        self.maker = f"POV-Ray {version}"
        self.pairs = FramePairs()

    def build(self, scene):
        self.scene = scene
        self.corners = scene.corners(casters_only=False)
        self.meshes = [vars(mesh) for mesh in scene.meshes]
        has_holes = any(mesh.get("alpha_mask") for mesh in self.meshes)
        self.uv = scene.uv[scene.triangle].astype(float) if has_holes else None
        self.words = np.array(scene.alpha_mask_bits) if has_holes else None
        self.texts = {}

    def relight(self, light):
        self.light = light

    def run(self, gbuffer, shadows):
        curved = gbuffer.truth == "shape"
        if curved not in self.texts:
            holes = None if self.uv is None else Holes(self.words, self.uv, self.folder)
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
            mask[...] = np.where(gbuffer.faces(self.light, self.scene), done.picture >= 0.5, 1)
        self.ms = done.trace_ms
        self.counts = self.pairs.counts() | {"parse": (done.parse_ms, "ms"), "shadow_rays": done.shadow_rays}


serve(PovRay)
