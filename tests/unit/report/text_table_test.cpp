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
