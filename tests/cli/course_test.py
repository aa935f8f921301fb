#!/usr/bin/python3 -IB
"""The course: the first sheet done from its starter files gives the numbers that it expects. `scripts/course --check` does all of them."""

import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PROGRAM, ROOT, ProgramTest  # noqa: E402

SHEET = "acne_and_bias"


class Course(ProgramTest):
    def test_a_sheet_expects_what_its_starter_files_give(self):
        (self.dir / "scripts").mkdir()
        shutil.copy(ROOT / "scripts/course", self.dir / "scripts")
        shutil.copytree(ROOT / "docs/course", self.dir / "docs/course")
        # Of a number that is another one it says so; all others are right.
        page = self.dir / "docs/course" / SHEET / "README.md"
        text = page.read_text()
        begin = text.index("| share of acne without a bias | ")
        end = text.index("\n", begin)
        page.write_text(text[:begin] + "| share of acne without a bias | 0.9 | 0.02 |" + text[end:])
        done = subprocess.run([self.dir / "scripts/course", "--program", PROGRAM, "--check", SHEET], env=self.environment, text=True, capture_output=True)
        self.assertEqual((done.returncode, done.stderr), (1, ""), done.stdout + done.stderr)
        self.assertRegex(done.stdout, rf"^course: {SHEET}: share of acne without a bias is 0\.\d+; the sheet expects 0\.9 within 0\.02\n"
                                      rf"course: {SHEET}: \d+ numbers, 1 differ\n$")


if __name__ == "__main__":
    unittest.main()
