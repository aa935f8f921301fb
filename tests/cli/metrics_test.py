#!/usr/bin/python3 -IB
"""Every metric of a record is what a second implementation, which shares no code with the program, finds in the row's mask."""

import math
import sys
import unittest
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parents[k]) for k in (0, 1)]
from export_reader import read_evidence, read_exr  # noqa: E402
from metrics_again import eye_rays, instability, measure, share  # noqa: E402
from program import ProgramTest, records  # noqa: E402

ROWS = (
    ("fence", "point", "shadow_map:resolution=64"),
    ("contact", "sun", "shadow_map:resolution=256,bias=constant,depth_bias=0"),
    ("box_city", "sun", "variance_map:resolution=64"),
    ("soup:count=200", "point", "svbsp"),
    ("sphere_over_plane", "sun", "unshadowed"),
    ("cornell_box", "ceiling", "area_rays:samples=16"),
    ("fence", "globe", "percentage_closer_soft"),
    ("single_triangle", "panel", "penumbra_wedge"),
    ("single_triangle", "lamp", "center_ray"),
    ("cornell_box", "ceiling", "radiosity"),
)
SMALL = ("--processes", "1", "--repetitions", "1", "--warmups", "1", "--size", "96x54")

# A fence seen from two places, which are the frames of a path, too.
MOVED = """scene = "fence"
view = [{ name = "before", eye = [2.6, 2.1, 5.0], target = [0.2, 0.2, 0.6], fov_y_degrees = 40 },
        { name = "now", eye = [2.65, 2.1, 5.0], target = [0.2, 0.2, 0.6], fov_y_degrees = 40 }]
path = [{ name = "way", moves = "camera", positions = [[2.6, 2.1, 5.0], [2.65, 2.1, 5.0]], frames = 2 }]
"""
GROUP = '[[group]]\nscenes = ["moved.toml"]\nlights = ["point"]\ntechniques = ["shadow_map:resolution=64"]\n'

# Metrics that a mask and what `gnomon export` writes do not decide.
LEFT_OUT = (
    # Of scenes with glass, which are none of these.
    *(f"transmittance_error_{part}" for part in ("rms", "p95", "at_jumps", "off_jumps", "0", "1", "2", "3_4", "5_up")),
    "hue_error",  # of glass that colors the light
    "radiosity_error",  # needs pictures of all light, which no file holds
    "instability",  # of rows on a path, which have a test of their own
    "contact_hardening",  # needs distances to casters, which the reference's own random rays find and no file holds
    "contact_hardening_floor",
)


# --- the snapping floor, which asks the scene itself ------------------------------------------------------------------------


def first_hits(triangles, spheres, origin, way, skipped):
    """The least t > 0 at which origin + t way meets a solid other than `skipped`; that solid's number, spheres after triangles; its normal.

    By Pluecker coordinates: a line meets a triangle that has all three edges on one side of it.
    """
    rows = np.arange(len(way))
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    moment = np.cross(origin, way)
    with np.errstate(divide="ignore", invalid="ignore"):
        times = ((normals * triangles[:, 0]).sum(axis=-1) - origin @ normals.T) / (way @ normals.T)
        sides = np.array([way @ np.cross(p, q).T + moment @ (q - p).T for p, q in
                          ((triangles[:, k], triangles[:, (k + 1) % 3]) for k in range(3))])
        times[~((sides >= 0).all(axis=0) | (sides <= 0).all(axis=0))] = math.inf
        for center, radius in spheres:
            a, b, c = (way**2).sum(axis=-1), ((origin - center) * way).sum(axis=-1), ((origin - center) ** 2).sum(axis=-1) - radius**2
            root = np.sqrt(b * b - a * c)
            times = np.column_stack([times, np.where(-b - root > 0, -b - root, -b + root) / a])
    times[~(times > 0)] = math.inf
    times[rows[skipped >= 0], skipped[skipped >= 0]] = math.inf
    hit = times.argmin(axis=-1)
    normal = normals[np.minimum(hit, len(normals) - 1)]
    for k, (center, _) in enumerate(spheres, len(normals)):
        normal = np.where((hit == k)[:, None], origin + times[rows, hit, None] * way - center, normal)
    return times[rows, hit], hit, normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def answers(e, solids, origin, way):
    """Whether the light arrives at the point that a ray of the eye meets: 1 or 0, nan where it meets nothing that faces the light.

    It is asked by a ray that starts 8 * 2^-24 max|P| over the surface.
    """
    time, hit, normal = first_hits(*solids, np.broadcast_to(origin, way.shape), way, np.full(len(way), -1))
    point = origin + time[:, None] * way
    normal = -np.sign((normal * way).sum(axis=-1, keepdims=True)) * normal
    start = point + 8 * 2**-24 * np.abs(point).max(axis=-1, keepdims=True) * normal
    if e.light["kind"] == "directional":
        to, end = np.broadcast_to(-np.array(e.light["direction"], float), start.shape), math.inf
    else:
        to, end = np.array(e.light["position"], float) - start, 1
    faces = np.isfinite(time) & ((normal * to).sum(axis=-1) > 0)
    return np.where(faces, first_hits(*solids, start, to, hit)[0] >= end, math.nan)


def snapping_floor(e):
    """Share of T whose answer is another one at a corner, if that has any, of the square of +-1/512 px around the pixel's center."""
    shapes = [mesh["shape"] or {} for mesh in e.scene["meshes"]]
    round_ones = [k for k, shape in enumerate(shapes) if shape.get("kind") == "sphere"]
    solids = e.corners[~np.isin(e.mesh_of_triangle, round_ones)], [(np.array(shapes[k]["center"], float), float(shapes[k]["radius"]))
                                                                    for k in round_ones]
    right, flips = e.reference[e.tested] > 0.5, False
    for dx, dy in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        eye, ways, _ = eye_rays(e, dx / 512, dy / 512)
        flips |= np.abs(np.concatenate([answers(e, solids, eye, way) for way in np.array_split(ways[e.tested], 16)]) - right) == 1
    return share(flips.sum(), flips.size)


# ----------------------------------------------------------------------------------------------------------------------------


class Metrics(ProgramTest):
    def rows(self, *words):
        """Of each row of a run its record, and its mask beside what is true there."""
        self.succeed("run", *words, *SMALL, "--pictures", "masks", "--quiet", "--out", "run")
        for record in records(self.dir / "run"):
            self.assertEqual(record["status"], "ok", record["reason"])
            scene, view, light = (record[key] for key in ("scene", "view", "light"))
            self.succeed("export", "--scene", scene, "--view", view, "--light", light, "--size", SMALL[-1], "--out", f"true_{view}")
            reference = record["lights"][0]["reference"]
            mask = read_exr(self.dir / "run" / record["mask"])[f"{light}.V"]
            yield record, read_evidence(self.dir / f"true_{view}", light, mask, reference and reference["estimates"])

    def compare(self, scene, light, technique):
        """Every metric of the row is found again, to 1e-6."""
        ((record, evidence),) = self.rows("--scene", scene, "--light", light, "--technique", technique)
        found = measure(evidence) | {"snapping_floor": math.nan if evidence.has_area else snapping_floor(evidence)}
        recorded = record["metrics"][record["truth"]]
        self.assertEqual(sorted([*found, *LEFT_OUT]), sorted(recorded))
        for name, value in found.items():
            told = recorded[name]
            # FLIP alone comes near to the bound: the program's float32 makes it up to 8e-7 too large in these rows. All others keep 5e-7.
            with self.subTest(metric=name, found=value, recorded=told):
                self.assertEqual(told is None, math.isnan(value))
                if told is not None:
                    self.assertLessEqual(abs(value - told), 1e-6 * max(1, abs(told)))

    def test_instability_is_what_two_frames_say(self):
        # The frames of the path are the two views, so rows without motion have the masks of both.
        self.write("moved.toml", MOVED)
        self.write("still.toml", GROUP + 'views = ["before", "now"]\n')
        still = {record["view"]: evidence for record, evidence in self.rows("still.toml")}
        self.write("path.toml", GROUP + 'views = ["before"]\npaths = ["way"]\n')
        self.succeed("run", "path.toml", *SMALL, "--pictures", "none", "--quiet", "--out", "path")
        (record,) = records(self.dir / "path")
        value, told = instability(still["before"], still["now"]), record["metrics"]["shape"]["instability"]
        self.assertGreater(told, 0)
        self.assertEqual(record["frames"]["instability"], [None, told])
        self.assertAlmostEqual(value, told, delta=1e-6)


def add_test(scene, light, technique):
    """A test for a row, named after it."""

    def test(self):
        self.compare(scene, light, technique)

    words = (scene.split(":")[0], "under", light, "by", technique.split(":")[0])
    setattr(Metrics, "_".join(("test", *words)), test)


for row in ROWS:
    add_test(*row)


if __name__ == "__main__":
    unittest.main()
