#!/usr/bin/python3 -IB
"""Which OpenGL draws is GNOMON_GL's word alone; one that cannot be had is refused with what to install."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import ProgramTest, records  # noqa: E402

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

    def test_a_smaller_device_is_a_reason_of_the_row_and_an_unknown_limit_is_refused(self):
        self.environment = dict(type(self).environment, GNOMON_GL_LIMITS="texture_size=512,vertex_storage_blocks=0")
        self.succeed("run", "--scene", "fence", "--light", "sun", "--technique", "shadow_map", "--technique", "shadow_map:resolution=512",
                     "--technique", "stencil_volume", "--size", "64x36", "--processes", "1", "--repetitions", "1", "--out", "out")
        self.assertEqual([(r["status"], r["reason"]) for r in records(self.dir / "out")],
                         [("unsupported", "the OpenGL device has texture_size = 512; 1024 are needed"), ("ok", ""),
                          ("unsupported", "the OpenGL device has vertex_storage_blocks = 0; 3 are needed")])
        self.assertIn("GNOMON_GL_LIMITS: speed is none of varying_components", self.draw(GNOMON_GL_LIMITS="speed=1"))

    def test_a_drawn_row_has_the_device_s_own_times(self):
        self.succeed("run", "--scene", "fence", "--light", "sun", "--technique", "shadow_map", "--technique", "embree_rays", "--size", "64x36",
                     "--processes", "2", "--repetitions", "2", "--out", "out")
        drawn, traced = records(self.dir / "out")
        self.assertEqual(traced["device_stages"], {})
        self.assertIsNone(traced["floor"])
        self.assertEqual(drawn["floor"]["pass"], "depth_draw")
        self.assertEqual([len(process) for process in drawn["floor"]["ms"]], [2, 2])
        self.assertTrue(all(ms > 0 for process in drawn["floor"]["ms"] for ms in process))
        if not drawn["device_stages"]:
            self.skipTest("a device without a clock")
        for stage, processes in drawn["stages"].items():
            self.assertEqual([len(p) for p in drawn["device_stages"][stage]], [len(p) for p in processes])
            for wall, device in zip(sum(processes, []), sum(drawn["device_stages"][stage], [])):
                self.assertTrue(0 <= device <= wall, (stage, device, wall))


if __name__ == "__main__":
    unittest.main()
