#!/usr/bin/python3 -IB
"""What needs Vulkan's rays says so where they are missing, in its own rows alone."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ProgramTest, records  # noqa: E402


class Vulkan(ProgramTest):
    def test_without_a_driver_its_row_says_what_is_missing_and_others_are_as_ever(self):
        self.environment = dict(type(self).environment, VK_ICD_FILENAMES="/no/driver", VK_DRIVER_FILES="/no/driver")
        self.succeed("run", "--scene", "fence", "--light", "sun", "--technique", "vulkan_rays", "--technique", "embree_rays", "--size", "64x36",
                     "--processes", "1", "--repetitions", "1", "--out", "out")
        missing, traced = records(self.dir / "out")
        self.assertEqual((missing["status"], traced["status"]), ("unsupported", "ok"))
        self.assertRegex(missing["reason"], "Vulkan|libvulkan")

    def test_a_word_that_trace_does_not_know_is_refused_with_the_known_ones(self):
        done = self.gnomon("run", "--scene", "fence", "--technique", "vulkan_rays:trace=both", "--out", "out")
        self.assertEqual(done.returncode, 2)
        self.assertIn("pipeline | query", done.stderr)
        self.assertFalse((self.dir / "out").exists())


if __name__ == "__main__":
    unittest.main()
