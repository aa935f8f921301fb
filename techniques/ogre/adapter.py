"""OGRE as a shadow technique: the stencil shadows and the texture shadows of its scene manager, in this process.

Each mesh of the scene is an entity of a material that is white by its own light (white.material), so that what is lit is white under
every light and no normal matters. OGRE's additive shadows draw all black first, then white once for the light: where the stencil
counts nothing, or multiplied by the shadow texture; depths are compared by the material's own program, as OGRE expects of its users. The
picture is the mask. Frames are drawn to a texture of the picture's size and end by glFinish.
"""

import atexit
import ctypes
import glob
import time
from pathlib import Path

import numpy as np
from gnomon_engine import Engine, is_closed, require_version
from gnomon_technique import serve

PLUGIN = "/usr/lib/*/OGRE/RenderSystem_GL.so"
PROGRAMS = "/usr/share/OGRE/Media/ShadowVolume"  # OGRE's own, which extrude shadow volumes
PART_TRIANGLES = 10922  # OGRE counts the vertices of a part's shadow volume, each twice, by 16 bits
WARM_FRAMES = 2  # shadow cameras are fitted to what the frame before has seen, by the eye and by themselves
LEAST_NEAR = 0.005  # of the far plane's distance: what casts from nearer to the light is left out, for want of bits of depth
KINDS = {"point": "LT_POINT", "spot": "LT_SPOTLIGHT", "directional": "LT_DIRECTIONAL"}


def set_optimal_adjust(setup, factor):
    """OGRE 1.12's create() leaves its arguments out, and its Python module reaches no setter from what create() gives: the setter
    and the getter are the fourth and the fifth virtual function of LiSPSMShadowCameraSetup."""
    place = int(setup.__deref__())
    functions = ctypes.cast(place, ctypes.POINTER(ctypes.POINTER(ctypes.c_void_p)))[0]
    ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_float)(functions[3])(place, factor)
    found = ctypes.CFUNCTYPE(ctypes.c_float, ctypes.c_void_p)(functions[4])(place)
    if not np.isclose(found, factor):
        raise RuntimeError(f"LiSPSMShadowCameraSetup's adjust factor is {found} instead of {factor}")


class OgreShadows(Engine):
    needs_display = True

    def supports(self, scene, light, view):
        why = ["frames of an engine: its own primary visibility"]
        if self.settings.shadows != "stencil":
            if self.settings.compares == "color":
                why.append("texture shadows without depth: what casts receives none, not even from other meshes")
            if light.kind == "point":
                why.append("one frustum of 120 degrees from the light, nothing beyond it is in shadow")
        return "approximate", "; ".join(why)

    def start(self):
        import Ogre  # here, since supports() does without

        self.ogre = Ogre
        version = f"{Ogre.OGRE_VERSION_MAJOR}.{Ogre.OGRE_VERSION_MINOR}.{Ogre.OGRE_VERSION_PATCH}"
        require_version("OGRE", version, "1.12")
        self.maker = f"OGRE {version} (RenderSystem_GL)"
        if not glob.glob(PLUGIN):
            raise RuntimeError(f"there is no {PLUGIN} (Debian: libogre-1.12-dev)")
        log = Ogre.LogManager()
        log.createLog("silent", True, False, True)  # no file, nothing on standard error
        log.disown()
        self.root = Ogre.Root("", "", "")  # neither plugins.cfg nor ogre.cfg nor Ogre.log
        self.root.loadPlugin(glob.glob(PLUGIN)[0])
        self.root.setRenderSystem(self.root.getAvailableRenderers()[0])
        self.root.initialise(False)
        atexit.register(self.end)
        hidden = Ogre.NameValuePairList()
        hidden["hidden"] = "true"
        self.root.createRenderWindow("hidden", 1, 1, False, hidden)
        self.finish = ctypes.CDLL("libGL.so.1").glFinish
        groups = Ogre.ResourceGroupManager.getSingleton()
        groups.addResourceLocation(str(Path(__file__).resolve().parent), "FileSystem", "General")
        groups.addResourceLocation(PROGRAMS, "FileSystem", "OgreInternal")
        groups.initialiseAllResourceGroups()
        self.caster = Ogre.MaterialManager.getSingleton().getByName("caster", "General")
        self.manager = self.root.createSceneManager("DefaultSceneManager")
        self.manager.setAmbientLight(Ogre.ColourValue(0, 0, 0))
        top = self.manager.getRootSceneNode()
        self.eye, self.eye_node = self.manager.createCamera("eye"), top.createChildSceneNode()
        self.eye_node.attachObject(self.eye)
        self.lamp, self.lamp_node = self.manager.createLight("lamp"), top.createChildSceneNode()
        self.lamp_node.attachObject(self.lamp)
        self.target, self.warm = None, set()
        self.resize(1, 1)
        self.manager.setShadowTechnique(Ogre.SHADOWTYPE_TEXTURE_ADDITIVE)
        self.target.update()  # makes OGRE's receiver, which takes all of an entity's material but that it has both sides
        receiver = Ogre.MaterialManager.getSingleton().getByName("Ogre/TextureShadowReceiver", "OgreInternal")
        receiver.getTechnique(0).getPass(0).setCullingMode(Ogre.CULL_NONE)

    def end(self):
        """Leaves the display before it ends."""
        self.root.shutdown()
        self.caster = self.root = None

    def load(self, scene):
        """Stencil shadows are cast by faces turned to the light alone: what is not closed is given both ways round."""
        self.warm.clear()
        self.manager.destroyAllEntities()
        self.ogre.MeshManager.getSingleton().removeAll()
        self.is_stencil = self.settings.shadows == "stencil"
        self.manager.setShadowTechnique(self.ogre.SHADOWTYPE_STENCIL_ADDITIVE if self.is_stencil else self.ogre.SHADOWTYPE_NONE)
        self.entities = []
        for first, end in self.ranges:
            if end > first:
                triangles = scene.triangle[first:end]
                entity = self.entity(f"mesh_{first}", scene.position, triangles, self.is_stencil and not is_closed(self.corners[first:end]))
                entity.setMaterialName("white" if self.receives[first] else "white_without_shadows")
                self.entities.append((entity, first, end))

    def entity(self, name, position, triangles, both_ways):
        """A mesh in parts of few vertices; OGRE matches its edges across them."""
        Ogre = self.ogre
        mesh = Ogre.MeshManager.getSingleton().createManual(name, "General")
        for start in range(0, len(triangles), PART_TRIANGLES):
            used, index = np.unique(triangles[start : start + PART_TRIANGLES], return_inverse=True)
            index = index.reshape(-1, 3).astype(np.uint32)
            self.fill(mesh.createSubMesh(), position[used], np.concatenate((index, index[:, ::-1])) if both_ways else index)
        points = position[triangles].reshape(-1, 3)
        mesh._setBounds(Ogre.AxisAlignedBox(*points.min(axis=0).tolist(), *points.max(axis=0).tolist()))
        mesh._setBoundingSphereRadius(float(np.linalg.norm(points, axis=1).max()))
        mesh.load()
        entity = self.manager.createEntity(mesh)
        self.manager.getRootSceneNode().attachObject(entity)
        return entity

    def fill(self, part, points, index):
        Ogre = self.ogre
        points, index = np.ascontiguousarray(points), np.ascontiguousarray(index)
        buffers, static = Ogre.HardwareBufferManager.getSingleton(), Ogre.HardwareBuffer.HBU_STATIC_WRITE_ONLY
        vertices = buffers.createVertexBuffer(12, len(points), static, True)
        vertices.writeData(0, points.nbytes, points)
        indices = buffers.createIndexBuffer(Ogre.HardwareIndexBuffer.IT_32BIT, index.size, static, True)
        indices.writeData(0, index.nbytes, index)
        data = Ogre.VertexData()
        data.disown()  # it is the part's
        data.vertexCount = len(points)
        data.vertexDeclaration.addElement(0, 0, Ogre.VET_FLOAT3, Ogre.VES_POSITION)
        data.vertexBufferBinding.setBinding(0, vertices)
        part.useSharedVertices, part.vertexData = False, data
        part.indexData.indexBuffer, part.indexData.indexCount = indices, index.size

    def place_light(self, light):
        Ogre = self.ogre
        self.warm.clear()
        self.lamp.setType(getattr(Ogre.Light, KINDS[light.kind]))
        if light.kind != "directional":
            self.lamp_node.setPosition(*light.position.tolist())
        if light.kind != "point":
            way = light.direction / np.linalg.norm(light.direction)
            self.lamp_node.resetOrientation()  # from which OGRE turns it
            self.lamp_node.setDirection(Ogre.Vector3(*way.tolist()), Ogre.Node.TS_WORLD)
        if light.kind == "spot":
            self.lamp.setSpotlightRange(*(Ogre.Radian(2 * float(np.radians(half))) for half in (light.inner_degrees, light.outer_degrees)))
        by_depth = self.is_stencil or self.settings.compares == "depth"
        for entity, first, end in self.entities:
            entity.setCastShadows(bool(self.casts[first]) and (by_depth or not self.has_nothing_behind(first, end)))

    def has_nothing_behind(self, first, end):
        """Whether a mesh is flat and all else on its side to the light, as a ground is. Without depth OGRE's user says that such a
        mesh does not cast; nothing of its shadow could be seen."""
        own = self.corners[first:end].astype(float)
        normals = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0])
        normal = normals[np.argmax((normals**2).sum(axis=1))]
        normal /= max(np.linalg.norm(normal), 1e-30)
        to_light = -self.light.direction if self.light.kind == "directional" else self.light.position - own[0, 0]
        normal *= np.sign(normal @ to_light)
        rounding = 1e-5 * np.abs(self.corners).max()  # some hundred times a float's
        return bool(((own - own[0, 0]) @ normal).max() <= rounding and ((self.corners - own[0, 0]) @ normal).min() >= -rounding)

    def frame(self, camera, width, height, shadows):
        Ogre = self.ogre
        if self.target is None or (self.target.getWidth(), self.target.getHeight()) != (width, height):
            self.resize(width, height)
        self.eye.setFOVy(Ogre.Radian(float(np.radians(camera.fov_y_degrees))))
        self.eye.setAspectRatio(camera.aspect)
        self.eye.setNearClipDistance(float(camera.near))
        self.eye.setFarClipDistance(0 if self.is_stencil else float(camera.far))  # 0: infinite, as its volumes are
        self.eye_node.setPosition(*camera.eye.tolist())
        axes = [Ogre.Vector3(*axis.tolist()) for axis in (camera.right, camera.up, -camera.forward)]
        self.eye_node.setOrientation(Ogre.Quaternion(*axes))
        has_map = shadows and not self.is_stencil
        if has_map:
            self.map_shadows(camera)
        self.view.setShadowsEnabled(shadows)
        self.view.setMaterialScheme("depth" if has_map and self.settings.compares == "depth" else "Default")
        # A first frame of its kind makes programs and buffers.
        for _ in range(WARM_FRAMES if has_map else shadows not in self.warm):
            self.target.update()
        self.warm.add(shadows)
        self.finish()
        start = time.perf_counter()
        self.target.update()
        self.finish()
        ms = 1000 * (time.perf_counter() - start)
        pixels = np.empty((height, width, 4), np.uint8)
        self.target.copyContentsToMemory(Ogre.Box(0, 0, width, height), Ogre.PixelBox(width, height, 1, Ogre.PF_BYTE_RGBA, pixels))
        return pixels[..., 0], ms

    def resize(self, width, height):
        Ogre = self.ogre
        self.warm.clear()
        textures = Ogre.TextureManager.getSingleton()
        if self.target is not None:
            textures.remove("frame", "General")
        frame = textures.createManual("frame", "General", Ogre.TEX_TYPE_2D, width, height, 1, 0, Ogre.PF_BYTE_RGBA, Ogre.TU_RENDERTARGET)
        self.target = frame.getBuffer().getRenderTarget()
        self.target.setAutoUpdated(False)
        self.view = self.target.addViewport(self.eye)
        self.view.setBackgroundColour(Ogre.ColourValue(0, 0, 0))
        self.view.setOverlaysEnabled(False)

    def map_shadows(self, camera):
        """A new shadow texture and its camera, which keep nothing of another view."""
        Ogre, settings = self.ogre, self.settings
        by_depth = settings.compares == "depth"
        self.manager.setShadowTechnique(Ogre.SHADOWTYPE_NONE)
        # RenderSystem_GL draws to no other depths than those of 16 bits.
        self.manager.setShadowTextureSettings(settings.map_size, 1, Ogre.PF_DEPTH16 if by_depth else Ogre.PF_BYTE_RGB)
        self.manager.setShadowTextureSelfShadow(by_depth)
        self.caster.getTechnique(0).getPass(0).setDepthBias(-settings.depth_bias, -settings.slope_bias)  # OGRE's draws nearer
        setups = {"texture": Ogre.DefaultShadowCameraSetup, "focused": Ogre.FocusedShadowCameraSetup, "lispsm": Ogre.LiSPSMShadowCameraSetup}
        setup = setups[settings.shadows].create()
        if settings.shadows == "lispsm":
            set_optimal_adjust(setup, settings.optimal_adjust)
        self.manager.setShadowCameraSetup(setup)
        self.manager.setShadowTechnique(Ogre.SHADOWTYPE_TEXTURE_ADDITIVE_INTEGRATED if by_depth else Ogre.SHADOWTYPE_TEXTURE_ADDITIVE)
        self.manager.setShadowFarDistance(float(camera.far))
        self.manager.setShadowDirLightTextureOffset(settings.offset)
        near, far = self.shadow_range(camera)
        self.lamp.setShadowNearClipDistance(float(near))
        self.lamp.setShadowFarClipDistance(float(far))

    def shadow_range(self, camera):
        """Near and far plane of the shadow camera, which OGRE leaves to its user."""
        points = self.corners.reshape(-1, 3).astype(float)
        if self.light.kind != "directional":
            far = 1.01 * np.linalg.norm(points - self.light.position, axis=1).max(initial=1)
            boxes = [self.corners[first:end].reshape(-1, 3) for _, first, end in self.entities]
            gaps = [np.maximum(box.min(axis=0) - self.light.position, self.light.position - box.max(axis=0)) for box in boxes]
            nearest = min((np.linalg.norm(np.maximum(gap, 0)) for gap in gaps), default=far)
            half = min(1.2 * self.light.outer_degrees, 87.5) if self.light.kind == "spot" else 60  # of OGRE's field of view
            corner = 1 / np.sqrt(1 + 2 * np.tan(np.radians(half)) ** 2)  # the cosine to a corner of the frustum
            return max(0.99 * corner * nearest, LEAST_NEAR * far), far
        target = camera.eye + self.settings.offset * camera.far * camera.forward  # at which OGRE aims
        depth = (points - target) @ self.light.direction / np.linalg.norm(self.light.direction)
        before, behind = -depth.min(initial=0), depth.max(initial=0)
        near = 0.01 * (before + behind + 1)
        self.manager.setShadowDirectionalLightExtrusionDistance(float(before + 2 * near))
        # Half the width of the map, too: the far plane takes the place of the shadows' far distance.
        return near, max(before + behind + 3 * near, camera.far)


serve(OgreShadows)
