#!/usr/bin/python3 -IB
"""convert_records: kept records of an older schema become today's, with every number as it was; who has others is told what to do."""

import fcntl
import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import DATA, ROOT, ProgramTest, records  # noqa: E402

CONVERT = ROOT / "scripts/convert_records"


class Convert(ProgramTest):
    def convert(self, *folders, status=0):
        done = subprocess.run([CONVERT, *folders], cwd=self.dir, text=True, capture_output=True)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def folder(self, schema):
        folder = self.dir / f"of_{schema}"
        folder.mkdir(exist_ok=True)
        shutil.copy(DATA / f"records/schema_{schema}.jsonl", folder / "records.jsonl")
        return folder

    def test_an_old_folder_is_refused_until_it_is_converted(self):
        folder = self.folder(2)
        self.refuse("table", folder, says=["records.jsonl:1: schema = 2 is that of an older program", "scripts/convert_records"])
        before = records(folder)
        self.convert(folder)
        self.assertEqual((folder / "records.jsonl").read_text(), (DATA / "records/schema_7.jsonl").read_text())
        for old, new in zip(before, records(folder)):
            for truth, metrics in old["metrics"].items():
                gone = ("error_mean", "penumbra_width_ratio", "penumbra_shift", "contact_hardening", "reference_error_mean")
                kept = {name: value for name, value in metrics.items() if name not in gone}
                self.assertEqual({**kept, "error": metrics["error_mean"]}, new["metrics"][truth])
            for key in old.keys() - {"schema", "metrics", "frames", "gl"}:
                self.assertEqual(old[key], new[key], key)
            light, = new["lights"]
            self.assertEqual((light["name"], light["kind"], light["answer"], new["answer"]), (old["light"], old["light_kind"], "binary", "binary"))
            self.assertEqual(list(light), ["name", "kind", "answer", "support", "reason", "reference"], "the rest is in the record")
        text = self.succeed("table", folder)
        self.assertIn("sphere_over_plane", text)
        self.convert(folder)
        self.assertEqual(self.succeed("table", folder), text)

    def test_rows_of_schema_6_change_in_their_schema_alone(self):
        folder = self.folder(6)
        before = (folder / "records.jsonl").read_text()
        self.convert(folder)
        self.assertEqual((folder / "records.jsonl").read_text(), before.replace('{"schema":6,', '{"schema":7,'))

    def test_lights_together_and_lights_with_area_say_what_they_are(self):
        folder = self.folder(2)
        one, two = records(folder)
        lamp = {**two, "job": "1", "light": "lamp", "light_kind": "disc", "context": {"frames": 8}, "reference": {"estimates": "area", "target": 0.002, "cap": 8, "rays": 3,
                "error_mean": 0.001, "error_max": 0.002, "global": None}, "cause_errors": {"noise": 0.5}}
        parts = [{"name": name, "kind": kind, "support": "full", "reason": "", "reference": reference, "classes": {}, "metrics": metrics,
                  "causes": None, "cause_errors": None} for name, kind, reference, metrics in (
                     ("sun", "directional", None, {"error": 0.5}), ("lamp", "disc", lamp["reference"], {"error_mean": 0.25}))]
        both = {**two, "job": "2", "light": "all+", "light_kind": "directional+disc", "lights": parts}
        missing = {**two, "job": "3", "status": "unsupported", "light": "-", "light_kind": "", "reason": "is not fetched", "metrics": {}, "causes": None}
        (folder / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in (lamp, both, missing)))
        self.convert(folder)
        lamp, both, missing = records(folder)
        self.assertEqual((lamp["answer"], lamp["lights"][0]["answer"], lamp["lights"][0]["reference"]["rays"]), ("fraction", "fraction", 3))
        self.assertEqual(lamp["cause_errors"], {"noise": 0.5})
        self.assertEqual(lamp["metrics"]["shape"]["error"], two["metrics"]["shape"]["error_mean"])
        self.assertEqual([light["metrics"] for light in both["lights"]], [{"error": 0.5}, {"error": 0.25}])
        self.assertEqual((both["answer"], [light["answer"] for light in both["lights"]]), ("received", ["binary", "fraction"]))
        self.assertEqual((missing["answer"], missing["lights"][0]["name"], missing["lights"][0]["support"]), ("binary", "-", None))
        self.succeed("table", folder, "--format", "json")

    def test_what_cannot_be_converted_stays_as_it_was(self):
        folder = self.folder(2)
        text = (folder / "records.jsonl").read_text().replace('"schema":2', '"schema":1')
        (folder / "records.jsonl").write_text(text)
        self.assertIn("no step leads from schema 1", self.convert(folder, status=2))
        self.assertEqual((folder / "records.jsonl").read_text(), text)
        self.assertIn("nowhere", self.convert("nowhere", status=2))
        good = (DATA / "records/schema_2.jsonl").read_text()
        for bad, says in (("[]", "records.jsonl:3"), ('{"schema": 2}', "lacks"), ('{"schema": 8}', "no step leads from schema 8"), ("{", "records.jsonl:3")):
            (folder / "records.jsonl").write_text(good + bad + "\n")
            self.assertIn(says, self.convert(folder, status=2))
            self.assertEqual((folder / "records.jsonl").read_text(), good + bad + "\n")
        with open(folder / "records.jsonl") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            self.assertIn("a run writes it", self.convert(folder, status=2))
        # What a killed run left at the end is no line yet.
        (folder / "records.jsonl").write_text(good + '{"schema": 2, "jo')
        self.convert(folder)
        self.assertEqual((folder / "records.jsonl").read_text(), (DATA / "records/schema_7.jsonl").read_text() + '{"schema": 2, "jo')

    def test_scores_against_the_center_of_a_light_with_area_are_withdrawn(self):
        folder = self.folder(2)
        rows = [{**records(folder)[1], "job": str(k), "light_kind": kind, "context": context}
                for k, (kind, context) in enumerate((("rect", {}), ("disc", {"frames": 5}), ("sphere", {"frames": 6}), ("point", {"frames": 5})))]
        (folder / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        self.convert(folder)
        self.assertEqual([(row["status"], bool(row["metrics"]), bool(row["classes"])) for row in records(folder)],
                         2 * [("unsupported", False, False)] + 2 * [("ok", True, True)])
        self.assertIn("hard shadow of the light's center", self.succeed("table", folder))

    def test_what_is_kept_has_today_s_schema(self):
        for file in sorted([*ROOT.glob("results/*/records.jsonl"), *ROOT.glob("results/editions/*/records.jsonl")]):
            with self.subTest(file.parent.name), open(file, encoding="utf-8") as lines:
                self.assertEqual({json.loads(line)["schema"] for line in lines}, {7})


if __name__ == "__main__":
    unittest.main()
