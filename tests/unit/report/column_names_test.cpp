// Columns by what people call them.
#include "table_rows.h"

namespace column_names_test {

using namespace table_rows;

/// A row in which a bare pass is timed, and whose technique has the parameter `memory`.
std::vector<Record> records() {
  std::vector<Record> all{row("filter", 1, 0.25)};
  all[0].parameters = {{"memory", "accumulate"}};
  return all;
}

std::string heads(std::initializer_list<std::string> words) {
  return lines_of(render_table(records(), Format::csv, {.columns = words}))[0];
}

std::string refusal_of(const std::string& word) {
  try {
    heads({word});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(column_names, a_heading_names_its_column) {
  EXPECT_EQ(heads({"wrong", "false dark", "resolve", "displ. p95"}),
            "wrong_rate,false_dark_rate,resolve_ms,displacement_p95\r");
  EXPECT_EQ(heads({"wrong (shape)"}), "shape.wrong_rate\r");
}

TEST(column_names, units_line_breaks_and_capitals_do_not_count) {
  EXPECT_EQ(heads({"false\ndark", " False  dark ", "false dark %", "false dark (%)", "false\ndark\n%", "false dark [%]"}),
            "false_dark_rate,false_dark_rate,false_dark_rate,false_dark_rate,false_dark_rate,false_dark_rate\r");
  EXPECT_EQ(refusal_of("false dark (ms)").substr(0, 39), "there is no column false dark (ms); did");
}

TEST(column_names, a_name_comes_before_a_heading) {
  // "floor" is the column of the bare pass, and "error floor" no column of that name.
  EXPECT_EQ(heads({"floor", "error floor"}), "floor,error_floor\r");
}

TEST(column_names, a_heading_of_several_columns_lists_them_unless_the_unit_tells_them_apart) {
  EXPECT_EQ(refusal_of("bare pass"), "bare pass is the heading of 2 columns; name one of them: floor, floor_ms");
  EXPECT_EQ(heads({"bare pass (ms)"}), "floor_ms\r");
  EXPECT_EQ(refusal_of("memory"), "memory is the heading of 2 columns; name one of them: bytes, parameter.memory");
  EXPECT_EQ(heads({"memory (MiB)"}), "bytes\r");
}

TEST(column_names, a_wrong_word_gets_the_five_nearest_names_by_name_or_heading) {
  // One letter is missing of a heading; of the name "false_dark_rate" seven.
  const std::string text = refusal_of("fals dark");
  EXPECT_TRUE(text.starts_with("there is no column fals dark; did you mean false_dark_rate? Near are also: ")) << text;
  EXPECT_EQ(std::ranges::count(text, ','), 3) << text;
}

}  // namespace column_names_test
