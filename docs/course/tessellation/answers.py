#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folder of its run."""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import exponent, rows  # noqa: E402


def answers(folder):
    """(what, value, how far another answer may be off)"""
    found = rows(folder)
    sphere = {row["of_scene"]["segments"]: row for row in found if row["technique"] == "exact_rays" and row["of_scene"]}
    flat = next(row for row in found if row["technique"] == "exact_rays" and not row["of_scene"])
    circle = {(row["fit"], row["segments"]): row for row in found if row["technique"] == "sphere_volume"}
    exact = next(row for (fit, _), row in circle.items() if fit == "exact")
    error = {fit: {n: row["error"] for (of, n), row in circle.items() if of == fit} for fit in ("inscribed", "equal_area", "circumscribed")}

    def missing(fit, n):  # share of the shadow's area, in (pi / n)^2
        return (1 - circle[fit, n]["metrics"]["shadow_area_ratio"]) * (n / math.pi) ** 2

    error_exponent = exponent([(n, row["error"]) for n, row in sphere.items()])
    lacks = {n: 1 - row["metrics"]["shadow_area_ratio"] for n, row in sphere.items()}
    enough = 16 * (lacks[16] / 0.01) ** (-1 / error_exponent)
    return [
        ("exponent of the error over the segments of the sphere", error_exponent, 0.1),
        ("error with 16 segments over that with 32", sphere[16]["error"] / sphere[32]["error"], 0.3),
        ("share of the shadow that 16 segments of the sphere lack", lacks[16], 0.003),
        ("segments for 1 % of the shadow, by the fit", enough, 3),
        ("triangles for that", enough * (enough - 2), 200),
        ("largest error of the sphere's triangles under mesh truth", max(row["mesh_error"] for row in sphere.values()), 0),
        ("share that an inscribed polygon of 16 lacks, in (pi / 16)^2", missing("inscribed", 16), 0.03),
        ("share that a circumscribed polygon of 16 lacks, in (pi / 16)^2", missing("circumscribed", 16), 0.03),
        ("error of circumscribed over that of inscribed, 16 edges", error["circumscribed"][16] / error["inscribed"][16], 0.05),
        ("error of equal area over that of inscribed, 16 edges", error["equal_area"][16] / error["inscribed"][16], 0.05),
        ("error of the sphere's own cone, no polygon", exact["error"], 1e-5),
        ("error of the flat scene, shape truth", flat["error"], 0),
        ("error of the flat scene, mesh truth", flat["mesh_error"], 0),
    ]


if __name__ == "__main__":
    for what, value, within in answers(sys.argv[1]):
        print(f"{what}: {value:.4g}, within {within:g}")
