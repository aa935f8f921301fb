#include "table_rows.h"

namespace table_test {

using namespace table_rows;

// --- terminal ---------------------------------------------------------------------------------------------------------

TEST(table, terminal_rows_of_all_groups_have_their_columns_at_the_same_place) {
  Record named = row("shadow_map", 1, 0.1, "other");
  named.label = "map ± bias";
  const std::vector<Record> records{row("shadow_map", 1.5, 0.25), row("planar", 12, 0.01), named};
  const std::string text = render_table(records, Format::terminal, {.columns = {"technique", "resolve_ms", "wrong_rate"}});
  // Digits end at the same column; the mark of the best is behind them.
  EXPECT_EQ(text.substr(0, text.find("\n\n*")),
            "technique   resolve  wrong\n"
            "                 ms      %\n"
            "--------------------------\n"
            "\n"
            "scene soup, light point, view main, 640 x 480, shape truth\n"
            "shadow_map    1.50*  25.0\n"
            "planar        12.0   1.00*\n"
            "\n"
            "scene other, light point, view main, 640 x 480, shape truth\n"
            "map ± bias    1.00   10.0");
}

TEST(table, refused_and_failed_rows_are_shown_with_their_reason) {
  const std::vector<Record> records{row("shadow_map", 1, 0.1), refusal("crow", Status::unsupported, "the mesh is open"),
                                    refusal("planar", Status::failed, "signal 11")};
  const std::string text = render_table(records, Format::terminal);
  EXPECT_TRUE(has(line_with(text, "crow"), "no       the mesh is open")) << text;
  EXPECT_TRUE(has(line_with(text, "planar"), "failed   signal 11")) << text;
  for (const Format format : {Format::markdown, Format::latex, Format::csv, Format::json}) {
    EXPECT_TRUE(has(render_table(records, format), "the mesh is open"));
    EXPECT_TRUE(has(render_table(records, format), "signal 11"));
  }
}

TEST(table, reason_of_an_approximate_row_is_a_note) {
  std::vector<Record> records{row("disc", 1, 0.1)};
  records[0].support = Support::Kind::approximate;
  records[0].reason = "cones only";
  const std::string text = render_table(records, Format::terminal);
  EXPECT_TRUE(has(line_with(text, "disc"), "approx. [1]")) << text;
  EXPECT_TRUE(has(text, "\n[1] cones only\n")) << text;
}

TEST(table, best_is_a_contender_that_is_better_than_another) {
  Record reference = row("rays", 0.1, 0), baseline = row("none", 0.01, 0.5);
  reference.role = Role::reference;
  baseline.role = Role::baseline;
  const std::vector<Record> records{reference, baseline, row("slow", 90, 0.1), row("fast", 3, 0.1)};
  const std::string text = render_table(records, Format::markdown, {.columns = {"technique", "resolve_ms", "wrong_rate"}});
  EXPECT_TRUE(has(text, "| fast | **3.00** | 10.0 |")) << text;  // equal rates: neither is best
  EXPECT_TRUE(has(text, "| slow | 90.0 | 10.0 |")) << text;
  EXPECT_TRUE(has(text, "| rays | 0.100 | 0 |")) << text;
}

// A million rays in 0.5 + 1.5 ms by the device's clock are 500 million in a second.
TEST(table, rays_per_second_are_millions_in_the_headline_of_rows_with_a_clock_of_the_device) {
  Record r = row("gl_rays", 1, 0);
  r.counts = {{"rays", 1000000, ""}, {"nodes", 3, ""}};
  const auto is_shown = [&] { return std::ranges::count(headline_columns({&r, 1}, false), "rays_per_second") > 0; };
  EXPECT_FALSE(is_shown());
  r.device_times(Stage::relight) = {{0.5}};
  r.device_times(Stage::resolve) = {{1.5}};
  EXPECT_TRUE(is_shown());
  const std::string text = render_table({&r, 1}, Format::markdown, {.columns = {"technique", "rays_per_second"}});
  EXPECT_TRUE(has(text, "| rays (Mray/s) |")) << text;
  EXPECT_TRUE(has(text, "| gl\\_rays | 500 |")) << text;
  r.counts.clear();
  EXPECT_FALSE(is_shown());
}

TEST(table, contenders_that_the_times_do_not_tell_apart_are_all_marked) {
  // Processes by `row`: resolve / 2, resolve, resolve * 2. Of 3 and 5 the logarithms differ by 0.5 and the means spread by 0.6;
  // 20 is 1.9 away.
  const std::vector<Record> records{row("a", 3, 0.1), row("b", 5, 0.2), row("c", 20, 0.3)};
  const std::string text = render_table(records, Format::markdown, {.columns = {"technique", "resolve_ms", "wrong_rate"}});
  EXPECT_TRUE(has(text, "| a | **3.00** | **10.0** |")) << text;
  EXPECT_TRUE(has(text, "| b | **5.00** | 20.0 |")) << text;
  EXPECT_TRUE(has(text, "| c | 20.0 | 30.0 |")) << text;
  EXPECT_TRUE(has(text,
                  "- **bold**: best contender of its group; of times, all that cannot be told apart from the best "
                  "one\n"));
}

TEST(table, where_no_time_is_better_than_another_none_is_marked) {
  const std::vector<Record> records{row("a", 3, 0.1), row("b", 5, 0.1)};
  EXPECT_FALSE(has(render_table(records, Format::markdown, {.columns = {"technique", "resolve_ms"}}), "**"));
}

TEST(table, the_snapping_floor_stands_beside_the_error_once_a_record_has_it) {
  std::vector<Record> records{row("a", 3, 0.1), row("b", 5, 0.2)};
  for (const Format format : {Format::markdown, Format::latex, Format::terminal})
    EXPECT_FALSE(has(render_table(records, format), "snapping")) << "older records do not have it";
  EXPECT_TRUE(has(render_table(records, Format::csv), ",snapping_floor,")) << "programs get every column";

  // 4 of 40,000 pixels are 0.01 %; of the older record it is missing, not 0. It is the scene's, so that no row is best.
  records[0].metrics[Truth::shape]["snapping_floor"] = 1e-4;
  const std::string text = render_table(records, Format::markdown);
  EXPECT_TRUE(has(text, "| error (%) | snapping floor (%) | wrong (%) |")) << text;
  EXPECT_TRUE(has(text, "| **10.0** | 0.010 | **10.0** |")) << text;
  EXPECT_TRUE(has(text, "| 20.0 | - | 20.0 |")) << text;
  EXPECT_TRUE(has(render_table(records, Format::latex), "snapping"));
  EXPECT_TRUE(has(render_table(records, Format::terminal), "snapping"));
  const TableOptions options{.columns = {"technique", "snapping_floor", "mesh.snapping_floor"}};
  EXPECT_EQ(render_table(records, Format::csv, options), "technique,snapping_floor,mesh.snapping_floor\r\na,1e-04,\r\nb,,\r\n");
  const Json json = Json::parse(render_table(records, Format::json, options));
  EXPECT_EQ(json["rows"][0]["snapping_floor"], 1e-4);
  EXPECT_TRUE(json["rows"][1]["snapping_floor"].is_null());
}

// As error_settled and the ghosts of techniques that remember frames: rows without them have a dash.
TEST(table, memory_of_frames_has_columns_where_a_row_has_it) {
  std::vector<Record> records{row("remembers", 1, 0.25), row("forgets", 1, 0.5)};
  const auto head = [&] { return line_with(render_table(records, Format::markdown), "| technique "); };
  EXPECT_FALSE(has(head(), "settled") || has(head(), "ghost")) << head();
  Metrics& metrics = records[0].metrics[Truth::shape];
  metrics.insert({{"error_settled", 0.125}, {"ghost_half_life", std::nullopt}, {"ghost_frames", std::nullopt}});
  EXPECT_TRUE(has(head(), "error settled (%)")) << head();
  EXPECT_FALSE(has(head(), "ghost")) << "there was no jump: " << head();
  metrics["ghost_half_life"] = 4;
  metrics["ghost_frames"] = 28;
  EXPECT_TRUE(has(head(), "| error settled (%) | ghost half life (frames) | ghost frames (frames) |")) << head();
  const std::string text = render_table(records, Format::terminal);
  EXPECT_TRUE(has(line_with(text, "remembers "), "12.5")) << text;
  EXPECT_TRUE(has(text, "\nghost frames: frames after a jump until")) << text;
  const std::string narrow = render_table(records, Format::terminal, {.width = 60});
  EXPECT_TRUE(has(narrow, "ghost_half_life, ghost_frames")) << narrow;
}

TEST(table, rows_on_a_path_stand_apart_from_rows_that_stand_still) {
  std::vector<Record> records{row("a", 3, 0.1), row("a", 3, 0.2)};
  records[1].path = "camera_slide";
  const std::string text = render_table(records, Format::terminal);
  EXPECT_TRUE(has(text, "view main, path camera_slide, 640 x 480")) << text;
  EXPECT_FALSE(has(text, "*")) << text;
  EXPECT_TRUE(has(lines_of(render_table(records, Format::markdown))[0], "| path |"));
}

TEST(table, causes_are_shares_of_wrong_pixels_for_people_and_of_tested_ones_in_their_columns) {
  std::vector<Record> records{row("a", 3, 0.1)};
  EXPECT_FALSE(has(render_table(records, Format::terminal), "causes"));  // not requested
  records[0].classes["T"] = 1000;
  records[0].causes = {{"acne", 78}, {"crack", 2}, {"edge_resolution", 20}, {"region", 0}};
  EXPECT_EQ(top_causes(records[0]), "acne 78 %, edge resolution 20 %");
  EXPECT_EQ(top_causes(records[0], 5), "acne 78 %, edge resolution 20 %, crack 2 %");
  EXPECT_TRUE(has(line_with(render_table(records, Format::terminal), "full"), "  acne 78 %, edge resolution 20 %"));
  const std::string csv =
      render_table(records, Format::csv, {.columns = {"cause.acne", "cause.region", "cause.missing_caster"}});
  EXPECT_EQ(csv, "cause.acne,cause.region,cause.missing_caster\r\n0.078,0,\r\n");
}

TEST(table, a_cause_of_a_techniques_own_has_a_column_where_one_of_the_records_tells_it) {
  std::vector<Record> records{row("a", 3, 0.1), row("b", 3, 0.1), row("c", 3, 0.1)};
  for (Record& record : records) record.classes["T"] = 1000;
  records[0].causes = {{"acne", 100}};
  records[1].causes = {{"acne", 25}, {"off_screen", 75}};
  records[1].own_causes = {{"off_screen", "What casts the shadow is out of the picture.", {252, 0, 132}}};
  records[2].causes = {{"off_screen", 0}};
  records[2].own_causes = {{"off_screen", "Said otherwise by a later version.", {20, 255, 148}}};
  EXPECT_EQ(top_causes(records[1]), "off screen 75 %, acne 25 %");
  EXPECT_EQ(render_table(records, Format::csv, {.columns = {"cause.off_screen"}}), "cause.off_screen\r\n\r\n0.075\r\n0\r\n");
  const std::vector<Column> columns = all_columns(records);
  const auto is_it = [](const Column& column) { return column.name == "cause.off_screen"; };
  ASSERT_EQ(std::ranges::count_if(columns, is_it), 1);
  EXPECT_EQ(std::ranges::find_if(columns, is_it)->sentence, "What casts the shadow is out of the picture.");
  records.erase(records.begin() + 1, records.end());
  EXPECT_EQ(std::ranges::count_if(all_columns(records), is_it), 0);
}

TEST(table, spread_of_times_is_the_median_absolute_deviation_of_the_processes) {
  // Process medians 4, 8, 4, 4, 2 have the median 4 and the distances 0, 4, 0, 0, 2: their median is 0. With 1 in place of a 4:
  // 2, 8, 4, 1, 4 has median 4, distances 2, 4, 0, 3, 0: 2.
  std::vector<Record> records{row("a", 4, 0.1), row("b", 4, 0.1)};
  records[1].times(Stage::resolve) = {{2, 2, 9}, {8}, {4}, {1}, {4}};
  EXPECT_EQ(render_table(records, Format::csv, {.columns = {"resolve_ms_mad"}}), "resolve_ms_mad\r\n0\r\n2\r\n");
}

TEST(table, indices_keep_the_digits_that_tell_them_from_one) {
  std::vector<Record> records{row("a", 1, 0.1)};
  records[0].metrics[Truth::shape]["ssim"] = 0.99437;
  EXPECT_TRUE(has(render_table(records, Format::markdown, {.columns = {"technique", "ssim"}}), "| a | 0.9944 |"));
}

TEST(table, share_below_ninety_percent_is_flagged_and_explained) {
  std::vector<Record> records{row("shadow_map", 1, 0.1)};
  const TableOptions options{.columns = {"technique", "tested_share"}};
  EXPECT_FALSE(has(render_table(records, Format::terminal, options), "!"));
  records[0].metrics[Truth::shape]["tested_share"] = 0.899;
  const std::string text = render_table(records, Format::terminal, options);
  EXPECT_TRUE(has(text, "89.9!\n")) << text;
  EXPECT_TRUE(has(text, "!: less than 90 % of the pixels facing the light")) << text;
}

TEST(table, a_group_that_float32_cannot_decide_is_named) {
  std::vector<Record> records{row("a", 1, 0.1), row("b", 1, 0.1), row("a", 1, 0.1, "fence")};
  for (Record& r : records) r.classes = {{"B", 500}, {"F", 100}, {"G", 10}, {"S", 0}, {"T", 980}, {"U", 10}};
  EXPECT_FALSE(has(render_table(records, Format::terminal), "uncertain:"));
  records[1].classes = {{"B", 500}, {"F", 100}, {"G", 50}, {"S", 50}, {"T", 880}, {"U", 20}};
  const std::string text = render_table(records, Format::terminal);
  EXPECT_TRUE(
      has(text,
          "\nuncertain: float32 cannot decide 2.00 % of the pixels facing the light (class U): soup, light point, view main\n"))
      << text;
  EXPECT_FALSE(has(text, "(class U): fence"));
  records[1].classes = {{"U", 900}, {"T", 100}};
  EXPECT_TRUE(has(render_table(records, Format::markdown), "the scene is outside what the reference can decide"));
}

TEST(table, null_is_a_dash_for_people_and_empty_or_null_for_programs) {
  const std::vector<Record> records{row("shadow_map", 1, 0.1)};
  const TableOptions options{.columns = {"technique", "displacement_mean", "build_ms"}};
  EXPECT_TRUE(has(render_table(records, Format::markdown, options), "| shadow\\_map | - | - |"));
  EXPECT_TRUE(has(render_table(records, Format::latex, options), "shadow\\_map & -- & -- \\\\"));
  EXPECT_TRUE(has(render_table(records, Format::csv, options), "shadow_map,,\r\n"));
  const Json json = Json::parse(render_table(records, Format::json, options));
  EXPECT_TRUE(json["rows"][0]["build_ms"].is_null());
}

TEST(table, provenance_comes_from_the_records) {
  std::vector<Record> records{row("shadow_map", 1, 0.1), row("planar", 1, 0.1)};
  records[1].context["threads"] = 1;
  const std::string text = render_table(records, Format::terminal);
  EXPECT_TRUE(has(text, "\nrenderer: a renderer\n")) << text;
  EXPECT_TRUE(has(text, "\nprocessor: an abacus\n"));
  EXPECT_TRUE(has(text, "\nthreads: 2; 1\n"));
  EXPECT_TRUE(has(text, "\ncommit: abc123\n"));
  EXPECT_TRUE(has(text, "\nversion: -\n"));
  EXPECT_TRUE(has(text, "\nprocesses x repetitions: 5 x 1\n"));
}

TEST(table, rows_that_began_beside_other_work_are_said) {
  std::vector<Record> records{row("shadow_map", 1, 0.1), row("planar", 1, 0.1), row("planar", 2, 0.1)};
  const auto load = [&](std::size_t k, double average) {
    records[k].context["cores"] = 2;
    records[k].context["load_average"] = average;
    return render_table(records, Format::terminal);
  };
  EXPECT_FALSE(has(load(0, 0), "\nload: "));
  EXPECT_FALSE(has(load(1, 5), "\nload: ")) << "two cores at work, and what an engine has beside them";
  EXPECT_TRUE(has(load(1, 5.1), "\nload: 1 row began at a load average of up to 5.1: other work ran beside"));
  EXPECT_TRUE(has(load(2, 9.25), "\nload: 2 rows began at a load average of up to 9.2"));
}

TEST(table, rows_of_several_programs_are_said) {
  std::vector<Record> records{row("shadow_map", 1, 0.1), row("planar", 1, 0.1), row("planar", 2, 0.1)};
  const auto mixed = [&] { return has(render_table(records, Format::terminal), "\nmixed: "); };
  EXPECT_FALSE(mixed());
  records[2].context["commit"] = "def456";
  EXPECT_TRUE(has(render_table(records, Format::terminal),
                  "\nmixed: rows of several programs may not be comparable: commit abc123 (2 rows), commit def456 (1 row)\n"));
  for (Record& r : records) r.context["build"] = "one";
  EXPECT_FALSE(mixed()) << "two commits of the same code";
  records[1].context["technique_source"] = "a";
  records[2].context["technique_source"] = "b";
  EXPECT_TRUE(has(render_table(records, Format::terminal),
                  "\nmixed: rows of several programs may not be comparable: 2 sources of planar:"));
}

TEST(table, unknown_column_is_an_error_with_the_nearest_one) {
  const std::vector<Record> records{row("shadow_map", 1, 0.1)};
  try {
    render_table(records, Format::csv, {.columns = {"wrong_rat"}});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_TRUE(has(error.what(), "there is no column wrong_rat; did you mean wrong_rate?")) << error.what();
  }
}

TEST(table, no_records_make_a_table_without_rows) {
  for (const Format format : {Format::terminal, Format::markdown, Format::csv, Format::latex, Format::json})
    EXPECT_FALSE(render_table({}, format).empty());
}

}  // namespace table_test
