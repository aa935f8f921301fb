"""three.js as a shadow technique: the shadow maps of its WebGLRenderer, and the ShadowMesh of its add-ons."""

import numpy as np
from browser_engine import OWN_VISIBILITY, BrowserEngine, pinned_version
from gnomon_technique import serve

LEAST_SHARE = 0.01  # of the receiving area: what a flat mesh has that a user would give planar shadows
MODULES = {"r187": "three", "r170": "three-170"}  # of package.json


def receiver_planes(scene):
    """Of each mesh its plane, [nx, ny, nz, n.p], if it receives and is flat and large; else None."""
    corners = scene.corners(casters_only=False)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    double_area = np.linalg.norm(normals, axis=1)
    receives = np.array([mesh.receives for mesh in scene.meshes], bool)[scene.mesh]
    least = max(LEAST_SHARE * double_area[receives].sum(), 1e-30)

    def plane(mesh):
        own = slice(mesh.first_triangle, mesh.first_triangle + mesh.triangles)
        if not mesh.receives or double_area[own].sum() < least:
            return None
        largest = own.start + np.argmax(double_area[own])
        normal = normals[largest] / double_area[largest]
        constant = normal @ corners[largest, 0]
        is_flat = np.abs(corners[own] @ normal - constant).max() <= 1e-5 * np.abs(corners[own]).max()
        return [*normal.tolist(), float(constant)] if is_flat else None

    return [plane(mesh) for mesh in scene.meshes]


class ThreeJs(BrowserEngine):
    title = "three.js"
    page = "page_three_js.mjs"

    def module(self):
        return MODULES[self.settings.version]

    def imports(self):
        return {"three": f"{self.module()}/build/three.module.js", "three/addons/": f"{self.module()}/examples/jsm/"}

    def wanted_version(self):
        return "r" + pinned_version(self.module()).split(".")[1]

    def supports(self, scene, light, view):
        shadows, why = self.settings.shadows, [OWN_VISIBILITY]
        if shadows == "pcf_soft" and self.settings.version != "r170":
            return "unsupported", f"three.js {self.settings.version} draws PCFShadowMap in the place of PCFSoftShadowMap"
        if shadows == "vsm":
            if light.kind == "point":
                return "unsupported", "three.js has no variance maps for point lights"
            if any(mesh.receives and not mesh.casts for mesh in scene.meshes):
                why.append("what receives is drawn into the variance map, and so casts")
        if shadows == "planar":
            if not any(receiver_planes(scene)):
                return "unsupported", f"no flat mesh has {LEAST_SHARE:.0%} of the receiving area: a ShadowMesh lies in one plane"
            why.append("shadows lie in the planes of flat meshes, beyond their edges, too, and nowhere else")
        return "approximate", "; ".join(why)

    def part_facts(self):
        return [{"plane": plane} for plane in receiver_planes(self.scene)]


serve(ThreeJs)
