#include "measure/statistics/statistics.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>

#include "measure/statistics/distributions.h"
#include "measure/statistics/resample.h"

namespace statistics_test {

using namespace gnomon;

TEST(statistics, median_of_an_even_count_is_the_middle_of_the_two_central_values) {
  EXPECT_EQ(median(std::vector{3.0}), 3);
  EXPECT_EQ(median(std::vector{9.0, 1.0, 5.0}), 5);
  EXPECT_EQ(median(std::vector{9.0, 1.0, 5.0, 2.0}), 3.5);
}

TEST(statistics, quantile_interpolates_between_order_statistics) {
  // Four values are at 0, 1/3, 2/3 and 1. q = 1/4 is three quarters of the way from the first to the second.
  const std::vector<double> values{40, 10, 30, 20};
  EXPECT_EQ(quantile(values, 0), 10);
  EXPECT_EQ(quantile(values, 1), 40);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 17.5);
  EXPECT_DOUBLE_EQ(quantile(values, 0.95), 38.5);
}

TEST(statistics, median_absolute_deviation_ignores_one_wild_value) {
  // Median 3; distances 2 1 0 1 97; their median 1.
  EXPECT_EQ(median_absolute_deviation(std::vector<double>{1, 2, 3, 4, 100}), 1);
}

RC_GTEST_PROP(statistics, quantiles_rise_with_q_and_stay_within_the_values, ()) {
  const auto values = *rc::gen::nonEmpty(
      rc::gen::container<std::vector<double>>(rc::gen::map(rc::gen::inRange(-1000, 1000), [](int i) { return i / 7.0; })));
  const double low = *rc::gen::inRange(0, 100) / 100.0, high = *rc::gen::inRange(0, 100) / 100.0;
  const double q = std::min(low, high), p = std::max(low, high);
  RC_ASSERT(quantile(values, q) <= quantile(values, p));
  RC_ASSERT(quantile(values, 0) == *std::min_element(values.begin(), values.end()));
  RC_ASSERT(quantile(values, 1) == *std::max_element(values.begin(), values.end()));
}

TEST(statistics, process_is_the_unit_of_the_median) {
  // Process medians 2, 10, 11: median 10. The pooled median would be 3, because the first process repeated more often.
  const ProcessTimes times{{1, 2, 3, 2, 1, 3, 2}, {10}, {}, {11, 11}};
  EXPECT_EQ(median_of_medians(times), 10);
  EXPECT_EQ(median_of_medians({{}, {}}), std::nullopt);
}

TEST(bootstrap, one_process_gives_no_interval) {
  EXPECT_EQ(bootstrap({{1, 2, 3}}), std::nullopt);
  EXPECT_EQ(bootstrap({{1, 2, 3}, {}}), std::nullopt);
  EXPECT_EQ(bootstrap({}), std::nullopt);
}

TEST(bootstrap, equal_times_give_an_interval_of_no_width) {
  const double time = 0.1;  // not representable: the quantile may not smear it
  EXPECT_EQ(bootstrap({{time, time}, {time}, {time, time, time}}), (Estimate{time, time, time}));
}

TEST(bootstrap, interval_of_five_quiet_processes_runs_from_the_least_to_the_greatest) {
  // The resampled median is the least value when at least 3 of 5 draws hit it: 10/125 * 16/25 + 5/625 * 4/5 + 1/3125 =
  // 5.8 %, above 2.5 %; the greatest by symmetry.
  EXPECT_EQ(bootstrap({{4}, {2}, {1}, {16}, {8}}), (Estimate{4, 1, 16}));
}

TEST(bootstrap, same_times_give_the_same_interval) {
  const ProcessTimes times{{1.0, 1.1}, {1.3, 1.2}, {0.9, 1.05}, {1.6, 1.5}};
  EXPECT_EQ(bootstrap(times), bootstrap(times));
}

/// Share of simulated runs whose interval holds the true median 10, for `processes` x `repetitions`.
double coverage(int processes, int repetitions, double process_spread, double repetition_spread, int runs) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  int covered = 0;
  for (int run = 0; run < runs; ++run) {
    ProcessTimes times(processes);
    for (std::vector<double>& process : times) {
      const double center = 10 + process_spread * normal(random);
      for (int i = 0; i < repetitions; ++i) process.push_back(center + repetition_spread * normal(random));
    }
    const Estimate estimate = *bootstrap(times);
    covered += estimate.low <= 10 && 10 <= estimate.high;
  }
  return static_cast<double>(covered) / runs;
}

TEST(bootstrap, coverage_is_that_of_the_order_statistics_it_picks) {
  // 5 processes: the interval is [least, greatest], see above. It misses when all 5 fall on one side: 2 / 2^5, so it covers
  // 93.75 %. 11 processes: the resampled median is at or below the 2nd value with Binomial(11, 2/11) >= 6, 0.7 %, and the
  // 3rd with 4.7 %, so the interval is [3rd, 9th]; it misses with Binomial(11, 1/2) <= 2 twice: 134 / 2048, so it covers
  // 93.46 %. Tolerance: 4 standard deviations of a share of 500 runs, 4 sqrt(0.94 * 0.06 / 500) = 4.2 %.
  EXPECT_NEAR(coverage(5, 1, 1, 0, 500), 0.9375, 0.042);
  EXPECT_NEAR(coverage(11, 1, 1, 0, 500), 0.9346, 0.042);
}

TEST(bootstrap, repetitions_do_not_narrow_the_interval_below_the_spread_of_processes) {
  // Process medians are independent and symmetric about 10 whatever the repetitions, so [least, greatest] of 5 covers
  // 93.75 % again, and resampling repetitions moves the ends by less than their noise. A bootstrap that pools the 25 times
  // would take them for independent and cover far less. Tolerance as above.
  EXPECT_NEAR(coverage(5, 5, 1, 0.1, 500), 0.9375, 0.042);
}

/// P(X = k) of a binomial distribution of n trials.
double binomial(std::size_t n, std::size_t k, double p) {
  const auto a = static_cast<double>(n), b = static_cast<double>(k);
  return std::exp(std::lgamma(a + 1) - std::lgamma(b + 1) - std::lgamma(a - b + 1) + b * std::log(p) +
                  (a - b) * std::log(1 - p));
}

/// P(X >= k).
double binomial_tail(std::size_t n, std::size_t k, double p) {
  double sum = 0;
  for (std::size_t i = k; i <= n; ++i) sum += binomial(n, i, p);
  return sum;
}

TEST(resample, middle_of_a_long_process_is_drawn_as_often_as_from_single_draws) {
  // Of n draws from 0 .. n-1 the k-th smallest is below j where k draws are: Binomial(n, j / n) >= k. Both values in the middle
  // are parted by j where exactly n / 2 are below. Tolerance: 4 standard deviations of a share of 20,000 draws.
  constexpr int draws = 20'000;
  for (const std::size_t n : {most_drawn_singly + 1, most_drawn_singly + 2, std::size_t{1000}}) {
    ProcessTimes times(1);
    for (std::size_t i = n; i-- > 0;) times[0].push_back(static_cast<double>(i));
    order_long_processes(times);
    Random random(3);
    std::vector<double> scratch;
    for (const double share : {0.46, 0.5, 0.53}) {
      const auto j = static_cast<std::size_t>(share * static_cast<double>(n));
      const auto edge = static_cast<double>(j);
      int below = 0, parted = 0;
      for (int draw = 0; draw < draws; ++draw) {
        const std::span<double> middle = draw_repetitions(times[0], random, scratch);
        ASSERT_EQ(middle.size(), 2 - n % 2);
        ASSERT_LE(middle.front(), middle.back());
        below += middle.front() < edge;
        parted += middle.front() < edge && middle.back() >= edge;
      }
      const double p = edge / static_cast<double>(n);
      const auto expect = [&](int count, double wanted) {
        EXPECT_NEAR(static_cast<double>(count) / draws, wanted, 4 * std::sqrt(wanted * (1 - wanted) / draws)) << n << ' ' << j;
      };
      expect(below, binomial_tail(n, (n + 1) / 2, p));
      if (n % 2 == 0) expect(parted, binomial(n, n / 2, p));
    }
  }
}

TEST(resample, short_processes_are_drawn_value_by_value) {
  const std::vector<double> process(most_drawn_singly, 7.5);
  Random random(1);
  std::vector<double> scratch;
  EXPECT_EQ(draw_repetitions(process, random, scratch).size(), most_drawn_singly);
  EXPECT_EQ(scratch, process);
}

TEST(student, tails_are_those_of_the_tables) {
  // One degree of freedom is Cauchy's distribution: 1/2 - atan(t) / pi. Two: 1/2 - t / (2 sqrt(2 + t^2)).
  for (const double t : {-3.0, -0.5, 0.0, 0.1, 1.0, 7.0, 1000.0}) {
    EXPECT_NEAR(student_tail(t, 1), 0.5 - std::atan(t) / std::acos(-1), 1e-13);
    EXPECT_NEAR(student_tail(t, 2), 0.5 - t / (2 * std::sqrt(2 + t * t)), 1e-13);
  }
  // With many it is the normal distribution, 1/2 erfc(t / sqrt(2)).
  EXPECT_NEAR(student_tail(1.5, 1e7), 0.5 * std::erfc(1.5 / std::sqrt(2.0)), 1e-7);
  EXPECT_EQ(student_tail(INFINITY, 4), 0);
  // Printed tables: 2.776 leaves 2.5 % at 4, 2.306 at 8, 3.355 leaves 0.5 % at 8.
  EXPECT_NEAR(student_quantile(0.025, 4), 2.776, 5e-4);
  EXPECT_NEAR(student_quantile(0.025, 8), 2.306, 5e-4);
  EXPECT_NEAR(student_quantile(0.005, 8), 3.355, 5e-4);
}

RC_GTEST_PROP(student, quantile_inverts_tail, ()) {
  const double tail = *rc::gen::inRange(1, 1000) / 1000.0, freedom = *rc::gen::inRange(2, 200) / 2.0;
  RC_ASSERT(std::abs(student_tail(student_quantile(tail, freedom), freedom) - tail) < 1e-12);
}

TEST(false_discovery, rates_are_those_of_benjamini_and_hochberg) {
  // Sorted 0.01 0.02 0.03 0.5: times 4 / rank 0.04 0.04 0.04 0.5.
  EXPECT_EQ(false_discovery_rates(std::vector{0.5, 0.02, 0.01, 0.03}), (std::vector{0.5, 0.04, 0.04, 0.04}));
  EXPECT_EQ(false_discovery_rates(std::vector{1.0, 0.9}), (std::vector{1.0, 1.0}));
  EXPECT_TRUE(false_discovery_rates({}).empty());
  // All alike, more than any sort takes one by one: p * count / rank is p at the last rank, and no rank has less.
  EXPECT_EQ(false_discovery_rates(std::vector(1000, 0.25)), std::vector(1000, 0.25));
}

TEST(family_rates, are_those_of_holm) {
  // The least of three counts thrice, the next twice; the last would be called at 0.25, but not before the one below it.
  EXPECT_EQ(family_rates(std::vector{0.125, 0.25, 0.1875}, 3), (std::vector{0.375, 0.375, 0.375}));
  EXPECT_EQ(family_rates(std::vector{0.5, 0.0625}, 2), (std::vector{0.5, 0.125}));
  EXPECT_EQ(family_rates(std::vector{0.5, 0.0625}, 8), (std::vector{1.0, 0.5}));  // two of eight
  EXPECT_TRUE(family_rates({}, 0).empty());
}

RC_GTEST_PROP(false_discovery, rates_lie_between_p_and_bonferroni_and_keep_their_order, ()) {
  const auto p =
      *rc::gen::container<std::vector<double>>(rc::gen::map(rc::gen::inRange(0, 1001), [](int i) { return i / 1e3; }));
  const std::vector<double> rates = false_discovery_rates(p);
  for (std::size_t a = 0; a < p.size(); ++a) {
    RC_ASSERT(p[a] <= rates[a] + 1e-15);
    RC_ASSERT(rates[a] <= std::min(1.0, p[a] * static_cast<double>(p.size())) + 1e-15);
    for (std::size_t b = 0; b < p.size(); ++b) RC_ASSERT(p[a] > p[b] || rates[a] <= rates[b]);
  }
}

// Process medians are the unit: 5 % from process to process, 2 % from repetition to repetition, as quick and standard run them.
TEST(bootstrap, the_interval_covers_what_the_pages_say) {
  for (const auto& [processes, repetitions, low, high] : {std::tuple(3, 3, 0.79, 0.87), std::tuple(5, 3, 0.90, 0.96)}) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    int covered = 0;
    constexpr int trials = 600;
    for (int trial = 0; trial < trials; ++trial) {
      ProcessTimes times;
      for (int p = 0; p < processes; ++p) {
        const double here = std::exp(0.05 * normal(random));
        times.emplace_back();
        for (int r = 0; r < repetitions; ++r) times.back().push_back(here * std::exp(0.02 * normal(random)));
      }
      const Estimate estimate = *bootstrap(times);
      covered += estimate.low <= 1 && 1 <= estimate.high;
    }
    RecordProperty("covered_" + std::to_string(processes), covered);
    EXPECT_GT(covered, low * trials) << processes;
    EXPECT_LT(covered, high * trials) << processes;
  }
}

}  // namespace statistics_test
