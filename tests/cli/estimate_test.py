#!/usr/bin/python3 -IB
"""How long it will take: --dry-run says it from what earlier runs took, here or in results/."""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, NUMBERS, ROOT, ProgramTest, records  # noqa: E402

ROWS = [*HARD, "--scene", "single_triangle", "--technique", "unshadowed", "--technique", "shadow_map"]


class Estimate(ProgramTest):
    def setUp(self):
        super().setUp()
        # Scenes and suites as they are, and no results: a machine without rates.
        self.root = self.dir / "root"
        (self.root / "bench").mkdir(parents=True)
        (self.root / "scenes").symlink_to(ROOT / "scenes")
        (self.root / "bench/suites").symlink_to(ROOT / "bench/suites")
        self.cache = self.dir / "cache"
        self.environment = dict(self.environment, GNOMON_ROOT=str(self.root), GNOMON_CACHE=str(self.cache))

    def estimate(self, *arguments):
        """The last line, and the seconds that it says."""
        line = self.succeed("run", *arguments, "--dry-run").splitlines()[-1]
        self.assertTrue(line.startswith("estimated time: "), line)
        found = re.match(r"estimated time: (?:(\d+) h )?(?:(\d+) min)? ?(?:(\d+) s)? \(from", line)
        return line, sum(int(part or 0) * unit for part, unit in zip(found.groups(), (3600, 60, 1))) if found else None

    def history(self):
        return [json.loads(line) for line in (self.cache / "history.jsonl").read_text().splitlines()]

    def test_nothing_is_known_until_something_has_run(self):
        self.assertIn("nothing is known yet", self.estimate(*ROWS)[0])
        self.assertFalse(self.cache.exists())  # a dry run leaves nothing
        self.succeed("run", *ROWS, *NUMBERS, "--out", "out")
        self.assertIn("(from 4 rows measured on this machine)", self.estimate(*ROWS, *NUMBERS)[0])
        self.assertIn("(from 4 rows guessed from similar rows)", self.estimate(*ROWS, "--size", "80x45")[0])
        self.assertIn("(from 4 rows measured on this machine, 4 guessed from similar rows)",
                      self.estimate("--scene", "soup:count=50", *ROWS, *NUMBERS)[0])

    def test_a_run_is_remembered_with_what_it_took(self):
        self.succeed("run", *ROWS, "--processes", "2", "--repetitions", "2", "--size", "160x90", "--out", "out")
        took = {r["job"]: r["seconds"] for r in records(self.dir / "out")}
        known = {r["job"]: r for r in self.history()}
        self.assertEqual(set(known), set(took))
        for job, row in known.items():
            self.assertLessEqual(row["once"] + 2 * row["process"], took[job] + 1e-9)
        # The seconds of all rows are those of the run.
        self.assertGreater(sum(took.values()), 0.2)

    def test_more_processes_and_repetitions_take_longer(self):
        slow = ["--scene", "soup:count=2000", "--technique", "shadow_map:filter=pcf,filter_radius=4", "--light", "sun"]
        self.succeed("run", *slow, *NUMBERS, "--out", "out")
        seconds = [self.estimate(*slow, "--size", "160x90", "--processes", str(p), "--repetitions", str(r))[1]
                   for p, r in ((1, 1), (100, 1), (100, 100))]
        self.assertLess(seconds[0], seconds[1])
        self.assertLess(seconds[1], seconds[2])

    def test_a_fresh_clone_knows_its_results(self):
        self.succeed("run", *ROWS, *NUMBERS, "--out", self.root / "results/mine")
        (self.cache / "history.jsonl").unlink()
        self.assertIn("(from 4 rows measured elsewhere)", self.estimate(*ROWS, *NUMBERS)[0])
        kept = self.cache / "shipped_costs.jsonl"
        self.assertEqual(len(kept.read_text().splitlines()), 1 + 4)
        self.assertIn("(from 4 rows measured elsewhere)", self.estimate(*ROWS, *NUMBERS)[0])  # from there
        kept.write_text(kept.read_text().splitlines()[0] + "\nno cost\n")
        self.assertNotIn("measured elsewhere", self.estimate(*ROWS, *NUMBERS)[0])  # from there, indeed
        (self.root / "results/broken").mkdir()
        (self.root / "results/broken/records.jsonl").write_text("no record\n")  # an estimate can do without
        self.assertIn("(from 4 rows measured elsewhere)", self.estimate(*ROWS, *NUMBERS)[0])

    def test_a_shard_is_estimated_as_what_it_is(self):
        self.succeed("run", *ROWS, *NUMBERS, "--out", "out")
        counts = []
        for k in (0, 1):
            found = re.search(r"from (\d+) rows? measured", self.succeed("run", *ROWS, *NUMBERS, "--shard", f"{k}/2", "--dry-run"))
            counts.append(int(found.group(1)) if found else 0)
        self.assertEqual(sum(counts), 4)

    def test_a_cache_that_cannot_be_written_costs_no_row(self):
        self.cache.mkdir()
        (self.cache / "history.jsonl.lock").mkdir()
        done = self.gnomon("run", *ROWS, *NUMBERS, "--out", "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("history.jsonl.lock cannot be locked", done.stderr)
        self.assertEqual({r["status"] for r in records(self.dir / "out")}, {"ok"})


class Retry(ProgramTest):
    def test_failed_rows_stay_until_they_are_tried_again(self):
        self.succeed("run", *ROWS, *NUMBERS, "--out", "out")
        failed = [dict(row, status="failed", reason="out of luck") for row in records(self.dir / "out")]
        (self.dir / "out/records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in failed))
        self.assertIn("4 were done before", self.succeed("run", *ROWS, *NUMBERS, "--resume", "--out", "out", status=1))
        self.assertEqual(records(self.dir / "out"), failed)
        # Only the rows that are requested; the others stay failed.
        text = self.succeed("run", *ROWS, *NUMBERS, "--filter", "sun", "--resume", "--retry-failed", "--out", "out", status=1)
        self.assertIn("2 rows: 2 ok, 0 unsupported, 0 failed", text)
        rows = records(self.dir / "out")
        self.assertEqual(sorted((r["light"], r["status"]) for r in rows), [("point", "failed")] * 2 + [("sun", "ok")] * 2)
        done = {r["job"]: r for r in rows if r["status"] == "ok"}
        text = self.succeed("run", *ROWS, *NUMBERS, "--resume", "--retry-failed", "--out", "out")
        self.assertIn("2 were done before", text)
        rows = records(self.dir / "out")
        self.assertEqual((len(rows), {r["status"] for r in rows}), (4, {"ok"}))
        self.assertEqual({r["job"]: r for r in rows if r["job"] in done}, done)  # these were not run again
        # Rows of the table are in the order of the suite, not in that in which they came to pass.
        table = json.loads(self.succeed("table", "out", "--format", "json"))
        self.assertEqual([r["job"] for r in table["rows"]], [r["job"] for r in failed])

    def test_trying_again_needs_a_run_to_continue(self):
        self.refuse("run", *ROWS, "--retry-failed", says=["--resume"])


if __name__ == "__main__":
    unittest.main()
