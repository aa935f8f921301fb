#include "measure/run/timing.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace timing_test {

using namespace gnomon;

TEST(timing, every_repetition_of_every_task_is_a_sample) {
  std::vector<TimingTask> tasks(3);
  std::vector<int> calls(3, 0);
  for (int k = 0; k < 3; ++k) {
    tasks[k].repetitions = k + 1;
    tasks[k].milliseconds = [&calls, k](int) {
      ++calls[k];
      return 10.0 * (k + 1);
    };
  }
  time_interleaved(tasks);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(calls[k], k + 1);
    ASSERT_EQ(tasks[k].samples.size(), static_cast<std::size_t>(k) + 1);
    for (const double sample : tasks[k].samples) EXPECT_NEAR(sample, 10.0 * (k + 1), 1e-9);
    EXPECT_EQ(tasks[k].failure, "");
  }
}

TEST(timing, a_sample_is_the_mean_of_its_iterations_as_the_task_reports_them) {
  // Repetitions of four iterations that take 10, 26 and 42 ms together have the means 2.5, 6.5 and 10.5, whatever the clock
  // says.
  int call = 0;
  std::vector<TimingTask> tasks(1);
  tasks[0].repetitions = 3;
  tasks[0].iterations = 4;
  tasks[0].milliseconds = [&](int iterations) {
    EXPECT_EQ(iterations, 4);
    return 10.0 + 16 * call++;
  };
  time_interleaved(tasks);
  EXPECT_EQ(call, 3) << "all iterations of a sample are one call";
  ASSERT_EQ(tasks[0].samples.size(), 3u);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(tasks[0].samples[k], 2.5 + 4 * k, 1e-9);
}

TEST(timing, short_stages_are_repeated_for_two_milliseconds_up_to_50_times) {
  EXPECT_EQ(iterations_for(0), 64);
  EXPECT_EQ(iterations_for(0.01), 64);
  EXPECT_EQ(iterations_for(0.125), 16);
  EXPECT_EQ(iterations_for(0.1), 16);   // 2 / 0.1 = 20, nearer to 16 than to 32 by ratio
  EXPECT_EQ(iterations_for(0.15), 16);  // 13.3
  EXPECT_EQ(iterations_for(0.6), 4);    // 3.3
  EXPECT_EQ(iterations_for(1.1), 2);
  EXPECT_EQ(iterations_for(1.5), 1);
  EXPECT_EQ(iterations_for(1e6), 1);
}

TEST(timing, repetitions_of_different_tasks_are_interleaved) {
  // 4 tasks of 12 repetitions in random order change hands 36 times on average; one task after the other only 3 times. That
  // a random order changes hands less than 12 times is less likely than 1 in 10^9.
  std::string order;
  std::vector<TimingTask> tasks(4);
  for (int k = 0; k < 4; ++k) {
    tasks[k].repetitions = 12;
    tasks[k].milliseconds = [&order, k](int) {
      order += static_cast<char>('a' + k);
      return 1.0;
    };
  }
  time_interleaved(tasks);
  ASSERT_EQ(order.size(), 48u);
  int changes = 0;
  for (std::size_t i = 1; i < order.size(); ++i) changes += order[i] != order[i - 1];
  EXPECT_GE(changes, 12) << order;
}

TEST(timing, a_task_that_throws_costs_only_its_own_samples) {
  std::vector<TimingTask> tasks(3);
  int calls = 0;
  tasks[0].repetitions = tasks[2].repetitions = 5;
  tasks[0].milliseconds = tasks[2].milliseconds = [](int) { return 2.0; };
  tasks[1].repetitions = 5;
  tasks[1].milliseconds = [&](int) -> double {
    if (++calls == 3) throw std::runtime_error("the worker died");
    return 1.0;
  };
  time_interleaved(tasks);
  EXPECT_EQ(tasks[0].samples, std::vector<double>(5, 2.0));
  EXPECT_EQ(tasks[2].samples, std::vector<double>(5, 2.0));
  EXPECT_EQ(tasks[1].failure, "the worker died");
  EXPECT_LE(tasks[1].samples.size(), 2u);
  EXPECT_EQ(calls, 3) << "a task that failed is not called again";
  EXPECT_EQ(tasks[0].failure + tasks[2].failure, "");
}

TEST(timing, nothing_to_time_is_no_error_and_nothing_remains_from_one_call_to_the_next) {
  std::vector<TimingTask> none;
  EXPECT_NO_THROW(time_interleaved(none));
  for (int round = 0; round < 2; ++round) {
    std::vector<TimingTask> tasks(1);
    tasks[0].milliseconds = [&](int) { return 1.0 + round; };
    time_interleaved(tasks);
    EXPECT_EQ(tasks[0].samples, std::vector<double>(3, 1.0 + round));
  }
}

}  // namespace timing_test
