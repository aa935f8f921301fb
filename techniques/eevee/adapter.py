"""Blender's EEVEE as a shadow technique: the mask is the ratio of a picture with shadows to one without.

A process of Blender runs beside this one and renders what it requests (eevee_side.py), without a window. The time of a resolve is
that of drawing the picture with shadows, with the programs that EEVEE makes anew for each picture; what Blender does before it is
the count `sync`.
"""

from pathlib import Path

import numpy as np
from gnomon_blender import HARD, lamp_of, rendered, start_blender
from gnomon_engine import FramePairs, pair_of
from gnomon_technique import Technique, serve

OF_LIGHTS = ("bias", "cascades", "exponent", "contact", "contact_distance", "contact_bias", "contact_thickness")
OF_SCENES = ("samples", "cube_size", "cascade_size", "bits", "soft_shadows")
REACH = 1.25  # of a light, in distances to the corner farthest from it: EEVEE fades it out to there, and its maps end there


class Eevee(Technique):
    def supports(self, scene, light, view):
        return "approximate", "frames of an engine: its own primary visibility"

    def setup(self):
        cycles = Path(__file__).resolve().parents[1] / "cycles"  # eevee_side.py imports from there
        script, environment = Path(__file__).with_name("eevee_side.py"), {"GNOMON_CYCLES": str(cycles), "LIBGL_ALWAYS_SOFTWARE": "1"}
        self.blender, version = start_blender(script, self.folder, self.threads, **environment)
        self.maker = f"Blender {version} (EEVEE): {self.blender.ask(do='facts')['gl']}"
        self.pairs = FramePairs()

    def build(self, scene):
        self.scene = scene
        self.corners = scene.corners(casters_only=False).astype(np.float32)
        np.save(Path(self.folder, "corners.npy"), self.corners)
        meshes = [{"first": int(mesh.first_triangle), "count": int(mesh.triangles), "casts": mesh.casts, "seen": True}
                  for mesh in scene.meshes]
        self.blender.ask(do="build", corners=str(Path(self.folder, "corners.npy")), meshes=meshes)

    def relight(self, light):
        """The light is as bright as gives 1 at the corner farthest from it: pictures hold 16 bits, of which a ratio has 11."""
        self.light = light
        reach, intensity = 0, np.pi
        if light.kind != "directional":
            place = light.position if light.kind in HARD else light.center
            farthest = np.linalg.norm(self.corners.reshape(-1, 3) - place, axis=1).max(initial=1e-3)
            reach, intensity = REACH * float(farthest), np.pi * farthest**2
            if light.kind not in HARD:
                is_disc = light.kind == "disc"
                intensity /= np.pi * light.radius**2 if is_disc else 4 * np.linalg.norm(np.cross(light.half_u, light.half_v))
        spot = None
        if light.kind == "spot":
            spot = {"axis": light.direction.tolist(), "outer": float(np.radians(light.outer_degrees))}
        self.blender.ask(do="relight", **lamp_of(light, intensity), reach=reach, spot=spot)

    def frame(self, gbuffer, shadows):
        of_light, of_scene = ({name: getattr(self.settings, name) for name in names} for names in (OF_LIGHTS, OF_SCENES))
        pixels, done = rendered(self, gbuffer, shadows=shadows, of_light=of_light, of_scene=of_scene)
        return pixels, done["draw_ms"], done["sync_ms"]

    def resolve(self, gbuffer, mask):
        drawn = self.pairs.draw(pair_of(self.light, gbuffer), lambda shadows: self.frame(gbuffer, shadows))
        (lit, self.ms, sync), (full, *_) = drawn
        share = np.clip(np.divide(lit, full, out=np.ones_like(full), where=full > 0), 0, 1)
        mask[...] = np.where(gbuffer.faces(self.light, self.scene), share, 1) if self.light.kind in HARD else share
        self.counts = self.pairs.counts() | {"sync": (sync, "ms")}


serve(Eevee)
