#!/usr/bin/python3 -IB
"""A short run of scripts/torture: kills, stops and full disks cost no row."""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PROGRAM, ROOT, ProgramTest  # noqa: E402


class Torture(ProgramTest):
    def test_nothing_is_found_in_half_a_minute(self):
        done = subprocess.run([ROOT / "scripts/torture", "0.5", "--seed", "7", "--program", PROGRAM, "--keep", self.dir / "found"],
                              env=self.environment, text=True, capture_output=True, timeout=500)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"(?m)^\d+ rounds, \d+ disturbed starts, \d+ kills, 0 findings")

    def test_a_program_that_is_not_there_is_said(self):
        done = subprocess.run([ROOT / "scripts/torture", "--program", "nowhere"], text=True, capture_output=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("there is no program nowhere", done.stderr)


if __name__ == "__main__":
    unittest.main()
