// Tables and figures of rows under lights with area, alone and beside others.
#include <gtest/gtest.h>

#include "analysis_rows.h"
#include "report/figure/figure.h"
#include "report/table/layout.h"

namespace soft_table_test {

using namespace analysis_rows;

Record soft(const std::string& technique, double error) {
  Record r = soft_row(technique, 1, 1, error);
  for (const auto& [metric, value] : {std::pair("other_error_mean", 0.03),
                                      {"penumbra_width_ratio", 1.25},
                                      {"penumbra_shift", -0.5},
                                      {"penumbra_noise", 0.04},
                                      {"tested_share", 0.97}})
    r.metrics[Truth::shape][metric] = value;
  return r;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

const std::vector<Record> soft_rows{soft("a", 0.04), soft("b", 0.01)}, hard_rows{row("a", 1, 1, 0.1), row("c", 1, 1, 0.2)};

std::vector<Record> mixed() {
  std::vector<Record> records = soft_rows;
  records.insert(records.end(), hard_rows.begin(), hard_rows.end());
  return records;
}

TEST(soft_table, an_error_stands_beside_the_references_own) {
  const std::string text = render_table(soft_rows, Format::markdown);
  EXPECT_TRUE(has(first_line(text), "| error (%) | error floor (%) | other error (%) | penumbra width ratio (ratio) |"))
      << text;
  EXPECT_TRUE(has(text, "| 4.00 | 0.20 | 3.00 | 1.25 | -0.50 | 4.00 | 97.0 |")) << text;
  EXPECT_TRUE(has(text, "| **1.00** | 0.20 |")) << "the best is marked by its error";
  EXPECT_FALSE(has(first_line(text), "wrong")) << text;
  EXPECT_FALSE(has(first_line(text), "contact hardening")) << "no row has it";
  EXPECT_TRUE(has(text, "- error: mean difference from the reference over the tested pixels; rows are judged by it\n")) << text;
  EXPECT_TRUE(has(text, "- error floor: error that the reference's noise alone makes; ")) << text;
  EXPECT_TRUE(has(render_table(soft_rows, Format::latex), "error floor"));
}

TEST(soft_table, rows_without_area_have_no_columns_of_soft_shadows) {
  for (const Format format : {Format::markdown, Format::terminal, Format::latex}) {
    const std::string text = render_table(hard_rows, format);
    EXPECT_FALSE(has(text, "error floor")) << text;
    EXPECT_FALSE(has(text, "penumbra"));
    EXPECT_TRUE(has(text, "wrong"));
  }
}

TEST(soft_table, both_kinds_have_a_table_each_and_one_provenance) {
  const std::string text = render_table(mixed(), Format::markdown);
  EXPECT_EQ(count(text, "| technique |"), 2u);
  EXPECT_LT(text.find("wrong (%)"), text.find("error floor (%)")) << "lights without area first";
  EXPECT_EQ(count(text, "- processor: "), 1u);
  EXPECT_EQ(count(text, "| point |"), 2u);
  EXPECT_EQ(count(text, "| disc |"), 2u);
  const std::string hard = render_table(hard_rows, Format::terminal);
  EXPECT_TRUE(render_table(mixed(), Format::terminal).starts_with(hard.substr(0, hard.find("renderer:")))) << hard;
  // Every table has a number of its own in LaTeX.
  const std::string latex = render_table(mixed(), Format::latex);
  EXPECT_TRUE(has(latex, "view: lights without area.}\n  \\label{tab:gnomon}\n")) << latex;
  EXPECT_TRUE(has(latex, "view: lights with area.}\n  \\label{tab:gnomon:2}\n")) << latex;
  std::vector<Record> three = mixed();
  three.push_back(row("a", 1, 1, 0.1));
  three.back().answer = AnswerKind::received;
  const std::string latex_of_three = render_table(three, Format::latex);
  EXPECT_TRUE(has(latex_of_three, "view: lights with area.}\n  \\label{tab:gnomon:2}\n")) << latex_of_three;
  EXPECT_TRUE(has(latex_of_three, "view: several lights together.}\n  \\label{tab:gnomon:3}\n")) << latex_of_three;
  // Named columns make one table.
  const std::string chosen =
      render_table(mixed(), Format::markdown, {.columns = {"light", "technique", "error", "error_floor"}});
  EXPECT_TRUE(has(chosen, "| disc | a | 4.00 | 0.20 |\n")) << chosen;
  EXPECT_TRUE(has(chosen, "| point | c | 20.0 | - |\n")) << chosen;
  // Programs get one table of all columns.
  EXPECT_EQ(Json::parse(render_table(mixed(), Format::json))["rows"].size(), 4u);
}

TEST(soft_table, a_narrow_terminal_keeps_error_and_floor) {
  const std::string text = render_table(soft_rows, Format::terminal, {.width = 70});
  EXPECT_TRUE(has(text, "left out for want of room: ")) << text;
  EXPECT_TRUE(has(text, "  0.20")) << text;
  EXPECT_TRUE(has(text, "  4.00")) << text;
}

TEST(soft_table, the_flag_speaks_of_errors) {
  std::vector<Record> records = soft_rows;
  records[0].metrics[Truth::shape]["tested_share"] = 0.5;
  EXPECT_TRUE(has(render_table(records, Format::terminal), "are tested: read the errors with care"));
}

TEST(soft_table, the_headline_of_a_page_covers_both_kinds) {
  const std::vector<std::string> names = headline_columns(mixed(), true);
  const auto at = [&](const std::string& name) { return std::ranges::find(names, name) - names.begin(); };
  EXPECT_EQ(at("error_floor"), at("error") + 1);
  EXPECT_LT(at("false_dark_rate"), std::ssize(names));
  EXPECT_LT(at("penumbra_shift"), std::ssize(names));
  EXPECT_EQ(at("wrong_rate"), at("error_floor") + 1);
}

TEST(soft_figure, a_front_has_a_panel_for_each_kind_of_light) {
  const auto script = [](const std::vector<Record>& records) { return figure_script(records, "front", {}, "f.svg"); };
  const std::string both = script(mixed());
  EXPECT_TRUE(has(both, "# Panels: 1 row of 2\n")) << both;
  EXPECT_EQ(count(both, "set ylabel 'error (%)'"), 2u) << both;
  EXPECT_EQ(count(both, "title 'a'"), 1u) << "a technique of both has one color, named once";
  EXPECT_EQ(count(both, "title 'error floor'"), 1u);
  EXPECT_FALSE(has(both, "nan") || has(both, "inf")) << both;
  const std::string hard = script(hard_rows);
  EXPECT_TRUE(has(hard, "# Panels: 1 row of 1\n")) << hard;
  EXPECT_FALSE(has(hard, "error floor")) << hard;
}

TEST(soft_figure, bars_stand_for_the_places_of_their_kind) {
  std::vector<Record> records = mixed();
  const std::string stages = figure_script(records, "stages", {}, "f.svg");
  EXPECT_TRUE(has(stages, "'a' 1, 'c' 2, 'a, light with area' 3, 'b, light with area' 4")) << stages;
  EXPECT_TRUE(has(stages, "mean over places: 1 without area of the light, 1 with area of the light")) << stages;
  for (Record& r : records) r.causes = {{"acne", 3}, {"crack", 1}};
  const std::string causes = figure_script(records, "causes", {}, "f.svg");
  EXPECT_TRUE(has(causes, "share of the error (%)")) << causes;
  EXPECT_TRUE(has(causes, "set label 'error'")) << causes;
  EXPECT_TRUE(has(figure_script(std::span(records).last(2), "causes", {}, "f.svg"), "share of the wrong pixels (%)"));
}

}  // namespace soft_table_test
