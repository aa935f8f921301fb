#!/usr/bin/python3 -IB
"""Plugins and programs that crash, throw, hang, exit and answer nonsense before anything runs: each costs itself alone."""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, NUMBERS, ProgramTest, records  # noqa: E402

UNRULY = Path(FAULTS).with_name("gnomon_unruly.so")
SCENE = ("--scene", "fence", "--light", "sun")
DEEDS = {"throw": "it throws", "throw_a_number": "", "abort": "Aborted", "exit": "exit status 0", "segv": "Segmentation fault"}
SHEET = 'title="T"\nsummary="S."\nsource="x"\nerror="E."\nfails="F."\ncommand=["/usr/bin/python3","-IB","odd.py"]\nanswers=["supports"]\n'
ANSWERS = """import json, os, struct, sys, time
for line in sys.stdin:
    asked = json.loads(line)
    answer = {"protocol": 1} if asked["do"] == "hello" else {"ms": 0}
    if asked["do"] == "supports":
        ODD
    if asked["do"] == "resolve":
        height, width = asked["mask"]["shape"]
        with open(asked["mask"]["file"], "r+b") as file:
            file.write(struct.pack("<f", 1.0) * (width * height))
    print(json.dumps(answer), flush=True)
"""


class Outside(ProgramTest):
    def misbehave(self, place, deed):
        self.environment["UNRULY"] = f"{place}:{deed}"

    def rows(self, out, status, *arguments):
        """Reasons by technique of a run of it beside a sound one; None where the row is ok."""
        self.succeed("--plugin", UNRULY, "run", *SCENE, *arguments, *NUMBERS, "--timeout", "3", "--out", out, status=status)
        return {r["technique"]: None if r["status"] == "ok" else r["reason"] for r in records(self.dir / out)}

    def test_a_sound_one_is_described_as_if_it_were_here(self):
        text = self.succeed("describe", "unruly", "--plugin", UNRULY)
        for words in ("1 .. 9", "0 .. 1", "one | two", "true | false", "gray"):
            self.assertIn(words, text)
        both = ("--technique", "unruly:level=4,share=0.25,word=two,flag=true", "--technique", "unshadowed")
        self.assertEqual(self.rows("out", 0, *both), {"unruly": None, "unshadowed": None})
        self.assertEqual(records(self.dir / "out")[0]["parameters"], {"level": 4, "share": 0.25, "word": "two", "flag": "true"})
        self.refuse("--plugin", UNRULY, "run", *SCENE, "--technique", "unruly:level=10", says=["unruly.level = 10 is outside 1 .. 9"])
        self.succeed("--plugin", UNRULY, "run", "--scene", "unruly_scene:width=20", "--technique", "unruly", *NUMBERS, "--out", "scene")
        self.assertEqual(records(self.dir / "scene")[0]["scene_facts"]["triangles"], 2)

    def test_one_that_cannot_be_loaded_is_refused(self):
        for place in ("load", "roll"):
            for deed, says in DEEDS.items():
                self.misbehave(place, deed)
                self.refuse("--plugin", UNRULY, "run", *SCENE, "--technique", "unruly", "--technique", "unshadowed", "--out", "out",
                            says=["gnomon_unruly.so cannot be loaded", says])
                self.assertFalse((self.dir / "out").exists())

    def test_an_object_that_cannot_be_made_costs_its_own_rows(self):
        for place in ("constructor", "layers", "detail"):
            for deed, says in ({**DEEDS, "nothing": "constructor gave nothing"} if place == "constructor" else DEEDS).items():
                self.misbehave(place, deed)
                reasons = self.rows(f"{place}_{deed}", 1, "--technique", "unruly", "--technique", "unshadowed")
                self.assertIsNone(reasons["unshadowed"])
                self.assertIn(says, reasons["unruly"], (place, deed))
        self.misbehave("constructor", "abort")
        self.assertIn("crashed in describe", self.succeed("--plugin", UNRULY, "describe", "unruly"))
        self.succeed("--plugin", UNRULY, "describe", "averaged_hard")  # whose parameter calls supports() of all techniques

    def test_what_hangs_is_given_up(self):
        """Both take the harness's patience, and so are tried at the same time."""
        runs = {}
        for place in ("roll", "constructor"):
            self.misbehave(place, "hang")
            runs[place] = self.start("--plugin", UNRULY, "run", *SCENE, "--technique", "unruly", "--technique", "unshadowed", *NUMBERS,
                                     "--out", place, "--quiet")
        said = {place: run.communicate()[1] for place, run in runs.items()}
        self.assertEqual(runs["roll"].returncode, 2)
        self.assertIn("hung in load", said["roll"])
        self.assertEqual(runs["constructor"].returncode, 1)
        reasons = {r["technique"]: r["reason"] for r in records(self.dir / "constructor")}
        self.assertIn("hung in describe", reasons["unruly"])
        self.assertEqual(reasons["unshadowed"], "")
        self.assert_gone()

    def test_whoever_does_not_say_what_it_supports_keeps_its_rows(self):
        for deed in (*DEEDS, "hang"):
            self.misbehave("supports", deed)
            if deed != "hang":  # its parameters are known all the same
                self.assertIn("one | two", self.succeed("--plugin", UNRULY, "describe", "unruly"))
            listed = self.succeed("--plugin", UNRULY, "run", *SCENE, "--technique", "*", *NUMBERS, "--timeout", "3", "--dry-run")
            self.assertIn(" unruly", listed, deed)
            self.assertIn(" shadow_map", listed, deed)

    def test_programs_that_do_not_say_what_they_support_keep_their_rows(self):
        for odd in ("time.sleep(300)", "os._exit(9)", "answer = 7", "answer = {'support': 'perhaps', 'why': 'w'}", "raise SystemError"):
            self.write("odd.toml", SHEET)
            self.write("odd.py", ANSWERS.replace("ODD", odd))
            listed = self.succeed("--program", "odd.toml", "run", *SCENE, "--technique", "*", *NUMBERS, "--timeout", "3", "--dry-run")
            self.assertIn(" odd\n", listed, odd)
            self.succeed("--program", "odd.toml", "run", *SCENE, "--technique", "odd", "--technique", "unshadowed", *NUMBERS, "--timeout", "3",
                         "--out", "out", status=1)
            self.assertEqual([r["status"] for r in records(self.dir / "out")], ["failed", "ok"], odd)
            subprocess.run(["rm", "-r", self.dir / "out"], check=True)
        self.assert_gone()

    def test_a_scene_that_cannot_be_made_is_refused(self):
        for deed, says in DEEDS.items():
            self.misbehave("scene", deed)
            self.refuse("--plugin", UNRULY, "run", "--scene", "unruly_scene", "--technique", "unshadowed", "--out", "out",
                        says=["scene unruly_scene", says])


if __name__ == "__main__":
    unittest.main()
