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

    def header(self):
        """What the build writes, by name."""
        out = self.dir / "commit.h"
        subprocess.run(["cmake", f"-DSOURCE={self.tree}", f"-DOUT={out}", "-P", SCRIPT], check=True, env=self.environment)
        return dict(line.removeprefix("#define GNOMON_").split(" ", 1) for line in out.read_text().splitlines())

    def commit(self):
        return self.header()["COMMIT"].strip('"')

    def setUp(self):
        super().setUp()
        self.tree = self.dir / "tree"
        for folder in ("techniques/a", "scenes", "docs", "harness/kit", "harness/report"):
            (self.tree / folder).mkdir(parents=True)
        (self.tree / "techniques/a.cpp").write_text("a")
        (self.tree / "docs/page.md").write_text("a page")
        (self.tree / ".gitignore").write_text("*.swp\n")
        self.git("init", "-q")
        self.git("add", ".")
        self.git("commit", "-qm", "one")
        self.clean = self.git("describe", "--always", "--abbrev=10")

    def test_a_tree_as_committed_has_the_bare_commit(self):
        self.assertEqual(self.commit(), self.clean)
        (self.tree / "docs/note.md").write_text("no part of the program")
        (self.tree / "docs/page.md").write_text("changed")
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

    def test_changes_of_the_tree_are_kept(self):
        def changes():
            return bytes(int(byte, 16) for byte in self.header()["CHANGES"].split(",")[:-1]).decode()

        self.assertEqual(changes(), "")
        (self.tree / "techniques/a.cpp").write_text('b; [1] "\\" \u2212\n')
        (self.tree / "scenes/new.toml").write_text("fresh")
        (self.tree / "docs/note.md").write_text("no part of the program")
        text = changes()
        for line in ("-a", '+b; [1] "\\" \u2212', "+++ b/scenes/new.toml", "+fresh"):
            self.assertIn(line, text.splitlines())
        self.assertNotIn("note.md", text)
        (self.tree / "techniques/a.cpp").write_text("x\n" * 600_000)
        self.assertRegex(changes(), r"^The tree differs from its commit by \d+ bytes of text, which are not kept.\n$")

    def test_files_of_any_name_break_no_build(self):
        for name in ("we ird;[f.h", "\u00fc ml]aut.h", "-x\ny.h"):
            (self.tree / "techniques/a" / name).write_text("x;y[1]\n")
        (self.tree / "scenes/binary").write_bytes(b"\0\xff\1")
        header = self.header()
        self.assertEqual(header["COMMIT"], f'"{self.clean}-dirty"')
        self.assertIn("scenes/binary", bytes(int(byte, 16) for byte in header["CHANGES"].split(",")[:-1]).decode(errors="replace"))

    def test_sources_have_a_hash_and_techniques_one_of_their_own(self):
        def hashes():
            header = self.header()
            return header["SOURCES"], header["TECHNIQUE_SOURCES"]

        before = hashes()
        self.assertRegex(before[1], r'^\{"a", "[0-9a-f]{16}"\}, $')
        for file, is_shared, is_own in (("techniques/a/part.h", False, True), ("techniques/a.cpp", False, True), ("harness/kit/b.cpp", True, False),
                                        ("harness/report/b.cpp", False, False), ("docs/note.md", False, False)):
            path = self.tree / file
            kept = path.read_text() if path.exists() else None
            path.write_text("other")
            after = hashes()
            self.assertEqual((after[0] != before[0], after[1] != before[1]), (is_shared, is_own), file)
            path.unlink() if kept is None else path.write_text(kept)
            self.assertEqual(hashes(), before)

    def test_a_tree_without_git_is_unknown(self):
        self.tree = self.dir / "bare"
        self.tree.mkdir()
        self.environment["GIT_CEILING_DIRECTORIES"] = str(self.dir)
        self.assertEqual(self.commit(), "unknown")


if __name__ == "__main__":
    unittest.main()
