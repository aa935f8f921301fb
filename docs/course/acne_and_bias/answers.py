#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folder of its run."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import rows  # noqa: E402


def answers(folder):
    """(what, value, how far another answer may be off)"""
    by_bias = {row["depth_bias"]: row for row in rows(folder)}
    acne = {bias: row["causes"].get("acne", 0) for bias, row in by_bias.items()}
    error = {bias: row["error"] for bias, row in by_bias.items()}
    return [
        ("share of acne without a bias", acne[0], 0.02),
        ("share of acne with 0.25 texels, as a part of that without", acne[0.25] / acne[0], 0.05),
        ("smallest bias without acne, texels", min(bias for bias in acne if acne[bias] < 1e-3), 0),
        ("bias with the smallest error, texels", min(error, key=error.get), 0),
        ("error that comes from 8 to 16 texels, over that from 4 to 8", (error[16] - error[8]) / (error[8] - error[4]), 0.25),
    ]


if __name__ == "__main__":
    for what, value, within in answers(sys.argv[1]):
        print(f"{what}: {value:.4g}, within {within:g}")
