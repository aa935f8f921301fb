// Tables as CSV, JSON, LaTeX and Markdown.
#include "table_rows.h"

namespace table_formats_test {

using namespace table_rows;

// --- CSV, JSON --------------------------------------------------------------------------------------------------------

TEST(csv, fields_are_quoted_as_rfc_4180_and_python_csv_do) {
  EXPECT_EQ(csv_field("plain text"), "plain text");
  EXPECT_EQ(csv_field("a=1,b=2"), "\"a=1,b=2\"");
  EXPECT_EQ(csv_field("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(csv_field("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_field("carriage\rreturn"), "\"carriage\rreturn\"");
  EXPECT_EQ(csv_field(""), "");
}

TEST(csv, every_record_is_one_row_with_full_precision_interval_and_both_truths) {
  std::vector<Record> records{row("shadow_map", 0.1, 1.0 / 3)};
  records[0].settings = "resolution=256,filter=pcf";
  records[0].parameters = {{"resolution", 256}, {"filter", "pcf"}};
  const TableOptions options{.columns = {"technique", "settings", "resolve_ms", "resolve_ms_low", "resolve_ms_high",
                                         "wrong_rate", "shape.wrong_rate", "mesh.wrong_rate", "parameter.resolution", "bytes"}};
  // Five processes: the interval runs from the least median to the greatest (statistics_test derives it).
  EXPECT_EQ(render_table(records, Format::csv, options),
            "technique,settings,resolve_ms,resolve_ms_low,resolve_ms_high,wrong_rate,shape.wrong_rate,mesh.wrong_rate,"
            "parameter.resolution,bytes\r\n"
            "shadow_map,\"resolution=256,filter=pcf\",0.1,0.05,0.2,0.3333333333333333,0.3333333333333333,0.16666666666666666,"
            "256,3145728\r\n");
}

TEST(csv, default_holds_every_column_of_the_records) {
  std::vector<Record> records{row("shadow_map", 0.1, 0.1)};
  records[0].counts = {{"texels", 65536, "texel"}};
  const std::string header = lines_of(render_table(records, Format::csv))[0];
  EXPECT_TRUE(header.starts_with("job,suite,scene,light,"));
  EXPECT_TRUE(has(header, ",count.texels\r"));
  EXPECT_EQ(std::count(header.begin(), header.end(), ',') + 1, static_cast<long>(column_names(records).size()));
}

TEST(json_table, values_stand_under_the_names_and_units_of_their_columns) {
  const std::vector<Record> records{row("shadow_map", 0.1, 0.25)};
  const Json json =
      Json::parse(render_table(records, Format::json, {.columns = {"technique", "resolve_ms", "wrong_rate", "bytes"}}));
  EXPECT_EQ(json["schema"], "gnomon-table-1");
  EXPECT_EQ(json["columns"][1]["unit"], "ms");
  EXPECT_EQ(json["columns"][2]["better"], "lower");
  EXPECT_EQ(json["columns"][3]["unit"], "byte");
  EXPECT_EQ(json["rows"][0],
            (Json{{"technique", "shadow_map"}, {"resolve_ms", 0.1}, {"wrong_rate", 0.25}, {"bytes", 3145728}}));
}

// --- LaTeX, Markdown --------------------------------------------------------------------------------------------------

TEST(latex, commands_in_text_are_made_harmless) {
  EXPECT_EQ(latex_text("_ % & # $ { }"), "\\_ \\% \\& \\# \\$ \\{ \\}");
  EXPECT_EQ(latex_text("~^\\"), "\\textasciitilde{}\\textasciicircum{}\\textbackslash{}");
  EXPECT_EQ(latex_text("a -> b"), "a $\\rightarrow$ b");
  EXPECT_EQ(latex_text("a<b, c>d, 1 ± 2"), "a$<$b, c$>$d, 1 $\\pm$ 2");
  EXPECT_EQ(latex_text("plain - text"), "plain - text");
}

TEST(latex, table_needs_booktabs_only_and_every_row_has_all_its_cells) {
  const std::vector<Record> records{row("shadow_map", 1, 0.1), row("planar", 20, 0.2), row("planar", 2, 0.2, "other")};
  const TableOptions options{.columns = {"scene", "technique", "resolve_ms"}, .caption = "50 % more", .label = "tab:a_b"};
  const std::string text = render_table(records, Format::latex, options);
  EXPECT_TRUE(has(text, "\\begin{tabular}{@{}llr@{}}"));
  EXPECT_TRUE(has(text, "\\caption{50 \\% more}"));
  EXPECT_TRUE(has(text, "\\label{tab:a_b}"));  // a name, not text
  EXPECT_TRUE(has(text, "soup & shadow\\_map & \\textbf{1.00} \\\\"));
  for (const std::string& line : lines_of(text)) {
    if (!line.ends_with("\\\\")) continue;
    EXPECT_EQ(std::count(line.begin(), line.end(), '&'), 2) << line;
  }
  int rules = 0;
  for (std::size_t at = text.find("\\midrule"); at != text.npos; at = text.find("\\midrule", at + 1)) ++rules;
  EXPECT_EQ(rules, 2);  // one above each group
}

TEST(latex, long_tables_become_several_floats_and_no_row_is_lost) {
  std::vector<Record> records;
  for (int scene = 0; scene < 12; ++scene)
    for (int k = 0; k < 9; ++k) records.push_back(row(fmt::format("t{}", k), 1 + k, 0.1, fmt::format("scene_{}", scene)));
  const std::string text = render_table(records, Format::latex);
  const auto count = [&](const std::string& part) {
    int found = 0;
    for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("\\begin{table}"), 4);  // 10 lines a group, 34 lines a page: three groups each
  EXPECT_EQ(count("\\caption{"), 4);
  EXPECT_EQ(count("\\label{"), 1);
  EXPECT_EQ(count(" (3 of 4)}"), 1);
  EXPECT_EQ(count("& full &"), 12 * 9);
  EXPECT_EQ(count("renderer: "), 1);  // notes are below the last one
}

// Three groups of ten lines a page: 40 pages are 120 groups.
TEST(latex, more_floats_than_latex_holds_are_printed_in_between) {
  const auto text_of = [](int groups) {
    std::vector<Record> records;
    for (int scene = 0; scene < groups; ++scene)
      for (int k = 0; k < 9; ++k) records.push_back(row(fmt::format("t{}", k), 1 + k, 0.1, fmt::format("scene_{}", scene)));
    return render_table(records, Format::latex);
  };
  EXPECT_FALSE(has(text_of(120), "\\clearpage"));
  const std::string text = text_of(121);
  EXPECT_TRUE(has(text, " (41 of 41)}"));
  EXPECT_LT(text.find(" (40 of 41)}"), text.find("\\clearpage\n"));
  EXPECT_GT(text.find(" (41 of 41)}"), text.find("\\clearpage\n"));
  EXPECT_EQ(text.find("\\clearpage"), text.rfind("\\clearpage"));
}

TEST(latex, words_too_long_for_the_page_wrap_into_further_lines) {
  std::vector<Record> records{row("shadow_map", 1, 0.1)};
  records[0].settings =
      "resolution=4096,bias=receiver_plane,depth_bias=1.5,slope_bias=3,normal_offset=1.5,filter=pcf,filter_radius=4";
  records[0].reason =
      "one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen seventeen";
  const std::string text = render_table(records, Format::latex, {.columns = {"technique", "reason", "resolve_ms"}});
  EXPECT_TRUE(has(text, "resolution=4096,")) << text;
  for (const std::string& line : lines_of(text)) {
    if (line.ends_with("\\\\")) {
      EXPECT_LE(line.size(), 175u) << line;
    }
  }
}

TEST(markdown, text_stays_in_its_cell) {
  EXPECT_EQ(markdown_text("a|b"), "a\\|b");
  EXPECT_EQ(markdown_text("two\nlines <b>"), "two lines \\<b\\>");
}

}  // namespace table_formats_test
