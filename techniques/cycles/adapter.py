"""Blender's Cycles as a shadow technique: the mask is the ratio of a rendering with cast shadows to one without.

A process of Blender runs beside this one and renders what it requests (blender_side.py). Lights without area take one ray a pixel; lights
with area take `samples` paths of one bounce, so what is estimated is the share of the irradiance. The time of a resolve is
that of tracing the picture with shadows; what Blender does before it (taking the scene over, its tree) is the count `sync`.
"""

from pathlib import Path

import numpy as np
from gnomon_blender import HARD, lamp_of, rendered, start_blender
from gnomon_engine import FramePairs, pair_of
from gnomon_technique import Technique, serve


def textures(mesh):
    """The alpha mask and the transmission of a mesh, by these names, where it has them."""
    some = {name: getattr(mesh, name, None) for name in ("alpha_mask", "transmission")}
    return {name: texture for name, texture in some.items() if texture} if mesh.triangles else {}


def wraps_of(texture):
    """How it goes on beyond its borders along u and v; a single texel repeats, whatever is said of it."""
    return [texture[wrap] if texture[side] > 1 else "repeat" for wrap, side in (("wrap_u", "width"), ("wrap_v", "height"))]


def why_not(mesh):
    """Why Blender cannot draw a mesh; "" where it can."""
    for name, texture in textures(mesh).items():
        u, v = wraps_of(texture)
        if [u, v].count("clamp") == 1:
            return (f"the {name.replace('_', ' ')} of mesh '{mesh.name}' has wrap {u} along u and {v} along v; Blender clamps "
                    "along both or along none")
    return ""


def texels_of(texture, scene):
    """Of an alpha mask its bits, of a transmission of one channel what its texels let through: height x width."""
    height, width = texture["height"], texture["width"]
    if "first_value" in texture:
        return np.asarray(scene.transmission_values, np.float32)[texture["first_value"]:][:height * width].reshape(height, width)
    rows = np.asarray(scene.alpha_mask_bits, "<u4")[texture["first_word"]:][:height * -(-width // 32)].reshape(height, -1)
    return np.unpackbits(np.ascontiguousarray(rows).view(np.uint8), axis=1, bitorder="little")[:, :width]


def picture_of(texture, texels, uv):
    """Of a texture: its texels, how Blender continues them beyond their borders, and the uv in them. The first row is the lower one
    for Blender, as v = 0 is. Mirrored texels are twice as many, which repeat: Blender 3.4 mirrors none."""
    wraps, uv = wraps_of(texture), np.array(uv, np.float32)
    for axis, wrap in enumerate(wraps):
        if wrap == "mirror":
            texels = np.concatenate((texels, np.flip(texels, 1 - axis)), 1 - axis)
            uv[..., axis] /= 2
    return texels, "EXTEND" if "clamp" in wraps else "REPEAT", uv


class Cycles(Technique):
    def supports(self, scene, light, view):
        why = next(filter(None, map(why_not, scene.meshes)), None)
        return ("unsupported", why) if why else "full"

    def setup(self):
        self.blender, version = start_blender(Path(__file__).with_name("blender_side.py"), self.folder, self.threads)
        self.maker = f"Blender {version} (Cycles)"
        self.pairs = FramePairs()

    def build(self, scene):
        self.scene = scene
        self.corners = scene.corners(casters_only=False).astype(np.float32)
        np.save(Path(self.folder, "corners.npy"), self.corners)
        meshes = [{"first": int(mesh.first_triangle), "count": int(mesh.triangles), "casts": mesh.casts, "seen": getattr(mesh, "seen", True)}
                  | {name: self.texture(name, scene, k) for name in textures(mesh)} for k, mesh in enumerate(scene.meshes)]
        self.has_glass = any(mesh["casts"] and "transmission" in mesh for mesh in meshes)
        self.blender.ask(do="build", corners=str(Path(self.folder, "corners.npy")), meshes=meshes)

    def texture(self, name, scene, k):
        """Of mesh k: a number where its texture has one texel; else the files of the texels and of the uv of its triangles' corners,
        and how the texels go on."""
        mesh = scene.meshes[k]
        texture = getattr(mesh, name)
        texels = texels_of(texture, scene)
        if texels.size == 1:
            return float(texels[0, 0])
        triangles = scene.triangle[mesh.first_triangle:mesh.first_triangle + mesh.triangles]
        texels, extension, uv = picture_of(texture, texels, scene.uv[triangles])
        first = texture["first_value" if name == "transmission" else "first_word"]  # meshes share a texture
        files = [str(Path(self.folder, file)) for file in (f"{name}_{first}.npy", f"{name}_uv_{k}.npy")]
        for file, array in zip(files, (texels, uv)):
            np.save(file, array)
        return [*files, extension]

    def relight(self, light):
        self.light = light
        self.blender.ask(do="relight", **lamp_of(light, light.intensity))
        self.is_hard = light.kind in HARD

    def frame(self, gbuffer, shadows):
        samples = 1 if self.is_hard else self.settings.samples
        pixels, done = rendered(self, gbuffer, shadows=shadows, samples=samples, seed=self.settings.seed)
        return pixels, done["trace_ms"], done["sync_ms"]

    def resolve(self, gbuffer, mask):
        (lit, self.ms, sync), (full, *_) = self.pairs.draw(pair_of(self.light, gbuffer), lambda shadows: self.frame(gbuffer, shadows))
        share = np.clip(np.divide(lit, full, out=np.ones_like(full), where=full > 0), 0, 1)
        if self.is_hard:
            share = np.where(gbuffer.faces(self.light, self.scene), share if self.has_glass else share >= 0.5, 1)
        mask[...] = share
        self.counts = self.pairs.counts() | {"sync": (sync, "ms")}


serve(Cycles)
