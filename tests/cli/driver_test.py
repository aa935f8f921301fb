#!/usr/bin/python3 -IB
"""Which OpenGL draws is GNOMON_GL's word alone; one that cannot be had is refused with what to install."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ProgramTest  # noqa: E402

ZINK = {"LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "zink", "MESA_LOADER_DRIVER_OVERRIDE": "zink"}


class Driver(ProgramTest):
    def draw(self, **environment):
        """What draws, or, where nothing can, what is said."""
        self.environment = dict(type(self).environment, **environment)
        done = self.gnomon("render", "--scene", "fence", "--light", "sun", "--technique", "shadow_map", "--size", "64x36", "--out", "out")
        if done.returncode:
            return done.stderr
        return json.loads((self.dir / "out/record.json").read_text())[0]["context"]["gl_renderer"]

    def test_software_is_llvmpipe_whatever_mesa_is_told(self):
        self.assertTrue(self.draw(GNOMON_GL="software").startswith("llvmpipe"))
        self.assertTrue(self.draw(GNOMON_GL="software", **ZINK).startswith("llvmpipe"))

    def test_an_unknown_word_is_refused_with_the_known_ones(self):
        self.assertIn("GNOMON_GL = fast is none of auto | software | hardware | zink", self.draw(GNOMON_GL="fast"))

    def test_without_vulkan_zink_is_refused_with_the_packages(self):
        said = self.draw(GNOMON_GL="zink", VK_ICD_FILENAMES="/no/driver", VK_DRIVER_FILES="/no/driver")
        self.assertIn("no OpenGL 4.5 core context of zink over lavapipe", said)
        self.assertIn("install libegl1 libgl1-mesa-dri mesa-vulkan-drivers", said)

    def test_zink_draws_where_it_is_installed(self):
        drawn = self.draw(GNOMON_GL="zink")
        if "install" in drawn:
            self.skipTest(drawn)
        self.assertTrue(drawn.startswith("zink (llvmpipe"), drawn)


if __name__ == "__main__":
    unittest.main()
