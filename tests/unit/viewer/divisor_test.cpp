// How small frames are while something moves.
#include <gtest/gtest.h>

#include "app/viewer/frame_lane.h"

namespace divisor_test {

using gnomon::viewer::PreviewDivisor;

// 40 ms a frame: of 1000 ms at full size a fifth in each direction takes 40, a quarter 62; of 100 ms a half takes 25.
TEST(viewer_divisor, first_frames_are_as_small_as_the_last_answer_foretells) {
  for (const auto& [full_ms, due] : {std::pair{1000.0, 5}, {1001.0, 6}, {100.0, 2}, {40.0, 1}, {0.0, 1}, {1e9, 8}}) {
    PreviewDivisor divisor(1);
    divisor.expect(full_ms);
    EXPECT_EQ(divisor.value(), due) << full_ms;
  }
  PreviewDivisor camera(2);
  camera.expect(10);
  EXPECT_EQ(camera.value(), 2) << "not larger than it begins";
}

TEST(viewer_divisor, what_frames_took_counts_for_more_than_what_was_foretold) {
  PreviewDivisor divisor(1);
  divisor.expect(1000);
  divisor.took(50);  // a fifth: too slow yet
  EXPECT_EQ(divisor.value(), 6);
  divisor.expect(1e9);
  EXPECT_EQ(divisor.value(), 6);
  divisor.forget();
  divisor.expect(1e9);
  EXPECT_EQ(divisor.value(), 8);
  divisor.took(4);  // an eighth is faster than it need be: a seventh would take 4 * 64 / 49 = 5.2
  EXPECT_EQ(divisor.value(), 7);
}

// 14 ms whatever the size is, and 2060 ms of pixels: a seventh takes 56, an eighth 46, which is too slow, but a fifth faster at
// a quarter fewer pixels. What takes as long at any size is shown at full size.
TEST(viewer_divisor, frames_stay_small_where_that_helps_and_only_there) {
  PreviewDivisor divisor(1);
  divisor.expect(2000);
  for (int k = 0; k < 50; ++k) divisor.took(14 + 2060.0 / (divisor.value() * divisor.value()));
  EXPECT_EQ(divisor.value(), 8);
  PreviewDivisor fixed(1);
  for (int k = 0; k < 50; ++k) fixed.took(60);
  EXPECT_EQ(fixed.value(), 1);
}

}  // namespace divisor_test
