// Tables with less room than they need: on terminals, and in the columns of a page.
#include "table_rows.h"

namespace fitted_table_test {

using namespace table_rows;

/// Rows with numbers in every headline column, long settings, and one without an answer.
std::vector<Record> wide_records() {
  std::vector<Record> records{row("shadow_map", 1.25, 0.25), row("planar_projected", 20.5, 0.125),
                              refusal("composite_planar", Status::unsupported, "no plane holds a hundredth of the area")};
  for (Record& record : records) {
    record.settings = "resolution=4096,bias=receiver_plane,depth_bias=1.5,filter=pcf";
    if (record.status != Status::ok) continue;
    record.times(Stage::build) = {{12.5}, {12.5}};
    record.times(Stage::relight) = {{1.5}, {1.5}};
    record.classes = {{"B", 500}, {"F", 100}, {"G", 50}, {"S", 50}, {"T", 880}, {"U", 20}};
    record.causes = {{"acne", 78}, {"edge_resolution", 22}};
    for (const char* metric : {"false_dark_rate", "false_lit_rate", "wrong_rate_all", "displacement_mean", "displacement_p95",
                               "snapping_floor", "constant_error"})
      record.metrics[Truth::shape][metric] = 0.5;
  }
  return records;
}

std::size_t longest_line(const std::string& text) {
  std::size_t longest = 0;
  for (const std::string& line : lines_of(text)) longest = std::max(longest, display_width(line));
  return longest;
}

TEST(fitted_table, every_line_fits_and_what_is_left_out_is_named) {
  const std::string all = render_table(wide_records(), Format::terminal);
  EXPECT_GT(longest_line(all), 200u);
  EXPECT_FALSE(has(all, "left out for want of room"));
  for (const std::size_t width : {80u, 120u, 200u}) {
    const std::string text = render_table(wide_records(), Format::terminal, {.width = width});
    EXPECT_LE(longest_line(text), width) << text;
    EXPECT_TRUE(width == 200 || has(text, "left out for want of room: ")) << text;
    for (const char* kept : {"resolve", "error", "shadow_map"}) EXPECT_TRUE(has(text, kept)) << text;
  }
}

TEST(fitted_table, lines_below_explain_no_column_that_is_left_out) {
  EXPECT_TRUE(has(render_table(wide_records(), Format::terminal), "\nsnapping floor: "));
  EXPECT_FALSE(has(render_table(wide_records(), Format::terminal, {.width = 80}), "\nsnapping floor: "));
}

TEST(fitted_table, columns_that_are_named_all_stay_and_go_on_below) {
  const std::vector<std::string> names{"technique",      "setup_ms",        "build_ms",       "relight_ms",        "resolve_ms",
                                       "wrong_rate_all", "false_dark_rate", "false_lit_rate", "displacement_mean", "error"};
  const std::string text = render_table(wide_records(), Format::terminal, {.columns = names, .width = 80});
  EXPECT_LE(longest_line(text), 80u) << text;
  EXPECT_FALSE(has(text, "left out")) << text;
  // Each table has its rule and its group.
  EXPECT_EQ(std::ranges::count_if(lines_of(text), [](const std::string& line) { return line.starts_with("---"); }), 2) << text;
  EXPECT_TRUE(has(text, "displ.")) << text;
}

TEST(fitted_table, a_column_of_a_page_gets_what_fits_and_names_the_rest) {
  const auto table = [](Paper paper) {
    return render_table(wide_records(), Format::latex, {.label = "tab:mine", .paper = paper});
  };
  const std::string landscape = table(Paper::landscape), page = table(Paper::page), column = table(Paper::column);
  EXPECT_TRUE(landscape.starts_with("% Needs \\usepackage{booktabs} and a page in landscape.\n\\begin{table}[p]\n"));
  EXPECT_TRUE(has(page, "\\begin{table*}[tp]\n"));
  EXPECT_TRUE(has(page, "\\end{table*}\n"));
  EXPECT_TRUE(has(column, "\\begin{table}[tp]\n"));
  EXPECT_TRUE(column.starts_with("% Left out for want of room: "));
  for (const std::string& text : {landscape, page, column}) {
    EXPECT_TRUE(has(text, "\\label{tab:mine}"));
    EXPECT_TRUE(has(text, "resolve"));
  }
  const auto columns_in = [](const std::string& text) {
    const std::size_t open = text.find("{@{}") + 4;
    return text.find("@{}}", open) - open;
  };
  EXPECT_GT(columns_in(landscape), columns_in(page));
  EXPECT_GT(columns_in(page), columns_in(column));
}

TEST(fitted_table, headings_of_groups_wrap_in_a_column) {
  for (const std::string& line : lines_of(render_table(wide_records(), Format::latex, {.paper = Paper::column})))
    if (const std::size_t open = line.find("\\emph{"); open != line.npos) {
      EXPECT_LE(line.find("}}", open) - open, 6 + 36 + 2u) << line;  // \emph{, 36 characters, a sign that is written \%
    }
}

TEST(fitted_table, a_row_without_an_answer_keeps_its_reason_where_support_is_left_out) {
  const std::string text =
      render_table(wide_records(), Format::latex, {.columns = {"technique", "error"}, .paper = Paper::column});
  EXPECT_TRUE(has(text, "$^{1}$ & ")) << text;
  EXPECT_TRUE(has(text, "$^{1}$~no plane holds a hundredth of the area.")) << text;
}

TEST(fitted_table, columns_that_are_named_and_do_not_fit_are_refused) {
  try {
    render_table(
        wide_records(), Format::latex,
        {.columns = {"technique", "setup_ms", "build_ms", "relight_ms", "resolve_ms", "error"}, .paper = Paper::column});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_TRUE(has(error.what(), "--fit column has room for 45 characters, and the 6 columns take ")) << error.what();
  }
}

TEST(fitted_table, papers_have_names) {
  EXPECT_EQ(paper_named("page"), Paper::page);
  EXPECT_THROW(paper_named("A4"), Error);
}

}  // namespace fitted_table_test
