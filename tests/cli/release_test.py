#!/usr/bin/python3 -IB
"""scripts/release: each step that is not done is named, in a small tree; of the real one the version is the same wherever it stands."""

import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ROOT, ProgramTest  # noqa: E402

STEPS = "version citation changes frozen program package pages results paper licenses tree tag".split()
NOTHING = "#!/bin/sh\necho all of it\n"
FAILS = "#!/bin/sh\necho it is stale >&2\nexit 1\n"
CHECKS = ("scripts/findings", "scripts/architecture", "scripts/stale_results", "tests/links", "tests/paper")
TREE = {
    "CMakeLists.txt": "project(gnomon VERSION 1.2.0 LANGUAGES CXX)\n",
    "CITATION.cff": 'version: "1.2.0"\nlicense: MIT\n',
    "LICENSE": "MIT License\n",
    "docs/changes.md": "# Changes\n\n## Unreleased\n\n## 1.2.0\n\n- One thing.\n- Another.\n",
    "docs/paper/paper.md": "# Paper\n",
    "docs/paper/paper.bib": "",
    "scenes/a.toml": '# Scene.\n# Source: a package, MIT.\nfile = "cache:a/a.obj"\n',
    "scenes/b.toml": "# Of shapes alone.\n",
    "web/package-lock.json": '{"packages": {"": {}, "node_modules/a": {"license": "MIT"}}}',
    "tests/frozen/1.0/run.txt": "as it was\n",
    ".gitignore": "/build/\n",
} | dict.fromkeys(CHECKS, NOTHING)


class Release(ProgramTest):
    def git(self, *words):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b.invalid", *words], cwd=self.tree, check=True, capture_output=True)

    def commit(self):
        self.git("add", "--all")
        self.git("commit", "-qm", "one")
        self.build()

    def build(self, version="1.2.0"):
        """A program that says that it is of the commit."""
        folder = self.tree / "build/release"
        folder.mkdir(parents=True, exist_ok=True)
        head = subprocess.run(["git", "rev-parse", "--short=10", "HEAD"], cwd=self.tree, check=True, capture_output=True, text=True).stdout.strip()
        (folder / "gnomon").write_text(f'#!/bin/sh\n[ "$1" = --version ] && echo "{version} (commit {head}, build 0123456789abcdef)"\nexit 0\n')
        (folder / "gnomon").chmod(0o755)
        (folder / "CPackConfig.cmake").write_text(f'set(CPACK_PACKAGE_VERSION "{version}")\n')
        (folder / "cmake_install.cmake").write_text("copyright\n")

    def setUp(self):
        super().setUp()
        self.tree = self.dir / "tree"
        for path, text in TREE.items():
            self.put(path, text)
        self.put("scripts/release", (ROOT / "scripts/release").read_text())
        self.git("init", "-q")
        self.commit()
        self.git("tag", "v1.0.0")

    def put(self, path, text):
        file = self.tree / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        if text.startswith("#!"):
            file.chmod(0o755)

    def check(self, *words, status):
        """{step: what was said of it if it is wrong, else None}"""
        done = subprocess.run([self.tree / "scripts/release", "--check", *words], cwd=self.dir, capture_output=True, text=True)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        lines = re.findall(r"(?m)^(ok|wrong) +(\w+): (.+)$", done.stdout)
        self.assertEqual([step for _, step, _ in lines], STEPS, done.stdout)
        return {step: what if verdict == "wrong" else None for verdict, step, what in lines}

    def assert_wrong(self, step, says, *words):
        """This step alone is wrong; an uncommitted change is another."""
        said = {name: what for name, what in self.check(*words, status=1).items() if what}
        self.assertIn(says, said.pop(step))
        return said

    def test_a_tree_that_is_ready(self):
        self.assertEqual(set(self.check(status=0).values()), {None})
        self.assertEqual(set(self.check("1.2.0", status=0).values()), {None})

    def test_another_version_is_wanted(self):
        said = self.assert_wrong("version", "it is 1.2.0, not 2.0.0", "2.0.0")
        self.assertEqual(set(said), {"citation", "changes", "frozen", "program", "package"})
        self.assertIn("tests/frozen/2.0 is missing", said["frozen"])

    def test_each_step_that_is_not_done_is_named(self):
        wrong = {  # step: file, its text, what is said
            "citation": ("CITATION.cff", 'version: "1.1.0"\nlicense: MIT\n', "it is 1.1.0, not 1.2.0"),
            "changes": ("docs/changes.md", "## Unreleased\n\n- One.\n\n## 1.2.0\n\n- Two.\n", "unreleased beside it: 1 entry"),
            "frozen": ("tests/frozen/1.0/run.txt", "another\n", "changed since v1.0.0: tests/frozen/1.0/run.txt"),
            "pages": ("scripts/findings", FAILS, "it is stale"),
            "results": ("scripts/stale_results", FAILS, "it is stale"),
            "paper": ("tests/paper", FAILS, "it is stale"),
            "licenses": ("scenes/a.toml", '# Scene.\nfile = "cache:a/a.obj"\n', "without a license: a.toml"),
        }
        for step, (path, text, says) in wrong.items():
            with self.subTest(step):
                before = (self.tree / path).read_text()
                self.put(path, text)
                self.commit()
                self.assertEqual(self.assert_wrong(step, says), {})
                self.put(path, before)
                self.commit()

    def test_licenses_of_packages_and_of_the_program(self):
        for path, text, says in (("web/package-lock.json", '{"packages": {"": {}, "node_modules/a": {}}}', "web/package-lock.json: node_modules/a"),
                                 ("LICENSE", "Apache License\n", "LICENSE is not MIT")):
            before = (self.tree / path).read_text()
            self.put(path, text)
            self.commit()
            self.assertEqual(self.assert_wrong("licenses", says), {})
            self.put(path, before)
            self.commit()

    def test_what_was_built_committed_and_tagged(self):
        self.put("note.txt", "new")
        self.assertEqual(self.assert_wrong("tree", "not committed: note.txt"), {})
        self.git("add", "--all")
        self.git("commit", "-qm", "two")
        self.assertIn("is checked out", self.check(status=1)["program"])
        self.build("1.1.0")
        self.assertEqual(set(self.assert_wrong("program", "it is 1.1.0, not 1.2.0")), {"package"})
        self.build()
        self.git("tag", "v1.2.0")
        self.assertEqual(self.assert_wrong("tag", "v1.2.0 is there already"), {})
        shutil.rmtree(self.tree / "build")
        self.assertEqual(set(self.assert_wrong("program", "No such file")), {"package", "pages", "tag"})

    def test_other_words_are_refused(self):
        for words in ([], ["--check", "1.0"], ["--check", "1.0.0", "1.0.0"], ["1.0.0"]):
            done = subprocess.run([ROOT / "scripts/release", *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""), words)
            self.assertIn("--check [VERSION]", done.stderr)


class Version(ProgramTest):
    def test_it_is_the_same_wherever_it_stands(self):
        project = re.search(r"(?m)^project\(gnomon VERSION (\S+) ", (ROOT / "CMakeLists.txt").read_text())[1]
        citation = re.search(r'(?m)^version: "(.+)"$', (ROOT / "CITATION.cff").read_text())[1]
        self.assertEqual([citation, self.succeed("--version").split()[0]], [project, project])

    def test_the_page_names_each_step(self):
        page = (ROOT / "docs/releasing.md").read_text()
        self.assertEqual(re.findall(r"(?m)^\| `(\w+)` \|", page), STEPS)

    def test_the_readme_is_one_screen_and_a_half(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text().splitlines()), 75)

    def test_the_numbers_of_the_page_are_those_of_the_program(self):
        page = (ROOT / "docs/stability.md").read_text()
        for number, path, name in ((r"\| contract, as binary \| (\d+)", "harness/include/gnomon/registry.h", "abi_version"),
                                   (r"\| schema (\d+);", "harness/measure/record/record.h", "record_schema"),
                                   (r"\| \[protocol with programs\]\(#the-two-protocols\) \| (\d+)", "harness/measure/program/program_technique.h", "program_protocol"),
                                   (r"\| protocol with workers \| (\d+)", "harness/measure/worker/protocol.h", "worker_protocol")):
            here = re.search(rf"int {name} = (\d+);", (ROOT / path).read_text())[1]
            self.assertEqual(re.search(number, page)[1], here, name)


if __name__ == "__main__":
    unittest.main()
