#include "report/table/text_table.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <sstream>

#include "report/table/digits.h"

namespace text_table_test {

using namespace gnomon;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(digits, numbers_get_as_many_digits_as_they_deserve) {
  EXPECT_EQ(rounded(0, 3), "0");
  EXPECT_EQ(rounded(0.012345, 3), "0.0123");
  EXPECT_EQ(rounded(1.2345, 3), "1.23");
  EXPECT_EQ(rounded(12.345, 3), "12.3");
  EXPECT_EQ(rounded(123.45, 3), "123");
  EXPECT_EQ(rounded(1234.6, 3), "1235");  // digits before the point stay
  EXPECT_EQ(rounded(-1.2345, 3), "-1.23");
  EXPECT_EQ(rounded(9.996, 3), "10.0");  // the carry costs a decimal
  EXPECT_EQ(rounded(0.9996, 3), "1.00");
  EXPECT_EQ(measured(0.0004567), "0.00046");
  EXPECT_EQ(measured(100), "100");
}

TEST(digits, zero_is_said_only_of_zero) {
  // One wrong pixel of a million is 0.0001 %: small, and not nothing.
  EXPECT_EQ(measured(100 * 1e-6), "0.00010");
  EXPECT_EQ(measured(0.0), "0");
}

RC_GTEST_PROP(digits, exact_text_reads_back_as_the_same_number, (double value)) {
  RC_PRE(std::isfinite(value));
  RC_ASSERT(std::stod(exact(value)) == value);
}

RC_GTEST_PROP(digits, rounding_errs_by_half_a_unit_of_the_last_digit_at_most, ()) {
  const double value = *rc::gen::inRange(1, 1000000) / 997.0;
  // Three digits: relative error at most 0.5 / 100.
  RC_ASSERT(std::abs(std::stod(rounded(value, 3)) - value) <= 0.005 * value * (1 + 1e-12));
}

TEST(text_table, signs_outside_ascii_count_as_one_column) {
  EXPECT_EQ(display_width("±"), 1u);
  EXPECT_EQ(display_width("3 ± 1 µm"), 8u);
  EXPECT_EQ(display_width("e\u0301"), 1u);  // e and a combining accent
  TextTable table({{"name", ""}, {"value", "", Align::right}, {"end", ""}});
  table.add_row({"Škoda", "1 ± 2", "|"});
  table.add_row({"plain", "12345", "|"});
  const std::vector<std::string> lines = lines_of(table.text());
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[2], "Škoda  1 ± 2  |");
  EXPECT_EQ(lines[3], "plain  12345  |");
}

TEST(text_table, headings_break_at_blanks_and_stand_on_their_units) {
  TextTable table({{"id", ""}, {"false dark", "%", Align::right}});
  table.add_row({"map", "1.25"});
  EXPECT_EQ(table.text(),
            "     false\n"
            "id    dark\n"
            "         %\n"
            "----------\n"
            "map   1.25\n");
}

TEST(text_table, long_text_wraps_into_its_own_column) {
  TextTable table({{"id", ""}, {"summary", ""}, {"n", "", Align::right}});
  table.add_row({"a", "one two three four five six", "7"});
  EXPECT_EQ(table.text(24),
            "id  summary            n\n"
            "------------------------\n"
            "a   one two three      7\n"
            "    four five six\n");
}

TEST(text_table, wrapped_text_breaks_at_blanks_commas_and_colons_and_loses_nothing) {
  EXPECT_EQ(wrap("a=1,b=2,c=3", 8), (std::vector<std::string>{"a=1,b=2,", "c=3"}));
  EXPECT_EQ(wrap("map:a=1,b=2", 8), (std::vector<std::string>{"map:a=1,", "b=2"}));
  EXPECT_EQ(wrap("abcdefgh", 3), (std::vector<std::string>{"abc", "def", "gh"}));
  EXPECT_EQ(wrap("±±±±", 3), (std::vector<std::string>{"±±±", "±"}));
  EXPECT_EQ(wrap("", 3), (std::vector<std::string>{""}));
}

TEST(text_table, words_are_not_cut_to_make_a_line_fit) {
  TextTable table({{"technique", ""}, {"n", "", Align::right}});
  table.add_row({"shadow_volume_tree:depth=12", "7"});
  EXPECT_EQ(table.text(10),
            "technique            n\n"
            "----------------------\n"
            "shadow_volume_tree:  7\n"
            "depth=12\n");
}

/// Each number is 12 columns wide, and has 2 before it.
TextTable three_numbers() {
  TextTable table({{"id", ""}, {"first", "", Align::right}, {"second", "", Align::right}, {"third", "", Align::right, 1}});
  table.add_heading("group");
  table.add_row({"a", "123456789012", "223456789012", "323456789012"});
  table.add_row({"b"}, "it has no numbers");
  return table;
}

TEST(text_table, spare_columns_are_left_out_and_named_where_there_is_no_room) {
  // 2 + 3 * 14 = 44 columns; without the third number 30.
  EXPECT_TRUE(three_numbers().left_out(44).empty());
  EXPECT_EQ(three_numbers().text(44), three_numbers().text());
  EXPECT_EQ(three_numbers().left_out(43), (std::vector<std::size_t>{3}));
  EXPECT_EQ(three_numbers().text(43),
            "id         first        second\n"
            "------------------------------\n"
            "\n"
            "group\n"
            "a   123456789012  223456789012\n"
            "b   it has no numbers\n"
            "left out for want of room: third; --wide\n"
            "  shows all\n");
}

TEST(text_table, columns_that_are_not_spare_go_on_below) {
  EXPECT_EQ(three_numbers().text(29),
            "id         first\n"
            "----------------\n"
            "\n"
            "group\n"
            "a   123456789012\n"
            "b   it has no numbers\n"
            "\n"
            "id        second\n"
            "----------------\n"
            "\n"
            "group\n"
            "a   223456789012\n"
            "left out for want of room:\n"
            "  third; --wide shows all\n");
}

TEST(text_table, what_runs_on_behind_a_cell_has_room) {
  TextTable table({{"technique", ""}, {"n", "", Align::right}});
  table.add_row({"one two three four five six seven eight nine ten"}, "a reason why there is no number");
  // The reason needs 16 columns and 2 before: the technique gets the other 22.
  EXPECT_EQ(table.text(40),
            "technique               n\n"
            "-------------------------\n"
            "one two three four      a reason why\n"
            "five six seven eight    there is no\n"
            "nine ten                number\n");
}

TEST(text_table, a_line_that_is_too_long_is_wrapped_and_indented) {
  EXPECT_EQ(wrapped_line("one two three", 0), "one two three\n");
  EXPECT_EQ(wrapped_line("one two three", 13), "one two three\n");
  EXPECT_EQ(wrapped_line("one two three", 9), "one two\n  three\n");
}

// Two columns of at most 32 with 2 between fit into 66, so any table does: its words are cut to 32 and its numbers are shorter.
RC_GTEST_PROP(text_table, every_line_of_a_table_fits, ()) {
  const auto width = *rc::gen::inRange<std::size_t>(66, 200);
  const auto text_of = [](int most) {
    return *rc::gen::resize(most, rc::gen::container<std::string>(rc::gen::element('a', 'b', ' ', ',', ':')));
  };
  std::vector<TextTable::Column> columns;
  const int count = *rc::gen::inRange(1, 12);
  for (int i = 0; i < count; ++i)
    columns.push_back({text_of(20), "", *rc::gen::element(Align::left, Align::right), *rc::gen::inRange(0, 3)});
  columns.front().spare = 0;
  columns.front().align = Align::left;
  TextTable table(columns);
  for (int row = 0; row < 5; ++row) {
    std::vector<std::string> cells;
    for (const TextTable::Column& column : columns) cells.push_back(text_of(column.align == Align::right ? 20 : 60));
    const bool is_refused = *rc::gen::element(false, true);
    if (is_refused) cells.resize(1);
    table.add_row(cells, is_refused && count > 1 ? text_of(90) + "!" : "");
  }
  for (const std::string& line : lines_of(table.text(width))) RC_ASSERT(display_width(line) <= width);
}

RC_GTEST_PROP(text_table, every_wrapped_line_fits, ()) {
  const auto text = *rc::gen::container<std::string>(rc::gen::element('a', 'b', ' ', ',', ':'));
  const auto width = *rc::gen::inRange<std::size_t>(1, 12);
  std::string kept;
  for (const std::string& line : wrap(text, width)) {
    RC_ASSERT(display_width(line) <= width);
    kept += line;
  }
  const auto without_blanks = [](std::string s) {
    std::erase(s, ' ');
    return s;
  };
  RC_ASSERT(without_blanks(kept) == without_blanks(text));
}

}  // namespace text_table_test
