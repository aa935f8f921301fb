// One step in the values of a parameter, whatever its kind.
#include "app/viewer/parameter_steps.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace parameter_steps_test {

using namespace gnomon;
using viewer::value_after;

struct Rows final : Parametrized {
  Number<int> resolution{this,           "resolution", 1024, {.unit = "texel", .min = 64, .max = 8192, .log = true},
                         Stage::relight, "Side."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::resolve, "Seed."};
  Number<int> taps{this, "taps", 3, {.min = 1, .max = 9}, Stage::resolve, "Taps."};
  Number<double> bias{this, "bias", 1.5, {.unit = "texel", .min = 0, .max = 10}, Stage::resolve, "Bias."};
  Number<double> shift{this, "shift", 0.1, {.min = -0.5, .max = 0.5}, Stage::resolve, "Shift."};
  Number<double> moment{this, "moment", 3e-5, {.min = 3e-6, .max = 0.1, .log = true}, Stage::resolve, "Moment."};
  Choice filter{this, "filter", "none", {"none", "pcf", "disc"}, Stage::resolve, "Filter."};
  Flag receiver{this, "receiver", false, Stage::resolve, "Receiver."};
};

/// The values on the way of so many single steps.
std::vector<std::string> way(Rows& rows, std::string_view name, int step, int count) {
  std::vector<std::string> values;
  for (int k = 0; k < count; ++k) {
    rows.parameter(name).set(value_after(rows.parameter(name), step));
    values.push_back(rows.parameter(name).text());
  }
  return values;
}
using Values = std::vector<std::string>;

TEST(parameter_steps, words_go_round_in_both_directions) {
  Rows rows;
  EXPECT_EQ(way(rows, "filter", 1, 4), (Values{"pcf", "disc", "none", "pcf"}));
  EXPECT_EQ(way(rows, "filter", -1, 3), (Values{"none", "disc", "pcf"}));
  EXPECT_EQ(way(rows, "receiver", 1, 2), (Values{"true", "false"}));
  EXPECT_EQ(value_after(rows.filter, -5), "disc") << "from pcf: two rounds back but one";
}

TEST(parameter_steps, whole_numbers_of_a_log_range_go_through_powers_of_two) {
  Rows rows;
  EXPECT_EQ(way(rows, "resolution", 1, 4), (Values{"2048", "4096", "8192", "8192"}));
  rows.resolution.set("1000");
  EXPECT_EQ(value_after(rows.resolution, 1), "1024");
  EXPECT_EQ(way(rows, "resolution", -1, 5), (Values{"512", "256", "128", "64", "64"}));
  EXPECT_EQ(value_after(rows.resolution, 3), "512");
}

// 1000000 / 50 is 20000; 8 / 50 is less than 1.
TEST(parameter_steps, other_whole_numbers_go_by_a_fiftieth_or_by_one) {
  Rows rows;
  EXPECT_EQ(way(rows, "seed", 1, 2), (Values{"20001", "40001"}));
  EXPECT_EQ(way(rows, "seed", -1, 3), (Values{"20001", "1", "0"}));
  EXPECT_EQ(way(rows, "taps", 1, 2), (Values{"4", "5"}));
  EXPECT_EQ(value_after(rows.taps, 40), "9");
  EXPECT_EQ(value_after(rows.taps, -40), "1");
}

// 10 / 50 is 0.2; 1 / 50 is 0.02, and three of them from 0.1 are 0.16, not 0.16000000000000003.
TEST(parameter_steps, real_numbers_go_by_a_round_fiftieth) {
  Rows rows;
  EXPECT_EQ(way(rows, "bias", 1, 2), (Values{"1.7", "1.9"}));
  EXPECT_EQ(value_after(rows.shift, 3), "0.16");
  EXPECT_EQ(value_after(rows.shift, -5), "0");
  EXPECT_EQ(value_after(rows.shift, -100), "-0.5");
}

TEST(parameter_steps, real_numbers_of_a_log_range_go_through_1_2_5) {
  Rows rows;
  EXPECT_EQ(way(rows, "moment", 1, 4), (Values{"5e-05", "0.0001", "0.0002", "0.0005"}));
  EXPECT_EQ(way(rows, "moment", -1, 7), (Values{"0.0002", "0.0001", "5e-05", "2e-05", "1e-05", "5e-06", "3e-06"}));
  EXPECT_EQ(value_after(rows.moment, 100), "0.1");
}

TEST(parameter_steps, a_log_range_that_begins_at_0_is_left_and_reached) {
  struct : Parametrized {
    Number<int> count{this, "count", 0, {.min = 0, .max = 8, .log = true}, Stage::build, "Count."};
    Number<double> width{this, "width", 0, {.min = 0, .max = 2, .log = true}, Stage::build, "Width."};
  } rows;
  EXPECT_EQ(value_after(rows.count, 1), "1");
  EXPECT_EQ(value_after(rows.count, 3), "4");
  rows.count.set("2");
  EXPECT_EQ(value_after(rows.count, -2), "0");
  EXPECT_EQ(value_after(rows.width, 1), "2e-06");
  rows.width.set("2e-06");
  EXPECT_EQ(value_after(rows.width, -1), "0");
}

RC_GTEST_PROP(parameter_steps, any_number_of_steps_from_any_value_gives_one_that_is_accepted, (int steps)) {
  Rows rows;
  const int whole = *rc::gen::inRange(64, 8193), seed = *rc::gen::inRange(0, 1000001);
  rows.resolution.set(std::to_string(whole));
  rows.seed.set(std::to_string(seed));
  rows.moment.set(fmt::format("{}", 3e-6 + 1e-6 * (whole % 90000)));
  rows.bias.set(fmt::format("{}", seed / 1e5));
  for (Parameter* const row : rows.parameters()) {
    const std::string before = row->text();
    row->set(value_after(*row, steps % 100));
    if (steps % 100 == 0) RC_ASSERT(row->text() == before);
  }
}

}  // namespace parameter_steps_test
