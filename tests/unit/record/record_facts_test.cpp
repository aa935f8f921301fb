#include <gtest/gtest.h>

#include "measure/record/record.h"

namespace record_facts_test {

using namespace gnomon;

// 0.02 of 0.1 + 0.3 ms by the device's clock, else 0.5 of 1 + 1 by the host's.
TEST(record_facts, share_of_the_bare_pass_is_by_the_device_where_both_are) {
  Record r;
  EXPECT_FALSE(floor_share(r));
  r.times(Stage::relight) = r.times(Stage::resolve) = {{1}};
  r.floor.emplace().ms = {{0.5}};
  EXPECT_NEAR(floor_share(r).value(), 0.25, 1e-12);
  r.floor->device_ms = {{0.02}};
  EXPECT_NEAR(floor_share(r).value(), 0.25, 1e-12);  // the stages have no such time
  r.device_times(Stage::relight) = {{0.1}};
  r.device_times(Stage::resolve) = {{0.3}};
  EXPECT_NEAR(floor_share(r).value(), 0.05, 1e-12);
}

// 3,000 rays in 2 + 4 ms are 500,000 in a second; by the device's clock in 0.5 + 1 ms four times as many.
TEST(record_facts, rays_per_second_are_those_of_a_frame_by_the_device_where_it_has_a_clock) {
  Record r;
  r.times(Stage::relight) = {{2}};
  r.times(Stage::resolve) = {{4}};
  EXPECT_FALSE(rays_per_second(r));  // it counts none
  r.counts = {{"texels", 7, "texel"}, {"rays", 3000, ""}};
  EXPECT_NEAR(rays_per_second(r).value(), 500000, 1e-6);
  r.device_times(Stage::resolve) = {{1}};
  EXPECT_NEAR(rays_per_second(r).value(), 500000, 1e-6);  // half of a frame is no frame
  r.device_times(Stage::relight) = {{0.5}};
  EXPECT_NEAR(rays_per_second(r).value(), 2000000, 1e-6);
  r.stages = {};
  r.device_stages = {};
  EXPECT_FALSE(rays_per_second(r));
}

TEST(record_facts, clocks_disagree_where_both_cannot_be_right) {
  Record r;
  r.times(Stage::resolve) = {{1}};
  EXPECT_FALSE(clocks_agree(r).has_value());  // there is only one
  r.device_times(Stage::resolve) = {{0.1}};
  EXPECT_EQ(clocks_agree(r), true);  // the rest is the processor's own work
  r.device_times(Stage::resolve) = {{1.2}};
  EXPECT_EQ(clocks_agree(r), false);  // longer than whoever waited for it
  r.device_times(Stage::resolve) = {{0.9}};
  r.floor.emplace().ms = {{1}};
  r.floor->device_ms = {{0.1}};
  EXPECT_EQ(clocks_agree(r), false);  // nothing but the device works in a bare pass
  r.floor->device_ms = {{0.8}};
  EXPECT_EQ(clocks_agree(r), true);
}

}  // namespace record_facts_test
