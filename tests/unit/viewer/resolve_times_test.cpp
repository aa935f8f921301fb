#include "app/viewer/resolve_times.h"

#include <gtest/gtest.h>

namespace gnomon::viewer::resolve_times_test {

/// A left side that has resolved so many times, the last one at a frame of that number.
struct Side {
  Selection selection;
  EngineState state;
  ResolveTimes times;

  void resolve(double ms, std::uint64_t frame) {
    auto answer = std::make_shared<SideAnswer>();
    auto seen = std::make_shared<Frame>();
    seen->number = frame;
    answer->frame = seen;
    SideState& side = state.sides[0];
    side.answer = answer;
    side.newest_ms[static_cast<int>(Stage::resolve)] = ms;
    ++side.answer_count;
    times.note(selection, state);
  }
};

TEST(resolve_times, median_is_of_the_frame_that_is_shown) {
  Side side;
  for (const double ms : {100.0, 200.0, 300.0, 400.0}) side.resolve(ms, 1);
  ASSERT_TRUE(side.times.median(0));
  EXPECT_EQ(side.times.median(0)->ms, 250);  // between the middle two
  EXPECT_EQ(side.times.median(0)->count, 4u);
  // The camera has moved: two times are no median yet, three are.
  side.resolve(7, 2);
  side.resolve(9, 2);
  EXPECT_FALSE(side.times.median(0));
  side.resolve(1, 2);
  ASSERT_TRUE(side.times.median(0));
  EXPECT_EQ(side.times.median(0)->ms, 7);
  // The curve goes on through both.
  EXPECT_EQ(std::vector<float>(side.times.last(0).begin(), side.times.last(0).end()),
            (std::vector<float>{100, 200, 300, 400, 7, 9, 1}));
  EXPECT_TRUE(side.times.last(1).empty());
}

TEST(resolve_times, a_state_that_is_seen_twice_counts_once) {
  Side side;
  side.resolve(5, 1);
  for (int k = 0; k < 3; ++k) side.times.note(side.selection, side.state);
  EXPECT_EQ(side.times.last(0).size(), 1u);
}

TEST(resolve_times, another_setting_begins_anew_and_another_layer_does_not) {
  Side side;
  side.resolve(5, 1);
  side.selection.sides[0].layer = "map";
  side.resolve(6, 1);
  EXPECT_EQ(side.times.last(0).size(), 2u);
  side.selection.sides[0].settings = "resolution=64";
  side.times.note(side.selection, side.state);
  EXPECT_TRUE(side.times.last(0).empty());
  side.resolve(1, 1);
  EXPECT_EQ(side.times.last(0).size(), 1u);
}

TEST(resolve_times, a_worker_that_was_started_again_begins_anew) {
  Side side;
  for (int k = 0; k < 5; ++k) side.resolve(5, 1);
  side.state.sides[0] = {};
  side.times.note(side.selection, side.state);
  EXPECT_TRUE(side.times.last(0).empty());
}

TEST(resolve_times, only_the_last_ones_are_kept) {
  Side side;
  const auto most = static_cast<int>(ResolveTimes::most);
  for (int k = 1; k <= most + 2; ++k) side.resolve(k, 1);
  EXPECT_EQ(side.times.last(0).size(), ResolveTimes::most);
  EXPECT_EQ(side.times.last(0).front(), 3);
  EXPECT_EQ(side.times.last(0).back(), most + 2);
  // Of 3 .. most + 2, whose number is even.
  EXPECT_EQ(side.times.median(0)->ms, (3 + most + 2) / 2.0);
}

}  // namespace gnomon::viewer::resolve_times_test
