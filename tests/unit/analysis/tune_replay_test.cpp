#include "analysis/tune_replay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "error_words.h"
#include "measure/run/suite.h"
#include "places.h"

namespace tune_replay_test {

using namespace gnomon;
using namespace gnomon::error_words;

/// Two resolutions by two filters at two places; bilinear errs less, and the larger map has four times the bytes.
const std::string small =
    "shadow_map:resolution,filter,error at a,bytes at a,error at b,bytes at b\n"
    "512,nearest,0.04,1000,0.02,1000\n"
    "512,bilinear,0.03,1000,0.01,1000\n"
    "1024,nearest,0.02,4000,0.01,4000\n"
    "1024,bilinear,0.01,4000,,\n";

TEST(tune_replay, a_table_is_a_grid_of_its_technique) {
  const KeptGrid kept = read_kept_grid(small, "small.csv");
  EXPECT_EQ(kept.space.technique, "shadow_map");
  EXPECT_EQ(kept.space.grid.count(), 4);
  EXPECT_EQ(kept.possible(), 8);
  EXPECT_EQ(kept.places, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(kept.space.settings({0, 1}), "resolution=512,filter=bilinear");
  EXPECT_EQ(kept.numbers.at({0, 1})[1]->error, 0.01);
  EXPECT_EQ(kept.numbers.at({1, 0})[0]->bytes, 4000);
  EXPECT_FALSE(kept.numbers.at({1, 1})[1].has_value());
}

TEST(tune_replay, what_is_no_such_table_is_refused_with_its_line) {
  const auto refused = [](std::string text, const std::string& was, const std::string& is) {
    text.replace(text.find(was), was.size(), is);
    return error_of([&] { read_kept_grid(text, "small.csv"); });
  };
  expect_words(refused(small, "shadow_map:", ""), {"small.csv:1", "is not ID:parameter"});
  expect_words(refused(small, "shadow_map:", "shadow_mpa:"), {"shadow_mpa", "shadow_map"});
  expect_words(refused(small, "bytes at b", "bytes at c"), {"small.csv:1", "bytes at c"});
  expect_words(refused(small, "512,nearest", "512,nearst"), {"filter = nearst", "nearest"});
  expect_words(refused(small, "0.04", "-1"), {"small.csv:2", "'-1'"});
  expect_words(refused(small, ",0.02,1000\n", "\n"), {"small.csv:2", "4 values under 6 headings"});
  expect_words(refused(small, "512,bilinear,0.03,1000,0.01,1000\n", ""), {"lacks shadow_map:resolution=512,filter=bilinear"});
  expect_words(error_of([] { read_kept_grid("", "small.csv"); }), {"there is no setting"});
  const KeptGrid kept = read_kept_grid(small, "small.csv");
  expect_words(error_of([&] { replay(kept, {.least = tuned_number("cost=light"), .each = {}}, 1); }), {"no light_ms"});
}

/// Errors of eight resolutions and nine biases: |log2 bias| + 1024 / resolution, with their least at the largest map and bias
/// 1; bytes are the square of the resolution.
KeptGrid valley() {
  std::string text = "shadow_map:resolution,depth_bias,error at a,bytes at a\n";
  for (int resolution = 64; resolution <= 8192; resolution *= 2)
    for (double bias = 1.0 / 16; bias <= 16; bias *= 2)
      text += fmt::format("{},{},{},{}\n", resolution, bias, std::abs(std::log2(bias)) + 1024.0 / resolution,
                          resolution * resolution);
  return read_kept_grid(text, "valley.csv");
}

TEST(tune_replay, a_search_ends_at_the_best_of_a_valley) {
  const KeptGrid kept = valley();
  const TuneReplay error = replay(kept, {.least = tuned_number("error"), .each = {}}, 1);
  EXPECT_EQ(kept.space.settings(error.best), "resolution=8192,depth_bias=1");
  EXPECT_EQ(error.best_standing.goal, 0.125);
  EXPECT_LE(error.asked, 14u);  // a fifth of 72
  EXPECT_EQ(error.ratio(), error.found_standing.goal / 0.125);
  // 1024 / resolution <= 0.5 at bias 1 alone: 2048, of 4 Mi bytes.
  const TuneReplay bytes = replay(kept, {.least = tuned_number("cost=bytes"), .each = tune_limits("error<=0.5")}, 1);
  EXPECT_EQ(kept.space.settings(bytes.best), "resolution=2048,depth_bias=1");
  EXPECT_EQ(bytes.best_standing.goal, 4.0 * 1024 * 1024);
}

/// The grids that scripts/results keeps.
std::vector<KeptGrid> kept_grids() {
  std::vector<KeptGrid> grids;
  for (const auto& entry : std::filesystem::directory_iterator(tree_file("results/tune_grids")))
    if (entry.path().extension() == ".csv") grids.push_back(read_kept_grid(file_text(entry.path()), entry.path().stem()));
  return grids;
}

/// How many of the grids come within 5 % of the best, where a fifth of the evaluations is asked.
int near_best(std::span<const KeptGrid> grids, const std::function<TuneGoal(const KeptGrid&)>& goal_of) {
  int near = 0;
  for (const KeptGrid& kept : grids) {
    const TuneReplay one = replay(kept, goal_of(kept), 1);
    EXPECT_LE(static_cast<double>(one.asked), kept.possible() / 5) << kept.name;
    EXPECT_GE(one.ratio(), 1) << kept.name;
    near += one.ratio() <= 1.05;
  }
  return near;
}

TEST(tune_replay, a_fifth_of_measured_grids_finds_the_best_of_all_but_one_in_twelve) {
  const std::vector<KeptGrid> grids = kept_grids();
  ASSERT_GE(grids.size(), 12u);
  const int least_near = static_cast<int>(grids.size() - grids.size() / 12);
  for (const KeptGrid& kept : grids) EXPECT_GT(kept.possible(), most_evaluations) << kept.name;
  const TuneGoal least{.least = tuned_number("error"), .each = {}};
  EXPECT_GE(near_best(grids, [&](const KeptGrid&) { return least; }), least_near);
  const auto bytes = [](const KeptGrid&) {
    return TuneGoal{.least = tuned_number("cost=bytes"), .each = tune_limits("error<=5%")};
  };
  EXPECT_GE(near_best(grids, bytes), least_near);
}

}  // namespace tune_replay_test
