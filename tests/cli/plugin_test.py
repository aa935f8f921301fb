#!/usr/bin/python3 -IB
"""Plugins: several at once, wherever they are in the command, and what records and resumed runs hold of them."""

import json
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, NUMBERS, ROOT, ProgramTest, records  # noqa: E402

SECOND = Path(FAULTS).with_name("gnomon_second.so")
ROWS = ["--scene", "single_triangle", "--light", "sun", *NUMBERS, "--quiet", "--out", "out"]


class Plugins(ProgramTest):
    def run_rows(self, *words):
        self.succeed("run", *words, *ROWS)
        return {row["technique"]: row for row in records(self.dir / "out")}

    def test_all_plugins_reach_the_workers_and_stand_anywhere_in_the_command(self):
        shutil.copy(SECOND, self.dir / "mine.so")
        rows = self.run_rows("--technique", "reserves", "--plugin", FAULTS, "--technique", "always_lit", "--plugin", "mine.so",
                             "--technique", "unshadowed")
        self.assertEqual({name: row["status"] for name, row in rows.items()},
                         {"reserves": "ok", "always_lit": "ok", "unshadowed": "ok"})
        for words in (["--plugin", FAULTS, "--plugin", "mine.so", "list", "--json"],
                      ["list", "--plugin", "mine.so", "--json", "--plugin", FAULTS],
                      ["--plugin", "mine.so", "list", "--json", "--plugin", FAULTS]):
            ids = [technique["id"] for technique in json.loads(self.succeed(*words))]
            self.assertTrue({"busy", "always_lit", "unshadowed"} <= set(ids), ids)
        self.assertIn("--plugin", self.succeed("run", "--help"))

    def test_the_same_plugin_twice_is_one(self):
        (self.dir / "link.so").symlink_to(FAULTS)
        once = self.succeed("--plugin", FAULTS, "list")
        self.assertEqual(self.succeed("--plugin", FAULTS, "list", "--plugin", FAULTS, "--plugin", "link.so"), once)

    def test_a_taken_id_is_refused_with_both_files(self):
        shutil.copy(FAULTS, self.dir / "copy.so")
        self.refuse("--plugin", FAULTS, "--plugin", "copy.so", "list", says=["technique busy", "copy.so", str(FAULTS)])
        self.refuse("list", "--plugin", "copy.so", "--plugin", FAULTS, says=["technique busy", "copy.so", str(FAULTS)])

    def test_what_is_no_plugin_is_refused(self):
        self.write("text.so", "no library")
        self.refuse("--plugin", "text.so", "list", says=["plugin text.so cannot be loaded"])
        self.refuse("list", "--plugin", "gone.so", says=["plugin gone.so cannot be loaded", "No such file"])
        self.refuse("list", "--plugin", "", says=["plugin"])
        self.refuse("list", "--plugin", ".", says=["plugin"])

    def test_a_plugin_is_averaged_by_its_id_and_named_in_the_record(self):
        self.succeed("run", "--plugin", SECOND, "--technique", "averaged_hard:of=always_lit,samples=2", "--scene", "single_triangle",
                     "--light", "globe", *NUMBERS, "--quiet", "--out", "out")
        row = records(self.dir / "out")[0]
        self.assertEqual((row["status"], row["parameters"]["of"]), ("ok", "always_lit"))
        self.assertEqual(ROOT / row["context"]["plugin"]["path"], SECOND)  # relative to the testbed's folder if within

    def test_records_name_the_plugin_of_their_technique(self):
        shutil.copy(SECOND, self.dir / "mine.so")
        rows = self.run_rows("--technique", "always_lit", "--technique", "unshadowed", "--plugin", "mine.so")
        self.assertNotIn("plugin", rows["unshadowed"]["context"])
        plugin = rows["always_lit"]["context"]["plugin"]
        self.assertEqual(plugin["path"], "mine.so")
        self.assertRegex(plugin["hash"], "^[0-9a-f]{32}$")
        # The tests' plugins are built as the program is.
        context = rows["always_lit"]["context"]
        self.assertEqual((plugin["build_type"], plugin["compiler"]), (context["build_type"], context["compiler"]))
        for flag in context["flags"].split():
            self.assertIn(flag, plugin["flags"].split())
        self.assertEqual(plugin["optimized"], any(flag.startswith("-O") and flag != "-O0" for flag in plugin["flags"].split()))
        self.succeed("render", "--plugin", "mine.so", "--scene", "single_triangle", "--light", "sun", "--size", "64x36",
                     "--technique", "always_lit", "--out", "picture")
        self.assertEqual(json.loads((self.dir / "picture/record.json").read_text())[0]["context"]["plugin"], plugin)

    def test_a_plugin_that_was_built_anew_is_run_again(self):
        shutil.copy(SECOND, self.dir / "mine.so")
        call = ["--technique", "always_lit", "--technique", "unshadowed", "--plugin", "mine.so"]
        before = self.run_rows(*call)
        self.assertIn("0 rows", self.succeed("run", *call, *ROWS, "--resume"))
        with open(self.dir / "mine.so", "ab") as file:
            file.write(b"built anew")  # behind all that a loader reads
        self.refuse("run", *call, *ROWS, "--resume", "--filter", "unshadowed", says=["always_lit", "another plugin"])
        planned = self.succeed("run", *call, *ROWS, "--resume", "--dry-run")
        self.assertIn("always_lit", planned)
        self.assertNotIn("sun unshadowed", planned)
        text = self.succeed("run", *call, *ROWS, "--resume")
        self.assertIn("1 row: 1 ok, 0 unsupported, 0 failed; 1 was done before", text)
        after = {row["technique"]: row for row in records(self.dir / "out")}
        self.assertEqual(len(records(self.dir / "out")), 2)
        self.assertNotEqual(before["always_lit"]["context"]["plugin"]["hash"], after["always_lit"]["context"]["plugin"]["hash"])
        self.assertEqual(before["unshadowed"], after["unshadowed"])
        # The question is the same one: `compare` pairs the rows of before and after by it.
        self.assertEqual(before["always_lit"]["job"], after["always_lit"]["job"])


if __name__ == "__main__":
    unittest.main()
