#include "analysis/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "measure/run/batch.h"
#include "measure/score/metrics.h"
#include "report/analysis/compare_table.h"

namespace compare_test {

using namespace gnomon;

/// Five processes around `center` milliseconds, one percent apart.
ProcessTimes around(double center) {
  ProcessTimes times;
  for (int k = -2; k <= 2; ++k)
    times.push_back({center * (1 + 0.01 * k), center * (1 + 0.01 * k), center * (1.005 + 0.01 * k)});
  return times;
}

Record record(const std::string& job, const std::string& technique = "shadow_map", const std::string& light = "sun") {
  Record r;
  r.job = job;
  r.scene = "box_city";
  r.light = light;
  r.technique = technique;
  r.width = 64, r.height = 36;
  r.status = Status::ok;
  r.times(Stage::setup) = {{80}, {90}, {85}, {70}, {95}};
  r.times(Stage::build) = around(0.4);
  r.times(Stage::relight) = around(2);
  r.times(Stage::resolve) = around(1);
  for (const Truth truth : {Truth::shape, Truth::mesh})
    r.metrics[truth] = {{"error", 0.01}, {"wrong_rate", 0.01}, {"false_dark_rate", 0.004}, {"displacement_mean", std::nullopt}};
  r.context = {{"processor", "A"}, {"cores", 8},          {"threads", 8},
               {"commit", "one"},  {"scene_hash", "abc"}, {"load_average", 0.5}};
  return r;
}

/// Ten rows, so that there is something to read the drift from.
std::vector<Record> run() {
  std::vector<Record> records;
  for (int k = 0; k < 10; ++k) records.push_back(record("job" + std::to_string(k), "technique" + std::to_string(k)));
  return records;
}

const StageChange& stage(const RowChange& row, Stage wanted) {
  return *std::find_if(row.stages.begin(), row.stages.end(), [&](const StageChange& s) { return s.stage == wanted; });
}

void scale(Record& record, Stage stage, double factor) {
  for (std::vector<double>& process : record.times(stage))
    for (double& time : process) time *= factor;
}

TEST(compare, a_run_and_itself_do_not_differ) {
  const std::vector<Record> base = run();
  const Comparison comparison = compare(base, base);
  const auto counts = comparison.counts();
  EXPECT_EQ(counts.matched, 10u);
  EXPECT_EQ(counts.judged, 30u) << "three stages, setup is listed only";
  EXPECT_EQ(counts.slower + counts.faster + counts.changed_metrics + counts.regressions, 0u);
  EXPECT_TRUE(comparison.differences.empty());
  EXPECT_TRUE(std::none_of(comparison.rows.begin(), comparison.rows.end(), [](const RowChange& r) { return r.differs(); }));
  EXPECT_EQ(stage(comparison.rows[0], Stage::resolve).ratio->value, 1);
  EXPECT_EQ(stage(comparison.rows[0], Stage::setup).verdict, Verdict::not_judged);
}

TEST(compare, counted_work_is_compared_exactly_and_times_among_it_are_not) {
  std::vector<Record> base = run(), contender = run();
  for (std::vector<Record>* records : {&base, &contender})
    for (Record& r : *records) r.counts = {{"rays", 1000, "ray"}, {"parse", 3, "ms"}};
  contender[2].counts = {{"parse", 4, "ms"}, {"rays", 1001, "ray"}, {"new", 5, ""}};
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(comparison.counts().rows_of_other_work, 1u);
  const std::vector<CountChange>& changes = comparison.rows[2].counts;
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].name, "rays");
  EXPECT_EQ(changes[0].base, 1000);
  EXPECT_EQ(changes[0].contender, 1001);
  EXPECT_TRUE(comparison.rows[2].differs());
  EXPECT_FALSE(comparison.rows[3].differs());
  const CompareTableOptions options{"before", "after", false};
  const std::string text = render_comparison(comparison, Format::terminal, options);
  EXPECT_NE(text.find("rays, ray"), std::string::npos) << text;
  EXPECT_NE(text.find("0 rows with other errors, 1 with other work"), std::string::npos) << summary_line(comparison);
  EXPECT_NE(render_comparison(comparison, Format::csv, options).find(",count,rays,,1000,1001,1.001,"), std::string::npos);
}

TEST(compare, other_code_is_said) {
  std::vector<Record> base = run(), contender = run();
  base[1].context["technique_source"] = "a";
  contender[1].context["technique_source"] = "b";
  contender[2].context["technique_source"] = "b";  // the base does not say
  for (Record& r : contender) r.context["build"] = "two";
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(comparison.rows[1].notes, std::vector<std::string>{"the source of the technique has changed"});
  EXPECT_TRUE(comparison.rows[2].notes.empty());
  EXPECT_EQ(comparison.differences, (std::vector<std::pair<std::string, std::string>>{{"build", "- -> two"}}));
}

TEST(compare, what_could_have_been_found_is_said_with_the_command_that_finds_less) {
  std::vector<Record> base = run(), contender = run();
  for (Record& r : contender) r.suite = "quick";
  const Comparison apart = compare(base, contender);
  EXPECT_GT(apart.least_ratio, 1.05);
  const std::string text = render_comparison(apart, Format::terminal, {"before", "after", false});
  EXPECT_NE(text.find("could find: times that are "), std::string::npos) << text;
  EXPECT_NE(text.find("gnomon compare --live PROGRAM --suite quick"), std::string::npos) << text;
  for (std::vector<Record>* records : {&base, &contender})
    for (Record& r : *records) r.context["side_by_side"] = "mark";
  const Comparison paired = compare(base, contender);
  EXPECT_LT(paired.least_ratio, apart.least_ratio);
  EXPECT_EQ(render_comparison(paired, Format::terminal, {"before", "after", false}).find("--live"), std::string::npos);
}

TEST(compare, a_slower_stage_is_a_regression_and_a_faster_one_is_not) {
  const std::vector<Record> base = run();
  std::vector<Record> contender = run();
  scale(contender[3], Stage::resolve, 1.3);
  scale(contender[4], Stage::relight, 0.6);
  const Comparison comparison = compare(base, contender);
  const StageChange& slow = stage(comparison.rows[3], Stage::resolve);
  EXPECT_EQ(slow.verdict, Verdict::slower);
  EXPECT_TRUE(slow.is_regression);
  EXPECT_NEAR(slow.ratio->value, 1.3, 1e-9);
  EXPECT_LT(slow.ratio->low, 1.3);
  EXPECT_GT(slow.ratio->low, 1.05);
  EXPECT_EQ(stage(comparison.rows[4], Stage::relight).verdict, Verdict::faster);
  EXPECT_EQ(comparison.counts().regressions, 1u);
  EXPECT_EQ(comparison.counts().slower, 1u);
  // The same above a threshold that allows it: slower, and no regression.
  EXPECT_EQ(compare(base, contender, {.threshold = 1.5}).counts().regressions, 0u);
  // A floor above it: not even slower.
  EXPECT_EQ(compare(base, contender, {.floor = 0.5}).counts().slower, 0u);
}

TEST(compare, times_below_the_clock_are_not_judged_and_count_as_its_resolution) {
  std::vector<Record> base = run(), contender = run();
  base[0].times(Stage::resolve) = around(0.001);
  contender[0].times(Stage::resolve) = around(0.004);
  base[1].times(Stage::resolve) = around(0.001);
  contender[1].times(Stage::resolve) = around(0.05);
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(stage(comparison.rows[0], Stage::resolve).verdict, Verdict::not_judged);
  EXPECT_EQ(stage(comparison.rows[0], Stage::resolve).why, "below 0.005 ms in both runs");
  EXPECT_EQ(stage(comparison.rows[1], Stage::resolve).verdict, Verdict::slower);
  EXPECT_NEAR(stage(comparison.rows[1], Stage::resolve).ratio->value, 0.05 / 0.005, 0.1);
}

TEST(compare, times_of_other_processors_are_not_judged_unless_forced) {
  const std::vector<Record> base = run();
  std::vector<Record> contender = run();
  for (Record& r : contender) r.context["processor"] = "B", scale(r, Stage::resolve, 2);
  const Comparison refused = compare(base, contender);
  EXPECT_EQ(refused.counts().judged, 0u);
  EXPECT_NE(refused.refusal.find("processor"), std::string::npos);
  ASSERT_EQ(refused.differences.size(), 1u);
  EXPECT_EQ(refused.differences[0], (std::pair<std::string, std::string>("processor", "A -> B")));
  EXPECT_EQ(compare(base, contender, {.force = true}).counts().slower, 10u);
}

TEST(compare, what_the_load_explains_is_not_called) {
  // 8 cores under load 0.5, then 25.5: 24 more than the run's own leave a worker (8 + 0.5) / (8 + 0.5 + 24), a quarter.
  const std::vector<Record> base = run();
  std::vector<Record> contender = run();
  for (Record& r : contender) r.context["load_average"] = 25.5, scale(r, Stage::resolve, 2);
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(comparison.counts().slower, 0u);
  EXPECT_NE(stage(comparison.rows[0], Stage::resolve).why.find("load of the machine"), std::string::npos);
  ASSERT_EQ(comparison.differences.size(), 1u);
  EXPECT_EQ(comparison.differences[0].first, "load_average");
  // The other way round it explains nothing: the busier run was the faster one.
  EXPECT_EQ(compare(contender, base).counts().faster, 0u);
  for (Record& r : contender) scale(r, Stage::resolve, 0.25);
  EXPECT_EQ(compare(base, contender).counts().faster, 10u);
}

TEST(compare, every_changed_metric_is_listed_once_for_equal_truths) {
  const std::vector<Record> base = run();
  std::vector<Record> contender = run();
  for (const Truth truth : {Truth::shape, Truth::mesh}) contender[2].metrics[truth]["false_dark_rate"] = 0.005;
  contender[2].metrics[Truth::mesh]["wrong_rate"] = 0.5;
  contender[5].metrics[Truth::shape]["displacement_mean"] = 1.5;
  contender[6].metrics[Truth::shape]["error"] = 0.01005;  // below the threshold
  contender[7].metrics[Truth::shape]["error"] = 0.0102;   // above it
  contender[8].metrics[Truth::shape]["error"] = 0.001;
  contender[9].metrics[Truth::shape]["ssim_of_the_future"] = 1;
  const Comparison comparison = compare(base, contender);
  ASSERT_EQ(comparison.rows[2].metrics.size(), 2u);
  EXPECT_EQ(comparison.rows[2].metrics[0].metric, "false_dark_rate");
  EXPECT_EQ(comparison.rows[2].metrics[0].truth, Truth::shape);
  EXPECT_EQ(comparison.rows[2].metrics[1].metric, "wrong_rate");
  EXPECT_EQ(comparison.rows[2].metrics[1].truth, Truth::mesh);
  EXPECT_FALSE(comparison.rows[2].regressed()) << "the headline truth decides";
  EXPECT_EQ(comparison.rows[5].metrics[0].base, std::nullopt);
  EXPECT_EQ(comparison.rows[5].metrics[0].contender, 1.5);
  EXPECT_FALSE(comparison.rows[6].regressed());
  EXPECT_TRUE(comparison.rows[7].regressed());
  EXPECT_FALSE(comparison.rows[8].regressed()) << "a smaller error is no regression";
  EXPECT_TRUE(comparison.rows[9].metrics.empty()) << "a metric that only one run has did not change";
  EXPECT_EQ(comparison.counts().changed_rows, 5u);
}

TEST(compare, missing_new_and_broken_rows_are_said) {
  std::vector<Record> base = run(), contender = run();
  base.push_back(record("gone", "old"));
  contender.push_back(record("fresh", "young"));
  contender[0].status = Status::failed;
  contender[0].reason = "crashed in relight";
  base[1].status = Status::failed;
  base[2].support = Support::Kind::full;
  contender[2].support = Support::Kind::approximate;
  contender[2].reason = "one light only";
  const Comparison comparison = compare(base, contender);
  const auto counts = comparison.counts();
  EXPECT_EQ(counts.matched, 10u);
  EXPECT_EQ(counts.missing, 1u);
  EXPECT_EQ(counts.added, 1u);
  EXPECT_EQ(counts.status, 2u);
  EXPECT_EQ(counts.regressions, 1u) << "what failed before and works now is none";
  EXPECT_EQ(comparison.rows[0].notes, std::vector<std::string>{"ok -> failed: crashed in relight"});
  EXPECT_EQ(comparison.rows[2].notes, std::vector<std::string>{"support: full -> approximate: one light only"});
  EXPECT_EQ(comparison.rows.back().contender, nullptr) << "missing rows are last";
}

TEST(compare, another_scene_under_the_same_name_is_not_compared) {
  const std::vector<Record> base = run();
  std::vector<Record> contender = run();
  contender[0].context["scene_hash"] = "def";
  contender[0].metrics[Truth::shape]["error"] = 0.9;
  scale(contender[0], Stage::resolve, 9);
  const Comparison comparison = compare(base, contender);
  EXPECT_TRUE(comparison.rows[0].differs());
  EXPECT_FALSE(comparison.rows[0].regressed());
  EXPECT_TRUE(comparison.rows[0].metrics.empty());
  EXPECT_EQ(stage(comparison.rows[0], Stage::resolve).why, "the scene has changed");
}

TEST(compare, a_changed_default_is_said) {
  std::vector<Record> base = run(), contender = run();
  base[0].parameters = {{"resolution", 1024}, {"bias", "auto"}};
  contender[0].parameters = {{"resolution", 2048}, {"bias", "auto"}, {"filter", "pcf"}};
  EXPECT_EQ(compare(base, contender).rows[0].notes,
            std::vector<std::string>{"parameters changed: resolution: 1024 -> 2048, filter is new: pcf"});
}

TEST(compare, build_times_that_lights_share_are_judged_once) {
  std::vector<Record> base, contender;
  for (const char* light : {"point", "sun"}) base.push_back(record(light, "shadow_map", light));
  contender = base;
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(comparison.counts().judged, 5u) << "build once, relight and resolve twice";
  EXPECT_EQ(stage(comparison.rows[1], Stage::build).why, "the same times as under another light");
}

TEST(compare, one_process_is_not_judged) {
  std::vector<Record> base = run(), contender = run();
  for (Record& r : base)
    for (ProcessTimes& times : r.stages) times.resize(1);
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(comparison.counts().judged, 0u);
  EXPECT_EQ(stage(comparison.rows[0], Stage::resolve).why, "needs two processes in each run");
}

TEST(compare, what_all_scenes_agree_on_is_found_where_no_row_is_sure) {
  // Every process median is 40 % off one way or the other, so no row alone can show 1.3; but all of five scenes do.
  std::vector<Record> base;
  for (int scene = 0; scene < 5; ++scene)
    for (const char* technique : {"shadow_map", "embree_rays"}) {
      Record r = record(std::string(technique) + std::to_string(scene), technique);
      r.scene = "scene" + std::to_string(scene);
      for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve})
        r.times(stage) = {{1.0}, {1.4}, {0.7}, {1.5}, {0.65}};
      base.push_back(std::move(r));
    }
  std::vector<Record> contender = base;
  for (Record& r : contender)
    if (r.technique == "shadow_map") scale(r, Stage::resolve, 1.3);
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(comparison.counts().slower, 0u);
  ASSERT_EQ(comparison.overall.size(), 9u) << "three stages: all rows, and each of two contenders";
  for (const OverallChange& change : comparison.overall) {
    const bool is_it = change.contender == "shadow_map" && change.stage == Stage::resolve;
    EXPECT_EQ(change.verdict == Verdict::slower, is_it) << change.contender << ' ' << name(change.stage);
    if (is_it) {
      EXPECT_NEAR(change.ratio.value, 1.3, 1e-9);
    }
  }
  EXPECT_EQ(comparison.counts().regressions, 1u);
  // One scene says nothing of what scenes agree on.
  EXPECT_TRUE(compare(run(), run()).overall.empty());
}

TEST(compare, runs_side_by_side_are_compared_in_pairs) {
  // The machine slows down threefold from process to process, for both: apart that hides 10 %, in pairs it does not.
  std::vector<Record> base = run(), contender = run();
  for (std::vector<Record>* records : {&base, &contender})
    for (Record& r : *records)
      for (std::size_t process = 0; process < 5; ++process)
        for (double& time : r.times(Stage::resolve)[process]) time *= std::pow(3.0, process);
  for (Record& r : contender) scale(r, Stage::resolve, 1.1);
  EXPECT_EQ(compare(base, contender).counts().slower, 0u);
  for (std::vector<Record>* records : {&base, &contender})
    for (Record& r : *records) r.context["side_by_side"] = "mark";
  const Comparison comparison = compare(base, contender);
  EXPECT_TRUE(comparison.side_by_side);
  EXPECT_EQ(comparison.counts().slower, 10u);
  base[0].context["side_by_side"] = "other";
  EXPECT_FALSE(compare(base, contender).side_by_side) << "rows of another run are no pairs";
}

TEST(compare_table, people_see_what_differs_and_programs_everything) {
  const std::vector<Record> base = run();
  std::vector<Record> contender = run();
  scale(contender[3], Stage::resolve, 1.5);
  contender[5].metrics[Truth::shape]["error"] = 0.02;
  const Comparison comparison = compare(base, contender);
  const CompareTableOptions options{"before", "after"};
  const std::string text = render_comparison(comparison, Format::terminal, options);
  EXPECT_NE(text.find("slower !"), std::string::npos) << text;
  EXPECT_NE(text.find("1.0 %"), std::string::npos) << text;
  EXPECT_NE(text.find("+1.0 %"), std::string::npos) << text;
  EXPECT_EQ(text.find("technique4"), std::string::npos) << "it does not differ";
  EXPECT_TRUE(text.ends_with("10 rows matched; 30 times judged: 1 slower, 0 faster; 1 row with other errors; 2 regressions\n"))
      << text;
  const std::string all = render_comparison(comparison, Format::terminal, {"before", "after", true});
  EXPECT_NE(all.find("technique4"), std::string::npos);
  EXPECT_NE(all.find("not distinguishable"), std::string::npos);

  const std::string csv = render_comparison(comparison, Format::csv, options);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 10 + 40 + 1) << "header, rows, times, metrics";
  const Json json = Json::parse(render_comparison(comparison, Format::json, options));
  EXPECT_EQ(json["rows"].size(), 10u);
  EXPECT_EQ(json["rows"][3]["times"][3]["verdict"], "slower");
  EXPECT_EQ(json["counts"]["regressions"], 2);
  EXPECT_THROW(render_comparison(comparison, Format::latex, options), Error);
}

TEST(compare_table, numbers_have_the_digits_that_tell_them_apart_and_a_unit) {
  std::vector<Record> base = run(), contender = run();
  base[5].metrics[Truth::shape]["displacement_mean"] = 0.018221485499772407;
  contender[5].metrics[Truth::shape]["displacement_mean"] = 0.017893087049536047;
  const std::string text = render_comparison(compare(base, contender), Format::markdown, {"before", "after"});
  EXPECT_NE(text.find("| 0.0182 px | 0.0179 px | -0.00033 px |"), std::string::npos) << text;
}

TEST(enough, interval_of_relight_and_resolve_decides) {
  // Five processes one percent apart: the interval runs from the least to the greatest, 4 % of the time, and a little more.
  Record r = record("a");
  EXPECT_TRUE(is_narrow(r, 0.06));
  EXPECT_FALSE(is_narrow(r, 0.03));
  r.times(Stage::build) = {{1}, {100}};
  EXPECT_TRUE(is_narrow(r, 0.06)) << "build is not judged";
  r.times(Stage::resolve) = {{0.0001}, {0.003}, {0.001}};
  EXPECT_TRUE(is_narrow(r, 0.06)) << "below the clock";
  r.times(Stage::relight) = {{1}};
  EXPECT_FALSE(is_narrow(r, 0.06)) << "one process has no interval";
  r.times(Stage::relight) = {{1}, {1}, {1}, {1}};
  EXPECT_FALSE(is_narrow(r, 0.06)) << "an interval from four processes is no 95 % interval";
  r.times(Stage::relight).push_back({1});
  EXPECT_TRUE(is_narrow(r, 0.06));
}

TEST(enough, five_processes_can_be_reached_from_one) {
  Suite suite;
  for (const auto& [fixed, most] : {std::pair(1, 8), std::pair(2, 8), std::pair(3, 12)}) {
    suite.processes = fixed;
    EXPECT_EQ(most_processes(suite), most);
  }
}

}  // namespace compare_test
