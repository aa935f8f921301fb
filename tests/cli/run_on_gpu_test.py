#!/usr/bin/python3 -IB
"""What scripts/run_on_gpu does where a driver fails, hangs or is ended, with programs in the bundle that only say what they were called with."""

import os
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PATIENCE, ROOT, wait_until  # noqa: E402

# A program of the bundle: notes its arguments, and makes a row of each run as the variables say.
STUB = """#!/bin/sh
printf '%s\\n' "$*" >>"$STUB_CALLS"
case "$*" in *vulkan_rays*) status=$STUB_RAYS ;; *) status=$STUB_DRAWN ;; esac
case "$*" in *--out*) ;; *) exit 0 ;; esac
while [ "$1" != --out ]; do shift; done
mkdir -p "$2"
case $status in
  hangs) echo $$ >"$STUB_CALLS.hangs"; exec sleep 600 ;;
  *) printf '{"status":"%s","reason":"because","gl_renderer":"Abacus","gl_version":"Vulkan 1.2"}\\n' "$status" >"$2/records.jsonl" ;;
esac
[ "$status" != failed ]
"""


class RunOnGpu(unittest.TestCase):
    def setUp(self):
        self.dir = Path(tempfile.mkdtemp(prefix="gnomon-on-gpu-"))
        self.addCleanup(shutil.rmtree, self.dir)
        bundle = self.dir / "bundle"
        for folder in ("bin/tools", "lib", "share/software"):
            (bundle / folder).mkdir(parents=True)
        shutil.copy(ROOT / "scripts/run_on_gpu", bundle)
        for name in ("gnomon", "gnomon_conformance_tests"):
            (bundle / "bin" / name).write_text(STUB)
            (bundle / "bin" / name).chmod(0o755)
        (bundle / "facts").write_text("libc=2.2\nstdcxx=6.0.1\ninterpreter=/lib64/ld-linux-x86-64.so.2\ninterpreter_at=\n")
        (bundle / "share/bundled").write_text("fence\n")
        (bundle / "share/drawing").write_text("shadow_map\nvulkan_rays\n")
        self.calls = self.dir / "calls"
        self.out = self.dir / "found"

    def start(self, *arguments, drawn="ok", rays="ok"):
        environment = dict(os.environ, STUB_CALLS=str(self.calls), STUB_DRAWN=drawn, STUB_RAYS=rays)
        return subprocess.Popen([self.dir / "bundle/run_on_gpu", *arguments, "--out", self.out], env=environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def found(self, process, status):
        """The summary, which is in the archive, too; and the calls of the programs."""
        text, words = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, status, text + words)
        summary = (self.out / "summary.txt").read_text()
        self.assertEqual(text, summary)
        with tarfile.open(self.dir / "found.tar.gz") as archive:
            self.assertEqual(archive.extractfile("found/summary.txt").read().decode(), summary)
        return summary, self.calls.read_text().splitlines()

    def test_all_parts_come_in_their_order(self):
        summary, calls = self.found(self.start(), 0)
        runs = [call.split("--out ")[1].split(" ")[0].rsplit("/", 1)[1] for call in calls if "--out" in call]
        self.assertEqual(runs, ["probe", "probe_vulkan", "gpu", "gpu_4k", "maps", "shadow_volumes", "soft", "masks"])
        self.assertIn("rays: Vulkan 1.2", summary)
        self.assertTrue(any("vulkan_rays-" in call for call in calls), "its rules")
        self.assertNotIn("findings", summary)

    def test_rays_that_fail_are_in_no_other_part(self):
        summary, calls = self.found(self.start(rays="failed"), 1)
        self.assertIn("rays in Vulkan are left out", summary)
        self.assertFalse([call for call in calls if "gtest" in call and "vulkan_rays" in call])
        for suite in ("gpu", "gpu_4k", "masks"):
            call = next(call for call in calls if f"/{suite} " in call + " ")
            self.assertIn("--filter ^(?!.* vulkan_rays)", call)

    def test_where_nothing_is_drawn_rays_are_measured_all_the_same(self):
        summary, calls = self.found(self.start(drawn="unsupported"), 3)
        self.assertIn("because", summary)
        self.assertEqual(len(calls), 4, calls)  # its version, two rows, and rays
        self.assertRegex(calls[-1], r"^run gpu --filter  \(vulkan_rays\|embree_rays\) ")

    def test_where_nothing_is_there_it_says_so(self):
        summary, calls = self.found(self.start(drawn="unsupported", rays="unsupported"), 3)
        self.assertIn("because", summary)
        self.assertEqual(len(calls), 3, calls)

    def test_a_signal_leaves_a_summary_and_nobody_behind(self):
        process = self.start(rays="hangs")
        hangs = self.calls.with_name("calls.hangs")
        wait_until(lambda: hangs.is_file() and hangs.read_text().strip(), "a row that hangs")
        process.send_signal(signal.SIGTERM)
        summary, _ = self.found(process, 1)
        self.assertIn("ended by a signal", summary)
        self.assertIn("rows: 1 done", summary)
        wait_until(lambda: not Path(f"/proc/{hangs.read_text().strip()}").exists(), "the row that hangs to be gone")


if __name__ == "__main__":
    unittest.main()
