#include "analysis/sweep.h"

#include <gtest/gtest.h>

#include "analysis_rows.h"
#include "report/analysis/analysis_table.h"
#include "report/figure/figure.h"

namespace sweep_test {

using namespace analysis_rows;

/// Two settings of one technique and another technique over three heights, as seen by two lights.
std::vector<Record> heights() {
  std::vector<Record> records;
  for (const char* light : {"point", "sun"})
    for (const char* setting : {"map:bias=1", "map:bias=2", "other"})
      for (const double height : {2.0, 0.0, 0.5}) {
        records.push_back(row(setting, 1 + height, 1, 0.1 * height, fmt::format("sphere_over_plane:height={}", height)));
        records.back().light = light;
      }
  return records;
}

Record& at(std::vector<Record>& records, const std::string& setting, double height) {
  for (Record& r : records)
    if (setting_name(r) == setting && r.scene == fmt::format("sphere_over_plane:height={}", height)) return r;
  throw Error("there is no {} at {}", setting, height);
}

std::string refusal(const std::vector<Record>& records, const std::string& parameter, const std::string& quantity) {
  try {
    find_sweeps(records, parameter, quantity);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(sweep, is_one_series_for_each_setting_and_family_of_places_in_the_order_of_x) {
  const Sweeps sweeps = find_sweeps(heights(), "height", "wrong_rate");
  EXPECT_EQ(sweeps.unit, "m");  // as the scene declares it
  ASSERT_EQ(sweeps.rows.size(), 6u);
  ASSERT_EQ(sweeps.places.size(), 2u);
  EXPECT_EQ(sweeps.places[0].scene, "sphere_over_plane:height=*");
  EXPECT_EQ(sweeps.places[1].light, "sun");
  EXPECT_EQ(sweeps.xs(sweeps.places[1]), (std::vector<double>{0, 0.5, 2}));
  EXPECT_EQ(sweeps.rows[1].setting, "map:bias=2");
  for (const Sweep& sweep : sweeps.rows) {
    ASSERT_EQ(sweep.points.size(), 3u);
    for (const Sweep::Point& point : sweep.points) EXPECT_EQ(point.value->value, 0.1 * point.x);
  }
}

TEST(sweep, times_have_their_intervals) {
  std::vector<Record> records = heights();
  for (Record& r : records) r.times(Stage::relight) = {{1}, {2}, {4}};
  const Sweeps sweeps = find_sweeps(records, "height", "relight_ms");
  const ValueWithInterval& m = *sweeps.rows[0].points[0].value;
  EXPECT_EQ(m.value, 2);
  EXPECT_TRUE(m.has_interval);
  EXPECT_LT(m.low, m.high);
  EXPECT_FALSE(find_sweeps(records, "height", "bytes").rows[0].points[0].value->has_interval);
}

TEST(sweep, a_default_that_the_reference_leaves_out_is_a_point_and_a_second_row_there_is_left_out) {
  std::vector<Record> records{row("a", 1, 1, 0.3, "sphere_over_plane"), row("a", 1, 1, 0.1, "sphere_over_plane:height=0.5"),
                              row("a", 1, 1, 0.2, "sphere_over_plane:height=2")};
  const Sweeps sweeps = find_sweeps(records, "height", "wrong_rate");  // its default is 0.5
  ASSERT_EQ(sweeps.rows.size(), 1u);
  EXPECT_EQ(sweeps.repeated, 1u);
  ASSERT_EQ(sweeps.rows[0].points.size(), 2u);
  EXPECT_EQ(sweeps.rows[0].points[0].x, 0.5);
  EXPECT_EQ(sweeps.rows[0].points[0].value->value, 0.3);
}

TEST(sweep, other_parameters_of_the_scene_stay_in_the_family) {
  std::vector<Record> records;
  for (const int seed : {7, 8})
    for (const int count : {10, 20}) records.push_back(row("a", 1, 1, 0.1, fmt::format("soup:count={},seed={}", count, seed)));
  const Sweeps by_count = find_sweeps(records, "count", "wrong_rate"), by_seed = find_sweeps(records, "seed", "wrong_rate");
  EXPECT_EQ(by_count.places[0].scene, "soup:seed=7,count=*");
  EXPECT_EQ(by_count.places[1].scene, "soup:seed=8,count=*");
  EXPECT_EQ(by_seed.places[1].scene, "soup:count=20,seed=*");
  // Along the parameter of a technique scenes stay apart as they are.
  for (Record& r : records) r.parameters["size"] = r.scene.ends_with("7") ? 1 : 2, r.scene = "soup:count=10";
  EXPECT_EQ(find_sweeps(records, "size", "wrong_rate").places[0].scene, "soup:count=10");
}

TEST(sweep, a_name_that_scenes_and_techniques_share_is_that_of_what_varies) {
  std::vector<Record> records;
  for (const int segments : {8, 16, 32})
    records.push_back(row("sphere_volume:segments=4", 1, 1, 0.1, fmt::format("sphere_over_plane:segments={}", segments)));
  EXPECT_EQ(find_sweeps(records, "segments", "wrong_rate").rows[0].setting, "sphere_volume:segments=4");
  for (Record& r : records) {
    r.parameters["segments"] = *scene_parameter(r.scene, "segments");
    r.settings = fmt::format("segments={}", *scene_parameter(r.scene, "segments"));
    r.scene = "sphere_over_plane";
  }
  const Sweeps of_technique = find_sweeps(records, "segments", "wrong_rate");
  EXPECT_EQ(of_technique.rows[0].setting, "sphere_volume");
  EXPECT_EQ(of_technique.rows[0].points.size(), 3u);
}

TEST(sweep, a_label_names_a_series_only_when_all_its_rows_have_it) {
  std::vector<Record> records{row("map:bias=1,size=256", 1, 1, 0.1), row("map:bias=1,size=512", 1, 1, 0.1),
                              row("map:bias=2,size=256", 1, 1, 0.1), row("map:bias=2,size=512", 1, 1, 0.1)};
  records[0].label = "usual";
  records[2].label = records[3].label = "strong";
  const Sweeps sweeps = find_sweeps(records, "size", "wrong_rate");
  EXPECT_EQ(sweeps.rows[0].setting, "map:bias=1");
  EXPECT_EQ(sweeps.rows[1].setting, "strong");
}

TEST(sweep, what_has_no_value_keeps_its_place_and_is_counted_below) {
  std::vector<Record> records = heights();
  std::erase_if(records, [](const Record& r) { return r.light == "sun"; });
  at(records, "other", 0).status = Status::unsupported;
  at(records, "other", 0.5).status = Status::failed;
  for (const char* metric : {"error", "wrong_rate"}) at(records, "map:bias=1", 2).metrics[Truth::shape][metric] = std::nullopt;
  std::erase_if(records, [](const Record& r) { return setting_name(r) == "map:bias=2" && r.scene.ends_with("=2"); });
  records.push_back(row("lonely", 1, 1, 0.1, "sphere_over_plane:height=2"));
  const Sweeps sweeps = find_sweeps(records, "height", "wrong_rate");
  EXPECT_EQ(sweeps.single, 1u);
  EXPECT_EQ(sweeps.rows[2].points[0].status, Status::unsupported);
  EXPECT_FALSE(sweeps.rows[2].points[0].value);
  EXPECT_EQ(sweeps.rows[2].points[2].value->value, 0.2);
  const std::string text = analyze(records, "sweep", {.x = "height"}, Format::terminal);
  EXPECT_TRUE(has(text, "error in % against height in m\n")) << text;
  EXPECT_TRUE(has(text, "\ntechnique   0   0.5     2\n")) << text;
  EXPECT_TRUE(has(text, "\nmap:bias=1  0  5.00     -\n")) << text;
  EXPECT_TRUE(has(text, "\nmap:bias=2  0  5.00     -\n")) << text;
  EXPECT_TRUE(has(text, "\nother       -     -  20.0\n")) << text;
  EXPECT_TRUE(has(text, "\n-: no value; 1 not supported, 1 failed, 1 not defined, 1 not run\n")) << text;
  EXPECT_TRUE(has(text, "\n1 setting with a single value of height is left out\n")) << text;
  // Programs get a row for each point of the run.
  const Json json = Json::parse(analyze(records, "sweep", {.x = "height"}, Format::json));
  ASSERT_EQ(json["rows"].size(), 8u);
  EXPECT_EQ(json["rows"][5]["parameter.height"], 0);
  EXPECT_EQ(json["rows"][5]["error"], nullptr);
  EXPECT_EQ(json["rows"][5]["status"], "unsupported");
}

TEST(sweep, people_get_columns_of_their_own_for_places_swept_over_other_values_and_for_more_than_twelve) {
  std::vector<Record> records;
  for (int count = 1; count <= 14; ++count) {
    records.push_back(row("a", 1, 1, 0.1, fmt::format("soup:count={}", count)));
    if (count % 5) continue;
    records.push_back(row("a", 1, 1, 0.1, fmt::format("soup:count={},seed=9", count)));
  }
  const std::string text = analyze(records, "sweep", {.x = "count"}, Format::terminal);
  EXPECT_TRUE(has(text, "\ntechnique     1     2     3     4     5     6     7\n")) << text;
  EXPECT_TRUE(has(text, "\ntechnique     8     9    10    11    12    13    14\n")) << text;
  EXPECT_TRUE(has(text, "\ntechnique     5    10\n")) << text;
  EXPECT_FALSE(has(text, "no value")) << text;
  EXPECT_TRUE(has(analyze(records, "sweep", {.x = "count"}, Format::markdown), " | 13 | 14 |\n"));
}

TEST(sweep, what_was_not_swept_is_an_error_that_says_what_was) {
  const std::vector<Record> records = heights();
  EXPECT_EQ(refusal(records, "", "wrong_rate"), "sweep wants --x PARAMETER; swept are: bias, height");
  EXPECT_TRUE(has(refusal(records, "hieght", "wrong_rate"), "there is no numeric parameter hieght; did you mean height?"));
  EXPECT_TRUE(has(refusal(records, "height", "wrong_rat"), "there is no wrong_rat; did you mean wrong_rate?"));
  // The scene has a radius, though no reference names it.
  EXPECT_TRUE(has(refusal(records, "radius", "wrong_rate"), "there is no sweep of radius in these records"));
  const std::vector<Record> one{row("a", 1, 1, 0.1, "soup:count=10")};
  EXPECT_TRUE(has(refusal(one, "count", "wrong_rate"), "there is no sweep of count")) << refusal(one, "count", "wrong_rate");
  EXPECT_TRUE(has(refusal(one, "count", "wrong_rate"), "no parameter is swept")) << refusal(one, "count", "wrong_rate");
  std::vector<Record> silent = heights();
  for (Record& r : silent) r.metrics[Truth::shape]["penumbra_shift"] = std::nullopt;
  EXPECT_TRUE(has(refusal(silent, "height", "penumbra_shift"), "no row of the sweep of height has a penumbra_shift"));
}

TEST(growth, a_run_without_a_series_is_an_error_and_no_empty_table) {
  EXPECT_THROW(analyze(std::vector{row("a", 1, 1, 0.1)}, "growth", {}, Format::csv), Error);
}

// --- the figure -------------------------------------------------------------------------------------------------------

std::string figure(const std::vector<Record>& records, const std::string& parameter, const std::string& quantity) {
  FigureOptions options;
  options.analysis.x = parameter;
  options.analysis.metric = quantity;
  return figure_script(records, "sweep", options, "f.svg");
}

TEST(sweep_figure, names_every_setting_and_draws_a_panel_for_each_place) {
  const std::string script = figure(heights(), "height", "wrong_rate");
  for (const char* setting : {"map:bias=1", "map:bias=2", "other"})
    EXPECT_TRUE(has(script, fmt::format("title '{}'", setting))) << script;
  for (const char* color : {"#0072b2", "#d55e00", "#009e73"}) EXPECT_TRUE(has(script, color)) << script;
  EXPECT_TRUE(has(script, "set title 'sphere_over_plane:height=*, point'")) << script;
  EXPECT_TRUE(has(script, "set title 'sphere_over_plane:height=*, sun'")) << script;
  EXPECT_TRUE(has(script, "set xlabel 'height (m)'")) << script;
  EXPECT_TRUE(has(script, "set ylabel 'wrong (%)'")) << script;
  EXPECT_TRUE(has(script, "set yrange [0:")) << script;
  EXPECT_FALSE(has(script, "logscale x")) << script;
}

TEST(sweep_figure, a_line_breaks_where_a_value_is_missing) {
  std::vector<Record> records = heights();
  EXPECT_FALSE(has(figure(records, "height", "wrong_rate"), "\n\n"));
  at(records, "other", 0.5).status = Status::unsupported;
  EXPECT_TRUE(has(figure(records, "height", "wrong_rate"), "\n0\t0\t0\t0\n\n2\t20\t20\t20\n"));
}

TEST(sweep_figure, axes_are_logarithmic_when_they_span_more_than_two_decades) {
  std::vector<Record> records = family({10, 100, 1000}, 0);
  EXPECT_TRUE(has(figure(records, "count", "wrong_rate"), "logscale x"));  // two decades, but declared so
  // A height is none of a logarithmic axis: up to two decades it is linear.
  const auto from_one_to = [](double highest) {
    std::vector<Record> high = heights();
    for (Record& r : high)
      r.scene = fmt::format("sphere_over_plane:height={}", 1 + *scene_parameter(r.scene, "height") / 2 * (highest - 1));
    return high;
  };
  EXPECT_FALSE(has(figure(from_one_to(100), "height", "wrong_rate"), "logscale x"));
  EXPECT_TRUE(has(figure(from_one_to(101), "height", "wrong_rate"), "logscale x"));
  const std::vector<Record> wide = family({10, 100, 1000, 2000}, 2);
  EXPECT_TRUE(has(figure(wide, "count", "wrong_rate"), "set logscale x"));
  EXPECT_TRUE(has(figure(wide, "count", "resolve_ms"), "set logscale y"));
  EXPECT_TRUE(has(figure(wide, "count", "relight_ms"), "set yrange [0:"));  // 3 ms everywhere
  // What the clock does not see is at its resolution.
  for (Record& r : records) r.times(Stage::relight) = {{4e-5}, {5e-5}, {4e-5}};
  EXPECT_TRUE(has(figure(records, "count", "relight_ms"), "\n10\t0.001\t0.001\t0.001\n"));
}

TEST(sweep_figure, ratios_are_read_against_one_and_signed_values_have_no_zero_at_the_bottom) {
  std::vector<Record> records = heights();
  for (Record& r : records) {
    const double height = *scene_parameter(r.scene, "height");
    r.metrics[Truth::shape]["shadow_area_ratio"] = 1 + 0.001 * height;
    r.metrics[Truth::shape]["penumbra_shift"] = height - 1;
  }
  EXPECT_TRUE(has(figure(records, "height", "shadow_area_ratio"), "set yrange [0.944:1.056]"))
      << figure(records, "height", "shadow_area_ratio");
  EXPECT_TRUE(has(figure(records, "height", "shadow_area_ratio"), "set ylabel 'shadow area ratio'"));
  EXPECT_TRUE(has(figure(records, "height", "penumbra_shift"), "set yrange [-1.12:1.12]"));
}

TEST(sweep_figure, baseline_and_reference_stand_beside_costs_or_nowhere) {
  std::vector<Record> records = heights();
  for (Record& r : records)
    if (r.technique == "other") r.role = Role::reference;
  EXPECT_FALSE(has(figure(records, "height", "wrong_rate"), "'other'"));
  EXPECT_TRUE(has(figure(records, "height", "resolve_ms"), "'other'"));
  for (Record& r : records) r.role = Role::baseline;
  EXPECT_THROW(figure(records, "height", "resolve_ms"), Error);
}

}  // namespace sweep_test
