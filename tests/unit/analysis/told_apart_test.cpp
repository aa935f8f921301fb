#include "analysis/told_apart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis_rows.h"

namespace told_apart_test {

using namespace gnomon;
using analysis_rows::normal;

/// Processes whose logarithms spread by `spread` about `middle` milliseconds, three repetitions each that spread by a tenth of
/// it.
ProcessTimes times(Random& random, double middle, double spread, int processes) {
  ProcessTimes all;
  for (int p = 0; p < processes; ++p) {
    const double here = middle * std::exp(spread * normal(random));
    all.emplace_back();
    for (int r = 0; r < 3; ++r) all.back().push_back(here * std::exp(0.1 * spread * normal(random)));
  }
  return all;
}

/// Which of these are told apart from the one that is least by its median of medians.
std::vector<bool> told_from_least(const std::vector<ProcessTimes>& group) {
  std::vector<double> values;
  for (const ProcessTimes& one : group) values.push_back(*median_of_medians(one));
  const auto least = static_cast<std::size_t>(std::ranges::min_element(values) - values.begin());
  std::vector<Contrast> contrasts;
  for (std::size_t k = 0; k < group.size(); ++k)
    if (k != least) contrasts.push_back({*log_time(group[k]), *log_time(group[least]), group.size()});
  std::vector<bool> told = told_apart(contrasts);
  told.insert(told.begin() + static_cast<std::ptrdiff_t>(least), false);
  return told;
}

TEST(told_apart, logarithms_of_process_medians_are_averaged) {
  const double e = std::exp(1.0);
  const auto time = log_time({{1, 1, 50}, {e}, {e * e}});
  ASSERT_TRUE(time);
  EXPECT_NEAR(time->value, 1, 1e-12);
  EXPECT_NEAR(time->variance, 1.0 / 3, 1e-12);
  EXPECT_EQ(time->freedom, 2);
  EXPECT_FALSE(log_time({{1, 2, 3}}));
  const LogTime parts[] = {*time, {.value = 3, .variance = 1.0 / 3, .freedom = 2}};
  const LogTime mean = mean_of(parts);
  EXPECT_NEAR(mean.value, 2, 1e-12);
  EXPECT_NEAR(mean.variance, 1.0 / 6, 1e-12);
  EXPECT_NEAR(mean.freedom, 4, 1e-12);
}

TEST(told_apart, times_without_spread_are_told_apart_and_equal_ones_are_not) {
  const LogTime one{.value = 0, .variance = 0, .freedom = 2}, more{.value = 0.01, .variance = 0, .freedom = 2};
  const Contrast contrasts[] = {{more, one}, {one, one}};
  EXPECT_EQ(told_apart(contrasts), (std::vector<bool>{true, false}));
  EXPECT_TRUE(told_apart({}).empty());
}

// The least of twelve equal times is less than they are by chance: without `among` one of them loses its star in every third
// group.
TEST(told_apart, in_at_most_six_of_a_hundred_groups_of_equals_one_is_told_apart) {
  for (const int processes : {3, 5})
    for (const double unequal : {1.0, 4.0}) {  // how much more the noisiest spreads than the quietest
      Random random(7, static_cast<std::uint64_t>(processes));
      int denied = 0;
      constexpr int groups = 1500;
      for (int g = 0; g < groups; ++g) {
        std::vector<ProcessTimes> group;
        for (int k = 0; k < 12; ++k) group.push_back(times(random, 5, 0.05 * std::pow(unequal, k / 11.0), processes));
        const std::vector<bool> told = told_from_least(group);
        denied += std::ranges::count(told, true) > 0;
      }
      RecordProperty("denied_" + std::to_string(processes) + (unequal > 1 ? "_unequal" : ""), denied);
      EXPECT_LE(denied, 0.06 * groups) << processes << " processes, spreads " << unequal;
    }
}

TEST(told_apart, what_is_slower_by_far_more_than_the_spread_is_told_apart) {
  Random random(9);
  int told_of_half_more = 0, told_of_the_equal = 0;
  constexpr int groups = 300;
  for (int g = 0; g < groups; ++g) {
    std::vector<ProcessTimes> group;
    for (const double middle : {5.0, 5.0, 7.5, 7.5, 20.0, 20.0}) group.push_back(times(random, middle, 0.05, 5));
    const std::vector<bool> told = told_from_least(group);
    told_of_half_more += told[2] + told[3];
    told_of_the_equal += told[0] + told[1];
    EXPECT_TRUE(told[4] && told[5]);
  }
  EXPECT_GE(told_of_half_more, 2 * groups * 99 / 100);
  EXPECT_LE(told_of_the_equal, groups * 6 / 100);
}

// A process that was disturbed makes an interval wide; 2.47 ms, 9.81 and 10.7 ms were all called best for that.
TEST(told_apart, one_noisy_process_of_five_does_not_hide_four_times_the_time) {
  const std::vector<ProcessTimes> group{{{2.4}, {2.5}, {2.47}, {2.6}, {9.9}},
                                        {{9.7}, {9.8}, {9.81}, {9.9}, {10.1}},
                                        {{10.5}, {10.7}, {10.7}, {10.8}, {11}},
                                        {{2.6}, {2.5}, {2.55}, {2.6}, {2.7}}};
  EXPECT_EQ(told_from_least(group), (std::vector<bool>{false, true, true, false}));
}

}  // namespace told_apart_test
