#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folder of its run."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import rows  # noqa: E402


def answers(folder):
    """(what, value, how far another answer may be off)"""
    found = rows(folder)
    shadow = {row["view"]: row["error"] for row in found if row["technique"] == "unshadowed"}
    volumes = {(row["view"], row["count"], row["near_cap"]): row for row in found if row["technique"] == "stencil_volume"}
    zpass, zfail, plus = ({view: volumes[view, count, "eye"] for view in shadow} for count in ("zpass", "zfail", "zpass_plus"))
    edge = {cap: volumes["edge", "zpass_plus", cap] for cap in ("eye", "rectangle")}
    return [
        ("share of shadow, view `light`", shadow["light"], 0.01),
        ("share of shadow, view `one`", shadow["one"], 0.01),
        ("share of shadow, view `two`", shadow["two"], 0.01),
        ("wrong share of z-pass, view `light`", zpass["light"]["error"], 1e-4),
        ("wrong share of z-pass, view `one`", zpass["one"]["error"], 0.01),
        ("wrong share of z-pass, view `two`", zpass["two"]["error"], 0.01),
        ("largest wrong share of z-fail, all views", max(row["error"] for row in zfail.values()), 1e-4),
        ("largest wrong share of z-pass from the volumes around the eye, all views", max(row["error"] for row in plus.values()), 1e-4),
        ("share of points in two volumes, view `one`", 1 - zpass["one"]["error"], 0.01),
        ("share of points in two volumes, view `two`", zpass["two"]["error"] - (1 - shadow["two"]), 0.01),
        ("volumes around the eye, view `two`", plus["two"]["counts"]["volumes_at_eye"], 0),
        ("edges of the outlines", zpass["light"]["counts"]["silhouette_edges"], 0),
        ("triangles that z-pass draws", zpass["light"]["counts"]["triangles"], 0),
        ("triangles that z-fail draws", zfail["light"]["counts"]["triangles"], 0),
        ("faces counted by z-fail over those by z-pass, view `light`", zfail["light"]["counts"]["fill"] / zpass["light"]["counts"]["fill"], 0.05),
        ("wrong pixels of the published near cap, view `edge`", edge["rectangle"]["error"] * edge["rectangle"]["tested"], 10),
        ("wrong pixels from the volumes around the eye, view `edge`", edge["eye"]["error"] * edge["eye"]["tested"], 5),
    ]


if __name__ == "__main__":
    for what, value, within in answers(sys.argv[1]):
        print(f"{what}: {value:.4g}, within {within:g}")
