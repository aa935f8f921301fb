#!/usr/bin/python3 -IB
"""Editions: suites that stay as they are. What is frozen, what is refused, what a run says of it, and what `scripts/edition` finds."""

import json
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, PROGRAM, ROOT, ProgramTest, records, scene_toml  # noqa: E402

TINY = """title = "Tiny"
width = 32
height = 18
truth = "shape"
truth_over = "center"
processes = 1
repetitions = 1
warmups = 1
timeout = 60
reference_error = 0.002
reference_rays = 8192

[[group]]
scenes = ["plate", "fence"]
lights = ["sun"]
views = ["view"]
techniques = ["unshadowed", "embree_rays"]

[[group]]
scenes = ["fence"]
lights = ["sun"]
views = ["view"]
techniques = ["shadow_map"]

[edition]
training = ["contact"]
"""
SUN = '[[light]]\nname = "sun"\nkind = "directional"\ndirection = [0.3, -1, 0.2]\n'
VIEW = '[[view]]\nname = "view"\neye = [0, 4, 6]\ntarget = [0, 0, 0]\n'
QUICK = ["--pictures", "none", "--quiet"]


class Editions(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.root = cls.home / "root"
        for folder in ("bench/suites", "bench/editions", "scenes", "techniques"):
            (cls.root / folder).mkdir(parents=True)
        (cls.root / "bench/suites/other.toml").write_text('[[group]]\nscenes = ["fence"]\nlights = ["sun"]\ntechniques = ["unshadowed"]\n')
        (cls.root / "reproduce").symlink_to(ROOT / "harness/app/pack/reproduce")  # as an installed program has it
        cls.file = cls.root / "bench/editions/tiny.toml"
        cls.errata = cls.file.with_name("tiny.errata.toml")
        cls.plate = cls.root / "scenes/plate.toml"
        cls.plate.write_text("# A plate.\nname = \"plate\"\n" + scene_toml(SUN, VIEW))
        cls.environment["GNOMON_ROOT"] = str(cls.root)
        cls.file.write_text(TINY)
        subprocess.run([PROGRAM, "edition", "tiny", "--freeze"], env=cls.environment, check=True, capture_output=True)
        cls.frozen = cls.file.read_text()

    def setUp(self):
        super().setUp()
        self.file.write_text(self.frozen)
        self.errata.unlink(missing_ok=True)

    def run_tiny(self, out, *words, status=0):
        self.succeed("run", "--edition", "tiny", *words, *QUICK, "--out", out, status=status)
        return self.dir / out

    def test_an_edition_says_what_it_is(self):
        facts = json.loads(self.succeed("edition", "tiny", "--json"))
        self.assertEqual(facts["differences"], [])
        self.assertEqual(facts["rows"], 5)
        self.assertEqual(facts["techniques"], ["unshadowed", "embree_rays", "shadow_map"])
        self.assertEqual([place["rows"] for place in facts["places"]], [2, 3])
        self.assertRegex(facts["hash"], "^[0-9a-f]{16}$")
        text = self.succeed("edition", "tiny")
        self.assertIn(f"to cite     Gnomon edition tiny, hash {facts['hash']}", text)
        self.assertIn("gives this edition", text)
        self.assertIn(facts["hash"], self.succeed("edition"))
        self.succeed("edition", "tiny", "--freeze")
        self.assertEqual(self.file.read_text(), self.frozen)
        self.refuse("edition", "tidy", says=["there is no edition tidy", "did you mean tiny?"])
        self.refuse("edition", "--freeze", says=["--freeze needs the name"])
        self.errata.write_text('[[erratum]]\ntechnique = "svbsp"\nversion = "0.1.0"\nreason = "R."\n')
        self.refuse("edition", "tiny", says=["erratum.technique = svbsp is not a technique of the edition"])

    def test_what_was_edited_is_refused_and_not_frozen_over(self):
        self.file.write_text(self.frozen.replace("width = 32", "width = 33"))
        self.refuse("run", "--edition", "tiny", *QUICK, "--out", "out", says=["edition tiny is not as it was frozen"])
        self.refuse("edition", "tiny", "--freeze", says=["frozen and would become another one"])
        self.file.write_text(self.frozen.replace("width = 32", "wide = 32"))
        self.refuse("run", "--edition", "tiny", *QUICK, "--out", "out", says=["suite has no key 'wide'"])
        other = self.file.with_name("whole.toml")
        other.write_text(TINY)
        try:
            self.succeed("edition", "whole", "--freeze")
            listed = {edition["name"]: edition for edition in json.loads(self.succeed("edition", "--json", status=2))}
            self.assertIn("suite has no key 'wide'", listed["tiny"]["reason"])
            self.assertRegex(listed["whole"]["hash"], "^[0-9a-f]{16}$")
        finally:
            other.unlink()
        self.file.write_text(TINY)
        self.refuse("run", "--edition", "tiny", *QUICK, "--out", "out", says=["is not frozen"])
        self.assertFalse((self.dir / "out").exists())

    def test_a_scene_that_has_changed_is_refused_before_anything_runs(self):
        before = self.plate.read_text()
        try:
            self.plate.write_text(before.replace("size = [8, 8]", "size = [8, 9]"))
            for words in (["--out", "out"], ["--dry-run"]):
                done = self.gnomon("run", "--edition", "tiny", *QUICK, *words)
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                self.assertRegex(done.stderr, r"(?m)^edition tiny: scene plate sun has hash [0-9a-f]{32}, and the edition [0-9a-f]{32}$")
                self.assertRegex(done.stderr, r"(?m)^gnomon: this program does not give edition tiny \([0-9a-f]{16}\): 1 difference; nothing was run$")
            self.assertIn("does not give this edition", self.succeed("edition", "tiny", status=1))
        finally:
            self.plate.write_text(before)
        self.assertFalse((self.dir / "out").exists())

    def test_what_changes_rows_is_refused(self):
        for option, *values in (["--scene", "contact"], ["--light", "point"], ["--view", "low"], ["--path", "camera_slide"], ["--animation", "walk"],
                                ["--time", "0"], ["--frames", "3"], ["--frame-rate", "30"], ["--start", "1"], ["--size", "16x9"],
                                ["--truth", "mesh"], ["--truth-over", "both"], ["--global-samples", "16"], ["--processes", "2"],
                                ["--repetitions", "2"], ["--warmups", "2"], ["--interval", "0.1"], ["--budget", "5"]):
            self.refuse("run", "--edition", "tiny", option, *values, "--out", "out", says=[f"{option} changes rows of edition tiny"])
        self.refuse("run", "other", "--edition", "tiny", "--out", "out", says=["run takes it or suite other, not both"])
        self.refuse("run", "--edition", "tiny", "--division", "best", "--out", "out", says=["best"])
        self.assertEqual(self.gnomon("run", "other", "--division", "open", "--out", "out").returncode, 2)
        self.refuse("run", "--edition", "tiny", "--technique", "shadow_map:resolution=512", "--out", "out",
                    says=["shadow_map:resolution=512 has settings", "--division tuned"])
        self.assertFalse((self.dir / "out").exists())

    def test_a_run_says_of_which_edition_and_division_it_is(self):
        folder = self.run_tiny("out")
        edition = {"name": "tiny", "hash": json.loads(self.succeed("edition", "tiny", "--json"))["hash"], "division": "default"}
        run = json.loads((folder / "run.json").read_text())["runs"][0]
        self.assertEqual(run["edition"], edition)
        self.assertEqual(run["suite"], {"name": "edition_tiny", "text": self.frozen})
        self.assertEqual([row["status"] for row in records(folder)], ["ok"] * 5)
        self.assertEqual({row["suite"] for row in records(folder)}, {"edition_tiny"})
        # Its file is a suite: the same rows, and any option, but of no edition.
        self.succeed("run", self.file, "--processes", "2", *QUICK, "--out", "plain")
        self.assertNotIn("edition", json.loads((self.dir / "plain/run.json").read_text())["runs"][0])
        self.assertEqual([row["job"] for row in records(self.dir / "plain")], [row["job"] for row in records(folder)])

    def test_rows_of_divisions_and_editions_stay_apart(self):
        part = ["--filter", "plate"]
        one = self.run_tiny("one", *part)
        self.run_tiny("one", "--resume")
        self.assertEqual(len(records(one)), 5)
        tuned = ["--technique", "shadow_map:resolution=512", "--division", "tuned"]
        self.refuse("run", "--edition", "tiny", *tuned, "--resume", *QUICK, "--out", "one",
                    says=["one holds rows of edition tiny", "division default", "division tuned"])
        self.refuse("run", "other", "--resume", *QUICK, "--out", "one", says=["one holds rows of edition tiny", "this run is of no edition"])
        two = self.run_tiny("two", *tuned)
        self.assertEqual({row["settings"] for row in records(two)}, {"resolution=512"})
        self.assertEqual(sorted({row["scene"] for row in records(two)}), ["fence", "plate"])
        self.refuse("merge", "one", "two", "--out", "both", says=["one holds rows of edition tiny", "division tuned", "are not merged"])
        three = self.run_tiny("three", "--technique", "moment_map")
        self.succeed("merge", "one", three, "--out", "both")
        self.assertEqual({entry["edition"]["division"] for entry in json.loads((self.dir / "both/run.json").read_text())["runs"]}, {"default"})

    def test_a_technique_that_supports_nothing_has_no_rows(self):
        said = self.succeed("run", "--edition", "tiny", "--technique", "exact_area", *QUICK, "--out", "out")
        self.assertIn("no rows: they support nothing of any group: exact_area: ", said)

    def test_a_packed_run_is_made_again(self):
        self.run_tiny("out", "--filter", "fence")
        done = self.gnomon("pack", "out", "--out", "packed.tar.gz", "--repository", self.dir)
        self.assertTrue((self.dir / "packed.tar.gz").is_file(), done.stderr)
        subprocess.run(["tar", "-xf", "packed.tar.gz"], cwd=self.dir, check=True)
        done = subprocess.run([self.dir / "packed/reproduce", "--gnomon", PROGRAM, "--processes", "1"], env=self.environment, text=True,
                              capture_output=True, timeout=PATIENCE, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("3 rows: 3 the same to the last digit", done.stdout)

    def check(self, *words, status):
        done = subprocess.run([ROOT / "scripts/edition", "tiny", "--program", PROGRAM, "--kept", self.dir / "kept", *words], env=self.environment,
                              text=True, capture_output=True, timeout=PATIENCE, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_kept_rows_that_the_program_does_not_give_are_found(self):
        self.assertIn("has no records.jsonl", self.check(status=2))
        kept = self.run_tiny("kept")

        def change(edit):
            rows = records(kept)
            for row in rows:
                row["context"]["commit"] = "0123456789"
                edit(row)
            (kept / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))

        change(lambda row: None)
        self.assertRegex(self.check(status=0), r"^edition tiny \([0-9a-f]{16}\): 0 differences; 5 rows measured again\n$")
        self.assertRegex(self.check("--rows", "2", status=0), r"0 differences; 2 rows measured again\n$")

        def edit(row):
            if row["technique"] != "embree_rays":
                row["metrics"]["shape"]["error"] += 1e-15
            if row["technique"] == "shadow_map":
                row["context"]["gl_renderer"] = "another"
        change(edit)
        said = self.check(status=1)
        self.assertEqual(said.count("metrics.shape.error"), 2, said)  # both rows of unshadowed
        self.assertRegex(said, r"2 differences; 1 row drawn by another OpenGL then, another and not .*, 4 rows measured again\n$")
        self.errata.write_text('[[erratum]]\ntechnique = "unshadowed"\nversion = "0.0.1"\nreason = "R."\nrows = "^fence"\n'
                               '[[erratum]]\ntechnique = "unshadowed"\nversion = "999.0.0"\nreason = "Not yet."\n')
        said = self.check(status=1)
        self.assertRegex(said, r"(?m)^plate sun unshadowed: metrics.shape.error ")
        self.assertRegex(said, r"1 difference; 1 row drawn by another .*, 1 row left out for an erratum, 3 rows measured again\n$")
        self.succeed("site", "kept", "--out", "site", "--no-docs")
        page = "".join(path.read_text(encoding="utf-8") for path in (self.dir / "site/suites").glob("*.html"))
        self.assertIn("<li><code>unshadowed</code> (<code>^fence</code>), from version 0.0.1: R.</li>", page)

        rows = records(kept)
        (kept / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows[1:]))
        run = json.loads((kept / "run.json").read_text())
        run["runs"][0]["edition"]["division"] = "open"
        (kept / "run.json").write_text(json.dumps(run))
        said = self.check(status=1)
        self.assertIn("1 row that the suite has and the results lack: plate sun unshadowed", said)
        self.assertRegex(said, r'kept rows are of \{.*"division": "open"\}, not of ')


class Shipped(ProgramTest):
    def test_every_edition_of_the_tree_is_frozen_and_its_errata_are_read(self):
        names = sorted(path.name.removesuffix(".toml") for path in (ROOT / "bench/editions").glob("*.toml") if not path.name.endswith(".errata.toml"))
        self.assertIn("2027", names)
        self.environment["GNOMON_ROOT"] = str(ROOT)
        self.assertEqual([edition["name"] for edition in json.loads(self.succeed("edition", "--json"))], names)
        for name in names:
            done = self.gnomon("edition", name, "--json")
            differences = json.loads(done.stdout)["differences"]
            self.assertEqual([line for line in differences if "is not fetched" not in line], [], done.stderr)


if __name__ == "__main__":
    unittest.main()
