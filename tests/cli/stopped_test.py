#!/usr/bin/python3 -IB
"""Runs that are stopped: what was finished stays, --resume does the rest, and nobody is left behind."""

import json
import os
import shutil
import signal
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, PATIENCE, ProgramTest, measured, records, wait_until, what, workers  # noqa: E402

SCENES = ["single_triangle", "soup:count=50", "sphere_over_plane"]
RUN = ["run", *HARD, *[word for scene in SCENES for word in ("--scene", scene)], "--technique", "unshadowed", "--technique", "shadow_map",
       "--processes", "3", "--repetitions", "2", "--size", "160x90", "--out", "out"]
BATCH = ["run", *HARD, "--scene", "soup:count=50", "--technique", "unshadowed", "--technique", "shadow_map", "--processes", "12",
         "--size", "160x90", "--out", "out"]
ROWS = 4 * len(SCENES)  # two lights, two techniques


class Stopped(ProgramTest):
    def setUp(self):
        super().setUp()
        self.file = self.dir / "out/records.jsonl"

    def lines(self):
        return self.file.read_bytes().splitlines(keepends=True) if self.file.exists() else []

    def stop(self, with_signal, after):
        """Starts the run, stops it when `after` records are there, and sees that its workers go with it."""
        run = self.start(*RUN, start_new_session=True)
        wait_until(lambda: len(self.lines()) >= after and len(workers(self.dir)) > 1, f"{after} records and a worker")
        if with_signal == signal.SIGINT:
            os.killpg(run.pid, signal.SIGINT)  # a terminal sends it to the workers too
        else:
            os.kill(run.pid, with_signal)
        run.communicate(timeout=PATIENCE)
        self.assert_gone()
        self.assertLess(len(self.lines()), ROWS)  # it has not come to its end instead
        return run.returncode

    def assert_whole(self):
        rows = records(self.dir / "out")
        self.assertEqual(len(rows), ROWS)
        self.assertEqual(len({row["job"] for row in rows}), ROWS)
        self.assertEqual({row["status"] for row in rows}, {"ok"})
        for row in rows:
            self.assertEqual(len(row["stages"]["resolve"]), 3)
            self.assertTrue((self.dir / "out" / row["mask"]).is_file())
        self.assertFalse((self.dir / "out/.scratch").exists())
        self.assertEqual([name for name in self.names(self.dir / "out") if "/." in name or name.startswith(".")], [])

    def test_a_killed_run_is_resumed_without_loss_or_repetition(self):
        self.assertEqual(self.stop(signal.SIGKILL, after=4), -signal.SIGKILL)
        before = self.lines()
        self.assertIn(len(before), (4, 8))
        half = self.dir / "out/masks/.1.part.exr"  # as if it had been killed in the middle of a picture
        half.write_bytes(b"half")
        self.refuse(*RUN, says=["--resume"])
        text = self.succeed(*RUN, "--resume")
        self.assertEqual(self.lines()[:len(before)], before)
        self.assertIn(f"{len(before)} were done before", text)
        self.assert_whole()
        whole = self.lines()
        self.succeed(*RUN, "--resume")  # nothing is left to do
        self.assertEqual(self.lines(), whole)

    def stop_within_a_batch(self):
        """Stops a run of one batch after its second process; returns what it has left, by job."""
        file = self.dir / "out/unfinished.jsonl"

        def kept():  # the file is replaced as a whole
            return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []

        program = self.start(*BATCH, "--repetitions", "2", start_new_session=True)
        wait_until(lambda: any(len(row["stages"]["resolve"]) >= 2 for row in kept()), "two processes")
        os.kill(program.pid, signal.SIGKILL)
        program.communicate(timeout=PATIENCE)
        self.assert_gone()
        self.assertEqual(self.lines(), [])  # no row has come to its end
        return {row["job"]: row for row in kept()}

    def test_a_killed_run_repeats_no_process_that_had_ended(self):
        kept = self.stop_within_a_batch()
        self.succeed(*BATCH, "--repetitions", "2", "--resume")
        rows = records(self.dir / "out")
        self.assertEqual({row["job"] for row in rows}, set(kept))
        for row in rows:
            self.assertEqual((row["status"], len(row["stages"]["resolve"]), row["stop"]), ("ok", 12, "fixed"))
            self.assertNotIn("effort", row["context"])
            for stage, processes in kept[row["job"]]["stages"].items():
                self.assertGreaterEqual(len(processes), 2 if stage != "update" else 0)
                self.assertEqual(row["stages"][stage][:len(processes)], processes, stage)
            self.assertEqual(row["metrics"], kept[row["job"]]["metrics"])
        self.assertFalse((self.dir / "out/unfinished.jsonl").exists())

    def test_processes_of_another_effort_or_without_their_pictures_are_repeated(self):
        kept = self.stop_within_a_batch()
        lost = next(row for row in kept.values() if row["light"] == "sun")
        (self.dir / "out" / lost["mask"]).unlink()
        self.succeed(*BATCH, "--repetitions", "2", "--resume")
        again = {row["job"]: row["stages"]["resolve"][:2] != kept[row["job"]]["stages"]["resolve"][:2] for row in records(self.dir / "out")}
        self.assertEqual([job for job, is_again in again.items() if is_again], [lost["job"]])
        shutil.rmtree(self.dir / "out")
        kept = self.stop_within_a_batch()
        self.succeed(*BATCH, "--repetitions", "3", "--resume")
        for row in records(self.dir / "out"):
            self.assertEqual([len(process) for process in row["stages"]["resolve"]], [3] * 12)

    def test_a_torn_last_line_is_mended_and_its_row_done_again(self):
        self.succeed(*RUN)
        whole, rows = self.lines(), records(self.dir / "out")
        self.file.write_bytes(b"".join(whole)[:-len(whole[-1]) // 2])
        done = self.gnomon("table", "out", "--format", "csv")  # readers leave it out and say so
        self.assertEqual((done.returncode, done.stdout.count("\n")), (0, ROWS))  # a heading, and all rows but the torn one
        self.assertIn("unfinished", done.stderr)
        self.succeed(*RUN, "--resume")
        self.assertEqual(self.lines()[:-1], whole[:-1])
        self.assert_whole()
        self.assertEqual([what(row) for row in records(self.dir / "out")], [what(row) for row in rows])
        self.assertEqual([measured(row) for row in records(self.dir / "out")], [measured(row) for row in rows])

    def test_control_c_stops_at_once_and_the_run_can_go_on(self):
        self.assertIn(self.stop(signal.SIGINT, after=4), (-signal.SIGINT, 130, 1))
        self.succeed(*RUN, "--resume")
        self.assert_whole()


if __name__ == "__main__":
    unittest.main()
