#!/usr/bin/python3 -IB
"""check: the rules of conformance, checked on a technique from outside, one process each."""

import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, HUNG, SANITIZED, ProgramTest, workers  # noqa: E402

QUICK = ["--rule", "data_sheet", "--rule", "same_mask", "--rule", "gl_state"]


class Check(ProgramTest):
    def test_a_good_technique_keeps_all_rules(self):
        text = self.succeed("check", "unshadowed")
        rules = [rule["name"] for rule in json.loads(self.succeed("list", "rules", "--json"))]
        self.assertEqual([line.split()[0] for line in text.splitlines()[2:2 + len(rules)]], rules)
        self.assertRegex(text, r"(?m)^rule +verdict$")
        self.assertRegex(text, r"(?m)^same_mask +holds$")
        self.assertRegex(text, r"(?m)^gl_state +does not apply: it does not draw$")
        self.assertRegex(text, rf"(?m)^{len(rules)} rules: \d+ hold, \d+ do not apply, 0 fail$")

    def test_a_technique_that_draws_is_asked_with_opengl(self):
        self.assertRegex(self.succeed("check", "shadow_map", *QUICK), r"(?m)^gl_state +holds$")

    def test_a_technique_that_explains_nothing_has_no_causes_to_judge(self):
        for technique, verdict in (("unshadowed", "does not apply: it explains no wrong pixel: causes are told from where they are alone"),
                                   ("embree_rays", "does not apply: no pixel of these scenes is wrong"), ("shadow_map", "holds"),
                                   ("names_causes", "holds")):
            with self.subTest(technique):
                told = json.loads(self.succeed("--plugin", FAULTS, "check", technique, "--rule", "named_causes", "--json"))["rules"][0]
                self.assertEqual(told["verdict"] + (": " + told["why"] if told["why"] else ""), verdict)

    def test_a_plugin_is_asked_and_its_faults_are_told_with_place_and_advice(self):
        text = self.succeed("--plugin", FAULTS, "check", "returns_nan", *QUICK, status=1)
        self.assertRegex(text, r"(?m)^data_sheet +holds$")
        self.assertRegex(text, r"(?m)^same_mask +fails: \d+ findings$")
        words = " ".join(text.split())
        self.assertIn("must: Under every supported light it writes every pixel", words)
        self.assertIn("found: the mask is nan, outside 0 .. 1; in sphere_over_plane:segments=24, light point (point), pixel 7, 0 of "
                      + ("48 x 27" if SANITIZED else "96 x 54"), words)
        self.assertIn("do: Write every pixel, 1 where faces_light() says no.", words)
        self.assertRegex(text, r"(?m)^ +and \d+ more$")
        self.assertTrue(text.endswith("\n3 rules: 1 hold, 1 do not apply, 1 fail\n"), text)

    def test_what_ends_its_process_costs_one_rule(self):
        for technique, found in (("crashes", "it crashed in same_mask: Segmentation fault (signal 11)"),
                                 ("exits", "it crashed in same_mask: exit status 3"),
                                 ("throws", "it threw: the tree has no root"),
                                 *([] if SANITIZED else [("eats_memory", "it ran out of memory")]),  # of which a sanitizer has no limit
                                 ("hangs", f"it hung in same_mask: no answer within {HUNG} s")):
            with self.subTest(technique):
                told = json.loads(self.succeed("--plugin", FAULTS, "check", technique, "--json", "--timeout", HUNG, *QUICK, status=1))
                self.assertEqual((told["technique"], told["holds"], told["does_not_apply"], told["fails"]), (technique, 1, 1, 1))
                words, mask, state = told["rules"]
                self.assertEqual((words["name"], words["verdict"], words["findings"]), ("data_sheet", "holds", []))
                self.assertEqual((state["name"], state["verdict"], state["why"]), ("gl_state", "does not apply", "it does not draw"))
                self.assertEqual((mask["name"], mask["verdict"]), ("same_mask", "fails"))
                self.assertEqual((mask["findings"][0]["what"], mask["findings"][0]["scene"], mask["findings"][0]["light"]),
                                 (found, "sphere_over_plane:segments=24", "point (point)"))
                self.assertTrue(mask["sentence"] and mask["advice"])
        self.assertEqual(workers(self.dir, keepers=True), [])

    def test_bad_usage_is_refused(self):
        self.refuse("check", "shadow_mapp", says=["there is no technique shadow_mapp; did you mean shadow_map?"])
        self.refuse("check", "unshadowed", "--rule", "same_masc", says=["there is no rule same_masc; did you mean same_mask?", "gl_state"])
        self.refuse("check", "unshadowed", "--timeout", "0", says=["--timeout"])
        self.refuse("check", says=["technique"])
        self.refuse("list", "rule", says=["there is no list rule; did you mean rules?"])


if __name__ == "__main__":
    unittest.main()
