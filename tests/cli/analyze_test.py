#!/usr/bin/python3 -IB
"""`gnomon analyze`: growth, fronts, budgets, maps and motion, from real runs and from runs made by hand."""

import csv
import io
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from program import HARD, NUMBERS, ROOT, SMALL, ProgramTest, records  # noqa: E402

SHIPPED = ROOT / "results/quick"


def record(technique="shadow_map", scene="soup", settings="", cost=1.0, wrong=0.1, **more):
    """A line of records.jsonl made by hand: three processes, each cost the same."""
    parameters = dict(pair.split("=") for pair in settings.split(",") if pair)
    row = {
        "schema": 7, "job": "", "scene": scene, "light": "point", "lights": [{"name": "point", "kind": "point", "answer": "binary"}], "answer": "binary",
        "technique": technique, "settings": settings,
        "parameters": {key: json.loads(value) for key, value in parameters.items()}, "width": 640, "height": 360,
        "status": "ok", "role": "contender", "bytes": 1 << 20, "classes": {"T": 1000},
        "stages": {stage: [[cost], [cost], [cost]] for stage in ("setup", "build", "relight", "resolve")},
        "metrics": {"shape": {"error": wrong, "wrong_rate": wrong}},
    }
    row.update(more)
    return row


class Analyze(ProgramTest):
    def run_of(self, *rows, name="run"):
        """A run's folder with these rows; every one that has no job is one of its own."""
        (self.dir / name).mkdir()
        lines = [json.dumps({**row, "job": row["job"] or f"{name}{k}"}) for k, row in enumerate(rows)]
        self.write(f"{name}/records.jsonl", "".join(line + "\n" for line in lines))
        return name

    def rows(self, *arguments):
        return list(csv.DictReader(io.StringIO(self.succeed("analyze", *arguments, "--format", "csv"))))

    def test_growth_finds_the_exponent_that_was_planted(self):
        run = self.run_of(*(record(scene=f"soup:count={n}", cost=n**1.5 / 100, scene_facts={"triangles": n})
                            for n in (10, 100, 1000, 10000)))
        for axis in ("triangles", "count"):
            rows = [row for row in self.rows(run, "growth", "--x", axis) if row["stage"] == "resolve"]
            self.assertEqual(len(rows), 1)
            self.assertEqual((rows[0]["scene"], rows[0]["points"]), ("soup:count=*", "4"))
            for column in ("exponent", "exponent_low", "exponent_high"):
                self.assertAlmostEqual(float(rows[0][column]), 1.5, places=9)
        text = self.succeed("analyze", run, "growth")
        self.assertRegex(text, r"(?m)^shadow_map +resolve +1\.50 +1\.50 \.\. 1\.50 +1\.50 \.\. 1\.50 +1\.50 +4 ")

    def test_growth_of_an_error_joins_seeds(self):
        run = self.run_of(*(record(technique="area_rays", settings=f"samples={n},seed={seed}", wrong=(1 + seed / 100) / n)
                            for n in (16, 64, 256) for seed in (1, 2, 3)))
        row, = self.rows(run, "growth", "--x", "samples", "--error", "wrong_rate")
        self.assertEqual((row["setting"], row["quantity"], row["points"], row["rows"]), ("area_rays", "wrong_rate", "3", "9"))
        self.assertAlmostEqual(float(row["exponent"]), -1, places=9)
        self.assertTrue(-1.02 < float(row["exponent_low"]) < -1 < float(row["exponent_high"]) < -0.98, row)
        self.assertAlmostEqual(float(row["wrong_rate_from"]), 1.02 / 16, places=9)
        text = self.succeed("analyze", run, "growth", "--x", "samples", "--error", "wrong_rate")
        self.assertIn("Growth of wrong_rate with samples: wrong_rate = coefficient * samples^exponent", text)
        self.refuse("analyze", run, "growth", "--x", "samples", "--error", "wrong_rat", says=["wrong_rat;", "wrong_rate"])
        script = self.succeed("figure", run, "growth", "--x", "samples", "--error", "wrong_rate", "--script")
        self.assertIn("-1.00", script)

    def test_two_points_are_said_to_be_too_few(self):
        run = self.run_of(*(record(scene=f"soup:count={n}", scene_facts={"triangles": n}) for n in (10, 100)))
        self.assertRegex(self.succeed("analyze", run, "growth"), r"(?m)^shadow_map +build +too few points +-")
        row = self.rows(run, "growth")[0]
        self.assertEqual((row["exponent"], row["why_not"]), ("", "too few points"))

    def test_a_run_without_a_sweep_is_refused_with_what_to_do(self):
        run = self.run_of(record(settings="bias=1", scene_facts={"triangles": 10}))
        self.refuse("analyze", run, "growth", says=["no growth with triangles", "sphere_field:count={4,16,64}"])
        self.refuse("analyze", run, "growth", "--x", "pixels", says=["no growth with pixels", "at several sizes"])
        self.refuse("analyze", run, "growth", "--x", "lights", says=["no growth with lights", "two lights of one scene"])
        for kind in (["growth"], ["map"], ["sweep"]):
            self.refuse("analyze", run, *kind, "--x", "bias", says=["ID:", "={A,B,C}"])
        self.refuse("analyze", run, "motion", says=["no row of these records follows a path", "paths = [...]"])
        failed = self.run_of(record(status="failed", stages={}, metrics={}, bytes=None), name="failed")
        self.refuse("analyze", failed, "growth", says=["no growth with triangles", "no row was measured"])
        for kind in ("front", "best", "map"):
            self.refuse("analyze", failed, kind, says=["no row of these records was measured"])

    def test_several_runs_are_analyzed_together(self):
        runs = [self.run_of(record(width=w, height=w, cost=w * w / 1000), name=f"run{w}") for w in (100, 200, 400)]
        rows = [row for row in self.rows(*runs, "growth", "--x", "pixels") if row["stage"] == "resolve"]
        self.assertAlmostEqual(float(rows[0]["exponent"]), 1, places=9)

    def test_a_row_of_two_folders_counts_once_and_two_answers_are_refused(self):
        both = record("fast", job="1"), record("slow", cost=4, wrong=0.05, job="2")
        self.run_of(*both, name="one")
        self.run_of(*both, record("other", job="3"), name="two")
        done = self.gnomon("analyze", "one", "two", "front", "--format", "csv", "--all")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(row["setting"] for row in csv.DictReader(io.StringIO(done.stdout))), ["fast", "other", "slow"])
        self.assertIn("2 rows stand in more than one folder", done.stderr)
        self.run_of(record("fast", wrong=0.2, job="1"), name="three")
        self.refuse("analyze", "one", "three", "front", says=["one and three answer soup point fast differently", "metrics.shape.error"])
        self.succeed("analyze", "one", "three", "front", "--filter", "slow")

    def test_a_path_is_part_of_what_the_filter_sees(self):
        run = self.run_of(record("moves", path="slide", frames={"wrong_rate": [0.1]}), record("stands"))
        rows = self.rows(run, "front", "--filter", "^soup point slide moves$")
        self.assertEqual([row["setting"] for row in rows], ["moves"])

    def test_an_option_that_a_kind_does_not_take_is_refused(self):
        run = self.run_of(record(settings="a=1,b=1"), record(settings="a=2,b=1"), record(settings="a=1,b=2"))
        self.refuse("analyze", run, "front", "--x", "a", says=["--x is for growth, forecast, map and sweep; front does not take it"])
        self.refuse("figure", run, "causes", "--error", "wrong_rate", "--script", says=["--error is for", "causes does not take it"])
        self.refuse("analyze", run, "front", "--times", "1", says=["--times is for best"])
        self.refuse("analyze", run, "best", "--cost", "bytes", says=["--cost bytes", "--memories"])
        self.refuse("analyze", run, "map", "--x", "a", "--y", "a", says=["--x and --y are both a"])
        self.refuse("figure", run, "growth", "--cost", "light", "--script", says=["--cost is for front and stages; growth"])
        self.refuse("analyze", run, "front", "--all-pairs", says=["--all-pairs is for rank; front does not take it"])
        self.refuse("analyze", run, "rank", "--all", says=["--all is for front; rank does not take it"])
        self.refuse("analyze", run, "sweep", "--x", "a", "--y", "b", says=["--y is for map; sweep does not take it"])

    def test_seams_show_where_the_error_lies(self):
        bins = ("0_1", "1_2", "2_4", "4_8", "8_16", "16_32", "32_64", "64_up")
        errors, shares = (0.8, 0.4, 0.2, 0.1, 0.05, 0.05, 0.05, 0.05), (0.02, 0.03, 0.05, 0.1, 0.2, 0.2, 0.2, 0.2)
        metrics = {"error": sum(e * s for e, s in zip(errors, shares)), **{f"error_seam_{b}": e for b, e in zip(bins, errors)},
                   **{f"seam_share_{b}": s for b, s in zip(bins, shares)}}
        run = self.run_of(record("cascaded_map", metrics={"shape": metrics}), record("svbsp"))
        row, = self.rows(run, "seams")
        self.assertEqual(row["setting"], "cascaded_map")
        self.assertEqual([float(row[f"error_seam_{b}"]) for b in bins], list(errors))
        self.assertAlmostEqual(float(row["near_share"]), 0.2)
        self.assertAlmostEqual(float(row["near_part"]), 0.048 / 0.088)
        self.assertIn("error in % by distance in px to the nearest seam", self.succeed("analyze", run, "seams"))
        self.refuse("analyze", run, "seams", "--error", "wrong_rate", says=["--error is for", "seams does not take it"])
        self.refuse("analyze", run, "seams", "--filter", "svbsp", says=["no row of these records has seams", "virtual_map"])

    def test_masks_are_compared_with_the_first_of_their_place(self):
        self.succeed("run", "--scene", "fence", *HARD, "--technique", "embree_rays", "--technique", "unshadowed", *SMALL, "--out", "run")
        rows = self.rows("run", "masks")
        self.assertEqual([(row["light"], row["base"], row["setting"]) for row in rows],
                         [(light, "embree_rays", "unshadowed") for light in ("point", "sun")])
        # The first mask is the reference and the other one is lit everywhere: they differ by 1 where the latter is wrong.
        errors = {row["light"]: row["metrics"]["shape"]["error"] for row in records(self.dir / "run") if row["technique"] == "unshadowed"}
        for row in rows:
            error = errors[row["light"]]
            self.assertGreater(error, 0.01)
            for column, value in (("changed_share", error), ("difference_mean", error), ("difference_rms", error**0.5), ("difference_max", 1)):
                self.assertAlmostEqual(float(row[column]), value, places=6)
        table = json.loads(self.succeed("analyze", "run", "masks", "--format", "json"))
        self.assertEqual((table["schema"], len(table["rows"]), len(table["rows"][0])), ("gnomon-table-1", 2, len(table["columns"])))
        for kind, head in (("md", "| base |"), ("tex", "\\begin{tabular}"), ("terminal", "Masks against")):
            self.assertIn(head, self.succeed("analyze", "run", "masks", "--format", kind))
        self.refuse("analyze", "run", "masks", "--filter", "unshadowed", says=["no two rows of one place have masks"])
        self.refuse("analyze", "run", "masks", "--error", "wrong_rate", says=["masks does not take it"])
        self.refuse("analyze", "run", "run", "masks", says=["masks are compared within one run, and run, run are given"])
        next((self.dir / "run/masks").glob("*sun*unshadowed*")).unlink()
        self.refuse("analyze", "run", "masks", says=["the mask", "fence sun unshadowed", "is not there"])

    def test_rows_without_a_mask_are_counted_where_masks_are_compared(self):
        self.succeed("run", "--scene", "fence", "--light", "sun", "--technique", "embree_rays", "--technique", "unshadowed", *NUMBERS, "--out", "run")
        self.refuse("analyze", "run", "masks", says=["no two rows of one place have masks", "2 rows left out: no mask was kept"])

    def test_numbers_are_numbers(self):
        run = self.run_of(record(), record("other", cost=2))
        for value in ("nan", "inf", "-1", "0", "1x", "2,nan"):
            self.refuse("analyze", run, "best", "--times", value, says=["--times", value.split(",")[-1], "a number above 0"])
        self.refuse("figure", run, "front", "--script", "--width", "nan", says=["--width", "nan is not a number in 5 .. 100"])
        self.refuse("compare", run, run, "--floor", "nan", says=["--floor", "nan is not a number in 0 .. 10"])
        self.succeed("analyze", run, "best", "--times", "1,2.5e1")

    def test_what_cannot_be_ranked_is_refused(self):
        run = self.run_of(record(metrics={"shape": {"wrong_rate": 0.1, "penumbra_shift": 1}}))
        for kind in ("front", "best", "rank"):
            self.refuse("analyze", run, kind, "--error", "penumbra_shift", says=["penumbra_shift has no better side"])
        only = self.run_of(record(role="reference"), name="only")
        self.refuse("analyze", only, "front", says=["nothing to rank", "no contender"])
        self.refuse("analyze", only, "rank", says=["nothing to rank", "no two contenders finished with the number error"])
        both = self.run_of(record("one"), record("other"), name="both")
        self.refuse("analyze", both, "rank", "--cost", "motion", says=["nothing to rank by motion", "no two contenders"])

    def test_front_of_a_run_made_by_hand(self):
        run = self.run_of(record("fast", cost=1, wrong=0.3), record("slow", cost=4, wrong=0.1),
                          record("bad", cost=5, wrong=0.2), record("truth", cost=1, wrong=0, role="reference"))
        found = {row["setting"]: (row["standing"], row["beaten_by"]) for row in self.rows(run, "front")}
        self.assertEqual(found, {"fast": ("front", ""), "slow": ("front", ""), "bad": ("beaten", "slow"),
                                 "truth": ("aside", "")})
        text = self.succeed("analyze", run, "front")
        self.assertNotRegex(text, "(?m)^bad ")
        self.assertIn("1 setting that is beaten or constant is not shown", text)
        self.assertRegex(self.succeed("analyze", run, "front", "--all"), r"(?m)^bad +20\.0 +10\.0 .*beaten \(slow\)")
        memory = {row["setting"]: row["standing"] for row in self.rows(run, "front", "--cost", "bytes")}
        self.assertEqual(memory, {"fast": "beaten", "slow": "front", "bad": "beaten", "truth": "aside"})

    def test_ranks_of_a_run_made_by_hand(self):
        scenes = [f"soup:count={n}" for n in range(1, 9)]
        run = self.run_of(*(record(name, scene, cost=cost, wrong=wrong) for scene in scenes
                            for name, cost, wrong in (("map", 1, 0.1), ("rays", 4, 0.05))),
                          record("gone", scenes[0], status="failed", reason="it crashed", stages={}, metrics={}, bytes=None),
                          record("gone", scenes[1], cost=2, wrong=0.2), record("truth", scenes[0], wrong=0, role="reference"))
        rows = self.rows(run, "rank", "--cost", "light")
        found = [(row["quantity"], row["setting"], row["against"], row["places"], row["left_out"], row["verdict"]) for row in rows]
        self.assertEqual(found, [("error", "rays", "map", "8", "0", "better"), ("error", "rays", "gone", "1", "7", "too few places"),
                                 ("light", "rays", "map", "8", "0", "worse"), ("light", "rays", "gone", "1", "7", "too few places")])
        self.assertAlmostEqual(float(rows[0]["ratio"]), 0.5)
        self.assertAlmostEqual(float(rows[2]["ratio"]), 4)
        self.assertEqual((rows[0]["p"], rows[0]["p_holm"], rows[0]["tests"], rows[0]["needed_places"]), ("0.0078125", "0.0234375", "3", "7"))
        self.assertEqual(len(rows[1]["left_out_places"].split("; ")), 7)
        text = self.succeed("analyze", run, "rank")
        self.assertRegex(text, r"(?m)^rays +map +0\.50 +0\.50 \.\. 0\.50 +0\.023 +8 +8 +0 +better$")
        self.assertIn("left out of pairs: soup:count=1, point (gone: failed, it crashed)\n", text)
        self.assertIn("by memory", text)
        pairs = [(row["setting"], row["against"]) for row in self.rows(run, "rank", "--cost", "bytes", "--all-pairs")]
        self.assertEqual(pairs, 2 * [("rays", "map"), ("rays", "gone"), ("map", "gone")])

    def test_the_cost_of_motion_is_of_rows_whose_geometry_moves(self):
        def moving(update, wrong):
            one = record(cost=1, wrong=wrong, settings=f"k={update}", path="walk", start=0, frame_rate=60)
            return {**one, "stages": {**one["stages"], "update": 3 * [[update]]}, "moving_stages": {"relight": 3 * [[0.5]], "resolve": 3 * [[2]]}}

        run = self.run_of(moving(1, 0.2), moving(4, 0.1), moving(5, 0.3), record("still"))
        rows = {row["setting"]: (float(row["cost_ms"]), row["standing"]) for row in self.rows(run, "front", "--cost", "motion")}
        self.assertEqual(rows, {"shadow_map:k=1": (3.5, "front"), "shadow_map:k=4": (6.5, "front"), "shadow_map:k=5": (7.5, "beaten")})
        text = self.succeed("analyze", run, "front", "--cost", "motion")
        self.assertIn("Front of error in % against update + relight + resolve", text)
        self.assertIn("left out: 1 row whose geometry stands still", text)
        self.assertIn("shadow_map:k=4", self.succeed("analyze", run, "best", "--cost", "motion", "--times", "7"))
        standing = self.run_of(record("still"), name="standing")
        self.refuse("analyze", standing, "front", "--cost", "motion", says=["there is no cost of motion", "follow an animation"])
        script = self.succeed("figure", run, "stages", "--cost", "motion", "--filter", "walk", "--script")
        self.assertIn("'moving relight'", script)
        self.assertNotIn("'build'", script)
        self.refuse("figure", run, "stages", "--cost", "bytes", "--script", says=["--cost bytes has no stages", "motion"])
        table = list(csv.DictReader(io.StringIO(self.succeed("table", run, "--format", "csv"))))
        self.assertEqual([(row["update_ms"], row["motion_ms"], row["frame_rate"]) for row in table],
                         [("1", "3.5", "60"), ("4", "6.5", "60"), ("5", "7.5", "60"), ("", "", "")])

    def test_what_does_not_beat_a_constant_mask_is_called_best_nowhere(self):
        def rated(name, cost, error):
            return record(name, cost=cost, metrics={"shape": {"error": error, "constant_error": 0.25, "wrong_rate": 0}})
        run = self.run_of(rated("half", 1, 0.5), rated("constant", 2, 0.25), rated("map", 4, 0.2), rated("rays", 8, 0.1))
        standings = {row["setting"]: row["standing"] for row in self.rows(run, "front")}
        self.assertEqual(standings, {"half": "constant", "constant": "constant", "map": "front", "rays": "front"})
        # However it is ranked: none of them is wrong anywhere.
        standings = {row["setting"]: row["standing"] for row in self.rows(run, "front", "--error", "wrong_rate")}
        self.assertEqual(standings, {"half": "constant", "constant": "constant", "map": "front", "rays": "beaten"})
        best = [row["setting"] for row in self.rows(run, "best", "--times", "3,9", "--errors", "60")]
        self.assertEqual(best, ["", "map", "map"])
        text = self.succeed("analyze", run, "front")
        self.assertIn("best constant mask 25.0 %", text)
        self.assertIn("2 settings that are beaten or constant are not shown", text)
        table = self.succeed("table", run, "--format", "md")
        self.assertRegex(table, r"\| half \|[^*]*\n")
        self.assertRegex(table, r"\| map \|.*\*\*4\.00\*\*")
        self.assertIn("best constant mask: error of the best mask of one value everywhere", table)
        script = self.succeed("figure", run, "front", "--script")
        self.assertIn("title 'best constant mask'", script)

    def test_budgets_are_given_in_the_units_that_tables_show(self):
        run = self.run_of(record("fast", cost=1, wrong=0.3), record("slow", cost=4, wrong=0.1))
        rows = self.rows(run, "best", "--times", "2,8", "--errors", "10,30")
        self.assertEqual([(row["limited"], float(row["budget"]), row["setting"]) for row in rows],
                         [("time", 2, "fast"), ("time", 8, "slow"), ("error", 0.1, "slow"), ("error", 0.3, "fast")])
        self.assertRegex(self.succeed("analyze", run, "best", "--errors", "5"), r"(?m)^error ≤ 5 % +none +-")

    def test_a_map_is_a_pivot_for_people_and_tidy_for_programs(self):
        run = self.run_of(*(record(settings=f"bias={bias},resolution={size}", wrong=(abs(bias - 1) + 100 / size) / 10)
                            for bias in (0, 1, 2) for size in (256, 1024)))
        rows = self.rows(run, "map")
        self.assertEqual(len(rows), 6)
        self.assertEqual([(row["parameter.bias"], row["parameter.resolution"]) for row in rows if row["best"] == "true"],
                         [("1", "1024")])
        text = self.succeed("analyze", run, "map")
        self.assertRegex(text, r"(?m)^1024 +11\.0 +0\.98\* +11\.0")
        self.assertRegex(text, r"\Aerror in %, mean over 1 place\n\nshadow_map: resolution \(rows\) against bias \(columns\)\n\nresolution +0 +1 +2\n")
        self.assertRegex(self.succeed("analyze", run, "map", "--x", "resolution", "--facet", "bias"),
                         r"(?m)^shadow_map: resolution; bias=2\n\n +256 +1024$")

    def test_a_sweep_is_a_line_a_setting_for_people_and_a_row_a_point_for_programs(self):
        run = self.run_of(*(record(name, f"composite:object=cone,light_x={x}", wrong=rate * x)
                            for name, rate in (("paper", 0.01), ("exact", 0)) for x in (0, 2, 5)),
                          record("printed", "composite:object=cone,light_x=0"),
                          record("printed", "composite:object=cone,light_x=2", status="unsupported", reason="below", metrics={}))
        text = self.succeed("analyze", run, "sweep", "--x", "light_x")
        self.assertRegex(text, r"\Aerror in % against light_x in m\n\ntechnique +0 +2 +5\n")
        self.assertRegex(text, r"(?m)^composite:object=cone,light_x=\*, point\npaper +0 +2\.00 +5\.00\nexact +0 +0 +0\n"
                               r"printed +10\.0 +- +-\n")
        self.assertIn("\n-: no value; 1 not supported, 1 not run\n", text)
        rows = self.rows(run, "sweep", "--x", "light_x")
        self.assertEqual([(row["setting"], row["parameter.light_x"], row["error"], row["status"]) for row in rows[5:]],
                         [("exact", "5", "0", "ok"), ("printed", "0", "0.1", "ok"), ("printed", "2", "", "unsupported")])
        self.assertEqual({row["scene"] for row in rows}, {"composite:object=cone,light_x=*"})
        times = self.rows(run, "sweep", "--x", "light_x", "--error", "relight_ms")
        self.assertEqual((times[0]["relight_ms"], times[0]["relight_ms_low"]), ("1", "1"))

    def test_rows_of_all_kinds_are_judged_by_one_error(self):
        soft = {"light": "lamp", "light_kind": "disc", "lights": [{"name": "lamp", "kind": "disc", "answer": "fraction"}], "answer": "fraction"}
        def metrics(error):
            return {"metrics": {"shape": {"error": error, "wrong_rate": 0, "error_floor": 0.001}}}
        run = self.run_of(record("hard", wrong=0.2), record("soft", cost=2, **soft, **metrics(0.03)),
                          record("better", cost=4, **soft, **metrics(0.01)))
        rows = {row["setting"]: row for row in self.rows(run, "front")}
        self.assertEqual([(name, row["error"], row["error_floor"]) for name, row in sorted(rows.items())],
                         [("better", "0.01", "0.001"), ("hard", "0.2", ""), ("soft", "0.03", "0.001")])
        self.assertEqual({row["standing"] for row in rows.values()}, {"front"})
        text = self.succeed("analyze", run, "front")
        self.assertRegex(text, r"(?m)^soft +3\.00 +0\.10 +")
        self.assertRegex(text, r"(?m)^hard +20\.0 +- +")
        script = self.succeed("figure", run, "front", "--script")
        self.assertEqual(script.count("set ylabel 'error (%)'"), 2)
        table = self.succeed("table", run, "--format", "md")
        self.assertRegex(table, r"\| lamp \| better \|.*\*\*1\.00\*\* \| 0\.10 \|")
        self.assertEqual(table.count("| technique |"), 2)

    def test_what_was_not_swept_is_no_empty_table(self):
        run = self.run_of(record(settings="a=1"), record(settings="a=2"), record("other", "soup:count=10"))
        self.refuse("analyze", run, "sweep", says=["sweep wants --x PARAMETER; swept are: a"])
        self.refuse("analyze", run, "sweep", "--x", "count", says=["there is no sweep of count", "swept are: a"])
        self.refuse("analyze", run, "sweep", "--x", "aa", says=["there is no numeric parameter aa; did you mean a?"])
        self.refuse("analyze", run, "sweep", "--x", "a", "--error", "wrong_rat", says=["there is no wrong_rat; did you mean wrong_rate?"])
        self.refuse("analyze", run, "growth", says=["there is no growth with triangles", "no row that was measured has a positive one", "sphere_field:count="])

    def test_motion_takes_rows_on_paths(self):
        run = self.run_of(record(path="slide", frames={"error": [0.1, 0.3], "wrong_rate": [0.1, 0.3], "instability": [None, 0.02]}), record())
        rows = self.rows(run, "motion")
        self.assertEqual(len(rows), 1)
        columns = ("frames", "instability_max", "error_max", "error_frame")
        self.assertEqual(tuple(rows[0][column] for column in columns), ("2", "0.02", "0.3", "1"))

    def test_bad_words_are_named(self):
        run = self.run_of(record())
        self.refuse("analyze", run, "fornt", says=["there is no analysis fornt; did you mean front?"])
        self.refuse("analyze", run, "front", "--error", "wrong_rat", says=["there is no wrong_rat; did you mean wrong_rate?"])
        self.refuse("analyze", run, "front", "--cost", "money", says=["money", "resolve, light, geometry, motion, bytes"])
        self.refuse("analyze", run, "growth", "--x", "triangels", says=["triangels", "triangles, pixels, lights"])
        self.refuse("analyze", run, "motion", says=["no row of these records follows a path"])
        self.refuse("analyze", run, "front", "--filter", "no such row", says=["holds no record that matches no such row"])
        self.refuse("analyze", run, "front", "--filter", "(", says=["--filter ( is not a regular expression"])
        self.refuse("analyze", "front", says=["a run's folder and a kind", "growth, forecast, front, best, enough, rank, map, motion, sweep, seams, masks"])
        self.refuse("analyze", "nowhere", "front", says=["nowhere"])

    def test_the_shipped_run_has_a_front_over_all_its_scenes(self):
        rows = self.rows(SHIPPED, "front")
        overall = [row for row in rows if not row["scene"]]
        self.assertGreaterEqual(sum(row["standing"] == "front" for row in overall), 1)
        self.assertEqual([row["setting"] for row in overall if row["role"] == "reference"], ["embree_rays"])

    def test_what_runs_is_analyzed(self):
        self.succeed("run", "--scene", "sphere_field:count=5", "--scene", "sphere_field:count=20",
                     "--scene", "sphere_field:count=80", "--technique", "shadow_map:resolution={256,1024}", "--technique",
                     "unshadowed", "--light", "sun", *NUMBERS, "--out", "out")
        growth = [row for row in self.rows("out", "growth") if row["stage"] == "relight" and "shadow_map" in row["setting"]]
        self.assertEqual([row["points"] for row in growth], ["3", "3"])
        best = [row["parameter.resolution"] for row in self.rows("out", "map") if row["best"] == "true"]
        self.assertEqual(best, ["1024"])
        for kind in ("growth", "front", "best", "rank", "map"):
            for form in ("terminal", "md", "tex", "json"):
                self.assertTrue(self.succeed("analyze", "out", kind, "--format", form))
        sweep = self.rows("out", "sweep", "--x", "count", "--error", "shadow_area_ratio")
        self.assertEqual([row["parameter.count"] for row in sweep], ["5", "20", "80"] * 3)
        for row in sweep:
            lit = row["setting"] == "unshadowed"
            self.assertAlmostEqual(float(row["shadow_area_ratio"]), 0 if lit else 1, delta=0 if lit else 0.3)


if __name__ == "__main__":
    unittest.main()
