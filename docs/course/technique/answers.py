#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folders of both runs: of the starter files, and of the finished techniques."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import rows  # noqa: E402


def answers(folder, finished):
    """(what, value, how far another answer may be off)"""
    begun = {(row["technique"], row["light"]): row for row in rows(folder)}
    ends = {(row["technique"], row["offset"], row["light"]): row for row in rows(finished)}
    lights = ("point", "sun")

    def error(technique, light):
        return begun[technique, light]["error"]

    def same(key, offset):  # how far apart both languages are, in whatever light that is more
        return max(abs(ends["my_triangles", offset, light][key] - ends["my_rays", offset, light][key]) for light in lights)

    return [
        *((f"error without shadows, {light}", error("unshadowed", light), 0.001) for light in lights),
        *((f"error of `my_boxes`, {light}", error("my_boxes", light), 0.001) for light in lights),
        ("share that `my_boxes` lights falsely", max(begun["my_boxes", light]["metrics"]["false_lit_rate"] for light in lights), 0),
        ("error of the skeleton over that without shadows, sun", error("my_plugin", "sun") / error("unshadowed", "sun"), 0),
        *((f"error of your triangles, offset {offset:g}, {light}", ends["my_triangles", offset, light]["error"], within)
          for offset, within in ((0, 0.005), (1e-6, 0), (0.01, 0.002)) for light in lights),
        ("difference of the errors in Python and in C++, offset 1e-06", same("error", 1e-6), 0),
        ("difference of the errors in Python and in C++, offset 0.01", same("error", 0.01), 1e-4),
        ("tests of the boxes, sun", begun["my_boxes", "sun"]["counts"]["tests"], 0),
        ("tests of all triangles in Python, sun", ends["my_triangles", 1e-6, "sun"]["counts"]["tests"], 0),
        ("tests in C++ up to the first triangle that is met, sun", ends["my_rays", 1e-6, "sun"]["counts"]["tests"], 1000),
    ]


if __name__ == "__main__":
    for what, value, within in answers(*sys.argv[1:3]):
        print(f"{what}: {value:.4g}, within {within:g}")
