#!/usr/bin/python3 -IB
"""scripts/instructions: what callgrind counts in each stage."""

import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, PROGRAM, ROOT, ProgramTest  # noqa: E402

HEADER = Path("/usr/include/valgrind/callgrind.h")


class Instructions(ProgramTest):
    def said(self, *words, status=0):
        done = subprocess.run([ROOT / "scripts/instructions", "--program", PROGRAM, "--times", "1", *words], env=self.environment, text=True,
                              capture_output=True, timeout=PATIENCE, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    @unittest.skipUnless(shutil.which("valgrind") and HEADER.is_file(), "valgrind is not installed, or its headers are not")
    def test_a_stage_of_four_times_the_pixels_takes_four_times_the_instructions(self):
        def resolve(size):
            lines = self.said("single_triangle", "point", "svbsp", size).splitlines()
            self.assertEqual(lines[0], f"single_triangle point svbsp, {size}: instructions of one thread, 1 run")
            counts = {line.split()[0]: int(line.split()[1].replace(",", "")) for line in lines[2:]}
            self.assertEqual(list(counts), ["setup", "build", "relight", "resolve"])
            return counts["resolve"]

        ratio = resolve("192x108") / resolve("96x54")
        self.assertGreater(ratio, 3)
        self.assertLess(ratio, 5)

    def test_bad_words_are_refused(self):
        self.assertIn("usage", self.said("fence", status=2))
        self.assertIn("1 at least", self.said("--times", "0", "fence", "point", "svbsp", status=2))
        if shutil.which("valgrind"):
            self.assertIn("scene fence has no light nowhere", self.said("fence", "nowhere", "svbsp", status=2))


if __name__ == "__main__":
    unittest.main()
