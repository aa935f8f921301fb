"""Every caster is the box around it: a ray from each pixel is tried against the boxes of all other meshes."""

import numpy as np
from gnomon_technique import Technique, serve


class MyBoxes(Technique):
    def build(self, scene):
        self.scene, self.boxes = scene, []
        for number, mesh in enumerate(scene.meshes):
            if not mesh.casts:
                continue
            points = scene.position[mesh.first_vertex : mesh.first_vertex + mesh.vertices].astype(float)
            self.boxes.append((number, points.min(axis=0), points.max(axis=0)))

    def relight(self, light):
        self.light = light

    def resolve(self, gbuffer, mask):
        seen = gbuffer.faces(self.light, self.scene)  # all others stay lit
        point, way = gbuffer.position[seen].T.astype(float), gbuffer.to_light(self.light)[seen].T
        own = gbuffer.mesh[seen]
        end = np.inf if self.light.kind == "directional" else 1  # of the way, in units of its length
        lit = np.ones(point.shape[1], bool)
        for number, low, high in self.boxes:
            lit &= ~self.meets(point, way, end, low, high) | (own == number)
        self.counts["tests"] = len(self.boxes) * point.shape[1]
        mask[...] = 1
        mask[seen] = lit

    @staticmethod
    def meets(point, way, end, low, high):
        """Where the ways from the points meet a box: behind the last side that they enter, before the first that they leave."""
        with np.errstate(divide="ignore", invalid="ignore"):
            to_low, to_high = (low[:, None] - point) / way, (high[:, None] - point) / way
        enters = np.fmax.reduce(np.fmin(to_low, to_high))
        leaves = np.fmin.reduce(np.fmax(to_low, to_high))
        return (enters <= leaves) & (leaves > 0) & (enters < end)


serve(MyBoxes)
