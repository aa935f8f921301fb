#!/usr/bin/python3 -IB
"""Engines in a browser: what is faulty costs its own row, and what an engine does not have is unsupported."""

import json
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import GONE, HUNG, NUMBERS, ROOT, ProgramTest, records, wait_until  # noqa: E402

FOLDER = ROOT / "techniques/browser"
PACKAGES = {"babylon_js": "@babylonjs/core", "playcanvas": "playcanvas", "three_js": "three"}
VERSIONS = json.loads((FOLDER / "package.json").read_text())["dependencies"]
TITLES = {"babylon_js": "Babylon.js", "playcanvas": "PlayCanvas", "three_js": "three.js"}
HAS_MODULES = (FOLDER / "node_modules").is_dir()
IS_HERE = HAS_MODULES and shutil.which("node") and shutil.which("chromium")
# In the place of Node.js: answers as renderer.mjs does, and draws nothing.
NODE = """#!/usr/bin/python3 -IB
import json, os, sys, time
open(os.environ["GNOMON_FAKE_PLACE"] + "/pids", "a").write(f"{os.getpid()}\\n")
answers = os.fdopen(int(os.environ["GNOMON_ANSWERS"]), "w")
for line in sys.stdin:
    request = json.loads(line)
    print("still talking", flush=True)
    WHAT
    print(json.dumps({"version": "VERSION", "browser": "1.0", "gl": "none", "ms": 1}), file=answers, flush=True)
"""
# A ground with a box above it, under a light of each kind.
BOX = """
[[shape]]
kind = "plane"
center = [0, 0, 0]
normal = [0, 1, 0]
size = [6, 6]
casts = CASTS
[[shape]]
kind = "box"
min = [-0.5, 0.75, -0.5]
max = [0.5, 1.25, 0.5]
casts = CASTS
[[light]]
name = "point"
kind = "point"
position = [1, 4, 1]
[[light]]
name = "sun"
kind = "directional"
direction = [0.3, -1, 0.2]
[[light]]
name = "spot"
kind = "spot"
position = [1, 4, 1]
direction = [-0.3, -1, -0.2]
inner_degrees = 20
outer_degrees = 30
[[view]]
name = "view"
eye = [1, 5, 4]
target = [0, 0, 0]
fov_y_degrees = 45
"""


def run_on(test, scene, *techniques, more=(), status=0):
    """The records, one of each row."""
    out = test.dir / "run"
    shutil.rmtree(out, ignore_errors=True)
    named = [word for technique in techniques for word in ("--technique", technique)]
    test.succeed("run", "--scene", scene, *named, *NUMBERS, *more, "--quiet", "--out", out, status=status)
    return records(out)


class EnginesInABrowser(ProgramTest):
    def with_fake_node(self, version, what):
        folder = self.dir / "bin"
        folder.mkdir(exist_ok=True)
        for name, text in (("node", NODE.replace("VERSION", version).replace("WHAT", what)), ("chromium", "#!/bin/bash\nexit 1\n")):
            (folder / name).write_text(text)
            (folder / name).chmod(0o755)
        (self.dir / "pids").unlink(missing_ok=True)
        self.environment = dict(self.environment, PATH=f"{folder}:/usr/bin:/bin", GNOMON_FAKE_PLACE=str(self.dir))

    def all_ended(self):
        started = (self.dir / "pids").read_text().split()
        self.assertTrue(started)
        wait_until(lambda: not any(Path("/proc", process).exists() for process in started), f"the processes {started} to be gone", GONE)

    @unittest.skipUnless(HAS_MODULES, "npm's modules are not there")
    def test_another_version_is_refused(self):
        for technique, package in PACKAGES.items():
            with self.subTest(technique):
                self.with_fake_node("0.1.2", "pass")
                (record,) = run_on(self, "single_triangle", technique, more=("--light", "point"), status=1)
                wanted = VERSIONS[package] if technique != "three_js" else "r" + VERSIONS[package].split(".")[1]
                self.assertIn(f"{TITLES[technique]} 0.1.2 is here; the adapter is made for {wanted}", record["reason"])
                self.all_ended()

    @unittest.skipUnless(HAS_MODULES, "npm's modules are not there")
    def test_faulty_renderers_cost_their_row_and_end(self):
        for what, says in (
            ("if request['do'] == 'relight': sys.exit(5)", "ended (5) when it was to answer relight"),
            ("if request['do'] == 'relight': print('what?', file=answers, flush=True); continue", "answered relight with no JSON: what?"),
            ("if request['do'] == 'frame': print('{\"error\": \"the context is lost\"}', file=answers, flush=True); continue", "the context is lost"),
            ("if request['do'] == 'relight': time.sleep(600)", f"hung in relight: no answer within {HUNG} s"),
            ("pass", "no picture was written"),
        ):
            with self.subTest(what):
                self.with_fake_node(VERSIONS["playcanvas"], what)
                (record,) = run_on(self, "single_triangle", "playcanvas", more=("--light", "point", "--timeout", HUNG), status=1)
                self.assertIn(says, record["reason"])
                self.all_ended()

    @unittest.skipUnless(IS_HERE, "an engine's modules, Node.js or Chromium are not there")
    def test_what_an_engine_does_not_have_is_unsupported(self):
        scene = self.write("box.toml", BOX.replace("CASTS", "true"))
        for technique, light, says in (
            ("babylon_js:shadows={pcf,contact_hardening}", "point", "Babylon.js gives point lights Poisson samples in the place of "),
            ("babylon_js:shadows={blurred_exponential,blurred_close_exponential}", "point", "Babylon.js gives point lights maps without blur"),
            ("babylon_js:shadows=cascaded", "spot", "cascades of Babylon.js are for directional lights"),
            ("playcanvas:shadows={pcf5,vsm}", "point", "PlayCanvas gives point lights pcf3 in the place of "),
            ("playcanvas:cascades={2,4}", "spot", "cascades of PlayCanvas are for directional lights"),
            ("playcanvas:shadows=pcss,depth_bits=16", "sun", "maps for pcss have 32 bits in PlayCanvas"),
            ("three_js:shadows=vsm", "point", "three.js has no variance maps for point lights"),
            ("three_js:shadows=pcf_soft", "sun", "three.js r187 draws PCFShadowMap in the place of PCFSoftShadowMap"),
        ):
            for record in run_on(self, scene, technique, more=("--light", light)):
                with self.subTest(f"{technique} {record['settings']}"):
                    self.assertEqual(record["status"], "unsupported", record)
                    self.assertIn(says, record["reason"])


if __name__ == "__main__":
    unittest.main()
