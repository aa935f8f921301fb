#!/usr/bin/python3 -IB
"""Adapters of engines: what is absent, of another version, or faulty costs its own row; what is there agrees with the reference."""

import os
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import GONE, HUNG, NUMBERS, PROGRAM_SHEET, ProgramTest, records, wait_until  # noqa: E402

ENGINES = ("babylon_js", "cycles", "eevee", "filament", "godot", "ogre", "open_scene_graph", "playcanvas", "pov_ray", "three_js")
# What each of these prints says who it is, as the true ones do.
POV_RAY = """#!/bin/bash
echo $$ >>"$GNOMON_FAKE_PLACE/pids"
if [ "$1" = --version ]; then echo "POV-Ray VERSION" >&2; exit; fi
WHAT
"""
BLENDER = """#!/usr/bin/python3
import json, os, sys, time
open(os.environ["GNOMON_FAKE_PLACE"] + "/pids", "a").write(f"{os.getpid()}\\n")
print("Blender VERSION, and more that nobody asked for", flush=True)
answers = os.fdopen(int(os.environ["GNOMON_ANSWERS"]), "w")
for line in sys.stdin:
    request = json.loads(line)
    print("still talking", flush=True)
    WHAT
    print(json.dumps({"version": "VERSION"}), file=answers, flush=True)
"""
# Renders a white picture the first time, and WHAT the next; says each time that all went well, in 2 ms: no stage is then repeated.
FORGETFUL = """#!/usr/bin/python3
import os, sys, time
from pathlib import Path
place, picture = Path(os.environ["GNOMON_FAKE_PLACE"]), Path("scene.ppm")
old = place / "old.ppm"
if "--version" in sys.argv:
    sys.exit(print("POV-Ray VERSION"))
width, height = (next(int(word[2:]) for word in sys.argv if word.startswith(letter)) for letter in ("+W", "+H"))
def write(width, height):
    picture.write_bytes(b"P6\\n# a remark\\n%d %d\\n65535\\n" % (width, height) + bytes([255]) * 6 * width * height)
if not old.exists():
    write(width, height)
    os.link(picture, old)
else:
    WHAT
print("Parse Time: x (0.0 seconds)\\nTrace Time: x (0.002 seconds)")
"""
# An engine that draws to a display: lit everywhere, which needs no engine at all.
LIT_ENGINE = """
import numpy as np
from gnomon_engine import Engine
from gnomon_technique import serve

class Lit(Engine):
    needs_display = True
    def start(self):
        print("an engine that says what it likes")
        self.maker = "Lit 1.0"
    def load(self, scene):
        pass
    def place_light(self, light):
        pass
    def frame(self, camera, width, height, shadows):
        WHAT
        return np.full((height, width), 200), 0.5

serve(Lit)
"""
LIT_SHEET = PROGRAM_SHEET.format(id="lit_engine").replace("-IB", "-B")  # not isolated: it imports gnomon_engine


def is_there(process):
    try:
        state = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


class Engines(ProgramTest):
    def setUp(self):
        super().setUp()
        self.bin = self.dir / "bin"
        self.bin.mkdir()
        self.environment = dict(self.environment, PATH=f"{self.bin}:/usr/bin:/bin", GNOMON_FAKE_PLACE=str(self.dir))

    def fake(self, name, text, version, what):
        file = self.bin / name
        file.write_text(text.replace("VERSION", version).replace("WHAT", what))
        file.chmod(0o755)

    def run_one(self, technique, *more, before=(), status=1):
        """The one row's record."""
        out = self.dir / "run"
        shutil.rmtree(out, ignore_errors=True)
        self.succeed(*before, "run", "--scene", "single_triangle", "--light", "point", "--technique", technique, *NUMBERS, *more, "--quiet",
                     "--out", out, status=status)
        (record,) = records(out)
        return record

    def all_ended(self, *names):
        """Whether what was started, and said its process id, has ended; a killed process may take a moment."""
        started = [int(line) for line in (self.dir / "pids").read_text().split()]
        self.assertTrue(started)
        wait_until(lambda: not any(map(is_there, started)), f"the processes {started} to be gone", GONE)

    def test_what_is_absent_says_what_to_install(self):
        self.environment["PATH"] = str(self.bin)
        for engine in ENGINES:
            with self.subTest(engine):
                record = self.run_one(engine, status=0)
                self.assertEqual(record["status"], "unsupported")
                self.assertIn("scripts/setup --engines", record["reason"])

    def test_none_runs_unless_it_is_named(self):
        self.write("star.toml", 'title = "T"\n[[group]]\nscenes = ["single_triangle"]\nlights = ["point"]\ntechniques = ["*"]\n')
        said = self.succeed("run", "star.toml", "--dry-run")
        self.assertIn("shadow_map", said)
        for engine in ENGINES:
            self.assertNotIn(engine, said)

    def test_another_version_is_refused(self):
        self.fake("povray", POV_RAY, "4.0.0", "exit 1")
        self.assertRegex(self.run_one("pov_ray")["reason"], "POV-Ray 4.0.0 is here; the adapter is made for 3.7")
        self.fake("blender", BLENDER, "9.3.1", "")
        self.assertRegex(self.run_one("cycles")["reason"], "Blender 9.3.1 is here; the adapter is made for 3.4")
        self.all_ended()

    def test_faulty_renderers_cost_their_row_and_end(self):
        pov_ray, blender = ("pov_ray", "povray", POV_RAY, "3.7.0"), ("cycles", "blender", BLENDER, "3.4.1")
        for (technique, program, text, version), what, says in (
            (pov_ray, "echo chatter; echo 'Parse Error: no camera' >&2; exit 1", "povray ended with 1: Parse Error: no camera"),
            (pov_ray, "exit 0", "povray says no times"),
            (pov_ray, "sleep 600 & sleep 600", f"hung in resolve: no answer within {HUNG} s"),
            (blender, "if request['do'] == 'build': print('what?', file=answers, flush=True); continue", "Blender answered build with no JSON: what?"),
            (blender, "if request['do'] == 'build': sys.exit(4)", "Blender ended (4) when it was to answer build"),
            (blender, "if request['do'] == 'relight': print('{\"error\": \"no such light\"}', file=answers, flush=True); continue", "no such light"),
            (blender, "if request['do'] == 'build': time.sleep(600)", f"hung in build: no answer within {HUNG} s"),
        ):
            with self.subTest(what):
                self.fake(program, text, version, what)
                self.assertIn(says, self.run_one(technique, "--timeout", HUNG)["reason"])
                self.all_ended()

    def test_a_picture_of_before_is_no_answer(self):
        for what, says in (
            ("pass", "povray says that it rendered, but wrote no picture"),
            ("os.utime(old, (1, 1)); os.link(old, picture)", "povray's picture is older than its scene"),
            ("write(width, height - 1)", "a PPM of 160 x 90 and 16 bits is wanted"),
            ("picture.write_bytes(old.read_bytes()[:-1])", "a PPM of 160 x 90 and 16 bits is wanted"),
            ("picture.write_text('sorry')", "begins with 'sorry'"),
            ("write(width, height)", None),
        ):
            with self.subTest(what):
                (self.dir / "old.ppm").unlink(missing_ok=True)
                self.fake("povray", FORGETFUL, "3.7.0", what)
                record = self.run_one("pov_ray", status=1 if says else 0)
                self.assertIn(says or "", record.get("reason", ""))

    def test_a_file_of_before_is_no_answer(self):
        write = "np.full((height, width), 200, np.uint8).tofile(picture.path)"
        for what, says in (
            ("pass", "no picture was written"),
            (f"{write}; os.utime(picture.path, (1, 1))", "picture is "),
            (f"{write}; os.truncate(picture.path, 14399)", "picture has 14399 bytes; 14400 are wanted, of 160 x 90 pixels"),
            (write, None),
        ):
            with self.subTest(what):
                asked = "import os; from gnomon_engine import Awaited; picture = Awaited(self.folder, 'picture')"
                before = self.lit_engine(f"{asked}; {what}; return picture.array(np.uint8, height, width), 0.5")
                record = self.run_one("lit_engine", before=before, status=1 if says else 0)
                self.assertIn(says or "", record.get("reason", ""))

    def lit_engine(self, what=""):
        self.write("lit_engine.py", LIT_ENGINE.replace("WHAT", what or "pass"))
        return ["--program", self.write("lit_engine.toml", LIT_SHEET)]

    @unittest.skipUnless(shutil.which("Xvfb"), "there is no Xvfb")
    def test_frames_are_drawn_in_pairs_of_alternating_order(self):
        # The frame with shadows takes 0.3 ms; that without 0.1 ms where it comes second, 0.2 ms where it comes first.
        order = self.dir / "order"
        before = self.lit_engine(f"""self.drawn = getattr(self, "drawn", "") + "-s"[shadows]; open({str(order)!r}, "w").write(self.drawn)
        return np.full((height, width), 200), 0.3 if shadows else 0.1 + len(self.drawn) % 2 / 10""")
        record = self.run_one("lit_engine", before=before, status=0)
        counts = {count["name"]: count["value"] for count in record["counts"]}
        self.assertIn(round(counts["frame_difference"], 6), (0.1, 0.15, 0.2))
        self.assertAlmostEqual(counts["plain_frame"] + counts["frame_difference"], 0.3)
        self.assertIn(order.read_text()[-4:], ("s--s", "-ss-"))

    @unittest.skipUnless(shutil.which("Xvfb"), "there is no Xvfb")
    def test_a_display_ends_with_who_needs_it(self):
        record = self.run_one("lit_engine", before=self.lit_engine(), status=0)
        self.assertEqual(record["status"], "ok")
        self.assertEqual(record["context"]["plugin"]["maker"], "Lit 1.0")
        self.assertIn({"name": "plain_frame", "value": 0.5, "unit": "ms"}, record["counts"])
        self.assert_gone()
        record = self.run_one("lit_engine", "--timeout", HUNG, before=self.lit_engine("import time; time.sleep(60)"))
        self.assertIn("hung in resolve", record["reason"])
        self.assert_gone()

    def test_a_display_that_does_not_open_fails_the_row(self):
        (self.bin / "Xvfb").write_text("#!/bin/bash\necho 'no screens' >&2; exit 3\n")
        (self.bin / "Xvfb").chmod(0o755)
        self.assertIn("Xvfb opened no display", self.run_one("lit_engine", before=self.lit_engine())["reason"])

    def test_engines_that_are_here_draw_shadows_and_end(self):
        self.environment["PATH"] = os.environ["PATH"]
        for engine in ENGINES:
            with self.subTest(engine):
                out = self.dir / engine
                self.succeed("run", "--scene", "box_city", "--light", "sun", "--technique", engine, "--technique", "unshadowed", "--truth", "mesh",
                             *NUMBERS, "--quiet", "--out", out)
                record, lit = records(out)
                self.assert_gone()
                if record["status"] == "unsupported":  # it is not here
                    continue
                wrong = record["metrics"]["mesh"]["wrong_rate"]
                self.assertLess(wrong, lit["metrics"]["mesh"]["wrong_rate"] / 4)
                self.assertTrue(record["context"]["plugin"]["maker"])
                self.assertLess(record["stages"]["resolve"][0][0], record["harness_stages"]["resolve"][0][0])

    @unittest.skipUnless(shutil.which("povray"), "there is no POV-Ray")
    def test_pov_ray_in_a_folder_of_any_name(self):
        self.environment["PATH"] = os.environ["PATH"]
        for name in ("my runs", "a=b;c#d", "J\u00f6rg", "it's \"so\"", "-A", "+W5", "@x", "$HOME `ls` %s", "a\nb"):
            with self.subTest(name):
                out = Path(self.dir, "named", name)
                self.succeed("run", "--scene", "fence", "--light", "point", "--technique", "pov_ray", *NUMBERS, "--quiet", "--out", out)
                self.assertEqual(records(out)[0]["metrics"]["shape"]["wrong_rate"], 0)

    @unittest.skipUnless(shutil.which("povray"), "there is no POV-Ray")
    def test_pov_ray_agrees_with_the_reference(self):
        self.environment["PATH"] = os.environ["PATH"]
        out = self.dir / "run"
        self.succeed("run", "--scene", "fence", "--light", "point", "--light", "sun", "--technique", "pov_ray", *NUMBERS, "--quiet", "--out", out)
        self.succeed("run", "--scene", "cornell_box", "--light", "ceiling", "--technique", "pov_ray:grid=8", *NUMBERS, "--quiet", "--out", self.dir / "soft")
        for record in records(out):
            self.assertEqual(record["metrics"]["shape"]["wrong_rate"], 0)
            self.assertRegex(record["context"]["plugin"]["maker"], r"POV-Ray 3\.7")
        (record,) = records(self.dir / "soft")
        # An edge of a shadow crosses some 8 of the 64 cells of the grid, so that a share may be off by half of these.
        self.assertLess(record["metrics"]["shape"]["error"], 8 / 2 / 64)


if __name__ == "__main__":
    unittest.main()
