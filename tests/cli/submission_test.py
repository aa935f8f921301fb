#!/usr/bin/python3 -IB
"""`gnomon submission`: a run of a small edition becomes a folder, which is accepted; each fault in it is found, in words, and what is hostile is
refused before it is read."""

import ctypes
import json
import os
import shutil
import struct
import subprocess
import sys
import unittest
from pathlib import Path

try:
    import jsonschema
except ImportError:
    jsonschema = None

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PROGRAM, ROOT, ProgramTest, records  # noqa: E402

EDITION = """title = "Small"
width = 96
height = 54
truth = "shape"
truth_over = "center"
processes = 1
repetitions = 2
warmups = 1
timeout = 60
reference_error = 0.01
reference_rays = 256

[[group]]
scenes = ["fence", "contact"]
lights = ["point", "sun"]
views = ["view"]
techniques = ["unshadowed", "embree_rays", "shadow_map"]

[edition]
training = ["sphere_field"]
"""
TUNED = "gnomon tune on sphere_field"


class Hash128(ctypes.Structure):
    _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]


def xxh128(data):
    """XXH3's 128 bits, by the library that the program uses."""
    library = ctypes.CDLL("libxxhash.so.0")
    library.XXH3_128bits.restype = Hash128
    library.XXH3_128bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
    value = library.XXH3_128bits(data, len(data))
    return f"{value.high:016x}{value.low:016x}"


def rewrite(file, change):
    """A file of JSON after `change`."""
    value = json.loads(file.read_text())
    change(value)
    file.write_text(json.dumps(value))


class Submissions(ProgramTest):
    @classmethod
    def setUpClass(cls):
        """An edition in a root of its own, its run by a program that says to be a clean commit, and the submission of that."""
        super().setUpClass()
        root = cls.home / "root"
        (root / "bench/editions").mkdir(parents=True)
        for name in ("scenes", "bench/suites", "techniques", "tests"):
            (root / name).symlink_to(ROOT / name)
        (root / "bench/editions/small.toml").write_text(EDITION)
        cls.environment = dict(cls.environment, GNOMON_ROOT=str(root))
        cls.environment.pop("GNOMON_SHADERS", None)  # rows of kept shaders are none of a submission
        cls.call("edition", "small", "--freeze")
        cls.run_folder = cls.home / "run"
        cls.call("run", "--edition", "small", "--pictures", "masks", "--quiet", "--out", cls.run_folder)
        cls.as_of_a_clean_commit(cls.run_folder)
        cls.made = cls.home / "made"
        cls.said = cls.call("submission", "make", cls.run_folder, "--out", cls.made, "--name", "abacus", "--notes", "A test.")

    @classmethod
    def call(cls, *words, status=0):
        done = subprocess.run([PROGRAM, *map(str, words)], cwd=cls.home, env=cls.environment, text=True, capture_output=True)
        if done.returncode != status:
            raise AssertionError(f"{words}: exit {done.returncode}\n{done.stdout}\n{done.stderr}")
        return done.stdout + done.stderr

    @staticmethod
    def as_of_a_clean_commit(run):
        """Tests run by programs of any tree."""
        rows = records(run)
        for row in rows:
            row["context"]["commit"] = "0123456789"
        (run / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))

        def clean(value):
            for entry in value["runs"]:
                entry["context"]["commit"], entry["changes"] = "0123456789", ""
        rewrite(run / "run.json", clean)

    def copy(self, name="copy"):
        shutil.copytree(self.made, self.dir / name)
        return self.dir / name

    def check(self, *folders, status, rows=3):
        done = self.gnomon("submission", "check", *folders, "--rows", rows, "--quiet")
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def sealed(self, folder):
        """The folder with the sizes and hashes of its files as they are now: as someone who wants it accepted would leave it."""
        facts = json.loads((folder / "submission.json").read_text())
        names = sorted(str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file())
        hashes = {}
        for name in names:
            if name != "submission.json":
                hashes[name] = {"bytes": (folder / name).stat().st_size, "hash": xxh128((folder / name).read_bytes())}
        facts["files"] = hashes
        (folder / "submission.json").write_text(json.dumps(facts))
        return folder

    def edit_rows(self, folder, change):
        rows = records(folder)
        rows = change(rows) or rows
        (folder / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        (folder / "table.md").unlink()  # made of the records
        facts = json.loads((folder / "submission.json").read_text())
        facts["program"] = "another"
        (folder / "submission.json").write_text(json.dumps(facts))
        return self.sealed(folder)

    def refused(self, folder, says):
        said = self.check(folder, status=1)
        self.assertIn(says, said)
        self.assertRegex(said, r"(?m)^\S+: not accepted: \d+ reasons?")
        return said

    # --- what is right ---

    def test_a_submission_is_accepted_and_says_what_was_looked_at(self):
        self.assertIn("edition small, division default, 12 rows", self.said)
        self.assertRegex(self.said, r"(?m)^check it: gnomon submission check \S+$")
        self.assertEqual(self.names(self.made), sorted(["README.md", "records.jsonl", "run.json", "submission.json", "table.md",
                                                        *(row["mask"] for row in records(self.made))]))
        said = self.check(self.made, status=0)
        self.assertRegex(said, r"accepted: 12 rows scored from their masks; run again: 3 the same to the last digit, 0 within .*, 0 not repeated")
        facts = json.loads((self.made / "submission.json").read_text())
        self.assertEqual([code["id"] for code in facts["techniques"]], ["embree_rays", "shadow_map", "unshadowed"])
        self.assertEqual(facts["techniques"][0]["source"], "gnomon 0123456789")
        self.assertGreater(facts["system"]["memory_bytes"], 2**20)
        self.assertNotIn(str(self.home), (self.made / "run.json").read_text() + (self.made / "records.jsonl").read_text())
        self.assertIn("embree_rays", (self.made / "README.md").read_text())

    @unittest.skipIf(jsonschema is None, "there is no python3-jsonschema")
    def test_what_is_stated_keeps_its_schema(self):
        schema = json.loads((ROOT / "docs/schema/submission.schema.json").read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        check = jsonschema.Draft202012Validator(schema)
        facts = json.loads((self.made / "submission.json").read_text())
        check.validate(facts)
        self.assertEqual(set(facts), set(schema["properties"]))
        self.assertEqual(set(facts["system"]), set(schema["properties"]["system"]["properties"]))

    def test_another_seed_draws_other_rows_and_none_may_be_drawn(self):
        self.assertIn("run again: 0 the same", self.check(self.made, status=0, rows=0))
        self.assertIn("run again: 12 the same", self.check(self.made, status=0, rows=100))

    def test_two_of_one_name_are_told(self):
        copy = self.copy()
        self.assertIn("are both by abacus, and hold the same records", self.check(self.made, copy, status=0, rows=0))
        rewrite(copy / "submission.json", lambda facts: facts["system"].update(memory_bytes=12345))
        self.assertIn("are both by abacus, and of different machines", self.check(self.made, copy, status=0, rows=0))

    # --- eight faults ---

    def test_a_changed_mask(self):
        copy = self.copy()
        masks = {row["technique"]: row["mask"] for row in records(copy) if row["scene"] == "fence" and row["light"] == "sun"}
        shutil.copy(copy / masks["shadow_map"], copy / masks["embree_rays"])
        self.refused(copy, f"{masks['embree_rays']} is not the file that submission.json names: it was changed")
        said = self.refused(self.sealed(copy), "its numbers are not those of its mask: ")
        self.assertIn("fence sun embree_rays", said)

    def test_a_changed_record(self):
        def better(rows):
            row = next(row for row in rows if row["technique"] == "shadow_map")
            row["metrics"]["shape"]["error"] = 0.25
        copy = self.copy()
        (copy / "records.jsonl").write_text((copy / "records.jsonl").read_text().replace('"reason"', '"reason" '))
        self.refused(copy, "records.jsonl is not the file that submission.json names")
        self.refused(self.edit_rows(self.copy("better"), better), "its numbers are not those of its mask: metrics.shape.error")

    def test_a_changed_count_is_found_when_the_row_is_run_again(self):
        def lighter(rows):
            for row in rows:
                row["bytes"] += 1
        self.refused(self.edit_rows(self.copy(), lighter), "has other numbers: bytes ")

    def test_a_changed_time(self):
        def faster(rows):
            rows[0]["stages"]["resolve"] = [[1000 * ms for ms in process] for process in rows[0]["stages"]["resolve"]]
            rows[0]["seconds"] = 1e-6
        self.refused(self.edit_rows(self.copy(), faster), "its repetitions of relight and resolve take longer together than the row")
        copy = self.copy("table")
        table = copy / "table.md"
        table.write_text(table.read_text().replace("| embree", "| embree*", 1))
        self.refused(self.sealed(copy), "table.md is not the table of the records")

    def test_another_scene(self):
        def other(rows):
            rows[0]["context"]["scene_hash"] = "0" * 32
        self.refused(self.edit_rows(self.copy(), other), "its scene is not that of the edition: it has another hash")

    def test_dropped_rows(self):
        def fewer(rows):
            return [row for row in rows if (row["scene"], row["light"], row["technique"]) != ("fence", "sun", "shadow_map")]
        copy = self.copy()
        gone = next(row["mask"] for row in records(copy) if row not in fewer(records(copy)))
        (copy / gone).unlink()
        self.refused(self.edit_rows(copy, fewer), "1 row of the edition is missing: fence sun shadow_map")

    def test_tuned_settings_in_division_default(self):
        run = self.dir / "run"
        self.succeed("run", "--edition", "small", "--division", "tuned", "--technique", "shadow_map:resolution=512", "--pictures", "masks", "--quiet",
                     "--out", run)
        self.as_of_a_clean_commit(run)
        done = self.gnomon("submission", "make", run, "--out", "tuned", "--name", "abacus")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("division tuned says how settings were found", done.stderr)
        self.assertFalse((self.dir / "tuned").exists())
        said = self.gnomon("submission", "make", run, "--out", "tuned", "--name", "abacus", "--tuning", TUNED + " and fence")
        self.assertIn("tuning names fence, which is a scene and none to find settings on", said.stderr)
        self.succeed("submission", "make", run, "--out", "tuned", "--name", "abacus", "--tuning", TUNED)
        self.check("tuned", status=0)

        def pretend(value):
            for entry in value["runs"]:
                entry["edition"]["division"] = "default"
        rewrite(self.dir / "tuned/run.json", pretend)
        rewrite(self.dir / "tuned/submission.json", lambda facts: facts.update(division="default", tuning=None))
        self.refused(self.sealed(self.dir / "tuned"), "division default has the settings as they are shipped, and shadow_map:resolution=512 is set")

    def test_another_metric_version(self):
        copy = self.copy()
        rewrite(copy / "submission.json", lambda facts: facts["metrics"].update(error=99))
        self.refused(copy, "metric error is of version 99, and the edition's of ")

    def test_a_missing_system(self):
        copy = self.copy()
        rewrite(copy / "submission.json", lambda facts: facts["system"].pop("memory_bytes"))
        self.refused(copy, "the system lacks memory_bytes")

    def test_a_record_of_a_dirty_build(self):
        def dirty(rows):
            rows[0]["context"]["commit"] += "-dirty"
        self.refused(self.edit_rows(self.copy(), dirty), "a program of commit '0123456789-dirty' made it, and a clean one is wanted")

    def test_make_refuses_what_check_would(self):
        run = self.dir / "run"
        shutil.copytree(self.run_folder, run)
        rows = records(run)[1:]
        (run / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        done = self.gnomon("submission", "make", run, "--out", "out", "--name", "abacus")
        self.assertEqual((done.returncode, done.stdout), (1, ""), done.stderr)
        self.assertIn("1 row of the edition is missing", done.stderr)
        self.assertEqual([path.name for path in self.dir.iterdir()], ["run"])

    # --- what is hostile, or no submission ---

    def hostile(self, change, *says):
        """The folder after `change` is refused before anything is said of it."""
        copy = self.copy()
        try:
            change(copy)
            self.refuse("submission", "check", "copy", says=["copy is no submission: ", *says])
        finally:
            shutil.rmtree(copy)

    def test_links_and_other_files_are_refused(self):
        mask = records(self.made)[0]["mask"]

        def link(copy):
            (copy / mask).unlink()
            (copy / mask).symlink_to("/etc/passwd")

        def folder_link(copy):
            shutil.rmtree(copy / "masks")
            (copy / "masks").symlink_to(self.made / "masks")
        self.hostile(link, mask, "is a link")
        self.hostile(folder_link, "masks is a link")
        self.hostile(lambda copy: os.mkfifo(copy / "masks/pipe.exr"), "masks/pipe.exr is no plain file")
        self.hostile(lambda copy: (copy / "mine.so").write_bytes(b"\x7fELF"), "mine.so is none of its files")
        self.hostile(lambda copy: (copy / "deep/er").mkdir(parents=True), "deep is no plain file")

    def test_names_that_leave_the_folder_are_refused(self):
        def manifest(copy):
            rewrite(copy / "submission.json", lambda facts: facts["files"].update({"../x": {"bytes": 1, "hash": ""}}))

        def rows_with(**fields):
            def change(copy):
                rows = records(copy)
                rows[0].update(fields)
                (copy / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
            return change

        def scene_file(copy):
            rows = records(copy)
            rows[0]["context"]["scene_file"] = "../../scene.toml"
            (copy / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        self.hostile(manifest, "files = ../x is not a name in the folder")
        self.hostile(rows_with(mask="../masks/a.exr"), "records.jsonl:1", "mask = ../masks/a.exr")
        self.hostile(rows_with(error_picture="errors/a.png"), "error_picture = errors/a.png")
        self.hostile(scene_file, "context.scene_file")
        self.hostile(lambda copy: rewrite(copy / "submission.json", lambda facts: facts["edition"].update(name="../small")),
                     "submission.edition.name = ../small")

    def test_bombs_are_refused(self):
        def many(copy):
            line = (copy / "records.jsonl").read_text().splitlines()[0]
            (copy / "records.jsonl").write_text((line + "\n") * 10_001)

        def huge(copy):
            with open(copy / "records.jsonl", "r+b") as file:
                file.truncate(2**30)

        def deep(copy):
            (copy / "submission.json").write_text('{"schema": ' + "[" * 100_000)

        def deep_row(copy):
            (copy / "records.jsonl").write_text('{"schema": ' + "[" * 100_000 + "\n")
        self.hostile(many, "records.jsonl:10001: it has more than 10000 rows")
        self.hostile(huge, "records.jsonl is 1073741824 bytes long")
        self.hostile(deep, "submission.json: brackets nest deeper than")
        self.hostile(deep_row, "records.jsonl:1: brackets nest deeper than")

    def test_a_mask_of_another_size_is_refused(self):
        copy = self.copy()
        mask = copy / records(copy)[0]["mask"]
        data = bytearray(mask.read_bytes())
        for window in (b"dataWindow\0box2i\0", b"displayWindow\0box2i\0"):
            at = data.index(window) + len(window) + 4
            data[at:at + 16] = struct.pack("<4i", 0, 0, 65535, 65535)
        mask.write_bytes(bytes(data))
        done = self.gnomon("submission", "check", self.sealed(copy), "--quiet")
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertRegex(done.stderr, r"gnomon: \S+\.exr")

    def test_another_schema_is_refused(self):
        def schema(copy):
            rewrite(copy / "submission.json", lambda facts: facts.update(schema="gnomon-submission-9"))

        def field(copy):
            rewrite(copy / "submission.json", lambda facts: facts.update(command="rm"))
        self.hostile(schema, 'schema = "gnomon-submission-9" is not gnomon-submission-1')
        self.hostile(field, "submission has no field command")
        self.hostile(lambda copy: (copy / "submission.json").unlink(), "it has no submission.json")
        self.hostile(lambda copy: (copy / "submission.json").write_text("[]"), "it is no object")
        self.hostile(lambda copy: (copy / "records.jsonl").write_text(""), "records.jsonl has no row")
        self.refuse("submission", "check", "nowhere", says=["nowhere is no submission: it is no folder"])

    def test_another_edition_and_an_edited_one(self):
        copy = self.copy()
        rewrite(copy / "submission.json", lambda facts: facts["edition"].update(hash="0" * 16))
        self.refused(copy, "it is of an edition small with the hash 0000000000000000")
        rewrite(copy / "submission.json", lambda facts: facts["edition"].update(name="unknown"))
        self.refuse("submission", "check", copy, says=["is of edition unknown, which is not known: small"])
        file = self.home / "root/bench/editions/small.toml"
        text = file.read_text()
        try:
            file.write_text(text.replace("repetitions = 2", "repetitions = 3"))
            self.refuse("submission", "check", self.made, says=["edition small is not as it was frozen"])
        finally:
            file.write_text(text)

    def test_words_that_do_not_go_together_are_refused(self):
        self.refuse("submission", "make", self.run_folder, "--out", "x", says=["--name is missing"])
        self.refuse("submission", "make", self.run_folder, "--name", "x", says=["--out is missing"])
        self.refuse("submission", "make", self.run_folder, "--out", "x", "--name", "A b", says=["--name A b is not 1 to 40"])
        self.refuse("submission", "make", self.run_folder, "--out", "x", "--name", "x", "--rows", "3", says=["--rows is for gnomon submission check"])
        self.refuse("submission", "check", self.made, "--name", "x", says=["--name is for gnomon submission make"])
        self.refuse("submission", "make", self.made, "--out", self.made, "--name", "x", says=["made"])
        self.refuse("submission", "send", self.made, says=["send"])
        self.assertEqual(self.names(self.dir), [])


if __name__ == "__main__":
    unittest.main()
