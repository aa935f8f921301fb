#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folder of its run."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import rows  # noqa: E402


def answers(folder):
    """(what, value, how far another answer may be off)"""
    found = rows(folder)
    trees = {(row["scene"], row["order"], row["drop_edges"]): row["counts"] for row in found}
    by_hand = [(name, drop, trees[scene, "bsp", drop]) for scene, name in (("scene.toml", "z = 0 first"), ("turned.toml", "x = 4 first"))
               for drop in ("none", "cut", "shared")]
    slanted, planes = (trees["slanted.toml", order, "shared"] for order in ("bsp", "face_planes"))
    bsp, tiles = (trees["soup", order, "shared"] for order in ("bsp", "tiles"))
    return [
        *((f"nodes, {name}, `{drop}`", counts["nodes"], 0) for name, drop, counts in by_hand),
        *((f"nodes on the longest way, {name}, `{drop}`", counts["depth"], 0) for name, drop, counts in by_hand),
        *((f"{what}, {name}", counts[of], 0) for what, of in (("fragments", "fragments"), ("lit fragments", "lit_fragments"), ("cuts", "splits"))
          for name, drop, counts in by_hand if drop == "none"),
        ("largest error of all rows", max(row["error"] for row in found), 0),
        ("`slanted.toml`: polygons that the regular BSP tree cuts", slanted["bsp_splits"], 0),
        ("`slanted.toml`: fragments in its order", slanted["fragments"], 0),
        ("`slanted.toml`: fragments without it", planes["fragments"], 0),
        ("`soup`: nodes on the longest way, one tree over those of tiles", bsp["depth"] / tiles["depth"], 0.2),
        ("`soup`: mean of visited nodes, one tree", bsp["visits"], 1),
        ("`soup`: mean of visited nodes, tiles", tiles["visits"], 1),
        ("`soup`: fragments a polygon, one tree", bsp["fragments_per_polygon"], 0.5),
        ("`soup`: fragments a polygon, tiles", tiles["fragments_per_polygon"], 0.5),
    ]


if __name__ == "__main__":
    for what, value, within in answers(sys.argv[1]):
        print(f"{what}: {value:.4g}, within {within:g}")
