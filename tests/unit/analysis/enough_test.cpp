#include "analysis/enough.h"

#include <gtest/gtest.h>

#include "analysis_rows.h"

namespace enough_test {

using namespace analysis_rows;

/// With relight and resolve of half the cost each.
Record paid(const std::string& setting, double cost, double error, Role role = Role::contender) {
  Record r = row(setting, cost / 2, cost / 2, error);
  r.role = role;
  return r;
}

/// "technique setting cost", or "technique none error".
std::vector<std::string> told(std::span<const Record> records, double budget) {
  const std::vector<Field> fields = find_fields(records, {});
  std::vector<std::string> lines;
  for (const Enough& one : find_enough(fields.front(), std::vector{budget}, "lower")) {
    const Candidate& c = fields.front().candidates[one.setting.value_or(one.least)];
    lines.push_back(one.setting ? fmt::format("{} {} {}", one.technique, c.setting, c.cost->value)
                                : fmt::format("{} none {}", one.technique, c.error));
  }
  return lines;
}

const std::vector<Record> rows = {paid("map:size=1", 1, 0.02),         paid("map:size=2", 2, 0.008),
                                  paid("map:size=4", 4, 0.003),        paid("volume", 3, 0.0005),
                                  paid("rays", 6, 0, Role::reference), paid("nothing", 0.5, 0.3, Role::baseline)};

// Each technique pays for its own cheapest setting; the cheapest technique is first, and those that never err so little are
// last.
TEST(enough, the_cheapest_setting_that_errs_no_more_is_what_a_technique_pays) {
  EXPECT_EQ(told(rows, 0.02), (std::vector<std::string>{"map map:size=1 1", "volume volume 3", "rays rays 6"}));
  EXPECT_EQ(told(rows, 0.01), (std::vector<std::string>{"map map:size=2 2", "volume volume 3", "rays rays 6"}));
  EXPECT_EQ(told(rows, 0.003), (std::vector<std::string>{"volume volume 3", "map map:size=4 4", "rays rays 6"}));
  EXPECT_EQ(told(rows, 0.001), (std::vector<std::string>{"volume volume 3", "rays rays 6", "map none 0.003"}));
}

TEST(enough, budgets_keep_their_order) {
  const std::vector<Field> fields = find_fields(rows, {});
  std::vector<double> budgets;
  for (const Enough& one : find_enough(fields.front(), std::vector{0.01, 0.005, 0.001}, "lower")) budgets.push_back(one.budget);
  EXPECT_EQ(budgets, (std::vector{0.01, 0.01, 0.01, 0.005, 0.005, 0.005, 0.001, 0.001, 0.001}));
}

// A mask of one value that errs less makes a setting's error worth nothing, however small it is.
TEST(enough, what_a_constant_mask_beats_is_not_enough) {
  const std::vector<Record> records = {with_constant(paid("map", 1, 0.004), 0.003),
                                       with_constant(paid("volume", 3, 0.001), 0.003)};
  EXPECT_EQ(told(records, 0.005), (std::vector<std::string>{"volume volume 3", "map none 0.004"}));
}

}  // namespace enough_test
