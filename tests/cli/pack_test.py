#!/usr/bin/python3 -IB
"""`gnomon pack`: a run as one archive, what is said of the parts that are gone, and its rows run again in a bare folder.

The program is not built again here, which takes minutes: `scripts/check_pack` does that."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tarfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, NUMBERS, PROGRAM, PROGRAM_SHEET, ProgramTest, records, wait_until  # noqa: E402

SECOND = Path(FAULTS).with_name("gnomon_second.so")
MODEL = "mtllib plate.mtl\nv -1 1 -1\nv 1 1 -1\nv 0 1 1\nusemtl plate\nf 1 2 3\n"
SCENE = """# Plate: a triangle above a floor.
# Source: drawn for this test, CC0.
name = "plate"
[[mesh]]
file = "models/plate.obj"
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [6, 6]
[[light]]
name = "sun"
kind = "directional"
direction = [0.3, -1, 0.2]
"""
ENGINE = """import sys
from gnomon_technique import Technique, serve

class Lit(Technique):
    def resolve(self, gbuffer, mask):
        mask[...] = 1

serve(Lit)
"""
COMMIT_TEXT = "a tree\n"


class Packed(ProgramTest):
    @classmethod
    def setUpClass(cls):
        """One run of three rows: by a technique of the program, of a plugin and of a program in Python; and a repository."""
        super().setUpClass()
        cls.work = cls.home / "work"
        (cls.work / "models").mkdir(parents=True)
        for name, text in {"plate.toml": SCENE, "models/plate.obj": MODEL, "models/plate.mtl": "newmtl plate\nKd 0.5 0.5 0.5\n",
                           "lit.toml": PROGRAM_SHEET.format(id="lit").replace("-IB", "-B"), "lit.py": ENGINE}.items():
            (cls.work / name).write_text(text)
        shutil.copy(SECOND, cls.work / "mine.so")
        cls.call("run", "--plugin", "mine.so", "--program=lit.toml", "--scene", "plate.toml", "--technique", "embree_rays", "--technique",
                 "always_lit", "--technique", "lit", *NUMBERS, "--quiet", "--out", "run")
        git = ["git", "-c", "user.name=nobody", "-c", "user.email=nobody@example.org", "-c", "init.defaultBranch=main"]
        repository = cls.home / "repository"
        repository.mkdir()
        (repository / "CMakeLists.txt").write_text(COMMIT_TEXT)
        for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "one"]):
            subprocess.run([*git, *words], cwd=repository, check=True)
        described = subprocess.run([*git, "describe", "--always", "--abbrev=10"], cwd=repository, check=True, capture_output=True, text=True)
        cls.commit = described.stdout.strip()
        cls.say_commit(cls.work / "run", cls.commit, "")

    @classmethod
    def call(cls, *words, status=0, **options):
        done = subprocess.run([PROGRAM, *map(str, words)], cwd=cls.work, env=cls.environment, text=True, capture_output=True, **options)
        if done.returncode != status:
            raise AssertionError(f"{words}: exit {done.returncode}\n{done.stdout}\n{done.stderr}")
        return done.stdout + done.stderr

    @staticmethod
    def say_commit(run, commit, changes):
        """As if a build of this commit had made the run."""
        rows = records(run)
        for row in rows:
            row["context"]["commit"] = commit
        (run / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        file = run / "run.json"
        text = json.loads(file.read_text())
        for entry in text["runs"]:
            entry["context"]["commit"], entry["changes"] = commit, changes
        file.write_text(json.dumps(text))

    def pack(self, *words, run="run", status=0, **options):
        """Returns what is said, and the archive."""
        out = self.dir / "packed.tar.gz"
        return self.call("pack", run, "--out", out, "--repository", self.home / "repository", *words, status=status, **options), out

    def unpacked(self, archive):
        subprocess.run(["tar", "-xf", archive, "-C", self.dir], check=True)
        return self.dir / "packed"

    def copied_run(self):
        """A copy of the run in a folder of the test's; its name from the folder of the calls."""
        shutil.copytree(self.work / "run", self.dir / "run")
        return self.dir / "run"

    def assert_nothing_left(self):
        self.assertEqual(self.names(self.dir), [])

    def test_the_archive_holds_what_makes_its_rows_again(self):
        said, archive = self.pack()
        self.assertIn("3 rows, 1 scene, 1 call, 1 plugin, ", said)
        with tarfile.open(archive) as tar:
            for member in tar:
                self.assertTrue(member.isfile() or member.isdir(), member.name)
                self.assertTrue(member.name == "packed" or member.name.startswith("packed/"), member.name)
                self.assertNotIn("..", Path(member.name).parts)
            names = {member.name.removeprefix("packed/") for member in tar if member.isfile()}
        self.assertLessEqual({"reproduce", "README.md", "LICENSES.md", "pack.json", "run/records.jsonl", "run/run.json", "scenes/1/plate.toml",
                              "scenes/1/models/plate.obj", "scenes/1/models/plate.mtl", f"source/{self.commit}.tar"}, names)
        self.assertEqual({name.split("/")[2] for name in names if name.startswith("programs/")}, {"lit.toml", "lit.py"})
        plugin = {"/".join(name.split("/")[2:]) for name in names if name.startswith("plugins/")}
        self.assertLessEqual({"mine.so", "CMakeLists.txt", "source/plugins/always_lit.cpp", "source/faults/harmless.h"}, plugin)
        folder = self.unpacked(archive)
        self.assertIn("Source: drawn for this test, CC0.", (folder / "LICENSES.md").read_text())
        with tarfile.open(folder / f"source/{self.commit}.tar") as tree:
            self.assertEqual(tree.extractfile("gnomon/CMakeLists.txt").read().decode(), COMMIT_TEXT)
        self.assertNotIn(str(self.work), (folder / "pack.json").read_text())

    def reproduce(self, folder, *words, status):
        """In an environment in which nothing leads to this machine's folders."""
        done = subprocess.run([folder / "reproduce", "--gnomon", PROGRAM, "--processes", "1", *words], cwd="/", text=True, capture_output=True,
                              env={key: value for key, value in os.environ.items() if key != "GNOMON_CACHE"})
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_the_rows_are_made_again_and_compared(self):
        folder = self.unpacked(self.pack()[1])
        said = self.reproduce(folder, status=0)
        self.assertIn("3 rows: 3 the same to the last digit, 0 drawn by another renderer with other answers, 0 differ, 0 not made", said)
        self.assertRegex(said, r"times of resolve: [0-9.]+ times as long as then")
        self.reproduce(folder, status=2)  # the folder of the rows is there
        # An answer that is another one is found, and a row that nothing makes; nothing else is.
        file = folder / "run/records.jsonl"
        rows = records(folder / "run")
        rows[0]["metrics"]["shape"]["error"] = 0.25
        rows.append(dict(rows[0], job="0", technique="unshadowed"))
        file.write_text("".join(json.dumps(row) + "\n" for row in rows))
        said = self.reproduce(folder, "--out", self.dir / "other", status=1)
        self.assertRegex(said, r"DIFFERS: plate.toml sun \w+ embree_rays: metrics.shape.error was 0.25, is 0.0\n")
        self.assertRegex(said, r"NOT MADE: plate.toml sun \w+ unshadowed")
        self.assertIn("4 rows: 2 the same", said)

    def test_one_run_packs_to_the_same_bytes(self):
        first = self.pack()[1].read_bytes()
        self.assertEqual(self.pack("--overwrite")[1].read_bytes(), first)

    def test_an_archive_that_is_there_is_not_replaced_unasked(self):
        file = self.write("packed.tar.gz", "mine")
        self.assertIn("is there already", self.pack(status=2)[0])
        self.assertEqual(file.read_text(), "mine")
        self.pack("--overwrite")
        self.assertTrue(tarfile.is_tarfile(file))
        self.assertEqual(self.names(self.dir), ["packed.tar.gz"])

    def test_what_is_gone_is_said_and_the_rest_is_packed(self):
        run = self.copied_run()
        self.say_commit(run, "0123456789-dirty", None)
        rows = records(run)
        rows[0]["context"]["scene_hash"] = "0" * 32
        rows.append(dict(rows[0], job="0", scene="gone.glb"))
        rows.append(dict(rows[0], job="1", context=dict(rows[0]["context"], foreign={"file": "x.exr", "channel": "V", "hash": ""})))
        (run / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
        kept = {name: (self.work / name).read_bytes() for name in ("plate.toml", "mine.so", "lit.py")}
        try:
            (self.work / "plate.toml").write_text(SCENE.replace("# Source", "# Seen in"))
            (self.work / "mine.so").write_bytes(kept["mine.so"].replace(b"gnomon plugin sources:", b"gnomon plugin nothing:"))
            (self.work / "lit.py").write_text(ENGINE + "# changed\n")
            said, archive = self.pack(run=run, status=1)
        finally:
            for name, text in kept.items():
                (self.work / name).write_bytes(text)
        for text in ("a license of ", "scene plate.toml as it was", "scene gone.glb: ", "plugin mine.so as it was", "the sources of plugin mine.so",
                     "program lit.toml as it was", "no repository with commit 0123456789", "differed by from commit 0123456789",
                     "what made 1 of the rows"):
            self.assertIn(text, said)
            self.assertEqual(said.count(text), 1)
        folder = self.unpacked(archive)
        self.assertIn("a license of ", (folder / "README.md").read_text())
        self.assertEqual(len(json.loads((folder / "pack.json").read_text())["missing"]), said.count("missing: "))
        self.assertTrue((folder / "scenes/1/models/plate.obj").is_file())

    def test_a_license_beside_the_model_is_packed(self):
        run = self.copied_run()
        page = self.work / "models/plate.obj.license"
        description = self.work / "plate.toml"
        try:
            page.write_text("CC0\n")
            (self.work / "models/LICENSE.txt").write_text("CC0 as well\n")
            description.write_text(SCENE.replace("# Source", "# Seen in"))
            said, archive = self.pack(run=run)
        finally:
            page.unlink()
            (self.work / "models/LICENSE.txt").unlink()
            description.write_text(SCENE)
        folder = self.unpacked(archive)
        self.assertEqual((folder / "scenes/1/models/plate.obj.license").read_text(), "CC0\n")
        self.assertIn("scenes/1/models/LICENSE.txt", (folder / "LICENSES.md").read_text())

    def test_changes_of_the_tree_are_packed_once(self):
        run = self.copied_run()
        changes = "diff --git a/CMakeLists.txt b/CMakeLists.txt\n--- a/CMakeLists.txt\n+++ b/CMakeLists.txt\n@@ -1 +1 @@\n-a tree\n+another\n"
        self.say_commit(run, f"{self.commit}-dirty", changes)
        text = json.loads((run / "run.json").read_text())
        text["runs"].append(dict(text["runs"][0], command=[*text["runs"][0]["command"], "--resume"]))  # as if it had been killed once
        (run / "run.json").write_text(json.dumps(text))
        folder = self.unpacked(self.pack(run=run)[1])
        self.assertEqual((folder / "source/changes-1.patch").read_text(), changes)
        self.assertEqual({file.name for file in (folder / "source").iterdir()}, {f"{self.commit}.tar", "changes-1.patch"})
        calls = json.loads((folder / "pack.json").read_text())["commands"]
        self.assertEqual(len(calls), 1)
        words = calls[0]["words"]
        self.assertNotIn("--out", words)
        self.assertIn("scenes/1/plate.toml", words)

    def test_what_is_no_run_and_what_is_no_archive_is_refused(self):
        for words, says in ((["work"], "is not the folder of a run"), (["run", "--out", self.dir / "a.zip"], "does not end in NAME.tar.gz"),
                            (["run", "--out", self.dir / ".tar.gz"], "does not end in NAME.tar.gz"), (["run", "--out", ""], "empty")):
            self.assertIn(says, self.call("pack", *words, status=2))
        self.assert_nothing_left()
        run = self.copied_run()
        (run / "run.json").write_text("{}")
        self.assertIn("does not say how the folder was run", self.pack(run=run, status=2)[0])
        (run / "run.json").unlink()
        (run / "run.json").symlink_to("/etc/hostname")
        self.assertIn("run.json", self.pack(run=run, status=2)[0])
        shutil.rmtree(run)
        self.assert_nothing_left()

    def test_a_full_disk_leaves_nothing(self):
        def little_room():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

        self.assertIn("cannot be written", self.pack(status=2, preexec_fn=little_room)[0])
        self.assert_nothing_left()

    def test_a_killed_pack_leaves_no_archive_and_the_next_one_clears_up(self):
        (self.dir / "tools").mkdir()
        tar = self.write("tools/tar", f'#!/bin/sh\ntouch "{self.dir}/tools/here"\nwhile kill -0 $PPID 2>/dev/null; do sleep 0.02; done\n')
        tar.chmod(0o755)
        out = self.dir / "out/packed.tar.gz"
        words = [PROGRAM, "pack", "run", "--out", out, "--repository", self.home / "repository"]
        process = subprocess.Popen(words, cwd=self.work, env=dict(self.environment, PATH=f"{self.dir}/tools:{os.environ['PATH']}"))
        wait_until((self.dir / "tools/here").exists, "the archive to be begun")
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.assertFalse(out.exists())
        subprocess.run(words, cwd=self.work, env=self.environment, check=True, stdout=subprocess.DEVNULL)
        self.assertEqual(os.listdir(out.parent), ["packed.tar.gz"])


if __name__ == "__main__":
    unittest.main()
