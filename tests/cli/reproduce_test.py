#!/usr/bin/python3 -IB
"""scripts/agrees on kept rows that were changed on purpose, and scripts/reproduce with a program that copies them. Nothing is built or run."""

import json
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, ROOT, ProgramTest  # noqa: E402

SCRIPTS = ("agrees", "reproduce", "lib.sh", "stale_results", "same_results", "convert_records")

# `gnomon` as far as the script calls it: the rows of $ROWS, a table and a figure.
PROGRAM = """#!/bin/sh
echo "$@" >>"$CALLS"
case $1 in
  run) for out; do :; done; mkdir "$out" && cp "$ROWS" "$out/records.jsonl" ;;
  table) echo '| a | table |' ;;
  figure) for out; do :; done; echo '<svg/>' >"$out" ;;
esac
"""


def kept_rows():
    with open(ROOT / "results/quick/records.jsonl", encoding="utf-8") as file:
        rows = [json.loads(line) for line in file]
    return [row for row in rows if row["scene"] == "fence" and row["light"] == "sun"]


class Agreement(ProgramTest):
    def setUp(self):
        super().setUp()
        for folder in ("scripts", "kept", "run"):
            (self.dir / folder).mkdir()
        for name in SCRIPTS:
            shutil.copy(ROOT / "scripts" / name, self.dir / "scripts")
        fetch = self.dir / "scripts/fetch_scenes"
        fetch.write_text("#!/bin/sh\n")
        fetch.chmod(0o755)
        self.write("kept", kept_rows())
        self.rows = kept_rows()
        self.drawn = next(row for row in self.rows if row["technique"] == "shadow_map")
        self.traced = next(row for row in self.rows if row["technique"] == "svbsp")

    def write(self, folder, rows):
        (self.dir / folder / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))

    def agrees(self, *options, status):
        self.write("run", self.rows)
        done = subprocess.run([self.dir / "scripts/agrees", self.dir / "run", self.dir / "kept", *options], cwd="/", text=True,
                              capture_output=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout

    def test_the_same_rows_agree_whatever_their_times(self):
        for row in self.rows:
            row["seconds"], row["stages"], row["bytes"] = 99, {}, 1
        self.assertEqual(self.agrees(status=0), f"The errors agree: all of {len(self.rows)} rows that can be judged are the same as the kept ones, "
                                                "to the last digit.\n")

    def test_a_last_digit_is_named(self):
        self.traced["metrics"]["shape"]["error"] += 2**-50
        said = self.agrees(status=1)
        self.assertIn(f"fence sun {self.traced['view']} svbsp: metrics.shape.error", said)
        self.assertIn(f"do NOT agree: 1 of {len(self.rows)} rows differs", said)

    def test_a_row_that_failed_does_not_agree(self):
        self.traced["status"] = "failed"
        self.assertIn("status ok -> failed", self.agrees(status=1))

    def test_a_drawn_row_that_has_no_support_any_more_does_not_agree(self):
        self.drawn.update(status="unsupported", gl=None)
        self.assertIn("status ok -> unsupported", self.agrees(status=1))

    def test_another_renderer_is_told_and_not_judged(self):
        self.drawn["metrics"]["shape"]["error"] *= 2
        self.drawn["context"]["gl_renderer"] = "a card"
        said = self.agrees(status=0)
        self.assertIn("1 row drawn by a card, and by llvmpipe", said)
        self.assertIn(f"all of {len(self.rows) - 1} rows", said)
        self.rows = [self.drawn]
        self.assertIn("no row could be judged", self.agrees(status=1))

    def test_another_processor_may_differ_where_nothing_is_tested(self):
        self.traced["context"]["processor"] = "another"
        self.traced["metrics"]["shape"]["ssim"] = 0.5
        self.assertIn("1 row with other pixels that are not tested", self.agrees(status=0))
        self.traced["metrics"]["shape"]["error"] = 0.5
        self.agrees(status=1)

    def test_an_erratum_speaks_for_its_rows_alone(self):
        for row in (self.drawn, self.traced):
            row["metrics"]["shape"]["error"] = 0.5
        errata = self.dir / "errata.toml"
        errata.write_text('[[erratum]]\ntechnique = "svbsp"\nversion = "0.2.0"\nreason = "a leak was mended"\n')
        said = self.agrees("--errata", errata, status=1)
        self.assertIn("is not judged, an erratum says why: a leak was mended", said)
        self.assertIn("1 of ", said)

    def test_a_folder_without_records_is_bad_usage(self):
        (self.dir / "kept/records.jsonl").unlink()
        self.agrees(status=2)

    def reproduce(self, status):
        program = self.dir / "gnomon"
        program.write_text(PROGRAM)
        program.chmod(0o755)
        self.write("run", self.rows)
        kept = self.dir / "results/editions/2027"
        if not kept.exists():
            shutil.copytree(self.dir / "kept", kept)
        done = subprocess.run([self.dir / "scripts/reproduce", "--program", program], cwd="/", text=True, capture_output=True, timeout=PATIENCE,
                              env=dict(os.environ, ROWS=str(self.dir / "run/records.jsonl"), CALLS=str(self.dir / "calls")))
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def test_the_script_leaves_a_table_and_a_figure_and_ends_with_the_verdict(self):
        for _ in range(2):  # a second call takes the place of the first
            done = self.reproduce(status=0)
            self.assertTrue(done.stdout.startswith("| a | table |\n"))
            self.assertIn("The errors agree", done.stdout.splitlines()[-1])
            self.assertIn("== 5 of 5: ", done.stderr)
            for name in ("table.md", "figure.svg", "run/records.jsonl"):
                self.assertTrue((self.dir / "reproduced" / name).is_file(), name)
        self.assertIn("run --edition 2027 --filter", (self.dir / "calls").read_text())

    def test_the_script_fails_where_errors_do_not_agree_or_a_step_fails(self):
        self.traced["metrics"]["shape"]["error"] = 0.5
        self.assertIn("do NOT agree", self.reproduce(status=1).stdout)
        shutil.rmtree(self.dir / "results")
        self.assertIn("2027 has no records.jsonl", self.reproduce_without_kept().stderr)

    def reproduce_without_kept(self):
        shutil.rmtree(self.dir / "kept")
        (self.dir / "kept").mkdir()
        return self.reproduce(status=1)


if __name__ == "__main__":
    unittest.main()
