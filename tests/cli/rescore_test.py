#!/usr/bin/python3 -IB
"""`gnomon table DIR --rescore`: today's metrics on old masks."""

import fcntl
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, SMALL, ProgramTest, records, what  # noqa: E402

# Shapes with two truths and a mesh with one; right rows, wrong rows, and one that is not supported.
ROWS = [*HARD, "--scene", "sphere_over_plane", "--scene", "fence", "--technique", "embree_rays", "--technique",
        "shadow_map:resolution=64,slope_bias=0,depth_bias=0", "--technique", "planar_projected"]


def edit(folder, change):
    """Rewrites every record by `change`."""
    rows = records(folder)
    for row in rows:
        change(row)
    (folder / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))


def scored(folder):
    return {row["job"]: {key: row[key] for key in ("status", "metrics", "causes", "classes")} for row in records(folder)}


class Rescore(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder = cls.home / "run"
        one = cls("test_without_saving_nothing_is_written")
        one.dir = cls.home
        one.succeed("run", *ROWS, *SMALL, "--out", cls.run_folder)

    def setUp(self):
        super().setUp()
        self.out = self.dir / "out"
        self.out.mkdir()
        for name in ("records.jsonl", "masks"):
            (self.out / name).symlink_to(self.run_folder / name)
        (self.out / "records.jsonl").unlink()
        (self.out / "records.jsonl").write_bytes((self.run_folder / "records.jsonl").read_bytes())

    def rescore(self, *arguments):
        done = self.gnomon("table", "out", "--rescore", "--format", "json", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout), done.stderr

    def ok_count(self):
        return sum(row["status"] == "ok" for row in records(self.out))

    def test_the_run_is_worth_rescoring(self):
        rows = records(self.out)
        self.assertTrue(any(row["causes"] and sum(row["causes"].values()) > 10 for row in rows if row["status"] == "ok"))
        self.assertTrue(any(row["metrics"]["shape"] != row["metrics"]["mesh"] for row in rows if row["status"] == "ok"))

    def test_deleted_metrics_come_back_exactly_as_they_were(self):
        before = scored(self.out)

        def forget(row):
            for metrics in row["metrics"].values():
                for name in ("wrong_rate", "displacement_p95", "ssim", "wrong_rate_edge_0_1"):
                    del metrics[name]
                metrics["flip"] = 0.123
            if row["status"] == "ok":
                row["causes"] = None
                row["classes"] = {}

        edit(self.out, lambda row: row["status"] == "ok" and forget(row))
        self.assertNotEqual(scored(self.out), before)
        _, said = self.rescore("--save")
        self.assertIn(f"{self.ok_count()} rows rescored", said)
        self.assertEqual(scored(self.out), before)
        self.assertEqual(self.names(self.out), ["records.jsonl"])

    def test_a_saved_row_keeps_everything_else(self):
        before = sorted(records(self.out), key=what)
        self.rescore("--save")
        self.assertEqual(sorted(records(self.out), key=what), before)

    def test_without_saving_nothing_is_written(self):
        edit(self.out, lambda row: row["metrics"].get("shape", {}).pop("wrong_rate", None))
        lines = (self.out / "records.jsonl").read_bytes()
        table, _ = self.rescore()
        self.assertEqual((self.out / "records.jsonl").read_bytes(), lines)
        self.assertIn("wrong_rate", json.dumps(table))
        plain = self.gnomon("table", "out", "--columns", "technique,wrong_rate", "--format", "csv").stdout
        fresh = self.gnomon("table", "out", "--columns", "technique,wrong_rate", "--format", "csv", "--rescore").stdout
        self.assertNotEqual(plain, fresh)
        original = self.gnomon("table", self.run_folder, "--columns", "technique,wrong_rate", "--format", "csv").stdout
        self.assertEqual(fresh, original)

    def test_another_scene_keeps_the_old_metrics_and_says_so(self):
        def spoil(row):
            for metrics in row["metrics"].values():
                metrics["wrong_rate"] = 0.25
            if row["scene"] == "fence":
                row["context"]["scene_hash"] = "0" * 32

        edit(self.out, spoil)
        _, said = self.rescore("--save")
        self.assertRegex(said, r"fence: \d+ rows keep their metrics: the scene is not the one that was measured\n")
        for row in records(self.out):
            if row["status"] != "ok":
                continue
            rate = row["metrics"]["shape"]["wrong_rate"]
            self.assertEqual(rate == 0.25, row["scene"] == "fence", row["scene"])

    def test_a_row_that_does_not_say_which_scene_was_measured_keeps_its_metrics(self):
        edit(self.out, lambda row: row["context"].pop("scene_hash", None) if row["scene"] == "fence" else None)
        before = scored(self.out)
        _, said = self.rescore("--save")
        self.assertRegex(said, r"fence: \d+ rows keep their metrics: its record does not say which scene was measured\n")
        self.assertEqual(scored(self.out), before)

    def test_a_scene_that_is_gone_keeps_its_metrics(self):
        edit(self.out, lambda row: row.update(scene="gone.toml") if row["scene"] == "fence" else None)
        before = scored(self.out)
        _, said = self.rescore("--save")
        self.assertIn("gone.toml", said)
        self.assertEqual(scored(self.out), before)

    def test_a_row_on_a_path_keeps_its_metrics(self):
        edit(self.out, lambda row: row.update(path="camera_slide") if row["scene"] == "fence" else None)
        _, said = self.rescore()
        self.assertRegex(said, r"\d+ rows keep their metrics: on a path")

    def test_a_mask_that_is_missing_or_of_another_size_is_an_error_that_names_the_row(self):
        original = (self.run_folder / "records.jsonl").read_bytes()
        for change, says in [
            (lambda row: row["mask"] and row.update(mask="masks/nowhere.exr"), ["nowhere.exr"]),
            (lambda row: row["mask"] and row.update(mask=None), ["no mask"]),
            (lambda row: row["mask"] and row.update(width=80, classes={}), ["160x90", "80x90"]),
        ]:
            (self.out / "records.jsonl").write_bytes(original)
            edit(self.out, change)
            lines = (self.out / "records.jsonl").read_bytes()
            done = self.gnomon("table", "out", "--rescore", "--save")
            self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
            complaint = done.stderr.splitlines()[-1]
            self.assertTrue(complaint.startswith("gnomon: "), complaint)
            self.assertRegex(complaint, r"(fence|sphere_over_plane) \w+ embree_rays \([0-9a-f]+\)")
            for text in says:
                self.assertIn(text, complaint)
            self.assertEqual((self.out / "records.jsonl").read_bytes(), lines)

    def test_saving_needs_rescoring_and_the_folder_for_itself(self):
        self.refuse("table", "out", "--save", says=["--save", "--rescore"])
        lines = (self.out / "records.jsonl").read_bytes()
        with open(self.out / "records.jsonl", "rb") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            self.refuse("table", "out", "--rescore", "--save", says=["records.jsonl", "another run"])
            self.assertEqual((self.out / "records.jsonl").read_bytes(), lines)
        self.refuse("table", "nowhere", "--rescore", "--save", says=["nowhere"])
        self.assertFalse((self.dir / "nowhere").exists())


if __name__ == "__main__":
    unittest.main()
