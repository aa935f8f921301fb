#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folder of its run."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import exponent, rows  # noqa: E402


def answers(folder):
    """(what, value, how far another answer may be off)"""
    found = rows(folder)
    errors = {kind: {row["samples"]: row["metrics"]["penumbra_error_rms"] for row in found if row["pattern"] == kind}
              for kind in ("random", "stratified")}
    return [
        ("root mean square error of 64 random rays, times sqrt 64", errors["random"][64] * 8, 0.01),
        ("exponent of the error of random rays", exponent(errors["random"].items()), 0.02),
        ("exponent of the error of stratified rays", exponent(errors["stratified"].items()), 0.03),
        ("random rays that err as little as 256 stratified ones", 256 * (errors["random"][256] / errors["stratified"][256]) ** 2, 300),
    ]


if __name__ == "__main__":
    for what, value, within in answers(sys.argv[1]):
        print(f"{what}: {value:.4g}, within {within:g}")
