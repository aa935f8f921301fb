"""Runs within Blender, as techniques/cycles/blender_side.py, and draws pictures with EEVEE."""

import os
import sys
import time

import bpy
import gpu
import numpy as np
from mathutils import Matrix, Vector

sys.path.append(os.environ["GNOMON_CYCLES"])
import blender_side  # noqa: E402

CONE_MARGIN = 1.01  # of a spot's tangent, so that light is on all of its rim's pixels


class Eevee(blender_side.Renderer):
    def __init__(self, folder, threads):
        super().__init__(folder, threads)
        self.scene.render.engine = "BLENDER_EEVEE"
        self.scene.render.filter_size = 0  # every sample is at the center of its pixel
        self.white_without_shadow = self.white_material("white_without_shadow")
        self.white_without_shadow.shadow_method = "NONE"

    def facts(self):
        """Draws a picture first: before it there is no OpenGL."""
        self.look(np.eye(4).tolist(), 1, 0.1, 1, 16, 16)
        self.scene.eevee.taa_render_samples = 1
        self.render()
        return {"gl": gpu.platform.renderer_get()}

    def build(self, corners, meshes):
        super().build(corners, meshes)
        for item, facts in zip(self.objects, (facts for facts in meshes if facts["count"])):
            item.data.materials[0] = self.white if facts["casts"] else self.white_without_shadow

    def relight(self, reach, spot, **lamp):
        """`reach`: how far from it a light is gone, 0 of a sun. `spot`: None, or its axis and its half angle in radians."""
        super().relight(**lamp)
        for light in self.lights:
            if reach:
                light.use_custom_distance, light.cutoff_distance = True, reach
        if spot:
            item = next(item for item in self.scene.objects if item.type == "LIGHT")
            place = item.matrix_world.translation.copy()
            self.lights[0].type = "SPOT"
            light = self.lights[0] = item.data
            light.spot_size = 2 * min(np.arctan(CONE_MARGIN * np.tan(spot["outer"])), np.radians(89.9))
            light.spot_blend = 0
            item.matrix_world = Matrix.Translation(place) @ Vector(spot["axis"]).to_track_quat("-Z", "Y").to_matrix().to_4x4()

    def frame(self, shadows, of_light, of_scene, out, **view):
        self.look(**view)
        eevee = self.scene.eevee
        eevee.taa_render_samples = of_scene["samples"]
        eevee.shadow_cube_size, eevee.shadow_cascade_size = of_scene["cube_size"], of_scene["cascade_size"]
        eevee.use_shadow_high_bitdepth, eevee.use_soft_shadows = of_scene["bits"] == "24", of_scene["soft_shadows"]
        for light in self.lights:
            light.use_shadow = shadows
            light.shadow_buffer_bias = of_light["bias"]
            light.use_contact_shadow = of_light["contact"]
            for name in ("distance", "bias", "thickness"):
                setattr(light, f"contact_shadow_{name}", of_light[f"contact_{name}"])
            if light.type == "SUN":
                light.shadow_cascade_count, light.shadow_cascade_exponent = of_light["cascades"], of_light["exponent"]
                light.shadow_cascade_max_distance = view["far"]
        said = self.render()
        end = time.perf_counter()
        start = next(when for line, when in said if "| Rendering 1 /" in line)
        self.save(out)
        return {"draw_ms": 1000 * (end - start), "sync_ms": 1000 * (start - said[0][1])}


if __name__ == "__main__":
    blender_side.main(Eevee)
