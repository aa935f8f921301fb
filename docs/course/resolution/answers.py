#!/usr/bin/python3 -B
"""The numbers of this sheet, of the folder of its run."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from rows import exponent, rows  # noqa: E402


def answers(folder):
    """(what, value, how far another answer may be off)"""
    found = rows(folder)
    errors = {kind: {row["resolution"]: row["error"] for row in found if row["filter"] == kind} for kind in ("nearest", "pcf")}
    fine = [(texels, error) for texels, error in errors["nearest"].items() if texels >= 512]
    bytes_of = {row["resolution"]: row["resolution"] ** 2 for row in found}
    return [
        ("exponent of the error over the resolution, from 512 texels on", exponent(fine), 0.05),
        ("error with 512 texels over that with 1024", errors["nearest"][512] / errors["nearest"][1024], 0.1),
        ("texels for half the error, times as many as before", bytes_of[1024] / bytes_of[512], 0),
        ("error of pcf over that of one comparison, 1024 texels", errors["pcf"][1024] / errors["nearest"][1024], 0.1),
    ]


if __name__ == "__main__":
    for what, value, within in answers(sys.argv[1]):
        print(f"{what}: {value:.4g}, within {within:g}")
