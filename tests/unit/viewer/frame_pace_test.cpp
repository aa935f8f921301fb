// When the window draws: on paper, for frames that cost what they cost here.
#include "app/viewer/frame_pace.h"

#include <gtest/gtest.h>

namespace gnomon::viewer::frame_pace_test {

TEST(viewer_frame_pace, a_frame_is_used_up_and_more_can_be_needed_never_fewer) {
  FramePace pace;
  EXPECT_EQ(pace.left(), FramePace::settling);
  for (int k = 0; k < FramePace::settling; ++k) pace.begin(k);
  EXPECT_EQ(pace.left(), 0);
  pace.need(2);
  pace.need(1);
  EXPECT_EQ(pace.left(), 2);
}

// A cheap frame: 60 a second, 25 while an answer is waited for. One of 50 ms: again after 100 ms, half of the time for workers.
TEST(viewer_frame_pace, the_window_takes_at_most_half_of_the_time) {
  FramePace pace;
  pace.begin(10);
  pace.end(10.001);
  EXPECT_NEAR(pace.next(false), 10 + 1 / 60.0, 1e-9);
  EXPECT_NEAR(pace.next(true), 10 + 1 / 25.0, 1e-9);
  pace.begin(20);
  pace.end(20.05);
  EXPECT_NEAR(pace.next(false), 20.1, 1e-9);
  EXPECT_NEAR(pace.next(true), 20.1, 1e-9);
}

TEST(viewer_frame_pace, the_rate_counts_new_frames_of_the_last_second) {
  FrameRate rate;
  rate.note(0, 5);  // nothing is shown yet
  EXPECT_EQ(rate.count(), 0u);
  for (int k = 0; k < 10; ++k) {
    rate.note(7 + k, 5 + 0.1 * k);
    rate.note(7 + k, 5.05 + 0.1 * k);  // the same again
  }
  EXPECT_EQ(rate.count(), 10u);
  rate.note(16, 6.45);  // those up to 5.4 are over a second old
  EXPECT_EQ(rate.count(), 5u);
}

}  // namespace gnomon::viewer::frame_pace_test
