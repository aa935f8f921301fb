#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folder of its run."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import rows  # noqa: E402


def answers(folder):
    """(what, value, how far another answer may be off)"""
    found = rows(folder)
    closed = [row for row in found if row["technique"] == "composite_planar"]
    of = {(row["of_scene"]["object"], row["of_scene"]["light_x"], row["form"]): row for row in closed}
    table = {clipped: [row for row in found if row["scene"] == "table" and (row["unclipped"] == "false") == clipped] for clipped in (True, False)}

    def area(*row):
        return of[row]["metrics"]["shadow_area_ratio"]

    paper = [row for row in closed if row["form"] != "exact" and row["error"] > 0]
    return [
        ("largest error of `exact`", max(row["error"] for row in closed if row["form"] == "exact"), 0),
        ("share of the wrong pixels of `printed` and `paper` with the cause `formula`",
         sum(row["causes"]["formula"] for row in paper) / sum(sum(row["causes"].values()) for row in paper), 0),
        ("error of the circle, as printed", of["circle", 4, "printed"]["error"], 0),
        ("area of the printed triangle over the true one, x_i = 2 m", area("triangle", 2, "printed"), 0.02),
        ("area of the printed triangle over the true one, x_i = 8 m", area("triangle", 8, "printed"), 0.02),
        ("area of the sphere's circle over the true shadow, x_i = 0", area("sphere", 0, "paper"), 0.01),
        ("area of the sphere's circle over the true shadow, x_i = 4 m", area("sphere", 4, "paper"), 0.01),
        ("area of the sphere's circle over the true shadow, x_i = 12 m", area("sphere", 12, "paper"), 0.01),
        ("pixels that the sphere's circle darkens wrongly", max(of["sphere", x, "paper"]["metrics"]["false_dark_rate"] for x in (0, 4, 12)), 0),
        ("error of the cone as meant, x_i = 2 m", of["cone", 2, "paper"]["error"], 1e-5),
        ("area of the cone as meant over the true shadow, x_i = 5 m", area("cone", 5, "paper"), 0.005),
        ("area of the cone as meant over the true shadow, x_i = 10 m", area("cone", 10, "paper"), 0.005),
        ("error of the table without clipping over that with it",
         sum(row["error"] for row in table[False]) / sum(row["error"] for row in table[True]), 0.2),
    ]


if __name__ == "__main__":
    for what, value, within in answers(sys.argv[1]):
        print(f"{what}: {value:.4g}, within {within:g}")
