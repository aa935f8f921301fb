#!/usr/bin/python3 -IB
"""What a build says of its commit: "-dirty" as soon as the tree holds a technique or scene that the commit does not."""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ROOT, ProgramTest  # noqa: E402

SCRIPT = ROOT / "harness/cmake/Commit.cmake"


class Commit(ProgramTest):
    def git(self, *words):
        name = ("-c", "user.name=nobody", "-c", "user.email=nobody@example.org")
        return subprocess.run(["git", *name, *words], cwd=self.tree, check=True, capture_output=True, text=True).stdout.strip()

    def commit(self):
        """As the header has it that the build writes."""
        out = self.dir / "commit.h"
        subprocess.run(["cmake", f"-DSOURCE={self.tree}", f"-DOUT={out}", "-P", SCRIPT], check=True, env=self.environment)
        return out.read_text().split('"')[1]

    def setUp(self):
        super().setUp()
        self.tree = self.dir / "tree"
        for folder in ("techniques", "scenes", "docs"):
            (self.tree / folder).mkdir(parents=True)
        (self.tree / "techniques/a.cpp").write_text("a")
        (self.tree / ".gitignore").write_text("*.swp\n")
        self.git("init", "-q")
        self.git("add", ".")
        self.git("commit", "-qm", "one")
        self.clean = self.git("describe", "--always", "--abbrev=10")

    def test_a_tree_as_committed_has_the_bare_commit(self):
        self.assertEqual(self.commit(), self.clean)
        (self.tree / "docs/note.md").write_text("no part of the program")
        (self.tree / "techniques/.a.cpp.swp").write_text("ignored")
        self.assertEqual(self.commit(), self.clean)

    def test_changed_and_new_files_say_so(self):
        for file in ("techniques/a.cpp", "techniques/b.cpp", "techniques/b/helper.cpp", "scenes/new.toml"):
            with self.subTest(file=file):
                path = self.tree / file
                before = path.read_text() if path.exists() else None
                path.parent.mkdir(exist_ok=True)
                path.write_text("changed")
                self.assertEqual(self.commit(), self.clean + "-dirty")
                if before is None:
                    path.unlink()
                else:
                    path.write_text(before)
                self.assertEqual(self.commit(), self.clean)

    def test_a_tree_without_git_is_unknown(self):
        self.tree = self.dir / "bare"
        self.tree.mkdir()
        self.environment["GIT_CEILING_DIRECTORIES"] = str(self.dir)
        self.assertEqual(self.commit(), "unknown")


if __name__ == "__main__":
    unittest.main()
