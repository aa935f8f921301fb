#!/usr/bin/python3 -IB
"""--resume: one run at a time in a folder, and only rows that may be in one table."""

import json
import re
import signal
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, HARD, NUMBERS, PATIENCE, ProgramTest, records, wait_until  # noqa: E402

ROWS = [*HARD, "--scene", "single_triangle", "--technique", "unshadowed", "--technique", "shadow_map"]
SUITE = """
width = 160
height = 90
processes = 1
repetitions = 1
[[group]]
scenes = {}
lights = ["point"]
techniques = ["unshadowed", "embree_rays"]
"""


class Resume(ProgramTest):
    def change(self, edit):
        """Every record of the folder `out`, changed."""
        file = self.dir / "out/records.jsonl"
        rows = records(file.parent)
        for row in rows:
            edit(row)
        file.write_text("".join(json.dumps(row) + "\n" for row in rows))

    def lines(self):
        return (self.dir / "out/records.jsonl").read_bytes().splitlines()

    def test_a_folder_that_is_being_written_is_left_alone(self):
        slow = ["--plugin", FAULTS, "run", "--scene", "single_triangle", "--scene", "contact", "--technique", "sleeps", *HARD, *NUMBERS,
                "--quiet", "--out", "out"]
        self.succeed(*slow)
        self.change(lambda row: row.update(status="failed"))
        self.environment["GNOMON_TEST_RESOLVE_MS"] = "300"
        first = self.start(*slow, "--resume", "--retry-failed", "--timeout", PATIENCE)

        def is_at_work():
            self.assertIsNone(first.poll())
            return (self.dir / "out/.scratch").exists() and not self.lines()  # its failed rows are gone, none is done again

        wait_until(is_at_work, "the first run to be at work")
        first.send_signal(signal.SIGSTOP)  # so that it is at work for as long as the others take
        for more in ([], ["--retry-failed"]):
            self.refuse(*slow, "--resume", *more, says=["records.jsonl is being written by another run"])
        self.assertTrue((self.dir / "out/.scratch").is_dir())
        first.send_signal(signal.SIGCONT)
        _, complaint = first.communicate(timeout=PATIENCE)
        self.assertEqual(first.returncode, 0, complaint)
        rows = records(self.dir / "out")
        self.assertEqual((len(rows), {row["status"] for row in rows}), (4, {"ok"}))
        self.assertEqual([name for name in self.names(self.dir / "out") if ".part" in name], [])

    def test_rows_that_are_not_like_the_new_ones_are_refused(self):
        run = ["run", *ROWS, *NUMBERS, "--out", "out", "--resume"]
        self.succeed(*run)
        before = self.lines()
        other = ["run", *ROWS, "--size", "160x90", "--out", "out", "--resume"]
        self.refuse(*other, "--repetitions", "1", "--processes", "2",
                    says=["single_triangle point unshadowed was run with 1 process, not 2", "another --out"])
        self.refuse(*other, "--processes", "1", "--repetitions", "3", says=["was run with 1 repetition, not 3"])
        self.refuse(*run, "--truth", "mesh", says=["its rows have the truth shape, not mesh"])
        self.assertEqual(self.lines(), before)

    def test_rows_that_other_code_measured_are_refused_or_run_again(self):
        run = ["run", *ROWS, *NUMBERS, "--out", "out", "--resume"]
        self.succeed(*run)
        now = records(self.dir / "out")[0]["context"]
        self.change(lambda row: row["context"].update(commit="feedc0de"))
        self.assertIn("4 were done before", self.succeed(*run))  # another commit of the same code

        def refused(*says):
            before = self.lines()
            self.refuse(*run, says=[*says, "--rebuilt, or name another --out"])
            self.refuse(*run, "--dry-run", says=says)
            self.refuse(*run, "--rebuilt", "--filter", " shadow_map", says=[*says, "single_triangle point unshadowed is not run again"])
            self.assertEqual(self.lines(), before)

        self.change(lambda row: row["context"].update(build="0" * 16))
        refused("out holds rows of commit feedc0de, and this program is ")
        self.change(lambda row: row["context"].pop("build"))  # as earlier programs wrote it
        refused("out holds rows of commit feedc0de, and this program is ")
        self.change(lambda row: row["context"].update(commit=now["commit"], build="0" * 16))
        refused(f"out holds rows of build {'0' * 16}, and this program is {now['build']}")
        self.assertIn("4 rows: 4 ok", self.succeed(*run, "--rebuilt"))
        self.assertEqual({row["context"]["build"] for row in records(self.dir / "out")}, {now["build"]})

        self.change(lambda row: row["technique"] == "unshadowed" and row["context"].update(technique_source="0" * 16))
        refused("out holds rows of unshadowed as its source was")
        self.assertIn("2 rows: 2 ok, 0 unsupported, 0 failed; 2 were done before", self.succeed(*run, "--rebuilt"))
        self.assertEqual(len({row["context"]["technique_source"] for row in records(self.dir / "out")}), 2)
        self.refuse(*run[:-1], "--rebuilt", says=["--rebuilt"])  # without --resume

        # Pictures of rows that are run again are not those of another program.
        with_masks = ["masks" if word == "none" else word for word in run]
        for words, count in ((with_masks, 4), (run, 0)):
            self.change(lambda row: row["context"].update(build="0" * 16))
            self.succeed(*words, "--rebuilt")
            self.assertEqual(len([*self.dir.glob("out/masks/*")]), count)

    def test_a_folder_says_how_it_was_run(self):
        scene = self.write("card.toml", 'scene = "contact"\n')
        suite = self.write("mine.toml", SUITE.format('["single_triangle", "card.toml"]'))
        self.succeed("run", suite, "--out", "out", "--quiet")
        said = json.loads((self.dir / "out/run.json").read_text())
        self.assertEqual(said["schema"], "gnomon-run-1")
        [run] = said["runs"]
        self.assertEqual(run["command"], ["gnomon", "run", str(suite), "--out", "out", "--quiet"])
        self.assertEqual(run["suite"], {"name": "mine", "text": Path(self.dir, suite).read_text()})
        self.assertEqual([one["scene"] for one in run["scenes"]], ["single_triangle", "card.toml"])
        self.assertEqual([one["text"] for one in run["scenes"]], [None, Path(self.dir, scene).read_text()])
        self.assertIn("point", [light["name"] for light in run["scenes"][0]["lights"]])
        context = records(self.dir / "out")[0]["context"]
        self.assertEqual({key: run["context"][key] for key in ("commit", "build", "flags")}, {key: context[key] for key in ("commit", "build", "flags")})
        self.assertEqual(run["changes"] != "", context["commit"].endswith("-dirty"))
        self.succeed("run", suite, "--out", "out", "--quiet", "--resume")
        self.succeed("run", "--scene", "fence", "--technique", "unshadowed", *HARD, *NUMBERS, "--out", "more", "--quiet")
        self.succeed("merge", "out", "more", "--out", "both")
        runs = json.loads((self.dir / "both/run.json").read_text())["runs"]
        self.assertEqual([run["suite"]["name"] for run in runs], ["mine", "mine", "adhoc"])
        self.assertIsNone(runs[-1]["suite"]["text"])
        self.assertEqual(runs[1]["command"][-1], "--resume")
        for broken in ("{", '{"schema": "gnomon-run-2", "runs": []}', "[]"):
            self.write("out/run.json", broken)
            before = self.lines()
            self.refuse("run", suite, "--out", "out", "--resume", "--quiet", says=["out/run.json does not say how the folder was run"])
            self.assertEqual((self.lines(), (self.dir / "out/run.json").read_text()), (before, broken))


    def test_another_machine_is_said(self):
        run = ["run", *ROWS, *NUMBERS, "--out", "out", "--resume"]
        self.succeed(*run)
        self.assertNotIn("note:", self.gnomon(*run).stderr)
        self.change(lambda row: row["context"].update(processor="Another 9000", threads=99))
        done = self.gnomon(*run)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("rows that are done had another processor: Another 9000, now ", done.stderr)
        self.assertIn("rows that are done had another number of threads: 99, now ", done.stderr)

    def test_rows_that_are_kept_get_their_places_in_the_suite_of_today(self):
        run = ["run", self.write("mine.toml", SUITE.format('["contact"]')), "--out", "out", "--resume"]
        self.succeed(*run)
        self.write("mine.toml", SUITE.format('["single_triangle", "contact"]'))
        text = self.succeed(*run, "--filter", "unshadowed")  # also of rows that are not requested now
        self.assertIn("1 was done before", text)
        rows = {(row["scene"], row["technique"]): row["place"] for row in records(self.dir / "out")}
        self.assertEqual(rows, {("single_triangle", "unshadowed"): 0, ("contact", "unshadowed"): 2, ("contact", "embree_rays"): 3})
        self.succeed(*run)
        table = json.loads(self.succeed("table", "out", "--format", "json"))
        self.assertEqual([row["scene"] for row in table["rows"]], ["single_triangle"] * 2 + ["contact"] * 2)

    def test_a_folder_of_other_rows_is_refused(self):
        self.succeed("run", *ROWS, *NUMBERS, "--out", "out")
        before = self.lines()
        new = ["--out", "out", "--resume", "--processes", "1", "--repetitions", "1"]
        none = ["out cannot go on: none of its 4 rows is in suite adhoc as it is now", "another --out"]
        self.refuse("run", "--scene", "contact", "--technique", "unshadowed", "--size", "160x90", *new, says=none)
        self.refuse("run", *ROWS, "--size", "64x36", *new, says=none)
        self.refuse("run", *ROWS, "--size", "64x36", *new, "--dry-run", says=none)
        mine = self.write("mine.toml", SUITE.format('["single_triangle"]'))  # has one of the rows
        self.refuse("run", mine, "--out", "out", "--resume", says=["it holds rows of suite adhoc, not mine", "another --out"])
        self.assertEqual(self.lines(), before)

    def test_a_suite_that_has_grown_goes_on_and_rows_that_it_lost_are_said(self):
        run = ["run", *NUMBERS, "--out", "out", "--resume", "--scene", "single_triangle", "--light", "sun"]
        self.succeed(*run, "--technique", "unshadowed;shadow_map:resolution=256")
        grown = self.gnomon(*run, "--technique", "unshadowed;shadow_map:resolution={256,512}")
        self.assertEqual((grown.returncode, grown.stderr.count("note:")), (0, 0), grown.stderr)
        self.assertIn("2 were done before", grown.stdout)
        other = self.gnomon(*run, "--technique", "shadow_map:resolution={512,128}")
        self.assertEqual(other.returncode, 0, other.stderr)
        self.assertIn("note: 2 of the rows in out are not in suite adhoc as it is now; they stay in its tables\n", other.stderr)
        self.assertEqual(len(self.lines()), 4)

    def test_a_dry_run_prints_what_is_left(self):
        run = ["run", *ROWS, *NUMBERS, "--out", "out"]
        self.succeed(*run, "--filter", "sun")
        text = self.succeed(*run, "--resume", "--dry-run")
        self.assertEqual(re.findall(r"(?m)^[0-9a-f]{16}  single_triangle (\w+) ", text), ["point", "point"])
        self.assertIn("\n2 are done\n2 rows, 1 process x 1 repetition each, 160x90 pixels\n", text)
        self.change(lambda row: row.update(status="failed"))
        self.assertIn("\n4 rows, ", self.succeed(*run, "--resume", "--retry-failed", "--dry-run"))
        self.assertEqual(len(self.lines()), 2)
        self.succeed(*run, "--resume", "--retry-failed")
        self.assertRegex(self.succeed(*run, "--resume", "--dry-run"), r"^4 are done\n0 rows, ")

if __name__ == "__main__":
    unittest.main()
