// The walk over the frames of a row whose geometry moves, by stages that report times of their own.
#include "measure/run/motion_walk.h"

#include <gtest/gtest.h>

#include <deque>
#include <set>
#include <stdexcept>

#include "measure/run/batch.h"

namespace motion_walk_test {

using namespace gnomon;

std::vector<int> frames_of(int frames, int steps) {
  FrameOrder order(frames);
  std::vector<int> numbers;
  for (int k = 0; k < steps; ++k) numbers.push_back(order.next());
  return numbers;
}

TEST(motion_walk, frames_go_forth_and_back_in_single_steps) {
  EXPECT_EQ(frames_of(4, 9), (std::vector<int>{1, 2, 3, 2, 1, 0, 1, 2, 3}));
  EXPECT_EQ(frames_of(2, 4), (std::vector<int>{1, 0, 1, 0}));
}

TEST(motion_walk, a_sample_averages_some_frames_where_that_is_cheap) {
  EXPECT_EQ(motion_iterations(0.01, 99), 64);
  EXPECT_EQ(motion_iterations(0.5, 99), 4);
  EXPECT_EQ(motion_iterations(10, 99), 4);
  EXPECT_EQ(motion_iterations(50, 99), 4);  // 0.2 s
  EXPECT_EQ(motion_iterations(51, 99), 2);
  EXPECT_EQ(motion_iterations(100, 99), 2);
  EXPECT_EQ(motion_iterations(101, 99), 1);
  EXPECT_EQ(motion_iterations(1e5, 99), 1);
  // At most all, or all forth and back some times.
  EXPECT_EQ(motion_iterations(0.01, 40), 40);
  EXPECT_EQ(motion_iterations(0.01, 30), 60);
  EXPECT_EQ(motion_iterations(0.01, 5), 60);
  EXPECT_EQ(motion_iterations(1e5, 1), 1);
}

/// Frame n takes n ms for update, ten times as long for relight, a hundred times for resolve.
MotionTime time_of(int number) {
  return {.update = 1.0 * number,
          .relight = 10.0 * number,
          .resolve = 100.0 * number,
          .update_clocks = {.device = {}, .harness = 2.0 * number}};
}

/// The frames that a walk visits.
std::vector<int> visited_by(int frames, int repetitions, int iterations, MotionWalk*& walk) {
  static std::vector<int> visited;
  static std::deque<FrameOrder> orders;
  static std::deque<MotionWalk> walks;
  visited.clear();
  walk = &walks.emplace_back(orders.emplace_back(frames), [](int number) {
    visited.push_back(number);
    return time_of(number);
  });
  std::vector<TimingTask> tasks{walk->task(repetitions, iterations)};
  time_interleaved(tasks);
  EXPECT_EQ(tasks[0].failure, "");
  return visited;
}

TEST(motion_walk, a_sample_is_the_mean_over_steps_spread_over_the_row) {
  MotionWalk* walk = nullptr;
  // Steps of a quarter and three quarters of half a row each, after a jump where one does not follow the other: of 8 steps
  // number 1, 5 and 3, 7.
  EXPECT_EQ(visited_by(9, 2, 2, walk), (std::vector<int>{1, 2, 5, 6, 3, 4, 7, 8}));
  EXPECT_EQ(walk->relight, (std::vector<double>{10 * (2 + 6) / 2.0, 10 * (4 + 8) / 2.0}));
  EXPECT_EQ(walk->resolve, (std::vector<double>{400, 600}));
  EXPECT_EQ(walk->update.harness, (std::vector<double>{8, 12}));
  EXPECT_TRUE(walk->update.device.empty()) << "one without a value is none";
  EXPECT_GT(walk->seconds, 0);
}

TEST(motion_walk, a_sample_of_all_steps_goes_on_or_comes_back) {
  MotionWalk* walk = nullptr;
  EXPECT_EQ(visited_by(4, 2, 3, walk), (std::vector<int>{1, 2, 3, 0, 1, 2, 3})) << "once forth";
  EXPECT_EQ(walk->relight, (std::vector<double>{20, 20}));
  EXPECT_EQ(visited_by(4, 2, 6, walk), (std::vector<int>{1, 2, 3, 2, 1, 0, 1, 2, 3, 2, 1, 0})) << "forth and back";
  EXPECT_EQ(walk->relight, (std::vector<double>{15, 15}));
}

TEST(motion_walk, a_warm_up_gives_the_slowest_step_but_the_first_and_ends_when_it_takes_long) {
  FrameOrder order(4), longer(7);
  int calls = 0;
  const auto time = [&](int number) {
    ++calls;
    return time_of(number);
  };
  MotionWalk walk(order, time);
  EXPECT_EQ(walk.warm_up(3), 222);  // frames 1, 2: 111 + 222 ms are enough
  EXPECT_EQ(calls, 2);
  EXPECT_TRUE(walk.relight.empty());
  EXPECT_EQ(walk.warm_up(0), 0);
  MotionWalk spread(longer, [](int number) { return MotionTime{.update = 1.0 * number}; });
  EXPECT_EQ(spread.warm_up(3), 6) << "steps to 2, 4 and 6";
}

TEST(motion_walk, walks_of_one_worker_go_on_where_the_other_is) {
  FrameOrder order(5);
  std::vector<int> visited;
  const auto time = [&](int number) {
    visited.push_back(number);
    return time_of(number);
  };
  MotionWalk one(order, time), other(order, time);
  one.warm_up(1);
  other.warm_up(1);
  std::vector<TimingTask> tasks{one.task(5, 8), other.task(5, 8)};
  time_interleaved(tasks);
  EXPECT_GT(visited.size(), 80u);
  std::set<int> means(one.relight.begin(), one.relight.end());
  means.insert(other.relight.begin(), other.relight.end());
  EXPECT_EQ(means, std::set<int>{20}) << "all steps, forth and back, wherever they begin";
}

TEST(motion_walk, a_frame_that_fails_costs_the_samples_of_its_own_walk) {
  FrameOrder order(3), other_order(3);
  int calls = 0;
  MotionWalk fails(order, [&](int number) {
    if (++calls == 3) throw std::runtime_error("the worker died");
    return time_of(number);
  });
  MotionWalk sound(other_order, time_of);
  std::vector<TimingTask> tasks{fails.task(4, 2), sound.task(4, 2)};
  time_interleaved(tasks);
  EXPECT_EQ(tasks[0].failure, "the worker died");
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(tasks[1].failure, "");
  EXPECT_EQ(tasks[1].samples.size(), 4u);
  EXPECT_EQ(sound.resolve.size(), 4u);
}

TEST(batches, rows_that_move_need_a_narrow_update_too) {
  Record record;
  const ProcessTimes narrow(5, {10, 10.01, 10}), wide{{10}, {14}, {9}, {20}, {11}};
  for (const Stage stage : frame_stages) record.times(stage) = narrow;
  EXPECT_TRUE(is_narrow(record, 0.05)) << "geometry that stands still has no update";
  record.times(Stage::update) = wide;
  EXPECT_FALSE(is_narrow(record, 0.05));
  record.times(Stage::update) = narrow;
  EXPECT_TRUE(is_narrow(record, 0.05));
}

}  // namespace motion_walk_test
