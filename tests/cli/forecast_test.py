#!/usr/bin/python3 -IB
"""`gnomon analyze DIR forecast` and `enough`: what planners ask, of kept results and of rows made by hand."""

import csv
import io
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ROOT, ProgramTest  # noqa: E402


def record(technique, cost=1.0, error=0.1, settings="", size=640, **more):
    """A line of records.jsonl made by hand: three processes, relight and resolve of half the cost each."""
    row = {
        "schema": 7, "scene": "soup", "light": "point", "lights": [{"name": "point", "kind": "point", "answer": "binary"}], "answer": "binary",
        "technique": technique, "settings": settings, "parameters": {}, "width": size, "height": 360, "status": "ok", "role": "contender",
        "bytes": 1 << 20, "classes": {"T": 1000},
        "stages": {stage: [[cost / 2], [cost / 2], [cost / 2]] for stage in ("setup", "build", "relight", "resolve")},
        "metrics": {"shape": {"error": error, "coverage_error_mean": error / 2}},
    }
    row.update(more)
    return row


class Forecast(ProgramTest):
    def run_of(self, *rows):
        (self.dir / "run").mkdir()
        self.write("run/records.jsonl", "".join(json.dumps({**row, "job": f"job{k}"}) + "\n" for k, row in enumerate(rows)))
        return "run"

    def rows(self, *arguments):
        return list(csv.DictReader(io.StringIO(self.succeed("analyze", *arguments, "--format", "csv"))))

    def test_costs_of_many_lights_are_extrapolated_and_marked(self):
        for cost in ("light", "bytes"):
            rows = self.rows(ROOT / "results/lights", "forecast", "--to", "256", "--cost", cost)
            told = [row for row in rows if row["forecast"]]
            self.assertGreater(len(told), 15)
            for row in told:
                self.assertEqual((row["x_to"], row["x_forecast"], row["why_not"]), ("64", "256", ""))
                low, value, high = (float(row[key]) for key in ("forecast_low", "forecast", "forecast_high"))
                self.assertTrue(0 <= low <= value <= high, row)
            # The rows of 1, 4 and 16 lights foretell that of 64, nearly always.
            held = [row["is_foretold"] == "yes" for row in told]
            self.assertGreaterEqual(sum(held), 0.85 * len(held))
        text = self.succeed("analyze", ROOT / "results/lights", "forecast", "--to", "256", "--wide")
        self.assertIn("extrapolated to 256\n", text)
        self.assertIn("extrapolated: nothing was measured there", text)

    def test_a_planted_line_is_found(self):
        run = self.run_of(*(record("map", cost=4 + size * 360 / 1000, size=size) for size in (100, 200, 400)))
        row, = self.rows(run, "forecast", "--x", "pixels", "--to", "288000")
        for column, value in (("fixed", 4), ("each", 0.001), ("forecast", 292), ("forecast_low", 292), ("forecast_high", 292)):
            self.assertAlmostEqual(float(row[column]), value, places=6)

    def test_what_was_measured_is_not_forecast(self):
        run = self.run_of(*(record("map", cost=size, size=size) for size in (100, 200, 400)))
        self.refuse("analyze", run, "forecast", "--x", "pixels", "--to", "36000", says=["--to 36000 is not beyond 144000"])
        self.refuse("analyze", run, "forecast", "--x", "pixels", "--to", "0", says=["--to", "above 0"])
        self.refuse("analyze", run, "forecast", says=["several lights together"])
        self.refuse("analyze", run, "forecast", "--x", "size", says=["there is no axis size", "pixels"])
        self.refuse("analyze", run, "growth", "--to", "9", says=["--to is for forecast; growth does not take it"])

    def test_each_technique_pays_for_its_cheapest_setting(self):
        run = self.run_of(record("map", 1, 0.02), record("map", 2, 0.008, "size=2"), record("map", 4, 0.003, "size=4", bytes=1 << 22),
                          record("rays", 6, 0, role="reference"), record("nothing", 0.1, 0.3, role="baseline"))
        rows = self.rows(run, "enough")
        self.assertEqual([(row["budget"], row["technique"], row["setting"], row["cost_ms"], row["bytes"]) for row in rows],
                         [("0.01", "map", "map:size=2", "2", "1048576"), ("0.01", "rays", "rays", "6", "1048576"),
                          ("0.005", "map", "map:size=4", "4", "4194304"), ("0.005", "rays", "rays", "6", "1048576"),
                          ("0.001", "rays", "rays", "6", "1048576"), ("0.001", "map", "", "", "")])
        over_pixels = self.rows(run, "enough", "--errors", "1", "--error", "coverage_error_mean")
        self.assertEqual([(row["setting"], row["cost_ms"]) for row in over_pixels], [("map", "1"), ("rays", "6")])
        text = self.succeed("analyze", run, "enough", "--errors", "0.1", "--wide")
        self.assertRegex(text, r"(?m)^error ≤ 0\.1 % +rays +rays +0 +6\.00 ")
        self.assertRegex(text, r"(?m)^error ≤ 0\.1 % +map +none +0\.3")
        self.refuse("analyze", run, "enough", "--errors", "-1", says=["--errors", "above 0"])
        self.refuse("analyze", run, "enough", "--times", "1", says=["--times is for best; enough does not take it"])


if __name__ == "__main__":
    unittest.main()
