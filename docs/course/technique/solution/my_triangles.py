"""A ray from each pixel is tried against every triangle that casts."""

import numpy as np
from gnomon_technique import Technique, serve


class MyTriangles(Technique):
    def build(self, scene):
        self.scene = scene
        corners = scene.corners()
        self.extent = np.abs(corners).max(initial=0)
        self.triangles = []
        for a, b, c in corners:
            u, v = b - a, c - a
            normal = np.cross(u, v)
            if normal.any():
                self.triangles.append((a[:, None], np.linalg.inv(np.column_stack((u, v, normal)))))

    def relight(self, light):
        self.light = light

    def resolve(self, gbuffer, mask):
        seen = gbuffer.faces(self.light, self.scene)
        point = gbuffer.position[seen].T + self.settings.offset * self.extent * gbuffer.normal[seen].T.astype(float)
        is_sun = self.light.kind == "directional"
        way = -self.light.direction[:, None] if is_sun else self.light.position[:, None] - point
        lit = np.ones(point.shape[1], bool)
        with np.errstate(divide="ignore", invalid="ignore"):
            for a, world in self.triangles:
                lit &= ~self.meets(world @ (point - a), world @ way, np.inf if is_sun else 1)
        self.counts["tests"] = len(self.triangles) * point.shape[1]
        mask[...] = 1
        mask[seen] = lit

    @staticmethod
    def meets(point, way, end):
        """In coordinates in which the triangle is x >= 0, y >= 0, x + y <= 1, z = 0."""
        t = -point[2] / way[2]
        x, y = point[0] + t * way[0], point[1] + t * way[1]
        return (t > 0) & (t < end) & (x >= 0) & (y >= 0) & (x + y <= 1)


serve(MyTriangles)
