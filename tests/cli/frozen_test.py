#!/usr/bin/python3 -IB
"""What version 1.0 wrote and was told is read and understood as it was: a run, its suite and scene, programs, words of commands.

docs/stability.md says what is promised, tests/frozen/check sees to plugins. `frozen_test.py command_line.txt` prints what a version
freezes as that file of tests/frozen/VERSION, commands and options; `frozen_test.py names.json` techniques and generated scenes;
`frozen_test.py keys.json`, called in that folder, the keys of what commands print as JSON.
"""

import csv
import io
import json
import math
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import PROGRAM, ROOT, ProgramTest, records  # noqa: E402

FROZEN = ROOT / "tests/frozen"
VERSIONS = sorted(folder.name for folder in FROZEN.iterdir() if folder.is_dir())
ANALYSES = ("front", "best", "rank", "motion")
FEW = ["--processes", "1", "--repetitions", "1", "--warmups", "1", "--pictures", "none", "--quiet"]


def helps(call):
    """(command, option) of all that the help shows; the option is empty for the command itself."""
    commands = re.findall(r"(?m)^  ([a-z][a-z-]*) ", call("--help").split("Subcommands:")[1])
    for command in sorted(commands):
        yield command, ""
        for line in re.findall(r"(?m)^  (-[^ ]*)", call(command, "--help")):
            yield from ((command, option) for option in sorted(line.split(",")) if option.startswith("-"))


def names(call):
    """Techniques, with parameters and their defaults; generated scenes, with theirs and what they hold."""
    def asked(*words):
        return json.loads(call(*words, "--json"))

    def defaults(thing):
        return {parameter["name"]: parameter["default"] for parameter in thing["parameters"]}

    scenes = {scene["id"]: asked("describe", scene["id"]) for scene in asked("list", "scenes") if scene["generated"]}
    return {"techniques": {entry["id"]: defaults(asked("describe", entry["id"])) for entry in asked("list", "techniques")},
            "scenes": {id_: {"parameters": defaults(scene), "triangles": scene["triangles"], "bounds": scene["bounds"],
                             "lights": {light["name"]: light for light in scene["lights"]}, "views": {view["name"]: view for view in scene["views"]}}
                       for id_, scene in scenes.items()}}


JSON_ANSWERS = (("table", "run", "--format", "json"), ("compare", "run", "run", "--format", "json"), ("analyze", "run", "front", "--format", "json"),
                ("describe", "shadow_map", "--json"), ("describe", "walking_boxes", "--json"),
                *(("list", what, "--json") for what in ("techniques", "scenes", "suites", "metrics", "causes", "rules")))


def keys_of(value):
    """The keys of nested objects; those of a list are all that its elements have."""
    if isinstance(value, list):
        together = {}
        for keys in map(keys_of, value):
            together = joined(together, keys)
        return {"[]": together}
    return {key: keys_of(part) for key, part in value.items()} if isinstance(value, dict) else {}


def joined(one, other):
    return {key: joined(one.get(key, {}), other.get(key, {})) for key in one | other}


def json_keys(call):
    return {" ".join(words): keys_of(json.loads(call(*words))) for words in JSON_ANSWERS}


def missing(then, now, place=""):
    """What of nested objects is not there any more, or is another value."""
    if isinstance(then, dict) and isinstance(now, dict):
        return [line for key, value in then.items()
                for line in (missing(value, now[key], f"{place}.{key}") if key in now else [f"{place}.{key} is gone"])]
    return [] if then == now else [f"{place}: {then} -> {now}"]


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


def is_same(old, new):
    """Of two fields: numbers that were computed anew may differ in their last digits."""
    try:
        return math.isclose(float(old), float(new), rel_tol=1e-9, abs_tol=1e-12)
    except ValueError:
        return old == new


class Frozen(ProgramTest):
    def setUp(self):
        super().setUp()
        self.copies = {}
        for version in VERSIONS:
            self.copies[version] = self.dir / version
            shutil.copytree(FROZEN / version, self.copies[version], ignore=shutil.ignore_patterns("plugin"))

    def each(self):
        """Copies of all versions, each with the test's folder in it: suite and scene are named as they were."""
        home = self.dir
        for version, copy in self.copies.items():
            with self.subTest(version):
                self.dir = copy
                yield copy
        self.dir = home

    def assert_holds(self, answer, text):
        """All columns and rows of the answer then are in the text, with the values then."""
        then, now = rows_of(answer.read_text()), rows_of(text)
        self.assertEqual(len(then), len(now), answer.name)
        for before, after in zip(then, now):
            for column, value in before.items():
                self.assertIn(column, after, answer.name)
                self.assertTrue(is_same(value, after[column]), f"{answer.name}: {column}: {value} -> {after[column]}")

    def test_there_is_one(self):
        self.assertIn("1.0", VERSIONS)
        kinds = {row["answer"] for row in records(FROZEN / "1.0/run")}
        self.assertLessEqual({"binary", "fraction", "received", "transmitted"}, kinds)
        self.assertTrue(any(row["path"] for row in records(FROZEN / "1.0/run")))

    def test_tables_and_analyses_have_the_numbers_then(self):
        for copy in self.each():
            self.assert_holds(copy / "answers/table.csv", self.succeed("table", "run", "--format", "csv"))
            for kind in ANALYSES:
                self.assert_holds(copy / f"answers/{kind}.csv", self.succeed("analyze", "run", kind, "--format", "csv"))

    def test_masks_are_scored_again(self):
        for copy in self.each():
            before = records(copy / "run")
            self.succeed("table", "run", "--rescore")
            for old, new in zip(before, records(copy / "run")):
                for truth, metrics in old["metrics"].items():
                    for name, value in metrics.items():
                        now = new["metrics"][truth][name]
                        self.assertTrue(value == now or value is not None and now is not None and is_same(value, now), f"{old['job']} {truth} {name}: {value} -> {now}")

    def test_the_report_shows_every_row(self):
        for copy in self.each():
            self.succeed("report", "run", "--out", "page.html")
            page = (copy / "page.html").read_text()
            for row in records(copy / "run"):
                self.assertIn(row["job"], page)

    def test_runs_are_compared_and_merged(self):
        for copy in self.each():
            said = json.loads(self.succeed("compare", "run", "run", "--format", "json"))
            self.assertEqual(said["schema"], "gnomon-compare-1")
            self.succeed("merge", "run", "--out", "merged")
            self.assertEqual(*({row["job"]: row for row in records(copy / name)} for name in ("run", "merged")))

    def test_the_suite_makes_the_same_jobs_and_its_rows_are_run_again(self):
        for copy in self.each():
            kept = {row["job"] for row in records(copy / "run") if not row["context"].get("foreign")}
            self.assertEqual(set(re.findall(r"(?m)^([0-9a-f]{16})  ", self.succeed("run", "suite.toml", "--dry-run"))), kept)
            self.succeed("run", "suite.toml", "--out", "again", "--processes", "1", "--repetitions", "1", "--pictures", "none", "--quiet")
            status = {row["job"]: row["status"] for row in records(copy / "run")}
            self.assertEqual({row["job"]: row["status"] for row in records(copy / "again")}, {job: status[job] for job in kept})

    def test_programs_are_spoken_with(self):
        for copy in self.each():
            programs = [word for name in ("plain_lines", "ray_numpy") for word in ("--program", f"program/{name}.toml")]
            self.succeed(*programs, "run", "--scene", "single_triangle", "--light", "point", "--technique", "plain_lines", "--technique", "ray_numpy",
                         "--size", "32x18", *FEW, "--out", "still")
            self.succeed(*programs, "run", "--scene", "walking_boxes:count=1", "--animation", "walk", "--frames", "2", "--light", "sun",
                         "--technique", "plain_lines", "--size", "16x9", *FEW, "--out", "moving")
            rows = records(copy / "still") + records(copy / "moving")
            self.assertEqual([(row["status"], row["metrics"]["mesh"]["error"]) for row in rows], [("ok", 0)] * 3, rows)
            lines = next(row for row in rows if row["technique"] == "plain_lines")
            self.assertEqual(lines["context"]["plugin"]["maker"], "plain_lines 1")
            self.assertEqual([cause["name"] for cause in lines["own_causes"]], ["lifted"])

    def test_commands_take_the_options_then(self):
        now = set(helps(self.succeed))
        for copy in self.each():
            then = {tuple((line + " ").split(" ")[:2]) for line in (copy / "command_line.txt").read_text().splitlines()}
            self.assertGreater(len(then), 100)
            self.assertEqual(then - now, set())


    def test_names_and_defaults_are_those_then(self):
        now = names(self.succeed)
        for copy in self.each():
            then = json.loads((copy / "names.json").read_text())
            self.assertGreater(min(len(then["techniques"]), len(then["scenes"])), 20)
            self.assertEqual(missing(then, now), [])

    def test_json_has_the_keys_then(self):
        for copy in self.each():
            then = json.loads((copy / "keys.json").read_text())
            self.assertEqual(set(then), {" ".join(words) for words in JSON_ANSWERS})
            self.assertEqual(missing(then, json_keys(self.succeed)), [])

    def test_keys_of_lists_are_those_of_any_element(self):
        self.assertEqual(keys_of({"a": [{"b": 1}, {"c": {"d": 2}}], "e": []}), {"a": {"[]": {"b": {}, "c": {"d": {}}}}, "e": {"[]": {}}})

    def test_what_is_missing_is_found(self):
        then = {"techniques": {"a": {"n": "1", "m": "2"}}, "scenes": {}}
        self.assertEqual(missing(then, {"techniques": {"a": {"n": "1", "m": "2", "k": "3"}, "b": {}}, "scenes": {"c": {}}}), [])
        self.assertEqual(missing(then, {"techniques": {"a": {"m": "4"}}}), [".techniques.a.n is gone", ".techniques.a.m: 2 -> 4", ".scenes is gone"])


def call(*words):
    return subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True).stdout


WRITES = {"command_line.txt": lambda: "\n".join(" ".join(filter(None, pair)) for pair in dict.fromkeys(helps(call))),
          "names.json": lambda: json.dumps(names(call), indent=1),
          "keys.json": lambda: json.dumps(json_keys(call), indent=1)}

if __name__ == "__main__":
    if sys.argv[1:] and sys.argv[1] in WRITES:
        print(WRITES[sys.argv[1]]())
        sys.exit()
    unittest.main()
