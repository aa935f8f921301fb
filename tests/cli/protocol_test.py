#!/usr/bin/python3 -IB
"""Techniques that are programs of their own: what a sound one gives, and what faulty ones cost."""

import json
import os
import re
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import program  # noqa: E402
from program import HUNG, NUMBERS, PROGRAM_SHEET, ROOT, SMALL, ProgramTest, records  # noqa: E402


# A program of nothing but the protocol: lit everywhere. `fault` is code that may do otherwise, called with each request.
LIT = """
import json, sys, time, os, struct

def say(answer):
    print(json.dumps(answer), flush=True)

def mask_of(request, value=1.0):
    height, width = request["mask"]["shape"]
    with open(request["mask"]["file"], "r+b") as file:
        file.write(struct.pack("<f", value) * (width * height))

def sound(request):
    if request["do"] == "hello":
        return {"protocol": 1}
    if request["do"] == "resolve":
        mask_of(request)
    return {"ms": 0.0}

def fault(request):
    return None
FAULT
for line in sys.stdin:
    request = json.loads(line)
    answer = fault(request)
    say(sound(request) if answer is None else answer)
"""

# By technique: what it does instead, and how its row fails.
FAULTS = {
    "says_garbage": ("def fault(r):\n  if r['do'] == 'build': print('hello there'); sys.stdout.flush()",
                     r"threw in build: python3 answered build with a line that is no JSON object: hello there"),
    "half_a_line": ("def fault(r):\n  if r['do'] == 'build': sys.stdout.write('{\"ms\":'); sys.stdout.flush(); sys.exit(4)",
                    r"threw in build: python3 ended in build, in the middle of a line: \{\"ms\":: exit status 4"),
    "says_too_much": ("def fault(r):\n  if r['do'] == 'build': print('{\"ms\": 0}\\n{\"ms\": 0}', flush=True); time.sleep(60)",
                      r"python3 said more than it was asked: \{\"ms\": 0"),
    "says_nothing": ("def fault(r):\n  if r['do'] == 'relight': time.sleep(60)", rf"hung in relight: no answer within {HUNG} s"),
    "dies": ("def fault(r):\n  if r['do'] == 'resolve': os.kill(os.getpid(), 11)",
             r"threw in resolve: python3 crashed in resolve: Segmentation fault \(signal 11\)"),
    "throws": ("def fault(r):\n  if r['do'] == 'relight': return {'error': 'the tree has no root'}",
               r"threw in relight: python3 says in relight: the tree has no root"),
    "other_protocol": ("def fault(r):\n  if r['do'] == 'hello': return {'protocol': 7}",
                       r"threw in setup: .*speaks protocol 7; this program speaks 1"),
    "no_list": ("def fault(r):\n  if r['do'] == 'build': return [1]", r"answered build with a line that is no JSON object: \[1\]"),
    "odd_key": ("def fault(r):\n  if r['do'] == 'build': return {'time': 1}", r"build was answered with the key time; it may have: ms, counts"),
    "slow_clock": ("def fault(r):\n  if r['do'] == 'build': return {'ms': 1e6}",
                   r"build took 1e\+06 ms by the technique's own clock, [0-9.]+ ms by the harness's"),
    "odd_count": ("def fault(r):\n  if r['do'] == 'build': return {'counts': [{'name': 'x'}]}", r"the count .* has not name, value"),
    "leaves_out": ("def fault(r):\n  if r['do'] == 'resolve': return {'ms': 0}", r"the mask's pixel \(0, 0\) was not written"),
    "writes_nan": ("def fault(r):\n  if r['do'] == 'resolve': mask_of(r, float('nan')); return {'ms': 0}", r"the mask's pixel \(0, 0\) is nan, outside 0 \.\. 1"),
    "writes_two": ("def fault(r):\n  if r['do'] == 'resolve': mask_of(r, 2.0); return {'ms': 0}", r"the mask's pixel \(0, 0\) is 2, outside 0 \.\. 1"),
    "too_small": ("def fault(r):\n  if r['do'] == 'resolve': os.truncate(r['mask']['file'], 12); return {'ms': 0}",
                  r"the mask has 12 bytes; 57600 are wanted"),
    "too_large": ("def fault(r):\n  if r['do'] == 'resolve': os.truncate(r['mask']['file'], 100000); return {'ms': 0}",
                  r"the mask has 100000 bytes; 57600 are wanted"),
    "removes_it": ("def fault(r):\n  if r['do'] == 'resolve': os.remove(r['mask']['file']); return {'ms': 0}", r"the mask .*mask\.f32 is gone"),
}


class Protocol(ProgramTest):
    def program(self, name, code=None, sheet="", fault=""):
        """ID.toml and ID.py in the test's folder; the option that loads it."""
        self.write(f"{name}.py", code or LIT.replace("FAULT", fault))
        return ["--program", self.write(f"{name}.toml", PROGRAM_SHEET.format(id=name) + sheet)]

    def run_one(self, name, options, *more, status=0, scene="single_triangle"):
        self.succeed(*options, "run", "--scene", scene, "--technique", name, "--light", "sun", *NUMBERS, *more, "--out", "out", status=status)
        return records(self.dir / "out")

    def test_a_sound_one_has_rows_like_any_other(self):
        options = self.program("lit", fault="", sheet="""
stages = ["build", "resolve"]
[[parameter]]
name = "depth"
value = 3
min = 1
max = 9
unit = "level"
stage = "build"
sentence = "How deep."
[[parameter]]
name = "mode"
value = "fast"
choices = ["fast", "slow"]
stage = "resolve"
sentence = "How."
[[parameter]]
name = "is_soft"
value = false
stage = "resolve"
sentence = "Whether."
""")
        rows = self.run_one("lit:depth={2,5}", options, "--technique", "unshadowed")
        self.assertEqual([(r["technique"], r["status"], r["parameters"]) for r in rows],
                         [("lit", "ok", {"depth": 2, "mode": "fast", "is_soft": "false"}), ("lit", "ok", {"depth": 5, "mode": "fast", "is_soft": "false"}),
                          ("unshadowed", "ok", {})])
        for key in ("metrics", "classes", "causes"):
            self.assertEqual(rows[0][key], rows[2][key], key)
        # Its own clock counts, the harness's is beside it; a stage that it is not told of takes no time.
        self.assertEqual(rows[0]["stages"]["resolve"], [[0.0]])
        self.assertGreater(rows[0]["harness_stages"]["resolve"][0][0], 0)
        self.assertEqual(rows[0]["stages"]["relight"], [[0.0]])
        self.assertEqual(rows[2]["harness_stages"], {})
        self.assertGreater(rows[0]["bytes"], 0)  # what it has grown by
        # Its rows run again when its files have changed.
        again = [*options, "run", "--scene", "single_triangle", "--technique", "lit:depth={2,5}", "--technique", "unshadowed", "--light", "sun", *NUMBERS, "--out", "out", "--resume"]
        self.assertEqual(rows[0]["context"]["plugin"]["path"], str(self.dir / "lit.toml"))
        self.assertNotIn("plugin", rows[2]["context"])
        self.succeed(*again)
        self.assertEqual([r["context"]["plugin"]["hash"] for r in records(self.dir / "out")[:2]], [rows[0]["context"]["plugin"]["hash"]] * 2)
        self.assertEqual(len(records(self.dir / "out")), 3)
        with open(self.dir / "lit.py", "a", encoding="utf-8") as file:
            file.write("# changed\n")
        self.succeed(*again)
        hashes = {r["context"]["plugin"]["hash"] for r in records(self.dir / "out") if r["technique"] == "lit"}
        self.assertGreater(len(hashes - {rows[0]["context"]["plugin"]["hash"]}), 0)
        described = self.succeed(*options, "describe", "lit")
        for words in ("S.", "depth", "1 .. 9 level", "How deep.", "fast | slow"):
            self.assertIn(words, described)
        self.refuse(*options, "run", "--scene", "fence", "--technique", "lit:depth=10", says=["lit.depth = 10 is outside 1 .. 9 level"])
        self.assert_gone()

    def test_peak_memory_is_the_workers_and_the_programs_together(self):
        hold = "held = bytes(range(256)) * (800 << 10)"  # 200 MiB
        once = "return {'ms': 2}"  # a stage of no time is repeated 64 times
        peaks = {}
        for name, fault in {
            "small": "",
            "large": f"def fault(r):\n  global held\n  if r['do'] == 'build': {hold}; {once}",
            "was_large": f"def fault(r):\n  if r['do'] == 'build': {hold}; {once}",
            "child": f"""
import subprocess
def fault(r):
    if r["do"] == "build" and "child" not in globals():
        global child
        child = subprocess.Popen([sys.executable, "-c", "{hold}; print(flush=True); input()"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        child.stdout.readline()
""",
            "ended_child": f"""
import subprocess
def fault(r):
    if r["do"] == "build":
        subprocess.run([sys.executable, "-c", "{hold}"], check=True)
        {once}
""",
        }.items():
            options = self.program(name, fault=fault)
            self.succeed(*options, "run", "--scene", "single_triangle", "--technique", name, "--light", "sun", *NUMBERS, "--out", name)
            row = records(self.dir / name)[0]
            self.assertEqual(row["status"], "ok", row["reason"])
            peaks[name] = row["peak_bytes"] / 2**20
        for name in ("large", "was_large", "child"):
            self.assertTrue(190 < peaks[name] - peaks["small"] < 260, peaks)
        self.assertLess(abs(peaks["ended_child"] - peaks["small"]), 50, peaks)
        self.assert_gone()

    def test_settings_and_files_are_what_the_protocol_says(self):
        code = LIT.replace("FAULT", """
import numpy
told = []
def fault(r):
    told.append(r)
    if r["do"] == "resolve":
        position = numpy.load(r["gbuffer"]["arrays"]["position"]["file"])
        mesh = numpy.load(r["gbuffer"]["arrays"]["mesh"]["file"])
        assert position.shape == (3, 90, 160) and mesh.dtype == numpy.uint32
        assert numpy.all(position[:, mesh == 0xFFFFFFFF] == 0) and numpy.all(mesh[45:][mesh[45:] != 0xFFFFFFFF] < 2)
        scene = json.load(open(told[2]["scene"]["file"]))
        for name, shape in (("position", (4 + 3, 3)), ("triangle", (2 + 1, 3)), ("mesh", (3,))):
            array = scene["arrays"][name]
            data = open(array["file"], "rb").read()
            assert len(data) == array["offset"] + 4 * numpy.prod(array["shape"]), name
            assert tuple(array["shape"]) == shape == numpy.load(array["file"]).shape, name
        assert [m["triangles"] for m in scene["meshes"]] == [2, 1] and scene["meshes"][1]["first_vertex"] == 4
        gltf = json.load(open(told[2]["scene"]["gltf"]))
        assert {l["type"] for l in gltf["extensions"]["KHR_lights_punctual"]["lights"]} == {"point", "directional"}
        assert os.path.getsize(r["gbuffer"]["exr"]) > 1000
        assert r["settings"] == {"depth": 0.5, "is_soft": True}, r["settings"]
        assert [t["do"] for t in told] == ["hello", "setup", "build", "relight", "resolve"][:len(told)] or len(told) > 5
        assert told[3]["light"]["kind"] == "directional" and r["view"]["fov_y_degrees"] > 0
""").replace("import json", "#!\nimport json")
        sheet = """
scene = ["arrays", "gltf"]
gbuffer = ["arrays", "exr"]
[[parameter]]
name = "depth"
value = 0.25
min = 0
max = 1.0
stage = "resolve"
sentence = "How deep."
[[parameter]]
name = "is_soft"
value = true
stage = "resolve"
sentence = "Whether."
"""
        rows = self.run_one("reads:depth=0.5", self.program("reads", code, sheet))
        self.assertEqual([(r["status"], r["reason"]) for r in rows], [("ok", "")])

    def test_one_in_the_folder_of_techniques_needs_no_option(self):
        root = self.dir / "root"
        (root / "techniques").mkdir(parents=True)
        for name in ("scenes", "bench"):
            (root / name).symlink_to(ROOT / name)
        (root / "techniques/lit.toml").write_text(PROGRAM_SHEET.format(id="lit"))
        (root / "techniques/lit.py").write_text(LIT.replace("FAULT", ""))
        self.environment["GNOMON_ROOT"] = str(root)
        self.addCleanup(self.environment.update, GNOMON_ROOT=str(ROOT))
        self.assertIn("lit", [entry["id"] for entry in json.loads(self.succeed("list", "techniques", "--json"))])
        self.assertEqual([(r["technique"], r["status"]) for r in self.run_one("lit", [])], [("lit", "ok")])

    def test_each_fault_costs_its_own_row_and_says_what_happened(self):
        options, arguments = [], []
        for name, (fault, _) in FAULTS.items():
            options += self.program(name, fault=fault)
            arguments += ["--technique", name]
        self.succeed(*options, "run", *arguments, "--technique", "unshadowed", "--scene", "single_triangle", "--light", "sun", *SMALL,
                     "--timeout", HUNG, "--out", "out", status=1)
        rows = {r["technique"]: r for r in records(self.dir / "out")}
        self.assertEqual(rows.pop("unshadowed")["status"], "ok")
        self.assertEqual(set(rows), set(FAULTS))
        for name, row in rows.items():
            with self.subTest(name):
                self.assertEqual((row["status"], row["mask"]), ("failed", None))
                self.assertRegex(row["reason"], FAULTS[name][1])
        self.assert_gone()

    def test_nothing_stays_behind(self):
        # One leaves a child in a session of its own, one ignores the end of its input; both are gone after the run, and their files.
        options = self.program("parent", fault="""
import subprocess
def fault(r):
    if r["do"] == "build":
        subprocess.Popen(["/bin/sleep", "987"], start_new_session=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
""")
        options += self.program("stays", code=LIT.replace("FAULT", "") + "\ntime.sleep(987)\n")
        self.succeed(*options, "run", "--scene", "single_triangle", "--technique", "parent", "--technique", "stays", "--light", "sun", *NUMBERS, "--out", "out")
        self.assertEqual([r["status"] for r in records(self.dir / "out")], ["ok", "ok"])
        self.assert_gone()
        self.assertEqual([p for p in Path("/dev/shm").glob("gnomon*") if f"-{os.getpid()}" in p.name], [])
        self.assertFalse((self.dir / "out/.scratch").exists())

    def test_what_is_not_there_is_unsupported_with_the_way_to_get_it(self):
        options = self.program("needy", sheet='[[need]]\nprogram = "no_such_program"\ninstall = "apt install nothing"\n')
        options += self.program("needs_run", sheet='[[need]]\nruns = ["/bin/false"]\ninstall = "pray"\n')
        self.write("absent.toml", PROGRAM_SHEET.format(id="absent").replace('"/usr/bin/python3", "-IB"', '"./absent"'))
        options += ["--program", self.dir / "absent.toml"]
        options += self.program("hard_only", sheet='lights = ["point"]\n')
        arguments = [word for name in ("needy", "needs_run", "absent", "hard_only") for word in ("--technique", name)]
        self.succeed(*options, "run", *arguments, "--scene", "single_triangle", "--light", "sun", *NUMBERS, "--out", "out")
        rows = records(self.dir / "out")
        self.assertEqual({r["status"] for r in rows}, {"unsupported"})
        for row, words in zip(rows, ("no_such_program is not on this machine: apt install nothing", "/bin/false fails here: pray",
                                     "absent is not on this machine", "it knows no directional lights; it knows point")):
            self.assertIn(words, row["reason"])

    def test_support_and_explanations_are_asked_where_they_are_answered(self):
        options = self.program("asked", sheet='answers = ["supports", "explain"]\napproximate = "no"\n[[cause]]\nid = "lazy"\nsentence = "It did nothing."\ncolor = [0, 70, 40]\n', fault="""
def fault(r):
    if r["do"] == "supports":
        assert r["scene"]["file"] and r["light"]["name"] and r["view"]["eye"]
        return {"support": "approximate", "why": "a " + r["light"]["kind"]} if r["light"]["kind"] == "directional" else {"support": "unsupported", "why": "not mine"}
    if r["do"] == "explain":
        return {"explanations": [{"covered": False} if pixel % 2 else {"cause": "lazy"} for pixel in r["pixels"]]}
""")
        self.succeed(*options, "run", "--scene", "single_triangle", "--technique", "asked", *NUMBERS, "--light", "sun", "--light", "point", "--out", "out")
        point, sun = sorted(records(self.dir / "out"), key=lambda row: row["light"])
        self.assertEqual((point["status"], point["reason"]), ("unsupported", "not mine"))
        self.assertEqual((sun["status"], sun["support"], sun["reason"]), ("ok", "approximate", "a directional"))
        self.assertEqual({cause for cause, count in sun["causes"].items() if count}, {"beyond_coverage", "lazy"})

    def test_masks_may_be_pictures(self):
        self.succeed("render", "--scene", "single_triangle", "--technique", "embree_rays", "--light", "sun", "--size", "160x90", "--out", "true")
        for kind in ("exr", "png"):
            options = self.program(f"copies_{kind}", sheet=f'mask = "{kind}"\n', fault=f"""
import shutil
def fault(r):
    if r["do"] == "resolve":
        shutil.copy({str(self.dir / "true")!r} + "/mask.{kind}", r["mask"]["file"])
        return {{"ms": 0}}
""")
            row, = self.run_one(f"copies_{kind}", options)
            self.assertEqual((row["status"], row["metrics"]["shape"]["wrong_rate"]), ("ok", 0))
            shutil.rmtree(self.dir / "out", ignore_errors=True)

    def test_a_description_that_is_none_is_refused_with_its_line(self):
        for sheet, says in (
            ("colour = 1\n", ["program has no key 'colour'", "(", ":7"]),
            ("mask = \"gif\"\n", ["program.mask = 'gif' is not one of float32, exr, png"]),
            ("lights = [\"sun\"]\n", ["'sun'", "a list of point, spot, directional, rect, disc, sphere"]),
            ("stages = [\"build\"]\n", ["a list with resolve, which makes the mask"]),
            ("[[parameter]]\nname = \"A b\"\nvalue = 1\nmin = 0\nmax = 2\nstage = \"build\"\nsentence = \"S.\"\n", ["parameter.name = 'A b'"]),
            ("[[parameter]]\nname = \"a\"\nvalue = 3\nmin = 0\nmax = 2\nstage = \"build\"\nsentence = \"S.\"\n", ["parameter.value = 3 is not within 0 .. 2"]),
            ("[[parameter]]\nname = \"a\"\nvalue = 1\nmin = 0\nmax = 2\nstage = \"later\"\nsentence = \"S.\"\n", ["'later'", "is not one of setup, build, relight, resolve"]),
            ("[[need]]\ninstall = \"x\"\n", ["one of program and runs, and only one"]),
            ("[[cause]]\nid = \"acne\"\nsentence = \"S.\"\ncolor = [1, 2, 3]\n", ["acne"]),
            ("[[cause]]\nid = \"mine\"\nsentence = \"S.\"\ncolor = [1, 2, 300]\n", ["0 .. 255"]),
            ("scene = [\"obj\"]\n", ["'obj'", "a list of arrays, gltf"]),
        ):
            with self.subTest(sheet):
                self.refuse(*self.program("bad", sheet=sheet), "list", says=says)
        self.refuse("--program", self.write("bad.toml", "title = \n"), "list", says=["bad.toml"])
        self.refuse("--program", self.write("empty.toml", ""), "list", says=["lacks the key 'title'"])
        self.refuse("--program", "nowhere.toml", "list", says=["nowhere.toml"])
        taken = self.program("shadow_map")
        self.refuse(*taken, "list", says=["technique shadow_map", "shadow_map.toml", "is there already: that is built in"])
        lit = self.program("lit2")
        (self.dir / "copy").mkdir()
        copy = shutil.copy(lit[1], self.dir / "copy")
        self.refuse(*lit, "--program", copy, "list", says=["technique lit2", str(copy), "is there already: of"])
        self.refuse(*self.program("Bad-Name"), "list", says=["'Bad-Name' is no id"])

    def test_a_program_keeps_its_files_when_another_technique_ends_its_process(self):
        self.succeed("--plugin", program.FAULTS, *self.program("lit"), "run", "--scene", "fence", "--technique", "crashes", "--technique", "lit",
                     *NUMBERS, "--light", "point", "--light", "sun", "--out", "out", status=1)
        self.assertEqual([(row["technique"], row["status"], row["reason"].split(":")[0]) for row in records(self.dir / "out")],
                         2 * [("crashes", "failed", "crashed in resolve"), ("lit", "ok", "")])

    def test_the_same_program_twice_is_one(self):
        (self.dir / "link").symlink_to(self.dir)
        once = self.program("lit")
        self.assertEqual(self.succeed(*once, "--program", "link/lit.toml", "list", *once), self.succeed(*once, "list"))
        self.assertEqual(self.succeed("--program", ROOT / "techniques/pov_ray.toml", "list"), self.succeed("list"))

    def test_the_page_s_example_has_nothing_wrong(self):
        page = (ROOT / "docs/protocol.md").read_text()
        code, sheet = page.split("```python\n")[1].split("```")[0], page.split("```toml\n")[1].split("```")[0]
        self.assertLessEqual(len([line for line in code.splitlines() if line.strip()]), 25)
        self.write("ray_numpy.py", code)
        self.write("ray_numpy.toml", sheet)
        call = re.search(r"```sh\ngnomon (--program .*)\n```", page)[1].split()
        self.succeed(*call, *NUMBERS, "--light", "point,sun", "--out", "out")
        rows = [r for r in records(self.dir / "out") if r["technique"] == "ray_numpy"]
        self.assertEqual(len(rows), 2)
        for row in rows:
            self.assertEqual((row["status"], row["reason"], row["metrics"]["mesh"]["wrong_rate"]), ("ok", "", 0))

    def test_the_way_there_and_back_takes_three_milliseconds_at_most(self):
        # The program tells what it takes itself. Other work on the machine adds to the rest: the repetition that it left alone is the
        # harness's own. Where it left none alone, neither did it leave what the program does beside each stage: as many bytes as a
        # mask written and read, and a line to another process and back, which takes a millisecond on two idle cores.
        options = self.program("lit", fault=f"""
import subprocess
echo = subprocess.Popen(["cat"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
def plain():
  start = time.perf_counter()
  with open("plain", "wb") as page: page.write(bytes(4 * 640 * 360))
  echo.stdin.write(b"hello\\n"); echo.stdin.flush(); echo.stdout.readline()
  with open("plain", "rb") as page: page.read()
  with open({str(self.dir / "plain.ms")!r}, "a") as page: print(1000 * (time.perf_counter() - start), file=page)
def fault(r):
  start = time.perf_counter()
  answer = sound(r)
  if "ms" in answer:
    plain()
    answer["ms"] = 1000 * (time.perf_counter() - start)
  return answer
""")
        self.succeed(*options, "run", "--scene", "fence", "--technique", "lit", "--light", "sun", "--size", "640x360", "--processes", "1",
                     "--repetitions", "40", "--out", "out")
        row, = records(self.dir / "out")
        plain = min(map(float, (self.dir / "plain.ms").read_text().split()))
        for stage in ("build", "relight", "resolve"):
            way = sorted(wall - own for wall, own in zip(*(row[key][stage][0] for key in ("harness_stages", "stages"))))
            self.assertLess(way[0], (10 if program.SANITIZED else 1) * 3 * max(1, plain), f"{stage}, where the plain way takes {plain} ms: {way}")


if __name__ == "__main__":
    unittest.main()
