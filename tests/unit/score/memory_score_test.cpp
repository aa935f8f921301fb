// Cold, settled and after a jump: the metrics of techniques that remember frames.
#include "measure/score/memory_score.h"

#include <gtest/gtest.h>

#include <cmath>

namespace memory_score_test {

using namespace gnomon;

// A mean that forgets a share `alpha` with each frame leaves (1 - alpha)^n of what a jump adds, n frames after its own.
std::vector<double> errors_of_mean(double alpha, double settled, double added, int frames) {
  std::vector<double> errors;
  for (int n = 0; n < frames; ++n) errors.push_back(settled + added * std::pow(1 - alpha, n));
  return errors;
}

// 0.8^n <= 1/2 from n = 4 on, 0.95^n from n = 14 on.
TEST(memory_score, half_life_of_a_mean) {
  EXPECT_EQ(ghost_times(errors_of_mean(0.2, 0.01, 0.5, 80), 0.01).half_life, 4);
  EXPECT_EQ(ghost_times(errors_of_mean(0.05, 0.01, 0.5, 80), 0.01).half_life, 14);
}

// What is left is 0.1 of the settled error: 0.5 * 0.8^n <= 0.001 from n = 28 on, 0.5 * 0.95^n only from n = 122 on.
TEST(memory_score, frames_until_within_a_tenth) {
  EXPECT_EQ(ghost_times(errors_of_mean(0.2, 0.01, 0.5, 80), 0.01).frames, 28);
  EXPECT_EQ(ghost_times(errors_of_mean(0.05, 0.01, 0.5, 80), 0.01).frames, std::nullopt);
  EXPECT_EQ(ghost_times(errors_of_mean(0.05, 0.01, 0.5, 140), 0.01).frames, 122);
}

TEST(memory_score, no_ghost_where_nothing_is_added) {
  const GhostTimes times = ghost_times(errors_of_mean(0.2, 0.01, 0, 8), 0.01);
  EXPECT_EQ(times.half_life, 0);
  EXPECT_EQ(times.frames, 0);
  EXPECT_EQ(ghost_times({}, 0.01).half_life, std::nullopt);
  // Less than before, and so it stays.
  const std::vector<double> less(8, 0.009);
  EXPECT_EQ(ghost_times(less, 0.01).half_life, 0);
  EXPECT_EQ(ghost_times(less, 0.01).frames, 0);
}

MemoryScore with_stills() {
  MemoryScore score;
  for (int k = 0; k < still_frames; ++k) score.add_still(k, k == 0 ? 0.4 : 0.1 + 0.01 * (k % 2));
  return score;
}

TEST(memory_score, cold_is_the_first_and_settled_the_mean_of_the_last) {
  const Metrics metrics = with_stills().metrics();
  EXPECT_EQ(metrics.at("error_cold"), 0.4);
  EXPECT_NEAR(*metrics.at("error_settled"), 0.105, 1e-12);
  EXPECT_EQ(metrics.at("ghost_frames"), std::nullopt);
}

TEST(memory_score, ghosts_are_those_of_the_one_change) {
  MemoryScore score = with_stills();
  const std::pair<double, const char*> frames[] = {{0.1, "a"}, {0.1, "a"}, {0.9, "b"}, {0.5, "b"}, {0.3, "b"}, {0.11, "b"}};
  for (const auto& [error, shown] : frames) score.add_frame(error, shown);
  EXPECT_EQ(score.metrics().at("ghost_half_life"), 1);  // 0.5 <= 0.105 + 0.795 / 2
  EXPECT_EQ(score.metrics().at("ghost_frames"), 3);     // 0.11 <= 0.1155
}

// What moves on, and what never moves, has no ghost; nor has a row of which a frame has no error.
TEST(memory_score, no_ghosts_without_one_jump) {
  MemoryScore moving, still, unknown;
  for (const char* const shown : {"a", "b", "c"}) moving.add_frame(0.1, shown);
  for (const char* const shown : {"a", "a", "a"}) still.add_frame(0.1, shown);
  unknown.add_frame(std::nullopt, "a");
  unknown.add_frame(0.2, "b");
  for (const MemoryScore* const score : {&moving, &still, &unknown}) {
    EXPECT_EQ(score->metrics().at("ghost_half_life"), std::nullopt);
    EXPECT_EQ(score->metrics().at("ghost_frames"), std::nullopt);
  }
}

// Without memory the frame before the jump is what is settled.
TEST(memory_score, of_one_that_does_not_remember) {
  MemoryScore score;
  score.add_frame(0.2, "a");
  score.add_frame(0.21, "b");
  const Metrics metrics = score.metrics();
  EXPECT_EQ(metrics.at("error_cold"), std::nullopt);
  EXPECT_EQ(metrics.at("error_settled"), std::nullopt);
  EXPECT_EQ(metrics.at("ghost_frames"), 0);
}

}  // namespace memory_score_test
