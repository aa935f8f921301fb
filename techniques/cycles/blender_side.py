"""Runs within Blender: takes scene, light and camera as lines of JSON, renders pictures with Cycles, and answers each line by one.

Requests come on standard input, answers go to the file descriptor that the variable GNOMON_ANSWERS names.
"""

import json
import os
import sys
import time
import traceback
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector


class Renderer:
    def __init__(self, folder, threads):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.folder, self.scene, self.lights, self.objects = Path(folder), bpy.context.scene, [], []
        self.scene.world = bpy.data.worlds.new("dark")
        self.scene.world.use_nodes = False
        self.scene.world.color = (0, 0, 0)
        render, cycles = self.scene.render, self.scene.cycles
        render.engine, cycles.device = "CYCLES", "CPU"
        render.threads_mode, render.threads = "FIXED", threads
        render.use_persistent_data = False  # kept data would keep an old light's flag for shadows
        render.use_compositing = render.use_sequencer = False
        cycles.max_bounces = 0
        cycles.use_denoising = cycles.use_adaptive_sampling = False
        cycles.light_sampling_threshold = 0
        cycles.sample_clamp_direct = 0
        cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01  # rays through the centers of pixels; a box is always a pixel wide
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        self.white, self.materials, self.images = self.white_material("white"), {}, {}
        self.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        self.scene.collection.objects.link(self.camera)
        self.scene.camera = self.camera
        self.steps = []  # when Blender reported each step of a render
        bpy.app.handlers.render_stats.append(lambda *_: self.steps.append(time.perf_counter()))

    @staticmethod
    def white_material(name):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        nodes = material.node_tree.nodes
        nodes.clear()
        diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
        diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
        material.node_tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
        return material

    def image(self, file):
        """Of the texels of a file, each as it is."""
        if file not in self.images:
            texels = np.load(file)
            image = self.images[file] = bpy.data.images.new("texels", texels.shape[1], texels.shape[0], is_data=True,
                                                            float_buffer=bool(texels.dtype == np.float32))
            image.pixels.foreach_set(np.stack((texels, texels, texels, np.ones_like(texels)), -1).astype(np.float32).ravel())
            image.update()
        return self.images[file]

    def material(self, textures):
        """White where the alpha mask is 1, and not there at all where it is 0. A transmission is what light passes of that, but not
        the eye. Each texture is a number, or the files of texels and of uv, and how the texels go on: the texel that holds a place
        counts."""
        key = tuple((name, texture if isinstance(texture, float) else (texture[0], texture[2])) for name, texture in textures.items())
        if key in self.materials:
            return self.materials[key]
        material = self.materials[key] = self.white_material("pierced")
        nodes, links = material.node_tree.nodes, material.node_tree.links
        surface, output = nodes["Diffuse BSDF"].outputs[0], nodes["Material Output"]

        def filled(name, plug):
            """Puts a texture of the mesh into an input."""
            texture = textures[name]
            if isinstance(texture, float):
                plug.default_value = (texture, texture, texture, 1) if plug.type == "RGBA" else texture
                return
            place, sample = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeTexImage")
            place.uv_map, sample.image, sample.interpolation, sample.extension = name, self.image(texture[0]), "Closest", texture[2]
            links.new(place.outputs["UV"], sample.inputs["Vector"])
            source = sample.outputs["Color"]
            if plug.type != "RGBA":
                red = nodes.new("ShaderNodeSeparateColor")
                links.new(source, red.inputs["Color"])
                source = red.outputs["Red"]
            links.new(source, plug)

        def mixed(clear, solid):
            """The mix of a transparent surface and a solid one, and its input that is 1 where it is the latter."""
            mix = nodes.new("ShaderNodeMixShader")
            links.new(clear.outputs[0], mix.inputs[1])
            links.new(solid, mix.inputs[2])
            return mix.outputs[0], mix.inputs[0]

        if "transmission" in textures:
            glass = nodes.new("ShaderNodeBsdfTransparent")
            filled("transmission", glass.inputs["Color"])
            surface, is_solid = mixed(glass, surface)
            links.new(nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"], is_solid)
        if "alpha_mask" in textures:
            surface, is_solid = mixed(nodes.new("ShaderNodeBsdfTransparent"), surface)
            filled("alpha_mask", is_solid)
        links.new(surface, output.inputs["Surface"])
        return material

    def build(self, corners, meshes):
        """`meshes`: dictionaries of `first` triangle and their `count`, whether it `casts` and is `seen`, and where it has them
        `alpha_mask` and `transmission` as material() takes them."""
        for item in self.objects:
            bpy.data.meshes.remove(item.data)  # and the object with it
        for material in self.materials.values():
            bpy.data.materials.remove(material)
        for image in self.images.values():
            bpy.data.images.remove(image)
        self.objects, self.materials, self.images = [], {}, {}
        if any("alpha_mask" in mesh or "transmission" in mesh for mesh in meshes):
            self.scene.cycles.transparent_max_bounces = 1024  # a ray goes on behind each hole; Blender allows no more
        corners = np.load(corners)
        for facts in meshes:
            first, count = facts["first"], facts["count"]
            points = corners[first:first + count].reshape(-1, 3)
            if not count:
                continue
            mesh = bpy.data.meshes.new("mesh")
            mesh.vertices.add(len(points))
            mesh.vertices.foreach_set("co", points.ravel())
            mesh.loops.add(len(points))
            mesh.loops.foreach_set("vertex_index", np.arange(len(points), dtype=np.int32))
            mesh.polygons.add(count)
            mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
            mesh.polygons.foreach_set("loop_total", np.full(count, 3, np.int32))
            mesh.update(calc_edges=True)
            textures = {name: facts[name] for name in ("alpha_mask", "transmission") if name in facts}
            for name, texture in textures.items():
                if not isinstance(texture, float):
                    mesh.uv_layers.new(name=name).data.foreach_set("uv", np.load(texture[1]).astype(np.float32).ravel())
            mesh.materials.append(self.material(textures) if textures else self.white)
            item = bpy.data.objects.new("mesh", mesh)
            item.visible_shadow, item.visible_camera = facts["casts"], facts["seen"]
            item.cycles.shadow_terminator_offset = item.cycles.shadow_terminator_geometry_offset = 0
            self.scene.collection.objects.link(item)
            self.objects.append(item)

    def relight(self, kind, power, matrix, size, sides):
        """`matrix`: 4 x 4, the light shines along its -z. `size`: full sizes along x and y; of a disc its diameter. `sides`: 1 or 2."""
        for light in [item.data for item in self.scene.objects if item.type == "LIGHT"]:
            bpy.data.lights.remove(light)
        self.lights = []
        for side in range(sides):
            light = bpy.data.lights.new("light", kind)
            light.energy = power
            light.cycles.max_bounces = 0
            light.cycles.use_multiple_importance_sampling = False
            if kind == "AREA":
                light.shape = "DISK" if size[1] is None else "RECTANGLE"
                light.size = size[0]
                if size[1] is not None:
                    light.size_y = size[1]
            elif kind == "SUN":
                light.angle = 0
            else:
                light.shadow_soft_size = 0
            item = bpy.data.objects.new("light", light)
            item.matrix_world = Matrix(matrix) @ Matrix.Rotation(np.pi * side, 4, "X")
            self.scene.collection.objects.link(item)
            self.lights.append(light)

    def frame(self, samples, seed, shadows, out, **view):
        self.look(**view)
        self.scene.cycles.samples, self.scene.cycles.seed = samples, seed
        for light in self.lights:
            light.cycles.cast_shadow = light.use_shadow = shadows
        said = self.render()
        start, end = (next(when for line, when in said if words in line) for words in ("| Sample 0/", "| Finished"))
        self.save(out)
        return {"trace_ms": 1000 * (end - start), "sync_ms": 1000 * (start - said[0][1])}

    def look(self, matrix, fov_y, near, far, width, height):
        camera, render = self.camera.data, self.scene.render
        self.camera.matrix_world = Matrix(matrix)
        camera.sensor_fit, camera.lens_unit = "VERTICAL", "FOV"
        camera.angle_y, camera.clip_start, camera.clip_end = fov_y, near, far
        render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100

    def save(self, out):
        """Writes the green of the picture, from the upper row on."""
        file = str(self.folder / "frame.exr")
        Path(file).unlink(missing_ok=True)  # a picture that cannot be written is an error, not the one before
        bpy.data.images["Render Result"].save_render(file)
        picture = bpy.data.images.load(file)
        picture.colorspace_settings.name = "Non-Color"
        width, height = picture.size
        pixels = np.empty(4 * width * height, np.float32)
        picture.pixels.foreach_get(pixels)
        bpy.data.images.remove(picture)
        np.save(out, pixels.reshape(height, width, 4)[::-1, :, 1])

    def render(self):
        """Renders, and returns the lines on its steps and when Blender wrote them: it prints each to standard output as it calls the handler."""
        self.steps.clear()
        place = self.folder / "steps.txt"
        with open(place, "w", encoding="utf-8") as file:
            before = os.dup(1)
            os.dup2(file.fileno(), 1)
            try:
                bpy.ops.render.render()
            finally:
                os.dup2(before, 1)
                os.close(before)
        lines = [line for line in place.read_text(errors="replace").splitlines() if line.startswith("Fra:")]
        if len(lines) > len(self.steps):
            raise RuntimeError(f"Blender told of {len(self.steps)} steps and printed {len(lines)}")
        return list(zip(lines, self.steps))


def main(kind=Renderer):
    renderer = None
    with os.fdopen(int(os.environ["GNOMON_ANSWERS"]), "w", encoding="utf-8") as answers:
        for line in sys.stdin:
            request = json.loads(line)
            doing = request.pop("do")
            try:
                if doing == "start":
                    renderer = kind(**request)
                    answer = {"version": bpy.app.version_string}
                else:
                    answer = getattr(renderer, doing)(**request) or {}
            except Exception as problem:  # pylint: disable=broad-except
                traceback.print_exc()
                answer = {"error": f"{type(problem).__name__}: {problem}"}
            answers.write(json.dumps(answer) + "\n")
            answers.flush()


if __name__ == "__main__":
    main()
