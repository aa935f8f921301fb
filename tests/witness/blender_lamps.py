"""Runs within Blender, as techniques/cycles/blender_side.py, and takes two more kinds of lamps, for light_pictures: spheres and spots.

Blender's own spheres are discs turned to the lit point, and its spots fade in a way of their own. A sphere is a mesh here that
shines, and a spot a point whose nodes fade as glTF has it.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.append(str(Path(__file__).resolve().parents[2] / "techniques/cycles"))
import blender_side  # noqa: E402


class Lamps(blender_side.Renderer):
    globe = None

    def relight(self, **request):
        if self.globe:
            bpy.data.meshes.remove(self.globe.data)  # and the object with it
            self.globe = None
        if request["kind"] == "GLOBE":
            super().relight("POINT", 0, np.eye(4).tolist(), (0, 0), 1)
            self.shine(**request)
        elif request["kind"] == "SPOT":
            super().relight("POINT", 4 * np.pi * request["intensity"], request["matrix"], (0, 0), 1)
            self.narrow(**request)
        else:
            super().relight(**request)

    def shine(self, kind, center, radius, radiance):
        """The mesh is as large as gives it the sphere's area, so that its outline is as large, too: of a convex figure it is a fourth of that."""
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=1, location=center)  # 20,480 triangles
        self.globe = bpy.context.object
        area = sum(face.area for face in self.globe.data.polygons)
        self.globe.scale = [radius * np.sqrt(4 * np.pi / area)] * 3
        material = bpy.data.materials.new("shining")
        material.use_nodes = True
        nodes, links = material.node_tree.nodes, material.node_tree.links
        nodes.clear()
        emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        emission.inputs["Strength"].default_value = radiance
        links.new(emission.outputs[0], output.inputs["Surface"])
        self.globe.data.materials.append(material)
        self.globe.visible_camera = False  # it hides its own far side, which shines, too

    def narrow(self, kind, matrix, intensity, inner, outer):
        """`inner`, `outer`: cosines. The share is ((cos - outer) / (inner - outer))^2, 0 .. 1."""
        light = self.lights[0]
        light.use_nodes = True
        tree = light.node_tree
        tree.nodes.clear()

        def node(kind, first, second=None, operation=None):
            made = tree.nodes.new(kind)
            if operation:
                made.operation = operation
            for k, value in enumerate((first, second)):
                if isinstance(value, bpy.types.NodeSocket):
                    tree.links.new(value, made.inputs[k])
                elif value is not None:
                    made.inputs[k].default_value = value
            return made

        # A light's shader sees the way from the lit point to the light as "incoming".
        geometry = tree.nodes.new("ShaderNodeNewGeometry")
        axis = Vector(row[2] for row in matrix[:3])  # it shines along -z
        along = node("ShaderNodeVectorMath", geometry.outputs["Incoming"], axis, "DOT_PRODUCT").outputs["Value"]
        away = node("ShaderNodeMath", along, -1.0, "MULTIPLY").outputs[0]
        above = node("ShaderNodeMath", away, outer, "SUBTRACT").outputs[0]
        share = node("ShaderNodeMath", above, max(inner - outer, 1e-9), "DIVIDE").outputs[0]
        bounded = node("ShaderNodeClamp", share).outputs[0]
        squared = node("ShaderNodeMath", bounded, 2.0, "POWER").outputs[0]
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(squared, emission.inputs["Strength"])
        output = tree.nodes.new("ShaderNodeOutputLight")
        tree.links.new(emission.outputs[0], output.inputs["Surface"])


if __name__ == "__main__":
    blender_side.main(Lamps)
