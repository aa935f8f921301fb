#!/usr/bin/python3 -IB
"""`gnomon tune`: the setting that it names is the one that its records say, in one run, resumed, and in shards."""

import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import FAULTS, HARD, ProgramTest, records  # noqa: E402

QUICK = ["--size", "96x54", "--pictures", "none", "--processes", "1", "--quiet"]
MAPS = ["--technique", "shadow_map:resolution={64,256},depth_bias={0.25,4}"]
ONE = ["--scene", "fence", *HARD]


class Tune(ProgramTest):
    def tune(self, *arguments, out="out", status=0):
        return self.succeed("tune", *arguments, *QUICK, "--out", out, status=status)

    def errors(self, out="out"):
        """By settings of the grid, the error at the worst place and the most bytes."""
        worst = {}
        for row in records(self.dir / out):
            if "resolution=" not in row["settings"]:
                continue  # the default
            error, size = worst.get(row["settings"], (0, 0))
            worst[row["settings"]] = max(error, row["metrics"]["shape"]["error"]), max(size, row["bytes"])
        return worst

    def answer(self, text):
        """The settings on the first line that names the technique alone."""
        return re.search(r"(?m)^shadow_map:?(\S*)$", text).group(1)

    def test_the_least_error_is_that_of_the_records(self):
        text = self.tune(*ONE, *MAPS, "--least", "error")
        errors = self.errors()
        self.assertEqual(len(errors), 4)
        self.assertEqual(len(records(self.dir / "out")), 10)  # each setting at each of two places, once, and the default
        self.assertEqual(self.answer(text), min(errors, key=lambda settings: errors[settings][0]))
        self.assertIn("8 evaluations of 8 possible (100 %), seed 1", text)
        self.assertIn("One scene says nothing of other scenes.", text)
        for words in ("default", "one step", "runner-up", "commit: ", "processor: "):
            self.assertIn(words, text)
        self.assertEqual(self.answer((self.dir / "out/tune.txt").read_text()), self.answer(text))
        self.assertTrue({"records.jsonl", "run.json", "table.csv", "tune.txt"} <= set(self.names(self.dir / "out")))
        self.succeed("table", "out")

    def test_the_fewest_bytes_keep_the_limit_at_each_place(self):
        self.tune(*ONE, *MAPS, "--least", "error", out="all")
        errors = self.errors("all")
        large = min(error for settings, (error, _) in errors.items() if "resolution=64" not in settings)
        small = min(error for settings, (error, _) in errors.items() if "resolution=64" in settings)
        for limit in (large, small):
            limit *= 1.001
            kept = {settings: size for settings, (error, size) in errors.items() if error <= limit}
            out = f"limit{limit}"
            text = self.tune(*ONE, *MAPS, "--least", "cost=bytes", "--each", f"error<={limit}", out=out)
            answer = self.answer(text)
            self.assertIn(answer, kept)
            self.assertEqual(kept[answer], min(kept.values()))
            self.assertRegex(text, r"(?m)^error<=\S+: .* at fence, (point|sun), \d+ % to spare$")

    def test_where_nothing_keeps_the_limit_the_nearest_miss_is_named(self):
        text = self.tune(*ONE, *MAPS, "--error", "0.00001%", status=1)
        errors = self.errors()
        self.assertIn("no setting keeps error<=0.00001% at each of 2 places; the nearest miss", text)
        self.assertEqual(self.answer(text), min(errors, key=lambda settings: errors[settings][0]))
        self.assertRegex(text, r"(?m)^error<=0.00001%: .* at fence, (point|sun), \d+ % beyond it$")

    def test_times_decide_among_finalists(self):
        text = self.tune(*ONE, *MAPS, "--error", "50%")
        self.assertRegex(text, r"(?m)^least light_ms \(worst over 2 places\), with error<=50% at each$")
        self.assertRegex(text, r"chance that it is the least of the finalists: \d+ %")

    def test_a_run_resumes_and_shards_join(self):
        arguments = [*ONE, *MAPS, "--least", "error"]
        whole = self.tune(*arguments)
        lines = (self.dir / "out/records.jsonl").read_text().splitlines(keepends=True)
        self.write("out/records.jsonl", "".join(lines[:3]))  # as if it had been killed
        self.refuse("tune", *arguments, *QUICK, "--out", "out", says=["out", "--resume"])
        self.assertEqual(self.answer(self.tune(*arguments, "--resume")), self.answer(whole))
        self.assertEqual((self.dir / "out/records.jsonl").read_text().splitlines(keepends=True)[:3], lines[:3])
        self.assertEqual(len(records(self.dir / "out")), 10)
        for k in range(2):
            self.assertIn(f"shard {k}/2 has", self.tune(*arguments, "--shard", f"{k}/2", out=f"part{k}"))
        self.succeed("merge", "part0", "part1", "--out", "joined")
        self.assertEqual(len(records(self.dir / "joined")), 8)
        self.assertEqual(self.answer(self.tune(*arguments, "--resume", out="joined")), self.answer(whole))
        self.assertEqual(len(records(self.dir / "joined")), 10)

    def test_scenes_are_left_out_in_turn(self):
        text = self.tune("--scene", "fence", "--scene", "contact", "--light", "point", *MAPS, "--least", "error")
        self.assertIn("Each scene left out in turn, among the 4 settings", text)
        self.assertRegex(text, r"(?m)^fence +shadow_map")
        self.assertIn("Fewer than 5 scenes say little of another one", text)

    def test_a_quarter_of_the_places_is_held_out_by_seed(self):
        arguments = ["--scene", "cornell_box", *MAPS, "--least", "error", *HARD, "--view", "*"]
        places = len(re.findall(r"(?m)^[0-9a-f]{16} ", self.succeed("run", "--scene", "cornell_box", "--technique", "shadow_map", *HARD,
                                                                   "--view", "*", "--dry-run")))
        text = self.tune(*arguments)
        self.assertEqual("Held out by seed 1" in text, places > 2, text)
        self.assertIn("One scene says nothing of other scenes.", text)

    def test_a_technique_that_fails_costs_itself(self):
        text = self.succeed("--plugin", FAULTS, "tune", *ONE, "--technique", "throws", *MAPS, "--least", "error", *QUICK, "--out", "out")
        self.assertTrue(self.answer(text))
        self.assertRegex(text, "left out: throws: fence .*the tree has no root")

    def test_of_a_large_grid_only_settings_that_keep_the_limits_have_rows(self):
        self.tune("shadow_map", "--scene", "fence", "--light", "point", "--error", "2%", "--budget", "2s")
        rows = records(self.dir / "out")
        self.assertEqual(rows[0]["settings"], "")
        for row in rows[1:]:
            self.assertLessEqual(row["metrics"]["shape"]["error"], 0.02, row["settings"])

    def test_of_a_large_grid_unsupported_settings_have_no_row(self):
        grid = "shadow_map:resolution={64,90,128,181,256},filter={nearest,revectorized},depth_bias=*,slope_bias=*,faces=*"
        text = self.tune("--technique", grid, "--scene", "fence", "--light", "point", "--error", "0.00001%", status=1)
        self.assertRegex(text, r"\d+ unsupported evaluations, for example .*filter=revectorized")
        for row in records(self.dir / "out"):
            self.assertEqual(row["status"], "ok", row["settings"])

    def test_what_settings_without_a_row_answered_is_known_when_a_search_goes_on(self):
        search = ["shadow_map", "--scene", "fence", "--light", "all", "--light", "point", "--error", "0.00001%"]
        self.refuse("tune", *search, says=["all"])  # not a light beside others
        search[4] = "point"
        asked = lambda text: int(re.search(r"(\d+) evaluations of \d+ possible", text).group(1))
        stopped = self.tune(*search, "--budget", "4s", status=1)
        self.assertRegex(stopped, r"no setting of the \d+ that were measured there keeps error<=")
        self.assertNotIn("whatever the other parameters", stopped)
        probes = self.dir / "out/probes.jsonl"
        said = probes.read_text().splitlines()
        self.assertGreater(len(said), 0)
        with open(probes, "a") as file:
            file.write('{"job": "cut off')
        known = self.tune(*search, "--budget", "0.01s", "--resume", status=1)
        self.assertGreaterEqual(asked(known), len(said))
        self.assertEqual(probes.read_text().splitlines(), said)

    def test_a_dry_run_prints_levels_and_evaluations(self):
        text = self.succeed("tune", "shadow_map", *ONE, "--error", "1%", "--dry-run")
        self.assertRegex(text, r"(?m)^resolution +64, 128, 256, 512, 1024, 2048, 4096, 8192 +always$")
        self.assertRegex(text, r"(?m)^slope_bias .* for bias=slope$")
        self.assertIn("skipped where it has no effect: alpha (no mesh has holes), glass (no caster lets light through), update (nothing moves)", text)
        self.assertNotRegex(text, r"(?m)^noise_frame ")
        self.assertRegex(text, r"2 places; \d+ evaluations, of which at most 2000 are run")
        self.assertEqual(self.succeed("tune", "shadow_map", "--scene", "fence", "--light", "all", "--error", "1%", "--dry-run"),
                         self.succeed("tune", "shadow_map", "--scene", "fence", "--error", "1%", "--dry-run"))
        self.assertEqual(self.names(self.dir), [])

    def test_a_kept_grid_has_the_errors_of_a_run_and_can_be_searched(self):
        sweep = "shadow_map:resolution=64,depth_bias={0.25,4},bias={slope,receiver_plane},slope_bias={0.5,1}"
        self.tune(*ONE, "--technique", sweep, "--least", "error")
        text = self.succeed("tune", *ONE, "--technique", sweep, "--size", "96x54", "--keep", "grid.csv")
        self.assertIn("6 settings of shadow_map at 2 places: 12 evaluations", text)
        head, *lines = (line.split(",") for line in (self.dir / "grid.csv").read_text().splitlines())
        self.assertEqual(head[:4], ["shadow_map:resolution", "bias", "depth_bias", "slope_bias"])
        self.assertEqual(len(lines), 6)
        kept = {(*line[:4], head[k].removeprefix("error at ")): (line[k], line[k + 1]) for line in lines for k in (4, 6)}
        default = {"resolution": "1024", "bias": "slope", "depth_bias": "0.25", "slope_bias": "1"}
        compared = 0
        for row in records(self.dir / "out"):
            values = default | dict(item.split("=") for item in row["settings"].split(",") if item)
            if (key := (*(values[name] for name in default), " ".join(row[k] for k in ("scene", "light", "view")))) in kept:
                error, size = kept[key]
                self.assertEqual(float(error), float(f"{row['metrics']['shape']['error']:.4g}"), key)
                compared += 1
        self.assertEqual(compared, 12)
        text = self.succeed("tune", "--replay", "grid.csv", "--least", "error", "--seed", "3")
        self.assertRegex(text, r"(?m)^grid +12 +\d+ ")
        self.assertRegex(text, r"(?m)^[01] of 1 grids within 5 % of the best, [\d.]+ % of the evaluations asked, seed 3$")
        self.refuse("tune", "--replay", "grid.csv", *ONE, "--least", "error", says=["--replay", "no --scene"])
        self.refuse("tune", "--replay", "grid.csv", "--error", "1%", says=["no light_ms"])
        self.refuse("tune", "--replay", "none.csv", "--least", "error", says=["none.csv"])
        self.refuse("tune", *ONE, *MAPS, "--technique", "svbsp:*", "--keep", "two.csv", says=["--keep", "one technique"])
        self.assertEqual([name for name in self.names(self.dir) if name.endswith(".csv") and "/" not in name], ["grid.csv"])

    def test_bad_input_is_refused_with_what_is_allowed(self):
        for arguments, says in (
            ([*ONE, "--error", "1%"], ["needs a technique"]),
            ([*MAPS, "--error", "1%"], ["needs a scene"]),
            ([*ONE, *MAPS], ["needs a limit", "--error 1%"]),
            ([*ONE, *MAPS, "--each", "eror<=1%"], ["eror", "the nearest are error"]),
            ([*ONE, *MAPS, "--each", "error=1%"], ["NAME<=NUMBER"]),
            ([*ONE, *MAPS, "--error", "1"], ["100 %", "error<=1%"]),
            ([*ONE, *MAPS, "--least", "cost=lihgt", "--error", "1%"], ["lihgt", "light"]),
            ([*ONE, *MAPS, "--error", "1%", "--budget", "soon"], ["--budget soon", "10min"]),
            ([*ONE, *MAPS, "--error", "1%", "--over", "best"], ["worst or mean"]),
            (["shadow_map:resolution=64", *ONE, "--error", "1%"], ["one setting", "nothing to choose"]),
            ([*ONE, "--technique", "shadow_map:*,svbsp:*", "--error", "1%"], ["names 2 techniques", "--technique shadow_map:* --technique svbsp:*"]),
            (["shadow_map:alpha=*", *ONE, "--error", "1%"], ["one setting", "alpha (no mesh has holes)"]),
            (["shadow_map:resolutoin=*", *ONE, "--error", "1%"], ["resolutoin", "resolution"]),
            (["shadow_map:resolution={1,64}", *ONE, "--error", "1%"], ["resolution = 1", "64 .. 8192"]),
            (["--scene", "fence", "--light", "moon", *MAPS, "--error", "1%"], ["moon", "point"]),
            ([*ONE, *MAPS, "--error", "1%", "--resume"], ["--resume needs --out"]),
        ):
            with self.subTest(arguments[-3:]):
                self.refuse("tune", *arguments, says=says)


if __name__ == "__main__":
    unittest.main()
