"""The rows of a run for the sheets of this course: what a row was called with, and what came out."""

import json
import math
import pathlib


def rows(folder):
    """Each row of a run as a dictionary: its settings by name, numbers as numbers, and beside them `technique`, `scene`, `view`, `light`,
    `error` (the mean error), `mesh_error` (the same under mesh truth), `metrics`, `counts`, `tested`, the number of tested pixels, and
    `causes`, the share of them that each cause made wrong. Of a scene with settings, `composite:light_x=4`, `scene` is the name and
    `of_scene` the settings."""
    found = []
    for line in pathlib.Path(folder, "records.jsonl").read_text(encoding="utf-8").splitlines():
        record = json.loads(line)
        if record["status"] != "ok":
            raise SystemExit(f"{record['technique']} {record['settings']}: {record['status']}: {record['reason']}")
        metrics = record["metrics"][record["truth"]]
        tested = record["classes"]["T"]
        causes = {name: pixels / tested for name, pixels in (record["causes"] or {}).items()}
        scene, _, settings = record["scene"].partition(":")
        of_scene = {name: number(value) for name, _, value in (setting.partition("=") for setting in settings.split(",") if setting)}
        found.append({**record["parameters"], "technique": record["technique"], "scene": scene, "of_scene": of_scene,
                      "view": record["view"], "light": record["light"],
                      "error": metrics["error"], "mesh_error": record["metrics"]["mesh"]["error"], "metrics": metrics,
                      "counts": {count["name"]: count["value"] for count in record["counts"]}, "causes": causes, "tested": tested})
    return found


def number(text):
    """A setting's value: a number where it is one."""
    try:
        return float(text)
    except ValueError:
        return text


def exponent(points):
    """The b of y = a x^b, by least squares of logarithms."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    middle_x, middle_y = (sum(column) / len(logs) for column in zip(*logs))
    return sum((x - middle_x) * (y - middle_y) for x, y in logs) / sum((x - middle_x) ** 2 for x, _ in logs)
