import numpy as np
from gnomon_technique import Technique, serve


class RayNumpy(Technique):
    def build(self, scene):
        self.scene = scene
        sides = [(a, b - a, c - a) for a, b, c in scene.corners()]
        self.triangles = [(a, np.linalg.inv(np.column_stack((u, v, np.cross(u, v))))) for a, u, v in sides if np.cross(u, v).any()]
        self.offset = 1e-6 * np.abs(scene.corners()).max(initial=0)  # no length is special

    def relight(self, light):
        self.light = light

    def resolve(self, gbuffer, mask):
        seen = gbuffer.faces(self.light, self.scene)
        point, way = gbuffer.position[seen].T.astype(float), gbuffer.to_light(self.light)[seen].T
        least = self.offset / np.sum(gbuffer.normal[seen].T * way, axis=0)  # of the way: leaves its own surface
        most = np.inf if self.light.kind == "directional" else 1
        lit = np.ones(point.shape[1], bool)
        for corner, world in self.triangles:  # in whose coordinates the triangle is x >= 0, y >= 0, x + y <= 1, z = 0
            x, y, z = world @ (point - corner[:, None])
            dx, dy, dz = world @ way
            t = -z / np.where(dz == 0, np.nan, dz)
            x, y = x + t * dx, y + t * dy
            lit &= ~((t > least) & (t < most) & (x >= 0) & (y >= 0) & (x + y <= 1))
        mask[...] = 1
        mask[seen] = lit


serve(RayNumpy)
