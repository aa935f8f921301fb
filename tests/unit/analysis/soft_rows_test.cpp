// Analyses of rows under lights with area: beside their error is its floor.
#include <gtest/gtest.h>

#include "analysis/compare.h"
#include "analysis_rows.h"
#include "report/analysis/analysis_table.h"
#include "report/analysis/compare_table.h"

namespace soft_rows_test {

using namespace analysis_rows;

/// Two scenes under a point light, two under a disc, with techniques of one kind each and one of both.
std::vector<Record> mixed() {
  std::vector<Record> records;
  for (const char* scene : {"one", "two"}) {
    records.push_back(row("hard", 1, 1, 0.1, scene));
    records.push_back(row("both", 2, 2, 0.2, scene));
    records.push_back(soft_row("soft", 3, 3, 0.01, scene));
    records.push_back(soft_row("both", 4, 4, std::string(scene) == "one" ? 0.02 : 0.04, scene));
  }
  return records;
}

TEST(soft_rows, a_floor_is_the_metric_of_that_name) {
  Record soft = soft_row("a", 1, 1, 0.1);
  EXPECT_EQ(noise_floor(soft, "error"), 0.002);
  EXPECT_EQ(noise_floor(soft, "wrong_rate"), std::nullopt);
  soft.metrics[Truth::shape]["penumbra_error_mean_floor"] = 0.003;
  EXPECT_EQ(noise_floor(soft, "penumbra_error_mean"), 0.003);
  EXPECT_EQ(noise_floor(row("a", 1, 1, 0.1), "error"), std::nullopt);
}

TEST(soft_rows, overall_means_are_of_one_kind_of_light) {
  const std::vector<Record> records = mixed();
  const std::vector<Field> fields = find_fields(records, {});
  ASSERT_EQ(fields.size(), 6u) << "four places, and two over all";
  const std::vector<const Field*> over = overall_fields(fields);
  ASSERT_EQ(over.size(), 2u);
  EXPECT_FALSE(over[0]->place || over[0]->answer != AnswerKind::binary);
  ASSERT_EQ(over[0]->candidates.size(), 2u);
  EXPECT_DOUBLE_EQ(over[0]->candidates[0].error, 0.1);
  EXPECT_EQ(over[0]->candidates[0].floor, std::nullopt);
  EXPECT_TRUE(!over[1]->place && over[1]->answer == AnswerKind::fraction);
  ASSERT_EQ(over[1]->candidates.size(), 2u);
  EXPECT_EQ(over[1]->candidates[0].setting, "soft");
  EXPECT_DOUBLE_EQ(over[1]->candidates[1].error, 0.03);
  EXPECT_DOUBLE_EQ(*over[1]->candidates[1].floor, 0.002);
  // Of a single place nothing is a mean: it stands for its kind.
  const std::vector<Record> few{records[0], records[4], records[2]};  // two places under a point light, one under a disc
  const std::vector<Field> fewer = find_fields(few, {});
  ASSERT_EQ(fewer.size(), 4u);
  EXPECT_FALSE(overall_fields(fewer)[0]->place);
  EXPECT_EQ(overall_fields(fewer)[1]->place->scene, "one");
}

// The noise of the reference, 0.002, may have made either: the cheaper one is the better.
TEST(soft_rows, errors_within_their_floor_are_alike) {
  const std::vector<Record> records{soft_row("fast", 1, 1, 0.0018), soft_row("slow", 2, 2, 0.0001),
                                    soft_row("off", 1.5, 1.5, 0.0021)};
  const std::vector<Field> fields = find_fields(records, {});
  const std::vector<FrontEntry> stands = find_front(fields[0], "lower");
  EXPECT_EQ(stands[0].standing, Standing::front);
  EXPECT_EQ(stands[1].standing, Standing::beaten);
  EXPECT_EQ(stands[2].standing, Standing::beaten);
  const std::vector<Best> best = find_best(fields[0], {.times = {10}, .memories = {}, .errors = {}}, "lower");
  EXPECT_EQ(best[0].winner, 0u);
  EXPECT_EQ(best[0].also, std::vector<std::size_t>{1});
}

TEST(soft_rows, tables_show_the_floor_where_there_is_one) {
  const auto text = [](const std::vector<Record>& records, const char* kind) {
    return analyze(records, kind, {.all = true}, Format::terminal);
  };
  const std::vector<Record> hard{row("a", 1, 1, 0.1), row("b", 1, 2, 0.05)};
  for (const char* kind : {"front", "best"}) {
    EXPECT_TRUE(has(text(hard, kind), "error in %")) << text(hard, kind);
    EXPECT_FALSE(has(text(hard, kind), "floor")) << "no column of nothing";
  }
  const std::vector<Record> soft{soft_row("a", 1, 1, 0.1), soft_row("b", 1, 2, 0.05)};
  for (const char* kind : {"front", "best"}) {
    EXPECT_TRUE(has(text(soft, kind), "error in %")) << text(soft, kind);
    EXPECT_TRUE(has(text(soft, kind), "\nerror floor: error that the reference's noise alone makes; ")) << text(soft, kind);
    EXPECT_TRUE(has(text(soft, kind), "0.20")) << "the floor beside each";
    EXPECT_FALSE(has(text(soft, kind), "lights without area"));
  }
  for (const char* kind : {"front", "best"}) {
    const std::string both = text(mixed(), kind);
    EXPECT_TRUE(has(both, "over all 2 places under lights without area that these settings finished")) << both;
    EXPECT_TRUE(has(both, "over all 2 places under lights with area that these settings finished")) << both;
  }
}

TEST(soft_rows, programs_get_the_floor_beside_the_error) {
  const Json json = Json::parse(analyze(mixed(), "front", {}, Format::json));
  for (const Json& one : json["rows"]) {
    EXPECT_EQ(one["error_floor"].is_null(), one["light"] == "point" || one["setting"] == "hard" || one["error"] > 0.09) << one;
    EXPECT_TRUE(one["error"].is_number());
  }
  const Json hard = Json::parse(analyze(std::vector{row("a", 1, 1, 0.1)}, "front", {}, Format::json));
  EXPECT_FALSE(hard["rows"][0].contains("error_floor"));
}

TEST(soft_rows, a_map_over_both_kinds_says_how_many_places_are_of_each) {
  std::vector<Record> records;
  for (const int size : {1, 2})
    for (const char* scene : {"one", "two"}) {
      records.push_back(row(fmt::format("a:size={}", size), 1, 1, 0.1 * size, scene));
      records.push_back(soft_row(fmt::format("a:size={}", size), 1, 1, 0.3 * size, scene));
    }
  const std::vector<Map> maps = make_maps(records, {});
  EXPECT_EQ(maps[0].places, 4u);
  EXPECT_EQ(maps[0].places_with_fractions, 2u);
  EXPECT_DOUBLE_EQ(*maps[0].at(1, 0).value, 0.4);
  EXPECT_EQ(places_text(maps[0]), "4 places, 2 of them under lights with area");
  const std::string text = analyze(records, "map", {}, Format::terminal);
  EXPECT_TRUE(has(text, "error in %, mean over 4 places, 2 of them under lights with area\n")) << text;
  // Each light a column: what is in it is of one kind.
  EXPECT_EQ(make_maps(records, {.x = "light"})[0].places_with_fractions, 0u);
}

TEST(soft_rows, motion_and_sweep_name_what_they_show) {
  std::vector<Record> records{soft_row("a:size=1", 1, 1, 0.1), soft_row("a:size=2", 1, 1, 0.2)};
  for (Record& r : records) {
    r.path = "slide";
    r.frames = {{"error", {0.1, 0.2}}, {"instability", {std::nullopt, 0.0}}};
  }
  const std::string motion = analyze(records, "motion", {}, Format::terminal);
  EXPECT_TRUE(has(motion, "and error in % of every frame")) << motion;
  EXPECT_TRUE(has(analyze(records, "sweep", {.x = "size"}, Format::terminal), "error in % against size"));
}

TEST(soft_rows, compare_judges_all_by_their_error) {
  std::vector<Record> base{soft_row("a", 1, 1, 0.01), soft_row("b", 1, 1, 0.01), row("c", 1, 1, 0.01)}, now = base;
  now[0].metrics[Truth::shape]["error"] = 0.011;
  now[0].metrics[Truth::shape]["error_floor"] = 0.003;
  now[1].metrics[Truth::shape]["wrong_rate"] = 0.5;
  now[2].metrics[Truth::shape]["error"] = 0.02;
  const Comparison comparison = compare(base, now);
  const auto metrics = [&](std::size_t k) {
    std::vector<std::string> names;
    for (const MetricChange& change : comparison.rows[k].metrics) names.push_back(change.metric);
    return names;
  };
  EXPECT_EQ(metrics(0), (std::vector<std::string>{"error", "error_floor"}));
  EXPECT_TRUE(comparison.rows[0].regressed());
  EXPECT_EQ(comparison.rows[0].metrics[0].floor, 0.003) << "the greater one";
  EXPECT_EQ(metrics(1), std::vector<std::string>{"wrong_rate"});
  EXPECT_FALSE(comparison.rows[1].regressed()) << "it is not what decides there";
  EXPECT_EQ(metrics(2), std::vector<std::string>{"error"});
  EXPECT_TRUE(comparison.rows[2].regressed());
  EXPECT_EQ(comparison.rows[2].metrics[0].floor, std::nullopt);
  const std::string text = render_comparison(comparison, Format::terminal, {.base = "x", .contender = "y"});
  EXPECT_TRUE(has(text, "changed !, floor 0.30 %")) << text;
  EXPECT_TRUE(has(text, "; floor: what the reference's own noise makes\n")) << text;
  const Json json = Json::parse(render_comparison(comparison, Format::json, {.base = "x", .contender = "y"}));
  EXPECT_EQ(json["rows"][0]["metrics"][0]["floor"], 0.003);
  EXPECT_TRUE(json["rows"][2]["metrics"][0]["floor"].is_null());
  EXPECT_TRUE(has(render_comparison(comparison, Format::csv, {}), ",true,floor 0.003\r\n"));
}

}  // namespace soft_rows_test
