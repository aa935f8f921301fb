// The cost of geometry that moves, in every analysis that takes a cost or a time.
#include <gtest/gtest.h>

#include "analysis/compare.h"
#include "analysis/front.h"
#include "analysis/growth.h"
#include "analysis/sweep.h"
#include "analysis_rows.h"

namespace motion_cost_test {

using namespace analysis_rows;

/// Build 1, relight 4, resolve 2; in the frames after an update of 3 they are 0.5 and 2.5.
Record example(const std::string& setting = "a") { return moving(row(setting, 4, 2, 0.1), 3, 0.5, 2.5); }

double value_of(const Record& record, Cost cost) { return cost_of(record, cost).value().value; }

TEST(motion_cost, is_update_with_relight_and_resolve_of_the_frames_after_it) {
  const Record r = example();
  EXPECT_EQ(value_of(r, Cost::motion), 6);
  EXPECT_EQ(value_of(r, Cost::geometry), 7);
  EXPECT_EQ(value_of(r, Cost::light), 6);
  EXPECT_EQ(value_of(r, Cost::resolve), 2);
  EXPECT_EQ(cost_named("motion"), Cost::motion);
  EXPECT_EQ(sentence(Cost::motion), "update + relight + resolve");
  EXPECT_TRUE(parts_of(Cost::bytes).empty());
}

TEST(motion_cost, a_row_that_stands_still_has_none) {
  const Record r = row("a", 4, 2, 0.1);
  EXPECT_FALSE(cost_of(r, Cost::motion));
  EXPECT_EQ(value_of(r, Cost::geometry), 7);
  EXPECT_EQ(quantity(r, "motion_ms"), std::nullopt);
  EXPECT_EQ(quantity(r, "update_ms"), std::nullopt);
}

TEST(motion_cost, an_unknown_cost_lists_it) {
  try {
    cost_named("moving");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "there is no cost moving; there are: resolve, light, geometry, motion, bytes");
  }
}

// A process is slow in all three or in none: sums are 3 or 30. Independent draws would give 12 and 21, too.
TEST(motion_cost, all_three_are_drawn_from_the_same_processes) {
  Record r = example();
  r.times(Stage::update) = r.moving_times(Stage::relight) = r.moving_times(Stage::resolve) = {{1}, {10}, {1}};
  const Sample sample = sample_of(r, parts_of(Cost::motion));
  Random random(7);
  for (int k = 0; k < 200; ++k) {
    const double drawn = sample.draw(random);
    EXPECT_TRUE(drawn == 3 || drawn == 30) << drawn;
  }
  const ValueWithInterval cost = cost_of(r, Cost::motion).value();
  EXPECT_TRUE(cost.has_interval);
  EXPECT_EQ(cost.value, 3);
}

TEST(motion_cost, times_are_quantities) {
  const Record r = example();
  EXPECT_EQ(quantity(r, "update_ms"), 3);
  EXPECT_EQ(quantity(r, "moving_relight_ms"), 0.5);
  EXPECT_EQ(quantity(r, "moving_resolve_ms"), 2.5);
  EXPECT_EQ(quantity(r, "motion_ms"), 6);
  EXPECT_EQ(quantity(r, "relight_ms"), 4);
  EXPECT_EQ(better("motion_ms"), "lower");
  const std::vector<Record> still{row("a", 1, 1, 0.1)};
  EXPECT_THROW(require_quantity(still, "motion_ms"), Error);
  require_quantity(std::vector{r}, "motion_ms");
}

TEST(motion_cost, a_front_leaves_out_rows_that_stand_still_and_says_so) {
  const std::vector<Record> records{example("a"), example("b"), row("a", 1, 1, 0.1), row("b", 1, 1, 0.1)};
  const std::vector<Field> fields = find_fields(records, {.cost = Cost::motion});
  ASSERT_EQ(fields.size(), 1u);
  EXPECT_EQ(fields[0].place->path, "walk");
  EXPECT_EQ(fields[0].candidates[0].cost->value, 6);
  EXPECT_EQ(fields[0].notes, std::vector<std::string>{"left out: 2 rows whose geometry stands still"});
  EXPECT_EQ(find_fields(records, {.cost = Cost::light}).size(), 3u) << "two places, and both of them together";
  const std::vector<Record> still{row("a", 1, 1, 0.1)};
  try {
    find_fields(still, {.cost = Cost::motion});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "there is no cost of motion: the geometry of no row moves; run rows that follow an animation");
  }
}

TEST(motion_cost, the_same_animation_at_another_rate_or_from_another_time_is_another_place) {
  std::vector<Record> records(3, example());
  records[1].frame_rate = 120;
  records[2].start = 1.5;
  std::vector<Place> places;
  for (const Record& r : records) places.push_back(place_of(r));
  EXPECT_NE(places[0], places[1]);
  EXPECT_NE(places[0], places[2]);
  EXPECT_EQ(title(places[1], places), "soup, point, path walk from 0 s at 120 Hz");
  EXPECT_EQ(title(places[0], std::span(places).first(1)), "soup, point, path walk");
}

TEST(motion_cost, each_time_grows_for_itself) {
  std::vector<Record> records = family({10, 100, 1000}, 1);
  EXPECT_EQ(find_growth(records, "triangles").rows.size(), 3u);
  for (Record& r : records) {
    const auto n = static_cast<double>(r.scene_facts->triangles);
    r = moving(r, n * n / 100, 3, n);
  }
  const Growths growths = find_growth(records, "triangles");
  std::vector<std::string> stages;
  std::map<std::string, double> exponents;
  for (const Growth& growth : growths.rows) {
    stages.push_back(growth.stage);
    exponents[growth.stage] = growth.exponent->value;
  }
  EXPECT_EQ(joined(stages), "build, update, relight, resolve, moving_relight, moving_resolve");
  EXPECT_NEAR(exponents["update"], 2, 1e-9);
  EXPECT_NEAR(exponents["moving_relight"], 0, 1e-9);
  EXPECT_NEAR(exponents["moving_resolve"], 1, 1e-9);
}

TEST(motion_cost, a_sweep_of_it_has_intervals) {
  std::vector<Record> records;
  for (const int k : {1, 2, 4}) records.push_back(moving(row(fmt::format("a:k={}", k), 1, 1, 0.1), k, 1, 1));
  for (Record& r : records) r.moving_times(Stage::resolve) = {{1}, {2}, {4}};
  const Sweeps sweeps = find_sweeps(records, "k", "motion_ms");
  ASSERT_EQ(sweeps.rows.size(), 1u);
  const ValueWithInterval& last = *sweeps.rows[0].points[2].value;
  EXPECT_EQ(last.value, 7);
  EXPECT_TRUE(last.has_interval);
  EXPECT_LT(last.low, last.high);
}

TEST(motion_cost, runs_are_compared_in_update_and_in_the_stages_after_it) {
  std::vector<Record> base;
  for (int k = 0; k < 10; ++k) {
    Record& r = base.emplace_back(example("a" + std::to_string(k)));
    r.job = std::to_string(k);
    const auto around = [](double center) {
      ProcessTimes times;
      for (int process = 0; process < 5; ++process) times.push_back({center * (1 + 0.01 * process)});
      return times;
    };
    for (const Stage stage : {Stage::build, Stage::update, Stage::relight, Stage::resolve}) r.times(stage) = around(1);
    for (const Stage stage : frame_stages) r.moving_times(stage) = around(1);
  }
  std::vector<Record> contender = base;
  for (double factor = 2; std::vector<double> & process : contender[3].moving_times(Stage::resolve)) process[0] *= factor;
  for (double factor = 0.5; std::vector<double> & process : contender[4].times(Stage::update)) process[0] *= factor;
  const Comparison comparison = compare(base, contender);
  EXPECT_EQ(comparison.counts().judged, 60u) << "six times a row";
  EXPECT_EQ(comparison.counts().slower, 1u);
  EXPECT_EQ(comparison.counts().faster, 1u);
  const auto find = [&](std::size_t row, TimedPart part) {
    return *std::ranges::find(comparison.rows[row].stages, part, &StageChange::stage);
  };
  EXPECT_EQ(find(3, {Stage::resolve, true}).verdict, Verdict::slower);
  EXPECT_EQ(find(3, Stage::resolve).verdict, Verdict::similar);
  EXPECT_EQ(find(4, Stage::update).verdict, Verdict::faster);
  EXPECT_EQ(name(find(3, {Stage::resolve, true}).stage), "moving_resolve");
}

}  // namespace motion_cost_test
