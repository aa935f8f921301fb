"""OGRE as a shadow technique: stencil shadows and texture shadows of its scene manager.

Each mesh is an entity, its material white by its own light (emissive) in the pass that OGRE draws for each light, so that a lit
pixel is white under every light and no normal matters. Additive shadows leave that pass out where the stencil counts, or
multiply it by the shadow texture: the picture is the mask. Frames go to a texture of the picture's size and end by glFinish.
"""

import ctypes
import glob
import os
import time

import numpy as np
from gnomon_engine import Engine, require_version
from gnomon_technique import serve

PLUGIN = "/usr/lib/*/OGRE/RenderSystem_GL.so"
MEDIA = "/usr/share/OGRE/Media/ShadowVolume"  # OGRE's own programs, which extrude shadow volumes
PART_TRIANGLES = 10922  # OGRE counts the vertices of a part's shadow volume, each twice, by 16 bits
WARM_FRAMES = 3  # setups of shadow cameras fit to what the frame before has seen
KINDS = {"point": "LT_POINT", "spot": "LT_SPOTLIGHT", "directional": "LT_DIRECTIONAL"}


def is_closed(corners):
    """Whether each edge of a mesh, triangles x 3 x 3, is passed once each way: OGRE casts from faces turned to the light alone."""
    _, place = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    place = place.reshape(-1, 3).astype(np.int64)
    start, end = place.ravel(), np.roll(place, -1, axis=1).ravel()
    passed = np.sort(start * (place.max() + 1) + end)
    return np.array_equal(passed, np.sort(end * (place.max() + 1) + start)) and np.all(np.diff(passed) > 0)


class OgreShadows(Engine):
    needs_display = True

    def supports(self, scene, light, view):
        shadows = self.settings.shadows
        why = ["frames of an engine: its own primary visibility"]
        if shadows != "stencil":
            if self.settings.compares == "color":
                why.append("texture shadows without depth: OGRE lets no caster receive")
            if light.kind == "point":
                why.append("one frustum of 120 degrees from the light")
        return "approximate", "; ".join(why)

    def start(self):
        import Ogre  # which supports() does without

        self.ogre = Ogre
        require_version("OGRE", f"{Ogre.OGRE_VERSION_MAJOR}.{Ogre.OGRE_VERSION_MINOR}.{Ogre.OGRE_VERSION_PATCH}", "1.12")
        log = Ogre.LogManager()
        log.createLog("/tmp/ogre.log", True, False, False)  # no file, nothing on standard error
        log.disown()
        self.root = Ogre.Root("", "", "")
        self.root.loadPlugin(glob.glob(PLUGIN)[0])
        self.root.setRenderSystem(self.root.getAvailableRenderers()[0])
        self.root.initialise(False)
        hidden = Ogre.NameValuePairList()
        hidden["hidden"] = "true"
        self.window = self.root.createRenderWindow("hidden", 1, 1, False, hidden)
        groups = Ogre.ResourceGroupManager.getSingleton()
        groups.addResourceLocation(os.path.dirname(os.path.abspath(__file__)), "FileSystem", "General")
        groups.addResourceLocation(MEDIA, "FileSystem", "OgreInternal")
        groups.initialiseAllResourceGroups()
        self.finish = ctypes.CDLL("libGL.so.1").glFinish
        self.maker = f"OGRE {Ogre.OGRE_VERSION_MAJOR}.{Ogre.OGRE_VERSION_MINOR}.{Ogre.OGRE_VERSION_PATCH} (RenderSystem_GL)"
        self.scene = self.root.createSceneManager("DefaultSceneManager")
        self.scene.setAmbientLight(Ogre.ColourValue(0, 0, 0))
        self.camera = self.scene.createCamera("eye")
        self.eye = self.scene.getRootSceneNode().createChildSceneNode()
        self.eye.attachObject(self.camera)
        self.sun = self.scene.createLight("light")
        self.lamp = self.scene.getRootSceneNode().createChildSceneNode()
        self.lamp.attachObject(self.sun)
        self.target, self.size = None, None
        self.caster = Ogre.MaterialManager.getSingleton().getByName("caster", "General")

    def load(self, scene):
        Ogre = self.ogre
        self.scene.destroyAllEntities()
        Ogre.MeshManager.getSingleton().removeAll()
        stencil = self.settings.shadows == "stencil"
        self.scene.setShadowTechnique(Ogre.SHADOWTYPE_STENCIL_ADDITIVE if stencil else Ogre.SHADOWTYPE_NONE)
        self.entities = [self.entity(first, end, stencil and not is_closed(self.corners[first:end])) for first, end in self.ranges if end > first]

    def entity(self, first, end, both_sides):
        """A mesh in parts of few vertices; its edges are matched across them."""
        Ogre = self.ogre
        mesh = Ogre.MeshManager.getSingleton().createManual(f"mesh_{first}", "General")
        for start in range(first, end, PART_TRIANGLES):
            self.part(mesh.createSubMesh(), self.corners[start : min(start + PART_TRIANGLES, end)].reshape(-1, 3), both_sides)
        corners = self.corners[first:end].reshape(-1, 3)
        mesh._setBounds(Ogre.AxisAlignedBox(*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist()))
        mesh._setBoundingSphereRadius(float(np.linalg.norm(corners, axis=1).max()))
        mesh.load()
        entity = self.scene.createEntity(mesh)
        entity.setMaterialName("white" if self.receives[first] else "white_without_shadows")
        self.scene.getRootSceneNode().attachObject(entity)
        return entity, first, end

    def part(self, part, corners, both_sides):
        Ogre = self.ogre
        index = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
        if both_sides:
            index = np.concatenate((index, index[:, ::-1]))
        index = np.ascontiguousarray(index)
        buffers, static = Ogre.HardwareBufferManager.getSingleton(), Ogre.HardwareBuffer.HBU_STATIC_WRITE_ONLY
        vertices = buffers.createVertexBuffer(12, len(corners), static, True)
        vertices.writeData(0, corners.nbytes, corners)
        indices = buffers.createIndexBuffer(Ogre.HardwareIndexBuffer.IT_32BIT, index.size, static, True)
        indices.writeData(0, index.nbytes, index)
        data = Ogre.VertexData()
        data.disown()  # it is the mesh's
        data.vertexCount = len(corners)
        data.vertexDeclaration.addElement(0, 0, Ogre.VET_FLOAT3, Ogre.VES_POSITION)
        data.vertexBufferBinding.setBinding(0, vertices)
        part.useSharedVertices, part.vertexData = False, data
        part.indexData.indexBuffer, part.indexData.indexCount = indices, index.size

    def place_light(self, light):
        Ogre = self.ogre
        self.sun.setType(getattr(Ogre.Light, KINDS[light.kind]))
        if light.kind != "directional":
            self.lamp.setPosition(*light.position.tolist())
        if light.kind != "point":
            way = Ogre.Vector3(*(light.direction / np.linalg.norm(light.direction)).tolist())
            self.lamp.setDirection(way, Ogre.Node.TS_WORLD)
        if light.kind == "spot":
            self.sun.setSpotlightRange(Ogre.Degree(2 * light.inner_degrees), Ogre.Degree(2 * light.outer_degrees))
        receivers_only = self.settings.shadows != "stencil" and self.settings.compares == "color"
        for entity, first, end in self.entities:
            entity.setCastShadows(bool(self.casts[first]) and not (receivers_only and self.has_nothing_behind(first, end)))

    def has_nothing_behind(self, first, end):
        """Whether a mesh is flat and all else lies on its side to the light, as on a ground."""
        sides = self.corners[first:end].astype(float)
        normals = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
        normal = normals[np.argmax((normals**2).sum(axis=1))]
        normal = normal / max(np.linalg.norm(normal), 1e-30)
        if self.light.kind == "directional":
            normal = normal * np.sign(-normal @ self.light.direction)
        else:
            normal = normal * np.sign(normal @ (self.light.position - sides[0, 0]))
        least = -1e-5 * np.ptp(self.corners.reshape(-1, 3), axis=0).max()  # of all coordinates: float's own rounding
        return ((self.corners - sides[0, 0]) @ normal).min() >= least and ((sides - sides[0, 0]) @ normal).max() <= -least

    def frame(self, camera, width, height, shadows):
        Ogre = self.ogre
        if self.size != (width, height):
            self.resize(width, height)
        self.camera.setFOVy(Ogre.Radian(float(np.radians(camera.fov_y_degrees))))
        self.camera.setAspectRatio(camera.aspect)
        self.camera.setNearClipDistance(float(camera.near))
        self.camera.setFarClipDistance(0 if self.settings.shadows == "stencil" else float(camera.far))
        self.eye.setPosition(*camera.eye.tolist())
        axes = [Ogre.Vector3(*axis.tolist()) for axis in (camera.right, camera.up, -camera.forward)]
        self.eye.setOrientation(Ogre.Quaternion(*axes))
        self.viewport.setShadowsEnabled(shadows)
        self.viewport.setMaterialScheme("depth" if shadows and self.settings.shadows != "stencil" and self.settings.compares == "depth" else "Default")
        frames = 1  # compiles and loads
        if shadows and self.settings.shadows != "stencil":
            self.map_shadows(camera)
            frames = WARM_FRAMES
        for _ in range(frames):
            self.target.update()
        self.finish()
        start = time.perf_counter()
        self.target.update()
        self.finish()
        ms = 1000 * (time.perf_counter() - start)
        pixels = np.empty((height, width, 4), np.uint8)
        self.target.copyContentsToMemory(Ogre.Box(0, 0, width, height), Ogre.PixelBox(width, height, 1, Ogre.PF_BYTE_RGBA, pixels))
        if shadows and os.environ.get("DBG"):
            t = self.scene.getShadowTexture(0)
            print("FORMAT", t.getFormat(), t.getWidth(), Ogre.PF_DEPTH32)
            d = np.empty((t.getHeight(), t.getWidth()), np.float32)
            t.getBuffer().blitToMemory(Ogre.Box(0, 0, t.getWidth(), t.getHeight()), Ogre.PixelBox(t.getWidth(), t.getHeight(), 1, Ogre.PF_FLOAT32_R, d))
            np.save("/tmp/d.npy", d)
            np.save("/tmp/p.npy", pixels)
        return pixels[..., 0], ms

    def map_shadows(self, camera):
        """A fresh shadow texture and camera, as if this view were the first."""
        Ogre, settings = self.ogre, self.settings
        by_depth = settings.compares == "depth"
        self.scene.setShadowTechnique(Ogre.SHADOWTYPE_NONE)
        self.scene.setShadowTextureSettings(settings.map_size, 1, Ogre.PF_DEPTH16 if by_depth else Ogre.PF_BYTE_RGB)
        self.scene.setShadowTextureSelfShadow(by_depth)
        if by_depth:
            self.caster.getTechnique(0).getPass(0).setDepthBias(-settings.depth_bias, -settings.slope_bias)
        self.scene.setShadowTechnique(Ogre.SHADOWTYPE_TEXTURE_ADDITIVE_INTEGRATED if by_depth else Ogre.SHADOWTYPE_TEXTURE_ADDITIVE)
        setups = {"texture": Ogre.DefaultShadowCameraSetup, "focused": Ogre.FocusedShadowCameraSetup, "lispsm": Ogre.LiSPSMShadowCameraSetup}
        self.scene.setShadowCameraSetup(setups[settings.shadows].create())
        self.scene.setShadowFarDistance(float(camera.far))
        self.scene.setShadowDirLightTextureOffset(settings.offset)
        points = self.corners.reshape(-1, 3).astype(float)
        if self.light.kind == "directional":
            target = camera.eye + settings.offset * camera.far * camera.forward
            depth = (points - target) @ self.light.direction / np.linalg.norm(self.light.direction)
            before, behind = -depth.min(initial=0), depth.max(initial=0)
            near = 0.01 * (before + behind + 1)
            self.scene.setShadowDirectionalLightExtrusionDistance(float(before + 2 * near))
            far = max(before + behind + 3 * near, camera.far)
        else:
            boxes = [points[3 * first : 3 * end] for first, end in self.ranges if end > first]
            gaps = [np.maximum(box.min(axis=0) - self.light.position, self.light.position - box.max(axis=0)) for box in boxes]
            far = 1.01 * np.linalg.norm(points - self.light.position, axis=1).max(initial=1)
            near = max(0.99 * min((np.linalg.norm(np.maximum(gap, 0)) for gap in gaps), default=0), 0.01 * far)
        self.sun.setShadowNearClipDistance(float(near))
        self.sun.setShadowFarClipDistance(float(far))

    def resize(self, width, height):
        Ogre = self.ogre
        textures = Ogre.TextureManager.getSingleton()
        if self.size:
            textures.remove("frame", "General")
        texture = textures.createManual("frame", "General", Ogre.TEX_TYPE_2D, width, height, 1, 0, Ogre.PF_BYTE_RGBA, Ogre.TU_RENDERTARGET)
        self.target = texture.getBuffer().getRenderTarget()
        self.target.setAutoUpdated(False)
        self.viewport = self.target.addViewport(self.camera)
        self.viewport.setBackgroundColour(Ogre.ColourValue(0, 0, 0))
        self.viewport.setOverlaysEnabled(False)
        self.size = (width, height)


serve(OgreShadows)
