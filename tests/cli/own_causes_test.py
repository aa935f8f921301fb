#!/usr/bin/python3 -IB
"""A plugin with causes of its own: in the run's records, and from there everywhere else without the plugin."""

import base64
import collections
import json
import re
import sys
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, PROGRAM_SHEET, SMALL, ProgramTest, records  # noqa: E402

# The plugin lights everything and names `left_half` in the left half of the picture; in the right one a shadow is a missing caster.
ROWS = ["--scene", "fence", "--technique", "names_causes", "--technique", "names_more", "--technique", "unshadowed"]
OWN = [{"name": "left_half", "sentence": "The left half of the picture is out of its sight.", "color": [252, 0, 132]},
       {"name": "never", "sentence": "A cause that holds nowhere.", "color": [20, 255, 148]}]


# A program that lights everything, and says why of the left half.
SHEET = PROGRAM_SHEET.format(id="lights_all") + """answers = ["explain"]
[[cause]]
id = "left_half"
sentence = "The left half of the picture is out of its sight."
color = [252, 0, COLOR]
"""
LIGHTS_ALL = """
import json, struct, sys
for line in sys.stdin:
    request, answer = json.loads(line), {}
    if request["do"] == "hello":
        answer = {"protocol": 1}
    if request["do"] == "resolve":
        height, width = request["mask"]["shape"]
        with open(request["mask"]["file"], "r+b") as file:
            file.write(struct.pack("<f", 1) * (width * height))
    if request["do"] == "explain":
        left = lambda i: {"cause": "left_half"} if i % width < width // 2 else None
        answer = {"explanations": [left(i) for i in request["pixels"]]}
    print(json.dumps(answer), flush=True)
"""


class OwnCauses(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder = cls.home / "run"
        one = cls("test_the_record_tells_them")
        one.dir = cls.home
        one.succeed("--plugin", FAULTS, "run", *ROWS, "--light", "sun", "--light", "point", *SMALL, "--out", cls.run_folder)

    def rows(self, technique="names_causes", folder=None):
        return [row for row in records(folder or self.run_folder) if row["technique"] == technique]

    def test_the_record_tells_them(self):
        for row, plain in zip(self.rows(), self.rows("unshadowed")):
            self.assertEqual(row["status"], "ok", row["reason"])
            self.assertEqual(row["own_causes"], OWN)
            self.assertEqual(plain["own_causes"], [])
            # The same mask: what one calls a missing caster is for the other out of its sight, in part.
            self.assertEqual(row["metrics"], plain["metrics"])
            counts, others = row["causes"], plain["causes"]
            self.assertEqual(sum(counts.values()), sum(others.values()))
            self.assertEqual(counts["never"], 0)
            self.assertGreater(counts["left_half"], 100)
            self.assertGreater(counts["missing_caster"], 100)
            self.assertNotIn("left_half", others)
            wrong = row["metrics"][row["truth"]]["wrong_rate"] * row["classes"]["T"]
            self.assertAlmostEqual(sum(counts.values()), wrong, places=3)

    def test_tables_have_columns_of_them_without_the_plugin(self):
        text = self.succeed("table", self.run_folder)
        self.assertRegex(text, r"names_causes .*left half \d+ %")
        lines = self.succeed("table", self.run_folder, "--format", "csv", "--columns", "job,cause.left_half,cause.never").split()
        self.assertEqual(lines[0], "job,cause.left_half,cause.never")
        shares = {line.split(",")[0]: line.split(",")[1:] for line in lines[1:]}
        for row in self.rows():
            left, never = map(float, shares[row["job"]])
            self.assertAlmostEqual(left, row["causes"]["left_half"] / row["classes"]["T"], places=9)
            self.assertEqual(never, 0)
        for row in self.rows("unshadowed"):
            self.assertEqual(shares[row["job"]], ["", ""])
        self.refuse("table", self.run_folder, "--columns", "cause.left_hall", says=["cause.left_half"])

    def test_the_report_shows_them_without_the_plugin(self):
        self.succeed("report", self.run_folder, "--out", self.dir / "page.html")
        page = (self.dir / "page.html").read_text()
        data = json.loads(re.search('id="data">(.*?)</script>', page, re.DOTALL)[1])
        names = [cause["name"] for cause in data["causes"]]
        self.assertEqual(names[-3:], ["left_half", "never", "right_half"])
        self.assertEqual([{key: cause[key] for key in OWN[0]} for cause in data["causes"][-3:-1]], OWN)
        # The pixels of a row's picture are numbers of the page's list, wherever a technique has a cause in its own.
        self.assertEqual(data["notes"], [])
        by_title = collections.defaultdict(list)
        for row in data["rows"]:
            packed = re.search(f'id="blob{row["pictures"]["causes"]}">(.*?)</script>', page)[1]
            numbers = collections.Counter(zlib.decompress(base64.b64decode(packed)))
            del numbers[0]
            by_title[row["technique"]].append({names[number - 1]: count for number, count in numbers.items()})
        for technique, pictures in by_title.items():
            counts = [{name: count for name, count in row["causes"].items() if count} for row in self.rows(technique)]
            self.assertCountEqual(pictures, counts, technique)

    def test_a_rescore_without_the_plugin_changes_nothing(self):
        out = self.dir / "out"
        out.mkdir()
        (out / "masks").symlink_to(self.run_folder / "masks")
        before = self.rows()
        lines = [json.loads(line) for line in (self.run_folder / "records.jsonl").read_text().splitlines()]
        for row in lines:
            row["causes"] = {name: 0 for name in row["causes"]}
        (out / "records.jsonl").write_text("".join(json.dumps(row) + "\n" for row in lines))
        self.succeed("table", out, "--rescore", "--save")
        for row, old in zip(self.rows(folder=out), before):
            self.assertEqual(row["causes"], old["causes"])
            self.assertEqual(row["own_causes"], OWN)

    def test_runs_merge_and_compare_without_the_plugin(self):
        self.succeed("merge", self.run_folder, "--out", self.dir / "merged")
        self.assertEqual([row["own_causes"] for row in self.rows(folder=self.dir / "merged")], [OWN, OWN])
        self.assertEqual(self.rows("names_more", self.dir / "merged")[0]["own_causes"][1], OWN[1])
        self.assertNotIn("left_half", self.succeed("compare", self.run_folder, self.dir / "merged"))

    def test_several_lights_and_motion_have_them_too(self):
        self.succeed("--plugin", FAULTS, "run", *ROWS, "--light", "all+", *SMALL, "--out", "several")
        row = self.rows(folder=self.dir / "several")[0]
        self.assertEqual(sum(light["causes"]["left_half"] for light in row["lights"]), row["causes"]["left_half"])
        self.assertGreater(row["causes"]["left_half"], 100)
        self.assertGreater(row["cause_errors"]["left_half"], 0)
        self.assertAlmostEqual(sum(row["cause_errors"].values()), row["metrics"][row["truth"]]["error"], delta=0.01)
        self.succeed("report", "several")
        self.succeed("table", "several", "--rescore")

    def test_the_program_describes_and_lists_them(self):
        self.assertIn("The left half of the picture is out of its sight.",
                      self.succeed("--plugin", FAULTS, "describe", "names_causes"))
        self.assertEqual(json.loads(self.succeed("--plugin", FAULTS, "describe", "names_causes", "--json"))["causes"][0]["color"],
                         "#fc0084")
        listed = json.loads(self.succeed("--plugin", FAULTS, "list", "causes", "--json"))
        self.assertEqual([c["name"] for c in listed if c["technique"] == "names_causes"], ["left_half", "never"])
        self.assertRegex(self.succeed("--plugin", FAULTS, "list", "causes"), r"left_half +names_causes +The left half")

    def test_one_that_is_not_declared_fails_its_row_and_says_which(self):
        self.environment["GNOMON_TEST_CAUSE"] = "right_half"
        try:
            self.gnomon("--plugin", FAULTS, "run", *ROWS, "--light", "sun", *SMALL, "--out", "out")
        finally:
            del self.environment["GNOMON_TEST_CAUSE"]
        failed, more, right = records(self.dir / "out")
        self.assertEqual([row["status"] for row in (failed, more, right)], ["failed", "ok", "ok"])
        self.assertIn("an explanation names the cause right_half, which the technique does not declare; it declares left_half, never",
                      failed["reason"])

    def test_a_plugin_whose_cause_has_a_color_that_is_taken_is_refused(self):
        self.environment["GNOMON_TEST_COLOR"] = "taken"
        try:
            self.refuse("--plugin", FAULTS, "list", says=["cause left_half of technique names_causes", "#e07800", "acne"])
        finally:
            del self.environment["GNOMON_TEST_COLOR"]

    def test_a_program_names_them_as_a_plugin_does(self):
        self.write("lights_all.py", LIGHTS_ALL)
        self.write("lights_all.toml", SHEET.replace("COLOR", "132"))
        self.succeed("--program", "lights_all.toml", "run", "--scene", "fence", "--technique", "lights_all", "--light", "sun", *SMALL,
                     "--out", "out")
        row, = records(self.dir / "out")
        self.assertEqual(row["status"], "ok", row["reason"])
        self.assertEqual(row["own_causes"], OWN[:1])
        same = next(other for other in self.rows() if other["light"] == "sun")
        self.assertEqual(row["causes"]["left_half"], same["causes"]["left_half"])
        for color, says in {"256": "three whole numbers, 0 .. 255", "-1": "three whole numbers", "130.5": "three whole numbers"}.items():
            self.write("lights_all.toml", SHEET.replace("COLOR", color))
            self.refuse("--program", "lights_all.toml", "list", says=["color", says])
        self.write("lights_all.toml", SHEET.replace("[252, 0, COLOR]", "[224, 120, 0]"))
        self.refuse("--program", "lights_all.toml", "list", says=["cause left_half of technique lights_all", "acne"])


if __name__ == "__main__":
    unittest.main()
