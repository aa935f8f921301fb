#!/usr/bin/python3 -IB
"""Programs and classes in Python that remember frames: what they are told, and the rules that they must keep."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import NUMBERS, PROGRAM_SHEET, ProgramTest, records  # noqa: E402

REMEMBERS = "remembers = true\n"

# A program of nothing but the protocol: lit everywhere. It keeps what it is told.
TOLD = """
import json, os, struct, sys
for line in sys.stdin:
    r = json.loads(line)
    if r["do"] == "resolve":
        height, width = r["mask"]["shape"]
        with open(r["mask"]["file"], "r+b") as file:
            file.write(struct.pack("<f", 1.0) * (width * height))
    with open("told." + str(os.getpid()), "a") as file:
        file.write(json.dumps([r["do"], sorted(r)]) + "\\n")
    print(json.dumps({"protocol": 1} if r["do"] == "hello" else FORGOTTEN if r["do"] == "forget" else {}), flush=True)
"""

# Lit where nothing faces the light; else light that is found anew in each frame, and averaged over the frames.
MEAN = """
import numpy as np
from gnomon_technique import Technique, serve

class Mean(Technique):
    sum, length, number = None, 0, 0
    def build(self, scene):
        self.scene = scene
    def relight(self, light):
        self.light = light
    def resolve(self, gbuffer, mask):
        if self.sum is None or self.sum.shape != mask.shape:
            self.sum, self.length = np.zeros(mask.shape), 0
        self.sum += np.random.default_rng(self.number).uniform(0.5, 1, mask.shape)
        self.length += 1
        self.number += 1
        mask[...] = np.where(gbuffer.faces(self.light, self.scene), self.sum / self.length, 1)
FORGET
serve(Mean)
"""
FORGETS = """
    def forget(self):
        self.sum, self.number = None, 0
"""
# The sum is dropped, but the frames are counted on.
LEAVES = """
    def forget(self):
        self.sum = None
"""


class Remember(ProgramTest):
    def told(self, name, sheet, forgotten="{}"):
        """The option of a program that keeps what it is told."""
        self.write(f"{name}.py", TOLD.replace("FORGOTTEN", forgotten))
        return ["--program", self.write(f"{name}.toml", PROGRAM_SHEET.format(id=name) + sheet)]

    def mean(self, name, forget, sheet=REMEMBERS):
        self.write(f"{name}.py", MEAN.replace("FORGET", forget))
        return ["--program", self.write(f"{name}.toml", PROGRAM_SHEET.format(id=name).replace("-IB", "-B") + sheet)]

    def verdict(self, options, technique, rule):
        told = json.loads(self.gnomon(*options, "check", technique, "--rule", rule, "--json").stdout)["rules"][0]
        return told["verdict"], told["why"] + " ".join(finding["what"] for finding in told["findings"])

    def test_a_program_that_remembers_is_told_to_forget_before_its_frames(self):
        self.assertEqual(self.verdict(self.told("tells", REMEMBERS), "tells", "forget_begins_anew"), ("holds", ""))
        requests = [json.loads(line) for file in self.dir.glob("told.*") for line in file.read_text().splitlines()]
        self.assertIn(["forget", ["do", "settings"]], requests)

    def test_a_program_that_does_not_remember_is_not_told(self):
        self.assertEqual(self.verdict(self.told("tells", ""), "tells", "no_memory_undeclared"), ("holds", ""))
        self.succeed(*self.told("tells", ""), "run", "--scene", "single_triangle", "--light", "sun", "--technique", "tells", *NUMBERS, "--out", "out")
        self.assertEqual(records(self.dir / "out")[0]["status"], "ok")
        self.assertNotIn('"forget"', "".join(file.read_text() for file in self.dir.glob("told.*")))

    def test_an_answer_to_forget_has_no_keys(self):
        kind, found = self.verdict(self.told("odd", REMEMBERS, '{"ms": 1}'), "odd", "forget_begins_anew")
        self.assertEqual(kind, "fails")
        self.assertIn("forget was answered with the key ms; it may have none", found)

    def test_a_class_in_python_keeps_the_rules_where_it_forgets(self):
        options = self.mean("mean", FORGETS)
        for rule in ("forget_begins_anew", "frames_before_decide", "bytes_of_frames", "same_mask"):
            with self.subTest(rule):
                self.assertEqual(self.verdict(options, "mean", rule), ("holds", ""))
        kind, why = self.verdict(options, "mean", "error_terms_add_up")
        self.assertEqual((kind, why), ("does not apply", "it gives no error terms"))

    def test_what_a_class_leaves_or_does_not_define_is_found(self):
        kind, found = self.verdict(self.mean("leaves", LEAVES), "leaves", "forget_begins_anew")
        self.assertEqual(kind, "fails")
        kind, found = self.verdict(self.mean("lacks", ""), "lacks", "forget_begins_anew")
        self.assertEqual(kind, "fails")
        self.assertIn("the description has remembers = true, and the class has no method forget", found)
        kind, found = self.verdict(self.mean("silent", FORGETS, ""), "silent", "same_mask")
        self.assertEqual(kind, "fails")
        self.assertIn("resolve again", found)
        text = " ".join(self.succeed(*self.mean("silent", FORGETS, ""), "check", "silent", "--rule", "no_memory_undeclared", status=1).split())
        self.assertIn("do: State remembers = true and drop the memory in forget, or keep no answer from one resolve to the next.", text)

    def test_what_remembers_says_so(self):
        options = self.told("tells", REMEMBERS)
        self.assertRegex(self.succeed(*options, "describe", "tells"), r"(?m)^remembers frames +yes: ")
        self.assertIs(json.loads(self.succeed(*options, "describe", "tells", "--json"))["remembers"], True)
        listed = {entry["id"]: entry for entry in json.loads(self.succeed(*options, "list", "techniques", "--json"))}
        self.assertEqual((listed["tells"]["remembers"], listed["shadow_map"]["remembers"]), (True, False))
        self.assertNotIn("remembers frames", self.succeed("describe", "shadow_map"))
        self.refuse(*self.told("bad", "remembers = 1\n"), "list", says=["program.remembers"])


if __name__ == "__main__":
    unittest.main()
