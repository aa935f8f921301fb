#!/usr/bin/python3 -IB
"""Techniques that crash, hang, throw, eat memory, lie or leave: each costs its own rows and no other."""

import json
import os
import shutil
import signal
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, HUNG, NUMBERS, PATIENCE, PROGRAM, SMALL, ProgramTest, records, wait_until, workers  # noqa: E402

REASONS = {
    "crashes": r"^crashed in resolve: Segmentation fault \(signal 11\)",
    "eats_memory": r"^threw in resolve: out of memory",
    "exits": r"^crashed in resolve: exit status 3",
    "hangs": rf"^hung in relight: no answer within {HUNG} s",
    "returns_nan": r"^mask value -?nan at pixel 7 is outside 0 \.\. 1",
    "throws": r"^threw in build: the tree has no root",
}
SOUND = ["unshadowed", "embree_rays"]
SCENES = ["single_triangle", "soup:count=50"]


class Faults(ProgramTest):
    def test_each_fault_costs_its_own_rows_and_says_what_happened(self):
        # Sound and faulty ones take turns, so that a fault could hit a neighbor.
        techniques = list(dict.fromkeys(name for pair in zip(REASONS, SOUND * 3) for name in pair))
        arguments = [word for name in techniques for word in ("--technique", name)]
        arguments += [word for scene in SCENES for word in ("--scene", scene)]
        text = self.succeed("--plugin", FAULTS, "run", *arguments, "--light", "point", *SMALL, "--timeout", HUNG, "--out", "out",
                            status=1)
        rows = {(r["scene"], r["technique"]): r for r in records(self.dir / "out")}
        self.assertEqual(set(rows), {(scene, name) for scene in SCENES for name in [*REASONS, *SOUND]})
        for (scene, name), row in rows.items():
            with self.subTest(f"{scene} {name}"):
                if name in REASONS:
                    self.assertEqual(row["status"], "failed")
                    self.assertRegex(row["reason"], REASONS[name])
                    self.assertIsNone(row["mask"])
                else:
                    self.assertEqual((row["status"], row["reason"]), ("ok", ""))
                    self.assertEqual([len(p) for p in row["stages"]["resolve"]], [1])
        self.assertRegex(text, r"(?m)^16 rows: 4 ok, 0 unsupported, 12 failed;")
        for name in REASONS:
            self.assertRegex(text, rf"(?m)^{name} +failed +{REASONS[name][1:]}")
        self.assertEqual(workers(self.dir, keepers=True), [])
        self.assertFalse((self.dir / "out/.scratch").exists())

    def test_addresses_may_be_reserved_beyond_all_memory(self):
        self.succeed("--plugin", FAULTS, "run", "--scene", "single_triangle", "--technique", "reserves", "--light", "point", *NUMBERS, "--out", "out")
        self.assertEqual([r["status"] for r in records(self.dir / "out")], ["ok"])

    def test_a_fault_in_a_later_process_costs_the_row_only(self):
        # Every process of a technique that throws is a new one; the others keep all three of theirs.
        self.succeed("--plugin", FAULTS, "run", "--scene", "single_triangle", "--technique", "crashes", "--technique", "unshadowed",
                     "--light", "point", "--light", "sun", "--processes", "3", "--repetitions", "1", "--size", "160x90", "--out", "out", status=1)
        rows = records(self.dir / "out")
        self.assertEqual([(r["technique"], r["status"]) for r in rows], [("crashes", "failed"), ("unshadowed", "ok")] * 2)
        self.assertEqual([len(r["stages"].get("resolve", [])) for r in rows], [0, 3, 0, 3])

    def test_a_row_that_fails_in_a_later_process_has_no_results(self):
        self.environment["GNOMON_TEST_TIRED"] = str(self.dir / "tired")
        self.succeed("--plugin", FAULTS, "run", "--scene", "single_triangle", "--light", "sun", "--technique", "tires", "--technique",
                     "unshadowed", "--processes", "3", "--repetitions", "1", "--size", "160x90", "--out", "out", status=1)
        tired, sound = records(self.dir / "out")
        self.assertEqual((tired["technique"], tired["status"]), ("tires", "failed"))
        self.assertRegex(tired["reason"], "enough for today")
        for key in ("metrics", "frames", "classes", "iterations", "causes", "bytes", "mask", "error_picture", "shaded_picture", "stop",
                    "counts"):
            self.assertFalse(tired[key], key)
            self.assertTrue(sound[key] or key in ("frames", "bytes", "counts"), key)
        self.assertEqual([p for p in tired["stages"].values() if p], [])
        self.assertEqual([name for name in self.names(self.dir / "out") if "tires" in name], [])

    def test_a_fault_in_the_middle_of_a_sample_costs_the_row_only(self):
        # The answer and the warm-up are builds 1 and 2; the ten iterations of the first sample, one request, are 3 .. 12.
        for variable, reason in (("GNOMON_TEST_THROWS_AT", "threw in build: one too many"),
                                 ("GNOMON_TEST_HANGS_AT", rf"hung in build: no answer within {HUNG}\.1 s")):
            with self.subTest(variable):
                self.environment[variable] = "8"
                self.succeed("--plugin", FAULTS, "run", "--scene", "single_triangle", "--light", "sun", "--technique", "busy",
                             "--technique", "unshadowed", "--timeout", HUNG, *NUMBERS, "--out", variable, status=1)
                del self.environment[variable]
                broken, sound = records(self.dir / variable)
                self.assertEqual((broken["technique"], broken["status"]), ("busy", "failed"))
                self.assertRegex(broken["reason"], f"^{reason}$")
                self.assertEqual([p for p in broken["stages"].values() if p], [])
                self.assertEqual((sound["status"], len(sound["stages"]["build"][0])), ("ok", 1))
                self.assertEqual(workers(self.dir, keepers=True), [])

    def test_render_of_a_fault_exits_with_1_and_writes_nothing(self):
        done = self.gnomon("--plugin", FAULTS, "render", "--scene", "single_triangle", "--technique", "crashes", "--size", "64x64",
                           "--out", "out")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^gnomon: crashed in \w+: Segmentation fault \(signal 11\)\n$")
        self.assertEqual(list(self.dir.iterdir()), [])

    def test_a_program_that_goes_away_while_it_runs_is_named(self):
        # As a build does it: the file of the running program is removed. The second process of the row finds none to start. A worker
        # that loads the plugin comes before the folder for files between both sides.
        program = self.dir / "gnomon"
        shutil.copy(PROGRAM, program)
        call = [program, "--plugin", FAULTS, "run", "--scene", "single_triangle", "--light", "sun", "--technique", "sleeps",
                "--processes", "2", "--repetitions", "1", "--size", "64x36", "--out", self.dir / "out"]
        environment = dict(self.environment, GNOMON_TEST_RELIGHT_MS="1500")  # long enough to be seen on a busy machine
        run = subprocess.Popen(list(map(str, call)), env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        wait_until(lambda: run.poll() is not None or ((self.dir / "out/.scratch").exists() and len(workers(program)) == 2),
                   "itself and its first worker")
        program.unlink()
        text, words = run.communicate(timeout=PATIENCE)
        self.assertEqual(run.returncode, 1, words)
        row = records(self.dir / "out")[0]
        self.assertEqual(row["status"], "failed")
        self.assertIn(f"program {program} was removed or replaced while it ran", row["reason"])
        self.assertIn("start again", text)

    def test_a_plugin_is_listed_and_described_like_what_is_built_in(self):
        ids = [entry["id"] for entry in json.loads(self.succeed("--plugin", FAULTS, "list", "--json"))]
        self.assertEqual([i for i in ids if i in REASONS], sorted(REASONS))
        self.assertIn("Never comes back from relight.", self.succeed("--plugin", FAULTS, "describe", "hangs"))


class Reference(ProgramTest):
    """The reference is traced by a worker, too. Nothing that may be loaded brings it down: here it is killed."""

    LARGE = ["--size", "2048x2048", "--light", "point", "--out", "out"]

    def start_and_kill_the_tracer(self, times, *arguments):
        """Kills the worker that was started last while it traces, and those that follow it; what the program then says."""
        self.environment.update(GNOMON_CACHE=str(self.dir / "cache"))  # where no frame is kept yet
        process = self.start(*arguments)
        killed = set()

        def at_work():
            self.assertIsNone(process.poll(), process.args)
            found = [w for w in workers(self.dir) if w not in killed and is_worker(w)]
            return len(found) >= 2 and found

        def is_worker(pid):  # not one that was forked a moment ago to keep a worker, and has no name of its own yet
            try:
                return b"\0worker\0" in Path(f"/proc/{pid}/cmdline").read_bytes()
            except OSError:
                return False

        while len(killed) < times:
            found = wait_until(at_work, "the technique's worker and the tracer")
            age = {w: int(Path(f"/proc/{w}/stat").read_text().rsplit(")", 1)[1].split()[19]) for w in found}
            killed.add(max(found, key=lambda w: (age[w], w)))
            os.kill(max(found, key=lambda w: (age[w], w)), signal.SIGSEGV)
        words = process.communicate(timeout=PATIENCE)
        return words, process.returncode

    def test_a_tracer_that_is_killed_once_costs_nothing(self):
        self.start_and_kill_the_tracer(1, "run", "--scene", "box_city", "--technique", "unshadowed", "--processes", "1",
                                       "--repetitions", "1", *self.LARGE)
        self.assertEqual([r["status"] for r in records(self.dir / "out")], ["ok"])

    def test_a_crash_of_the_reference_costs_its_own_rows(self):
        run = ["run", "--scene", "box_city", "--scene", "single_triangle", "--technique", "unshadowed", "--processes", "1",
               "--repetitions", "1", *self.LARGE]
        (text, _), status = self.start_and_kill_the_tracer(2, *run)
        self.assertEqual(status, 1)
        first, second = records(self.dir / "out")
        self.assertEqual((first["scene"], first["status"]), ("box_city", "failed"))
        self.assertRegex(first["reason"], r"^the reference crashed in trace: Segmentation fault \(signal 11\)")
        self.assertEqual((second["scene"], second["status"]), ("single_triangle", "ok"))
        self.assertRegex(text, r"(?m)^unshadowed +failed +the reference crashed in trace")
        self.succeed(*run, "--resume", "--retry-failed")
        self.assertEqual(sorted((r["scene"], r["status"]) for r in records(self.dir / "out")),
                         [("box_city", "ok"), ("single_triangle", "ok")])

    def test_render_says_so_and_writes_nothing(self):
        (_, words), status = self.start_and_kill_the_tracer(2, "render", "--scene", "box_city", "--technique", "unshadowed", *self.LARGE)
        self.assertEqual(status, 1)
        self.assertRegex(words, r"^gnomon: the reference crashed in trace: Segmentation fault \(signal 11\)\n$")
        self.assertEqual([p.name for p in self.dir.iterdir()], ["cache"])
        self.assertEqual(workers(self.dir, keepers=True), [])


if __name__ == "__main__":
    unittest.main()
