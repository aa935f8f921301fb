#!/usr/bin/python3 -IB
"""compare: two runs of one program, planted changes, other machines, and two programs side by side."""
# Runs alone: it judges times.

import csv
import io
import json
import re
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, PATIENCE, PROGRAM, ROOT, ProgramTest, records  # noqa: E402

ROWS = ["--scene", "single_triangle", "--scene", "contact", "--light", "point", "--technique",
        "shadow_map:resolution={512,1024};unshadowed;embree_rays", "--size", "96x54", "--quiet"]


class Compare(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_dir = cls.home / "run"
        done = subprocess.run([PROGRAM, "run", *ROWS, "--processes", "3", "--repetitions", "2", "--out", str(cls.run_dir)],
                              env=cls.environment, text=True, capture_output=True, timeout=PATIENCE)
        assert done.returncode == 0, done.stderr

    def copy(self, name, change):
        """The run again, each record changed."""
        folder = self.dir / name
        folder.mkdir()
        rows = records(self.run_dir)
        for row in rows:
            change(row)
        (folder / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        return folder

    def test_a_run_and_itself_do_not_differ(self):
        text = self.succeed("compare", self.run_dir, self.run_dir)
        self.assertRegex(text, r"(?m)^8 rows matched; \d+ times judged: 0 slower, 0 faster; 0 rows with other errors; .*no regression$")
        for word in ("shadow_map", " slower$"):
            self.assertNotRegex(text, word)
        self.assertRegex(self.succeed("compare", self.run_dir, self.run_dir, "--all"), "shadow_map")

    def test_two_values_of_a_parameter_are_compared_as_two_runs_are(self):
        def compared(*words):
            done = self.gnomon("compare", *words, "--format", "json")
            self.assertIn(done.returncode, (0, 1), done.stderr)
            return json.loads(done.stdout)
        across = compared(self.run_dir, "--across", "resolution=512,1024")
        kept = {(row["scene"], row["parameters"].get("resolution")): row for row in records(self.run_dir) if row["technique"] == "shadow_map"}
        self.assertEqual([row["scene"] for row in across["rows"]], ["single_triangle", "contact"])  # those of other techniques are left out
        for row in across["rows"]:
            before, after = (kept[row["scene"], texels]["metrics"]["shape"]["error"] for texels in (512, 1024))
            self.assertNotEqual(before, after)
            change = next(one for one in row["metrics"] if one["metric"] == "error" and one["truth"] == "shape")
            self.assertEqual((change["base"], change["contender"]), (before, after))
        self.assertEqual(len(compared(self.run_dir, self.run_dir, "--across", "resolution=1024,512")["rows"]), 2)
        for words, says in ((["resolution=512"], "PARAMETER=A,B"), (["resolution=512,512"], "PARAMETER=A,B"),
                            (["resolutoin=512,1024"], "did you mean resolution"), (["resolution=512,777"], "there are: 1024, 512"),
                            (["resolution=512,1024", "--live", PROGRAM], "--live makes two")):
            self.refuse("compare", *([] if "--live" in words else [self.run_dir]), "--across", *words, says=[says])

    def test_runs_of_other_rows_are_refused(self):
        def other(row):
            row["job"] = "f" * 8 + row["job"][8:]
        folder = self.copy("other", other)
        self.refuse("compare", self.run_dir, folder, says=["have no row in common", "8 and 8 rows"])

    def test_a_slowdown_of_everything_is_a_regression(self):
        def slow(row):
            for stage, processes in row["stages"].items():
                row["stages"][stage] = [[2 * ms for ms in process] for process in processes]
        slower = self.copy("slower", slow)
        found = json.loads(self.succeed("compare", self.run_dir, slower, "--format", "json", status=1))
        self.assertEqual(found["schema"], "gnomon-compare-1")
        together = {t["stage"]: t for t in found["over_all_scenes"] if t["contender"] is None}
        self.assertEqual(together["resolve"]["verdict"], "slower")
        # Times that the clock hardly resolves count as 0.005 ms, so the mean is below 2.
        self.assertTrue(1.3 < together["resolve"]["ratio"] < 2.001, together["resolve"])
        self.succeed("compare", slower, self.run_dir)  # the other way round it is good news
        self.succeed("compare", self.run_dir, slower, "--threshold", "3")
        self.succeed("compare", self.run_dir, slower, "--floor", "4")

    def test_changed_errors_are_listed_and_a_larger_one_is_a_regression(self):
        def worse(row):
            if row["technique"] == "unshadowed":
                row["metrics"]["shape"]["error"] += 0.01
        def slightly(row):
            row["metrics"]["shape"]["error"] += 0.00001
        text = self.succeed("compare", self.run_dir, self.copy("worse", worse), status=1)
        self.assertEqual(text.count("changed !"), 2, text)
        self.assertRegex(text, r"unshadowed +error .* % +\+1.0 % +changed !")
        text = self.succeed("compare", self.run_dir, self.copy("slightly", slightly))
        self.assertEqual(len(re.findall(r" error  ", text)), 8, text)
        self.succeed("compare", self.run_dir, self.dir / "slightly", "--error-threshold", "0.000001", status=1)

    def test_a_row_that_breaks_is_a_regression_and_a_missing_one_is_said(self):
        def broken(row):
            if row["technique"] == "embree_rays":
                row.update(status="failed", reason="crashed in relight: killed")
        text = self.succeed("compare", self.run_dir, self.copy("broken", broken), status=1)
        self.assertEqual(text.count("! ok -> failed: crashed in relight: killed"), 2, text)
        folder = self.copy("fewer", lambda row: None)
        lines = (folder / "records.jsonl").read_text().splitlines(True)
        (folder / "records.jsonl").write_text("".join(lines[1:]))
        self.assertIn("7 rows matched, 1 missing;", self.succeed("compare", self.run_dir, folder))
        self.assertIn("7 rows matched, 1 new;", self.succeed("compare", folder, self.run_dir))

    def test_other_processors_are_not_judged_unless_forced(self):
        other = self.copy("other", lambda row: row["context"].update(processor="Another 9000", commit="feedc0de"))
        text = self.succeed("compare", self.run_dir, other)
        self.assertRegex(text, r"(?m)^processor: .* -> Another 9000$")
        self.assertRegex(text, r"(?m)^commit: .* -> feedc0de$")
        self.assertIn("; 0 times judged", text)
        self.assertNotIn("; 0 times judged", self.succeed("compare", self.run_dir, other, "--force"))

    def test_every_format_is_read_by_its_reader(self):
        rows = list(csv.DictReader(io.StringIO(self.succeed("compare", self.run_dir, self.run_dir, "--format", "csv"))))
        self.assertEqual([r["name"] for r in rows if r["kind"] == "row"], ["status"] * 8)
        self.assertTrue(all(float(r["ratio"]) == 1 for r in rows if r["kind"] == "time"))
        self.assertEqual({r["kind"] for r in rows}, {"row", "time", "together"})
        text = self.succeed("compare", self.run_dir, self.run_dir, "--format", "md", "--all")
        table = [line for line in text.splitlines() if line.startswith("|")]
        self.assertEqual({line.replace("\\|", "").count("|") for line in table}, {9})
        self.refuse("compare", self.run_dir, self.run_dir, "--format", "tex", says=["tex", "md", "csv", "json"])

    def test_bad_input_is_refused(self):
        self.refuse("compare", self.run_dir, says=["two folders"])
        self.refuse("compare", self.run_dir, self.dir / "nothing", says=["nothing", "records.jsonl"])
        self.refuse("compare", self.run_dir, self.run_dir, "--suite", "quick", says=["--suite", "--live"])
        self.refuse("compare", self.run_dir, self.run_dir, "--fdr", "2", says=["--fdr"])
        self.refuse("compare", self.run_dir, "--live", PROGRAM, says=["one folder too many"])


class Live(ProgramTest):
    def test_the_same_program_side_by_side_does_not_differ(self):
        # 8 rows, about 20 times: one false call among them is more than the rate of 5 % allows on average, two are a fault.
        twin = self.dir / "twin"
        twin.symlink_to(PROGRAM)
        out = self.dir / "out"
        found = json.loads(self.gnomon("compare", "--live", twin, *ROWS, "--processes", "5", "--format", "json", "--out", out).stdout)
        self.assertTrue(found["side_by_side"])
        counts = found["counts"]
        self.assertEqual((counts["matched"], counts["changed_metrics"], counts["missing"]), (8, 0, 0))
        self.assertGreater(counts["times_judged"], 8)
        self.assertLessEqual(counts["slower"] + counts["faster"], 1)
        base, contender = records(out / "base"), records(out / "contender")
        for ours, theirs in zip(base, contender):
            self.assertEqual(ours["job"], theirs["job"])
            self.assertEqual([len(p) for p in ours["stages"]["resolve"]], [3] * 5)
            self.assertEqual(ours["context"]["side_by_side"], theirs["context"]["side_by_side"])
            self.assertTrue((out / "base" / ours["mask"]).is_file() and (out / "contender" / theirs["mask"]).is_file())
        # The folders are runs like any other.
        again = json.loads(self.gnomon("compare", out / "base", out / "contender", "--format", "json").stdout)
        self.assertEqual(again["counts"], counts)
        self.refuse("compare", "--live", twin, *ROWS, "--out", out, says=["holds records already"])

    def test_a_slower_program_is_found_out(self):
        # The base sleeps 40 ms in relight and in resolve, this program 60 and 40: ratios of 1.5 and of 1. Who has to wait for a core
        # after a sleep is late by some milliseconds, on both sides alike: a tenth of these times at most, in the median.
        base = self.write("base", f"#!/bin/bash\nGNOMON_TEST_RELIGHT_MS=40 exec {PROGRAM} \"$@\"\n")
        base.chmod(0o755)
        call = self.command("--plugin", FAULTS, "compare", "--live", base, "--scene", "single_triangle", "--scene", "contact",
                            "--light", "point", "--technique", "sleeps;unshadowed", "--size", "64x36", "--processes", "5",
                            "--repetitions", "3", "--format", "json", "--quiet", "--out", "out")
        environment = dict(self.environment, GNOMON_TEST_RELIGHT_MS="60", GNOMON_TEST_RESOLVE_MS="40")
        done = subprocess.run(call, cwd=self.dir, env=environment, text=True, capture_output=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, 1, done.stderr)
        times = {(row["scene"], time["stage"]): time for row in json.loads(done.stdout)["rows"] if row["technique"] == "sleeps"
                 for time in row["times"]}
        for scene in ("single_triangle", "contact"):
            slower = times[scene, "relight"]
            self.assertEqual((slower["verdict"], slower["regression"]), ("slower", True), slower)
            self.assertTrue(slower["low"] / 1.1 < 1.5 < slower["high"] * 1.1, slower)
            self.assertNotEqual(times[scene, "resolve"]["verdict"], "slower", times[scene, "resolve"])

    def test_what_is_no_gnomon_is_refused(self):
        for name, text in {"talks": "echo hello", "fails": "exit 3", "answers": "printf 'hello\\n' >&$2"}.items():
            file = self.write(name, f"#!/bin/bash\n{text}\n")
            file.chmod(0o755)
            self.refuse("compare", "--live", file, *ROWS, "--out", "out", says=[str(file), "cannot work for this one"])
        self.refuse("compare", "--live", self.dir / "absent", *ROWS, says=["absent", "No such file"])
        self.refuse("compare", "--live", self.write("plain", "text"), *ROWS, says=["plain", "Permission denied"])
        old = self.write("old", "#!/bin/bash\nread line <&$2; printf '{\"protocol\": 1}\\n' >&$2; sleep 5\n")
        old.chmod(0o755)
        ours = re.search(r"worker_protocol = (\d+);", (ROOT / "harness/measure/worker/protocol.h").read_text())[1]
        self.refuse("compare", "--live", old, *ROWS, says=["protocol 1", f"this one {ours}"])
        self.assertFalse((self.dir / "out").exists())


class Adaptive(ProgramTest):
    def test_rows_get_processes_until_they_are_narrow_or_the_limit_is_reached(self):
        rows = ["--plugin", FAULTS, "--scene", "single_triangle", "--light", "point", "--technique", "sleeps;unshadowed", "--size", "96x54",
                "--processes", "2", "--repetitions", "2", "--quiet"]
        # Sleeps of 0.05 ms differ by far more than a thousandth, and of 20 ms by far less than ten times, for which two processes of five
        # would have to be late by 200 ms, twice.
        self.environment.update(GNOMON_TEST_RELIGHT_MS="0.05", GNOMON_TEST_RESOLVE_MS="0.05")
        self.succeed("run", *rows, "--out", "fixed")
        self.succeed("run", *rows, "--interval", "0.001", "--budget", "600", "--out", "limit")
        self.succeed("run", *rows, "--interval", "0.001", "--budget", "0.001", "--out", "budget")
        self.environment.update(GNOMON_TEST_RELIGHT_MS="20", GNOMON_TEST_RESOLVE_MS="20")
        self.succeed("run", *rows, "--interval", "10", "--out", "target")
        for name, stop, processes in (("fixed", "fixed", 2), ("limit", "budget", 8), ("target", "target", 5)):
            row = records(self.dir / name)[0]
            self.assertEqual((row["technique"], row["stop"], len(row["stages"]["resolve"])), ("sleeps", stop, processes))
            self.assertEqual(set(row["iterations"]), {"setup", "build", "relight", "resolve"})
            self.assertEqual({len(p) for p in row["stages"].values()}, {processes})
        self.refuse("run", *rows, "--budget", "10", says=["--budget = 10", "--interval"])
        row = records(self.dir / "budget")[0]
        self.assertEqual(row["stop"], "budget")
        self.assertLessEqual(len(row["stages"]["resolve"]), 3)


# A technique whose clock and count are what it says: each process of its own mood, 5 %, each call 1 %.
WORKS = """
import os, random, time
from gnomon_technique import Technique, serve
class Works(Technique):
    def setup(self):
        self.mood = random.SystemRandom().gauss(0, 0.05)
    def resolve(self, gbuffer, mask):
        mask[...] = 1
        time.sleep(0.001)  # the clock that is told may not say more than the harness's
        units = 2 ** (self.settings.size / 5)
        self.ms = 0.05 * units * float(os.environ.get("PLANTED_TIME", 1)) * 2.718 ** (self.mood + random.gauss(0, 0.01))
        self.counts = {"steps": 1000 * 2 ** self.settings.size * float(os.environ.get("PLANTED_WORK", 1))}
serve(Works)
"""
WORKS_SHEET = """
title = "Works"
summary = "Says what it took."
source = "Nowhere"
error = "All of it."
fails = "Always."
command = ["/usr/bin/python3", "-IB", "works.py"]
[[parameter]]
name = "size"
value = 0
min = 0
max = 20
stage = "resolve"
sentence = "Work, as a power of two."
"""


class Planted(ProgramTest):
    def test_a_planted_slowdown_is_found_side_by_side_and_more_work_always(self):
        (self.dir / "works.py").write_text(f"import sys\nsys.path.insert(0, {str(ROOT / 'harness/python')!r})\n{WORKS}")
        sheet = self.write("works.toml", WORKS_SHEET)
        before = self.write("before", f'#!/bin/sh\nunset PLANTED_TIME PLANTED_WORK\nexec {PROGRAM} "$@"\n')
        (self.dir / "before").chmod(0o755)
        sizes = range(5)

        def compared(time, work):
            self.environment.update(PLANTED_TIME=str(time), PLANTED_WORK=str(work))
            done = self.gnomon("--program", sheet, "compare", "--live", self.dir / before, "--scene", "single_triangle", "--light", "point", "--size",
                               "32x18", "--technique", f"works:size={{{','.join(map(str, sizes))}}}", "--processes", "5", "--repetitions", "3", "--pictures",
                               "none", "--out", self.dir / f"by_{time}_{work}", "--format", "json", "--quiet")
            self.assertIn(done.returncode, (0, 1), done.stderr)
            rows = json.loads(done.stdout)["rows"]
            self.assertEqual(len(rows), len(sizes))
            slower = sum(time["stage"] == "resolve" and time["verdict"] == "slower" for row in rows for time in row["times"])
            return slower, [[(one["count"], one["contender"] / one["base"]) for one in row["counts"]] for row in rows]

        slower, counts = compared(1.3, 1.05)
        self.assertGreaterEqual(slower, 0.8 * len(sizes))
        self.assertEqual([[(name, round(ratio, 9)) for name, ratio in row] for row in counts], [[("steps", 1.05)]] * len(sizes))
        slower, counts = compared(1, 1)
        self.assertLessEqual(slower, 1)
        self.assertEqual(counts, [[]] * len(sizes))


if __name__ == "__main__":
    unittest.main()
