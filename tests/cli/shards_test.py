#!/usr/bin/python3 -IB
"""Shards: dealt by the hash of the job, so that every machine deals alike; and the script that runs them with GNU parallel."""

import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, NUMBERS, PATIENCE, PROGRAM, ROOT, SMALL, ProgramTest, measured, records, what  # noqa: E402

ROWS = [*HARD, "--scene", "single_triangle", "--technique", "shadow_map:resolution={256,512}", "--technique", "unshadowed"]


def has_gnu_parallel():
    program = shutil.which("parallel")
    return program and "GNU parallel" in subprocess.run([program, "--version"], capture_output=True, text=True).stdout


class Shards(ProgramTest):
    def jobs(self, *arguments):
        return re.findall(r"(?m)^([0-9a-f]{16})  ", self.succeed("run", *arguments, "--dry-run"))

    def test_a_job_belongs_to_the_shard_that_its_hash_says(self):
        whole = self.jobs("quick")
        self.assertEqual(len(whole), len(set(whole)))
        for count in (1, 2, 7):
            shards = [self.jobs("quick", "--shard", f"{k}/{count}") for k in range(count)]
            self.assertEqual(sorted(sum(shards, [])), sorted(whole))
            for k, shard in enumerate(shards):
                self.assertEqual({int(job[:8], 16) % count for job in shard} - {k}, set())
                self.assertEqual(shard, [job for job in whole if job in set(shard)])  # in the order of the suite

    def test_rows_stay_in_their_shard_when_others_come_and_go(self):
        # As on two machines of which one has fetched more scenes: what both have is dealt alike.
        few, many = ROWS, ["--scene", "soup:count=50", *ROWS, "--technique", "embree_rays"]
        for k in range(3):
            ours = self.jobs(*few, "--shard", f"{k}/3")
            theirs = self.jobs(*many, "--shard", f"{k}/3")
            self.assertLessEqual(set(ours), set(theirs))

    def test_an_empty_shard_says_so_and_can_be_merged(self):
        count = 64
        full = {int(job[:8], 16) % count for job in self.jobs(*ROWS)}
        empty = next(k for k in range(count) if k not in full)
        text = self.succeed("run", *ROWS, *NUMBERS, "--shard", f"{empty}/{count}", "--out", "empty")
        self.assertIn(f"shard {empty}/{count} has no rows", text)
        self.assertEqual((self.dir / "empty/records.jsonl").read_bytes(), b"")
        self.succeed("run", *ROWS, *NUMBERS, "--out", "whole")
        self.succeed("merge", "empty", "whole", "--out", "merged")
        self.assertEqual(records(self.dir / "merged"), records(self.dir / "whole"))
        self.assertIn("the folders hold no rows", self.succeed("merge", "empty", "--out", "nothing"))

    def test_bad_shards_are_refused(self):
        for shard in ("3/3", "-1/3", "1", "1/0", "1/3x", "a/b"):
            self.refuse("run", *ROWS, "--shard", shard, "--dry-run", says=[f"--shard {shard} is not I/N with 0 <= I < N"])


@unittest.skipUnless(has_gnu_parallel(), "GNU parallel is not installed (Debian: parallel)")
class Parallel(ProgramTest):
    def script(self, *arguments):
        environment = dict(self.environment, GNOMON_PROGRAM=PROGRAM)
        return subprocess.run([ROOT / "scripts/shards_parallel", *map(str, arguments)], cwd=self.dir, env=environment, text=True,
                              capture_output=True, timeout=PATIENCE)

    def test_three_shards_are_run_merged_and_cleared_away(self):
        out = self.dir / "a folder/merged"  # with a space, as people have them
        done = self.script("3", out, *ROWS, *SMALL)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.succeed("run", *ROWS, *SMALL, "--out", "whole")
        whole, merged = records(self.dir / "whole"), records(out)
        self.assertEqual([what(r) for r in merged], [what(r) for r in whole])
        self.assertEqual([measured(r) for r in merged], [measured(r) for r in whole])
        self.assertEqual(self.names(out), self.names(self.dir / "whole"))
        self.assertEqual([p.name for p in out.parent.iterdir()], ["merged"])
        self.assertIn("6 rows: 6 ok", done.stdout)

    def test_a_stopped_call_is_continued(self):
        # What a stopped call leaves: one shard done, the others not begun.
        parts = self.dir / "merged.parts"
        parts.mkdir()
        (parts / "count").write_text("3\n")
        self.succeed("run", *ROWS, *NUMBERS, "--shard", "1/3", "--out", parts / "1")
        before = (parts / "1/records.jsonl").read_text().splitlines()
        self.assertGreater(len(before), 0)
        done = self.script("2", self.dir / "merged", *ROWS, *NUMBERS)
        self.assertEqual(done.returncode, 2)
        self.assertIn("shards of a run in 3 parts", done.stderr)
        (parts / "arguments").write_text("quick --light sun\n")
        done = self.script("3", self.dir / "merged", *ROWS, *NUMBERS)
        self.assertEqual(done.returncode, 2)
        self.assertIn("merged.parts holds shards of 'gnomon run quick --light sun': continue with these arguments", done.stderr)
        (parts / "arguments").unlink()
        done = self.script("--jobs", "2", "3", self.dir / "merged", *ROWS, *NUMBERS)
        self.assertEqual(done.returncode, 0, done.stderr)
        merged = (self.dir / "merged/records.jsonl").read_text().splitlines()
        self.assertEqual(len(merged), 6)
        self.assertLessEqual(set(before), set(merged))  # not measured again

    def test_failed_rows_are_tried_again_when_a_call_is_continued(self):
        call = ["2", self.dir / "merged", *ROWS, *NUMBERS]
        parts = self.dir / "merged.parts"
        parts.mkdir()
        (parts / "1").write_text("a file where the folder of the shard should be")
        self.assertEqual(self.script(*call).returncode, 1)
        remembered = (parts / "arguments").read_text()
        (parts / "1").unlink()
        file = parts / "0/records.jsonl"
        self.assertGreater(file.stat().st_size, 0)
        file.write_text(file.read_text().replace('"status":"ok"', '"status":"failed"'))
        done = self.script(*call, "--retry-failed")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual({r["status"] for r in records(self.dir / "merged")}, {"ok"})
        self.assertNotIn("--retry-failed", remembered)

    def test_a_shard_that_cannot_run_stops_the_merge_and_keeps_the_others(self):
        parts = self.dir / "merged.parts"
        parts.mkdir()
        (parts / "1").write_text("a file where the folder of the shard should be")
        done = self.script("2", self.dir / "merged", *ROWS, *NUMBERS)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("shard 1/2 ended with status 2", done.stderr)
        self.assertIn("1 of 2 shards are not done", done.stderr)
        self.assertFalse((self.dir / "merged").exists())
        self.assertTrue((parts / "0/records.jsonl").is_file())

    def test_bad_arguments_are_refused_before_anything_runs(self):
        (self.dir / "there").mkdir()
        for arguments, says in ((["0", "out", *ROWS], "COUNT = 0 is not a whole number of 1 .. 9999"),
                                (["2", "out"], "are wanted"),
                                (["2", "out", *ROWS, "--resume"], "--resume is for this script to say"),
                                (["2", self.dir / "there", *ROWS], "is there already"),
                                (["--jobs", "x", "2", "out", *ROWS], "--jobs x is not a whole number"),
                                (["2", self.dir / "out", "--scene", "soop", "--technique", "unshadowed"], "did you mean soup"),
                                (["--machine", "2", "out"], "--machine is not an argument of it")):
            done = self.script(*arguments)
            self.assertEqual(done.returncode, 2, f"{arguments}: {done.stdout}{done.stderr}")
            self.assertIn(says, done.stderr)
        self.assertEqual([p.name for p in self.dir.iterdir()], ["there"])


# What the script needs of Slurm, without its daemons: sbatch runs the tasks of the array one after the other, squeue shows them, does
# not answer once, and no longer has the job when all are done. scripts/check_slurm is the same with the real one.
SBATCH = """#!/bin/bash
echo "$@" >"$FAKE/submitted"
script=${!#}
last=$(sed -nE 's/^#SBATCH --array=0-([0-9]+)$/\\1/p' "$script")
(for k in $(seq 0 "$last"); do [ -e "$FAKE/lost$k" ] || SLURM_ARRAY_TASK_ID=$k bash "$script"; done; touch "$FAKE/done") >/dev/null 2>&1 &
echo "7;cluster"
"""
SQUEUE = """#!/bin/bash
echo >>"$FAKE/asked"
if [ "$(wc -l <"$FAKE/asked")" = 2 ]; then echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1; fi
if [ -e "$FAKE/done" ]; then echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1; fi
echo RUNNING; echo PENDING
"""


class Slurm(ProgramTest):
    def setUp(self):
        super().setUp()
        self.fake = self.dir / "fake"
        self.fake.mkdir()
        for name, text in (("sbatch", SBATCH), ("squeue", SQUEUE)):
            self.write(f"fake/{name}", text).chmod(0o755)
        self.environment = dict(self.environment, GNOMON_PROGRAM=PROGRAM, FAKE=str(self.fake),
                                PATH=f"{self.fake}:{self.environment['PATH']}")

    def script(self, *arguments):
        return subprocess.run([ROOT / "scripts/shards_slurm", *map(str, arguments)], cwd=self.dir, env=self.environment, text=True,
                              capture_output=True, timeout=PATIENCE)

    def test_the_array_is_submitted_awaited_and_merged(self):
        done = self.script("--sbatch", "--partition=gpu --time=120", "3", self.dir / "merged", *ROWS, *NUMBERS)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex((self.fake / "submitted").read_text(), r"^--parsable --partition=gpu --time=120 .*merged\.parts/job\.sh$")
        self.assertIn("Slurm job 7: 3 shards", done.stderr)
        self.assertIn("shards: 1 pending, 1 running", done.stderr)
        self.succeed("run", *ROWS, *NUMBERS, "--out", "whole")
        whole, merged = records(self.dir / "whole"), records(self.dir / "merged")
        self.assertEqual([what(r) for r in merged], [what(r) for r in whole])
        self.assertEqual([measured(r) for r in merged], [measured(r) for r in whole])
        self.assertFalse((self.dir / "merged.parts").exists())

    def test_a_task_that_was_lost_is_named_and_done_by_the_next_call(self):
        (self.fake / "lost1").touch()
        call = ["3", self.dir / "merged", *ROWS, *NUMBERS]
        done = self.script(*call)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("shard 1/3 was stopped", done.stderr)
        self.assertFalse((self.dir / "merged").exists())
        for name in ("lost1", "done", "asked"):
            (self.fake / name).unlink()
        done = self.script(*call)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(records(self.dir / "merged")), 6)

    def test_print_submits_nothing(self):
        done = self.script("--print", "2", self.dir / "merged", *ROWS)
        self.assertEqual(done.stdout.strip(), str(self.dir / "merged.parts/job.sh"))
        text = (self.dir / "merged.parts/job.sh").read_text()
        for line in ("#SBATCH --array=0-1\n", "#SBATCH --exclusive\n"):
            self.assertIn(line, text)
        self.assertFalse((self.fake / "submitted").exists())


if __name__ == "__main__":
    unittest.main()
