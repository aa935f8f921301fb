"""The rows of a run for the sheets of this course: what a row was called with, and what came out."""

import json
import math
import pathlib


def rows(folder):
    """Each row of a run as a dictionary: its settings by name, numbers as numbers, and beside them `technique`, `error` (the mean
    error), `metrics`, and `causes`, the share of the tested pixels that each cause made wrong."""
    found = []
    for line in pathlib.Path(folder, "records.jsonl").read_text(encoding="utf-8").splitlines():
        record = json.loads(line)
        if record["status"] != "ok":
            raise SystemExit(f"{record['technique']} {record['settings']}: {record['status']}: {record['reason']}")
        metrics = record["metrics"][record["truth"]]
        tested = record["classes"]["T"]
        causes = {name: pixels / tested for name, pixels in (record["causes"] or {}).items()}
        found.append({**record["parameters"], "technique": record["technique"], "error": metrics["error"], "metrics": metrics, "causes": causes})
    return found


def exponent(points):
    """The b of y = a x^b, by least squares of logarithms."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    middle_x, middle_y = (sum(column) / len(logs) for column in zip(*logs))
    return sum((x - middle_x) * (y - middle_y) for x, y in logs) / sum((x - middle_x) ** 2 for x, _ in logs)
