#include "analysis/difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "measure/statistics/distributions.h"

namespace difference_test {

using namespace gnomon;

TEST(difference, welch_takes_the_logarithms_of_process_medians) {
  // Medians 1, e, e^2 and e, e^2, e^3: means 1 and 2 of the logarithms, variances 1 each, so 1/3 + 1/3 of the difference.
  // Equal variances of equal samples have all 4 degrees of freedom.
  const double e = std::exp(1.0);
  const auto difference = log_difference({{1, 1, 50}, {e}, {e * e}}, {{e}, {e * e}, {0.1, e * e * e, 1000}}, 0.005);
  ASSERT_TRUE(difference);
  EXPECT_NEAR(difference->value, 1, 1e-12);
  EXPECT_NEAR(difference->variance, 2.0 / 3, 1e-12);
  EXPECT_NEAR(difference->freedom, 4, 1e-12);
}

TEST(difference, pairs_cancel_what_disturbs_both) {
  // The machine slows down twofold from process to process; the contender takes 1.5 times as long in each.
  const ProcessTimes base{{1}, {2}, {4}, {8}}, contender{{1.5}, {3}, {6}, {12}};
  const auto paired = paired_difference(base, contender, 0.005), apart = log_difference(base, contender, 0.005);
  EXPECT_NEAR(paired->value, std::log(1.5), 1e-12);
  EXPECT_NEAR(paired->variance, 0, 1e-24);
  EXPECT_EQ(paired->freedom, 3);
  EXPECT_NEAR(apart->value, std::log(1.5), 1e-12);
  EXPECT_GT(apart->variance, 0.3);
}

TEST(difference, an_empty_process_breaks_its_own_pair_only) {
  const auto paired = paired_difference({{1}, {}, {2}, {3}}, {{2}, {9}, {4}, {6}}, 0.005);
  EXPECT_NEAR(paired->value, std::log(2.0), 1e-12);
  EXPECT_EQ(paired->freedom, 2);
  EXPECT_EQ(paired_difference({{1}, {}}, {{1}, {1}}, 0.005), std::nullopt);
  EXPECT_EQ(log_difference({{1}}, {{1}, {1}}, 0.005), std::nullopt);
}

TEST(difference, times_below_the_least_count_as_the_least) {
  const auto difference = log_difference({{0.001}, {0.004}}, {{0.002}, {0.003}}, 0.005);
  EXPECT_EQ(difference->value, 0);
  EXPECT_EQ(difference->variance, 0);
}

TEST(difference, slack_is_the_share_of_the_cores_that_the_load_takes) {
  // 2 cores under load 1, then 4; one unit is the run's own. (2 + 1 + 2) / (2 + 1).
  EXPECT_NEAR(load_slack(1, 4, 2), std::log(5.0 / 3), 1e-12);
  EXPECT_NEAR(load_slack(4, 1, 2), -std::log(5.0 / 3), 1e-12);
  EXPECT_EQ(load_slack(0.3, 1.2, 2), 0);
}

/// A simulated pair of runs: log times of `scenes` x `rows`, two stages, five processes a side. `drift` moves every scene of a
/// run, `spread` every process; `effect` is what the contender really adds to the first `changed` rows of every scene.
struct World {
  int scenes = 6, rows = 8;
  double drift = 0, spread = 0.05, effect = 0;
  int changed = 0;
  double load = 0;  ///< the contender ran while other threads took this much, and all its times are longer for it
};

struct Calls {
  int called = 0, wrong = 0, real = 0, found = 0, all = 0;
};

Calls compare_worlds(const World& world, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<LogDifference> differences;
  std::vector<bool> is_real;
  const auto run = [&](double center) {
    ProcessTimes times;
    for (int process = 0; process < 5; ++process) times.push_back({std::exp(center + world.spread * normal(random))});
    return times;
  };
  const double loaded = std::log((2 + world.load) / 2);
  for (int stage = 0; stage < 2; ++stage)
    for (int scene = 0; scene < world.scenes; ++scene) {
      const double base_drift = world.drift * normal(random), contender_drift = world.drift * normal(random);
      for (int row = 0; row < world.rows; ++row) {
        const bool real = row < world.changed;
        const ProcessTimes base = run(base_drift), contender = run(contender_drift + loaded + (real ? world.effect : 0));
        differences.push_back(*log_difference(base, contender, 1e-9));
        differences.back().kind = stage;
        differences.back().batch = scene;
        differences.back().slack = world.load > 0 ? load_slack(0, world.load + 1, 2) : 0;
        is_real.push_back(real);
      }
    }
  const Judgements judged = judge(differences, std::log(1.05), false);
  Calls calls;
  for (std::size_t k = 0; k < differences.size(); ++k) {
    const bool is_called = judged.each[k].false_discovery <= 0.05;
    calls.called += is_called;
    calls.wrong += is_called && !is_real[k];
    calls.real += is_real[k];
    calls.found += is_called && is_real[k];
    ++calls.all;
  }
  return calls;
}

Calls compare_many(const World& world, int times) {
  std::mt19937 random(20);
  Calls sum;
  for (int k = 0; k < times; ++k) {
    const Calls calls = compare_worlds(world, random);
    sum.called += calls.called, sum.wrong += calls.wrong, sum.real += calls.real, sum.found += calls.found,
        sum.all += calls.all;
  }
  return sum;
}

double share(int part, int whole) { return static_cast<double>(part) / whole; }

TEST(judge, two_runs_of_one_program_are_called_the_same) {
  // No row differs, so every call is false. 100 pairs of runs of 96 times each.
  const Calls quiet = compare_many({.drift = 0}, 100);
  EXPECT_LE(share(quiet.called, quiet.all), 0.005);
  const Calls noisy = compare_many({.drift = 0, .spread = 0.2}, 100);
  EXPECT_LE(share(noisy.called, noisy.all), 0.005);
}

/// Two techniques, one in ten places of three rows, the other in one place of two; the spread of two times five processes.
/// `burst` is what a neighbor of the machine adds in the fourth place and in that of the second, `effect` what the first one
/// really grew by.
std::vector<LogDifference> in_places(std::mt19937& random, double burst, double effect) {
  std::normal_distribution<double> normal;
  constexpr double deviation = 0.05;
  std::vector<LogDifference> differences;
  for (int place = 0; place < 11; ++place)
    for (int row = 0; row < (place < 10 ? 3 : 2); ++row) {
      const bool is_first = place < 10, is_met = place == 3 || place == 10;
      const double value = deviation * normal(random) + (is_met ? burst : 0) + (is_first ? effect : 0);
      differences.push_back({.value = value,
                             .variance = deviation * deviation,
                             .freedom = 8,
                             .kind = 0,
                             .batch = place % 5,
                             .place = place,
                             .owner = is_first ? 0 : 1});
    }
  return differences;
}

TEST(judge, a_burst_in_one_place_is_no_difference_and_a_change_in_all_is_one) {
  std::mt19937 random(7);
  int called = 0, found = 0, all = 0;
  for (int k = 0; k < 50; ++k) {
    const std::vector<LogDifference> met = in_places(random, 0.7, 0), changed = in_places(random, 0, std::log(3));
    const Judgements burst = judge(met, std::log(1.05), false), effect = judge(changed, std::log(1.05), false);
    for (std::size_t i = 0; i < met.size(); ++i) {
      called += burst.each[i].false_discovery <= 0.05;
      if (changed[i].owner != 0) continue;
      found += effect.each[i].false_discovery <= 0.05;
      ++all;
    }
  }
  EXPECT_EQ(called, 0);
  EXPECT_GE(share(found, all), 0.95);
}

TEST(judge, drift_between_runs_is_no_difference) {
  // Every scene of every run is 20 % faster or slower than the next. Welch's test alone calls a good part of the rows.
  const Calls drifting = compare_many({.drift = 0.2}, 100);
  EXPECT_LE(share(drifting.called, drifting.all), 0.01);
  std::mt19937 random(20);
  std::normal_distribution<double> normal;
  int called = 0;
  for (int k = 0; k < 1000; ++k) {
    const double drift = 0.2 * normal(random) - 0.2 * normal(random);
    ProcessTimes base(5), contender(5);
    for (int process = 0; process < 5; ++process) {
      base[process] = {std::exp(0.05 * normal(random))};
      contender[process] = {std::exp(drift + 0.05 * normal(random))};
    }
    const LogDifference d = *log_difference(base, contender, 1e-9);
    called += 2 * student_tail((std::abs(d.value) - std::log(1.05)) / std::sqrt(d.variance), d.freedom) < 0.05;
  }
  EXPECT_GT(called, 400) << "the test must be able to fail";
}

TEST(judge, a_slowdown_of_everything_is_found_on_a_quiet_machine) {
  const Calls calls = compare_many({.drift = 0.02, .effect = std::log(1.3), .changed = 8}, 50);
  EXPECT_GE(share(calls.found, calls.real), 0.95);
}

TEST(judge, a_slowdown_of_one_row_in_eight_is_found_and_little_else) {
  const Calls calls = compare_many({.drift = 0.02, .effect = std::log(1.3), .changed = 1}, 50);
  EXPECT_GE(share(calls.found, calls.real), 0.8);
  EXPECT_LE(share(calls.wrong, calls.called), 0.05);
}

TEST(judge, a_large_slowdown_is_found_through_drift) {
  const Calls calls = compare_many({.drift = 0.1, .effect = std::log(2.5), .changed = 1}, 50);
  EXPECT_GE(share(calls.found, calls.real), 0.8);
  EXPECT_LE(share(calls.wrong, calls.called), 0.05);
}

TEST(judge, what_the_load_of_the_machine_explains_is_no_difference) {
  const Calls calls = compare_many({.drift = 0.05, .load = 2}, 50);
  EXPECT_LE(share(calls.called, calls.all), 0.005);
}

TEST(judge, differences_within_the_floor_are_not_called_however_sure) {
  std::vector<LogDifference> differences(20, LogDifference{.value = 0.04, .variance = 1e-8, .freedom = 8});
  for (const Judgement& judgement : judge(differences, std::log(1.05), true).each) {
    EXPECT_GT(judgement.false_discovery, 0.9);
    EXPECT_GT(judgement.low, 0) << "the interval excludes zero all the same";
  }
}

TEST(judge, a_lone_row_is_judged_by_the_usual_drift) {
  // One row tells nothing of the drift, so 10 % are taken: 15 % more is then nothing, 3 times as much is something.
  const auto lone = [](double ratio, bool side_by_side) {
    const LogDifference d{.value = std::log(ratio), .variance = 1e-4, .freedom = 8};
    return judge({&d, 1}, std::log(1.05), side_by_side);
  };
  EXPECT_NEAR(lone(1.15, false).between, 0.1, 1e-12);
  EXPECT_GT(lone(1.15, false).each[0].p, 0.1);
  EXPECT_LT(lone(3, false).each[0].p, 0.01);
  EXPECT_EQ(lone(1.15, true).between, 0);
  EXPECT_LT(lone(1.15, true).each[0].p, 0.01);
  EXPECT_TRUE(judge({}, 0.05, false).each.empty());
}

TEST(judge_groups, group_is_the_mean_of_its_batches) {
  // Batches {0.1, 0.3} and {0.4}: means 0.2 and 0.4, so 0.3 however many rows a batch has. Squares of the batches 2 * 0.01, two
  // more of 0.05 by assumption: 0.025 / 3, over 2 batches, and as much again for the whole run at different times.
  std::vector<LogDifference> differences{{.value = 0.1, .batch = 0}, {.value = 0.3, .batch = 0}, {.value = 0.4, .batch = 1}};
  differences.push_back({.value = 9, .batch = 0});
  const std::vector<int> groups{0, 0, 0, 1};
  const auto apart = judge_groups(differences, groups, 2, 0.05, false), live = judge_groups(differences, groups, 2, 0.05, true);
  ASSERT_TRUE(apart[0]);
  EXPECT_NEAR(apart[0]->value, 0.3, 1e-12);
  const double half = student_quantile(0.025, 3) * std::sqrt(0.025 / 3 * 1.5);
  EXPECT_NEAR(apart[0]->judgement.high - 0.3, half, 1e-9);
  EXPECT_NEAR(live[0]->judgement.high - 0.3, half / std::sqrt(3.0), 1e-9);
  EXPECT_FALSE(apart[1]) << "one batch";
}

TEST(judge_groups, drift_of_whole_runs_is_no_difference) {
  // Scenes of a run drift by 10 %, and runs as a whole by 10 %, which no scene can show.
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int called = 0;
  for (int k = 0; k < 1000; ++k) {
    const double run = 0.1 * normal(random);
    std::vector<LogDifference> differences;
    for (int scene = 0; scene < 6; ++scene) {
      const double drift = 0.1 * normal(random);
      for (int row = 0; row < 4; ++row) differences.push_back({.value = run + drift + 0.03 * normal(random), .batch = scene});
    }
    const std::vector<int> groups(differences.size(), 0);
    called += judge_groups(differences, groups, 1, std::log(1.05), false)[0]->judgement.false_discovery <= 0.05;
  }
  EXPECT_LE(called, 50);
}

TEST(judge, quiet_data_are_not_inflated) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<LogDifference> differences;
  for (int k = 0; k < 2000; ++k)
    differences.push_back({.value = 0.02 * normal(random), .variance = 4e-4, .freedom = 8, .kind = 0, .batch = k % 20});
  const Judgements judged = judge(differences, std::log(1.05), true);
  EXPECT_LT(judged.inflation, 1.1);
  // The same values under variances that are nine times too small: the excess makes up for it.
  for (LogDifference& d : differences) d.variance /= 9;
  EXPECT_NEAR(judge(differences, std::log(1.05), true).inflation, 3, 0.3);
}

// One of forty rows is as much slower as the judgement says could be found; the others are the same program.
TEST(judge, the_least_difference_is_called_four_times_in_five) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  int called = 0;
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<LogDifference> rows;
    for (int k = 0; k < 40; ++k) {
      std::vector<double> pairs;
      for (int p = 0; p < 5; ++p) pairs.push_back(0.05 * normal(random));
      double mean = 0, squares = 0;
      for (const double pair : pairs) mean += pair / 5;
      for (const double pair : pairs) squares += (pair - mean) * (pair - mean);
      rows.push_back({.value = mean, .variance = squares / 4 / 5, .freedom = 4});
    }
    const double least = judge(rows, 0.05, true).each[0].least;
    rows[0].value += least;
    called += judge(rows, 0.05, true).each[0].false_discovery <= 0.05;
  }
  EXPECT_GT(called, 0.7 * trials);
  EXPECT_LT(called, 0.9 * trials);
}

}  // namespace difference_test
