#!/usr/bin/python3 -IB
"""scripts/run: what it does with the program once that is built. Installing, building and fetching are left out."""

import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, PROGRAM, ROOT, SMALL, ProgramTest  # noqa: E402

ROW = ["--filter", "soup.* point unshadowed", *SMALL, "--quiet"]


class FirstRun(ProgramTest):
    def setUp(self):
        super().setUp()
        (self.dir / "scripts").mkdir()
        for name in ("run", "lib.sh"):
            shutil.copy(ROOT / "scripts" / name, self.dir / "scripts")
        for name in ("scripts/setup", "scripts/fetch_scenes", "tools/cmake"):
            self.script(name, "exit 0")
        self.script("build/release/gnomon", f'exec {PROGRAM} "$@"')
        self.environment = dict(self.environment, PATH=f"{self.dir}/tools:{os.environ['PATH']}", GNOMON_ROOT=str(ROOT))

    def script(self, name, text):
        file = self.dir / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"#!/bin/sh\n{text}\n")
        file.chmod(0o755)

    def run_script(self, *arguments, status=0):
        done = subprocess.run([self.dir / "scripts/run", *arguments], env=self.environment, cwd="/", text=True, capture_output=True,
                              timeout=PATIENCE)
        if "GNOMON_REPORT=OFF" in done.stderr:
            self.skipTest("the program was built without the report's page")
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def test_it_ends_with_the_report_and_how_to_look_at_it(self):
        done = self.run_script(*ROW)
        self.assertIn("\nunshadowed ", done.stdout)
        page = Path(self.dir, done.stdout.splitlines()[-1])
        self.assertEqual((page.name, page.parent.parent), ("report.html", self.dir / "runs"))
        self.assertTrue(page.is_file())
        self.assertIn("browser", done.stderr.splitlines()[-1])
        self.assertIn(str(page), done.stderr.splitlines()[-1])

    def test_the_folder_may_be_named_and_continued(self):
        for words in (["--out", "mine"], ["--out=mine", "--resume"]):
            self.assertEqual(self.run_script(*words, *ROW).stdout.splitlines()[-1], "mine/report.html")

    def test_nothing_measured_is_no_report(self):
        self.assertIn("1 row, ", self.run_script("--dry-run", *ROW).stdout)
        self.assertIn("gnomon", self.run_script("--nonsense", status=2).stderr)
        self.assertIn("--out", self.run_script("--resume", status=2).stderr)
        self.assertFalse((self.dir / "runs").exists())

    def test_the_status_is_that_of_the_run(self):
        self.script("build/release/gnomon", f'[ "$1" = run ] || exec {PROGRAM} "$@"\n{PROGRAM} "$@"; exit 1')
        self.assertTrue(self.run_script(*ROW, status=1).stdout.endswith("/report.html\n"))

    def test_without_a_page_the_table_stands(self):
        self.script("build/release/gnomon", f'[ "$1" = run ] || exit 2\nexec {PROGRAM} "$@"')
        done = self.run_script(*ROW)
        self.assertIn("\nunshadowed ", done.stdout)
        self.assertIn("could not be made", done.stderr.splitlines()[-1])


if __name__ == "__main__":
    unittest.main()
