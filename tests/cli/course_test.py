#!/usr/bin/python3 -IB
"""The course: sheets done from their starter files give the numbers that they expect, as far as that takes seconds, and the others are
complete. `scripts/course --check` does all of them."""

import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PROGRAM, ROOT, ProgramTest  # noqa: E402

SHEET = "acne_and_bias"
COURSE = ROOT / "docs/course"


class Course(ProgramTest):
    def course(self, *arguments):
        return subprocess.run([self.dir / "scripts/course", "--program", PROGRAM, *arguments], env=self.environment, text=True, capture_output=True)

    def setUp(self):
        super().setUp()
        (self.dir / "scripts").mkdir()
        shutil.copy(ROOT / "scripts/course", self.dir / "scripts")
        shutil.copytree(COURSE, self.dir / "docs/course")

    def test_a_sheet_expects_what_its_starter_files_give(self):
        # Of a number that is another one it says so; all others are right.
        page = self.dir / "docs/course" / SHEET / "README.md"
        text = page.read_text()
        begin = text.index("| share of acne without a bias | ")
        end = text.index("\n", begin)
        page.write_text(text[:begin] + "| share of acne without a bias | 0.9 | 0.02 |" + text[end:])
        done = self.course("--check", SHEET)
        self.assertEqual((done.returncode, done.stderr), (1, ""), done.stdout + done.stderr)
        self.assertRegex(done.stdout, rf"^course: {SHEET}: share of acne without a bias is 0\.\d+; the sheet expects 0\.9 within 0\.02\n"
                                      rf"course: {SHEET}: \d+ numbers, 0 pictures, 1 differ\n$")

    def test_trees_drawn_by_hand_have_the_nodes_of_the_program(self):
        done = self.course("--check", "svbsp")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertRegex(done.stdout, r"^course: svbsp: \d+ numbers, 1 picture, 0 differ\n$")
        (self.dir / "docs/course/svbsp/splits.png").write_bytes((self.dir / "docs/course/counting/counts.png").read_bytes())
        done = self.course("--check", "svbsp")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("course: svbsp: splits.png is not what the command beside it draws today\n", done.stdout)

    def test_what_a_solution_adds_is_run_beside_what_a_sheet_begins_with(self):
        """A program beside each suite, and answers from both runs."""
        sheet = self.dir / "docs/course/technique"
        for made in ("CMakeLists.txt", "solution/CMakeLists.txt"):  # no compiler here
            (sheet / made).unlink()
        for suite, less in (("suite.toml", '"my_plugin", '), ("solution/suite.toml", ', "my_rays:offset={0,1e-6,0.01}"')):
            text = (sheet / suite).read_text()
            self.assertIn(less, text)
            (sheet / suite).write_text(re.sub(r"(width|height) = \d+", r"\1 = 60", text.replace(less, "")))
        answers = (sheet / "answers.py").read_text()
        (sheet / "answers.py").write_text(answers[: answers.index("def answers")] + """def answers(begun, finished):
    errors = [max(row["error"] for row in rows(folder) if row["technique"].startswith("my_") and row.get("offset", 1e-6) == 1e-6)
              for folder in (begun, finished)]
    return [("boxes err", float(errors[0] > 0), 0), ("triangles err", float(errors[1] > 0), 0)]
""")
        done = self.course("technique")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        table = (sheet / "README.md").read_text()
        self.assertIn("| boxes err | 1 | 0 |\n| triangles err | 0 | 0 |\n<!-- end -->", table)

    def test_all_sheets_are_listed_and_have_their_numbers(self):
        refused = self.course("no_such_sheet")
        self.assertEqual(refused.returncode, 2)
        sheets = re.search(r"there are (.*)$", refused.stderr, re.MULTILINE).group(1).split(", ")
        self.assertEqual(sorted(re.findall(r"\]\((\w+)/README\.md\)", (COURSE / "README.md").read_text())), sheets)
        for sheet in sheets:
            self.assertTrue((COURSE / sheet / "answers.py").exists(), sheet)
            text = (COURSE / sheet / "README.md").read_text()
            self.assertRegex(text, r"(?s)^# .*\n## What to do\n.*\n## What to hand in\n.*\n## What to expect\n", sheet)
            self.assertRegex(text, r"<!-- scripts/course -->\n\| what \| expected \| right within \|\n\|---\|---:\|---:\|\n"
                                   r"(\|[^|]+\|[^|]+\|[^|]+\|\n)+<!-- end -->", sheet)


if __name__ == "__main__":
    unittest.main()
