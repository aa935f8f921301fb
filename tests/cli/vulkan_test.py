#!/usr/bin/python3 -IB
"""What needs Vulkan's rays says so where they are missing or go away, in its own rows alone. Most tests load a library that stands for
Vulkan: tests/fake_vulkan.cpp."""

import os
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HUNG, ROOT, ProgramTest, records, workers  # noqa: E402

FAKE = Path(os.environ.get("GNOMON_FAKE_VULKAN", ROOT / "build/release/tests/fake_vulkan/libvulkan.so.1"))  # none: built without Vulkan
SMALL = ["--size", "64x36", "--processes", "1", "--repetitions", "1", "--pictures", "none"]
WAYS = ["--technique", "vulkan_rays", "--technique", "vulkan_rays:trace=query"]
LOST = r"the device is lost \(VkResult -4\)$"


class Vulkan(ProgramTest):
    def rows(self, *arguments, status=0, out="out", **environment):
        """Each way of tracing, then rays by the processor: the records."""
        self.environment = dict(type(self).environment, GNOMON_TEST=str(self.dir), **environment)
        self.succeed("run", "--scene", "fence", *WAYS, "--technique", "embree_rays", *SMALL, *arguments, "--out", out, status=status)
        return records(self.dir / out)

    def assert_sound(self, *rows):
        for row in rows:
            self.assertEqual((row["status"], row["reason"]), ("ok", ""))
            self.assertEqual([len(process) for process in row["stages"]["resolve"]], [1])

    def assert_missing(self, reason, *rows):
        for row in rows:
            self.assertEqual(row["status"], "unsupported")
            self.assertRegex(row["reason"], reason)


class NoVulkan(Vulkan):
    def test_without_a_driver_its_rows_say_what_is_missing_and_others_are_as_ever(self):
        *missing, traced = self.rows("--light", "sun", VK_ICD_FILENAMES="/no/driver", VK_DRIVER_FILES="/no/driver")
        self.assert_missing("Vulkan|libvulkan", *missing)
        self.assert_sound(traced)

    def test_a_word_that_trace_does_not_know_is_refused_with_the_known_ones(self):
        done = self.gnomon("run", "--scene", "fence", "--technique", "vulkan_rays:trace=both", "--out", "out")
        self.assertEqual(done.returncode, 2)
        self.assertIn("pipeline | query", done.stderr)
        self.assertFalse((self.dir / "out").exists())


class FakeVulkan(Vulkan):
    def setUp(self):
        super().setUp()
        if FAKE.is_file():
            return
        reason = self.rows("--light", "sun", out="none")[0]["reason"]
        self.assertIn("this program was built without Vulkan", reason, f"else there is {FAKE}")
        self.skipTest(reason)

    def faked(self, words, *arguments, status=0, out="out"):
        """With a Vulkan that does what these words say."""
        return self.rows(*(arguments or ("--light", "sun")), status=status, out=out, LD_LIBRARY_PATH=str(FAKE.parent), GNOMON_TEST_VULKAN=words)

    def loading(self, file):
        """With a loader that is this file."""
        (self.dir / "libvulkan.so.1").symlink_to(file)
        return self.rows("--light", "sun", LD_LIBRARY_PATH=str(self.dir))

    def test_without_a_fault_it_measures_all_rows(self):
        pipeline, query, traced = self.faked("")
        self.assert_sound(pipeline, query, traced)
        self.assertEqual([row["context"].get("gl_renderer") for row in (pipeline, query, traced)], ["Abacus", "Abacus", None])
        self.assertEqual(pipeline["device_stages"], {}, "a device without a clock")

    def test_a_lost_device_costs_its_row_in_whatever_stage(self):
        # Setup builds two trees and traces one ray, build makes two more trees; then come the answer, a warm-up and the samples.
        for call, stage, lost in (("CreateDevice:1", "open", 2), ("CreateRayTracingPipelinesKHR:1", "setup", 1),
                                  ("CmdBuildAccelerationStructuresKHR:1", "setup", 2), ("CmdTraceRaysKHR:1", "setup", 1),
                                  ("CmdBuildAccelerationStructuresKHR:3", "build", 2), ("CmdTraceRaysKHR:2", "resolve", 1),
                                  ("CmdTraceRaysKHR:4", "resolve", 1)):
            with self.subTest(call):
                rows = self.faked(f"lost={call}", status=1, out=call.replace(":", "_"))
                self.assert_sound(*rows[lost:])
                for row in rows[:lost]:
                    self.assertEqual(row["status"], "failed")
                    self.assertRegex(row["reason"], f"^threw in {stage}: .*{LOST}")
                    self.assertEqual([process for process in row["stages"].values() if process], [])
        self.assertEqual(workers(self.dir, keepers=True), [])

    def test_the_row_after_a_lost_device_has_a_new_one(self):
        lights = ("--light", "sun", "--light", "point")
        lost, query, traced, *others = self.faked(f"lost=CmdTraceRaysKHR:2 once={self.dir / 'lost'}", *lights, status=1)
        self.assertEqual((lost["light"], lost["status"]), ("sun", "failed"))
        self.assertRegex(lost["reason"], LOST)
        self.assertEqual(len(others), 3)
        self.assert_sound(query, traced, *others)
        self.succeed("run", "--scene", "fence", *WAYS, "--technique", "embree_rays", *SMALL, *lights, "--out", "out", "--resume", "--retry-failed")
        self.assertEqual([row["status"] for row in records(self.dir / "out")], 6 * ["ok"])

    def test_a_device_that_is_never_done_costs_its_row_after_the_timeout(self):
        hung, query, traced = self.faked("hangs=CmdTraceRaysKHR:2", "--light", "sun", "--timeout", HUNG, status=1)
        self.assertEqual((hung["status"], hung["reason"]), ("failed", f"hung in resolve: no answer within {HUNG} s"))
        self.assert_sound(query, traced)
        self.assert_gone()

    def test_render_of_a_lost_device_exits_with_1_and_writes_nothing(self):
        self.environment.update(LD_LIBRARY_PATH=str(FAKE.parent), GNOMON_TEST_VULKAN="lost=CmdTraceRaysKHR:2")
        done = self.gnomon("render", "--scene", "fence", "--light", "sun", "--technique", "vulkan_rays", "--size", "64x36", "--out", "out")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, rf"^gnomon: threw in resolve: .*{LOST}")
        self.assertEqual(list(self.dir.iterdir()), [])

    def test_a_device_without_memory_costs_its_row(self):
        for call, reason in (("CreateDevice:1", r"^threw in open: Abacus: out of memory of the device"),
                             ("AllocateMemory:5", r"^threw in setup: memory of a buffer: out of memory of the device")):
            with self.subTest(call):
                *full, traced = self.faked(f"full={call}", status=1, out=call.replace(":", "_"))
                for row in full:
                    self.assertEqual(row["status"], "failed")
                    self.assertRegex(row["reason"], reason)
                self.assert_sound(traced)

    def test_what_a_device_lacks_is_a_reason_of_the_row(self):
        for words, reason in (("devices=0", "^there is no Vulkan device that is the processor with rays$"),
                              ("lacks=VK_KHR_acceleration_structure", ": Abacus has no VK_KHR_acceleration_structure$"),
                              ("triangles=701", r"^702 triangles cast; Abacus takes 701 into a tree$")):
            with self.subTest(words):
                *missing, traced = self.faked(words, out=words)
                self.assert_missing(reason, *missing)
                self.assert_sound(traced)

    def test_one_way_of_tracing_works_without_the_other(self):
        pipeline, query, _ = self.faked("lacks=VK_KHR_ray_query")
        self.assert_missing("^Abacus has no VK_KHR_ray_query; trace = pipeline works there$", query)
        self.assert_sound(pipeline)
        pipeline, query, _ = self.faked("lacks=VK_KHR_ray_tracing_pipeline", out="other")
        self.assert_missing("^Abacus has no VK_KHR_ray_tracing_pipeline; trace = query works there$", pipeline)
        self.assert_sound(query)

    def test_without_a_loader_its_rows_name_the_package(self):
        *missing, traced = self.loading("/dev/null")  # as good as none
        self.assert_missing(r"^there is no Vulkan loader \(Debian: libvulkan1\): .*libvulkan\.so\.1: ", *missing)
        self.assert_sound(traced)

    def test_a_library_that_is_no_loader_is_not_called(self):
        *missing, _ = self.loading(os.environ.get("GNOMON_FAULTS") or ROOT / "build/release/gnomon_faults.so")
        self.assert_missing("^libvulkan.so.1 is no Vulkan loader: it has no vkGetInstanceProcAddr$", *missing)


if __name__ == "__main__":
    unittest.main()
