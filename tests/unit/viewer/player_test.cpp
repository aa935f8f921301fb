// Which frame is shown at which moment: in real time, whatever comes late.
#include "app/viewer/player.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace gnomon::viewer::player_test {

/// Two seconds at 60 frames a second.
Player walk() { return Player(Path{.name = "walk", .moves = Path::Moves::geometry, .frame_count = 121}); }

TEST(player, at_rest_there_is_nothing_to_play) {
  Player player;
  player.play(0);
  player.step(1);
  EXPECT_TRUE(player.is_at_rest());
  EXPECT_FALSE(player.is_playing());
  EXPECT_FALSE(player.advance(10));
  EXPECT_FALSE(player.pose());
  EXPECT_FALSE(player.due());
  EXPECT_EQ(player.animation(), "");
}

TEST(player, opens_paused_at_the_first_frame_of_the_whole_row) {
  Player player = walk();
  EXPECT_FALSE(player.advance(100));
  EXPECT_EQ(player.frame(), 0);
  EXPECT_EQ(player.pose(), (RowPose{.animation = "walk", .seconds = 0, .start = 0, .frame_rate = 60, .frames = 121}));
  player.step(3);
  EXPECT_EQ(player.pose(), (RowPose{.animation = "walk", .seconds = 3 / 60.0, .start = 0, .frame_rate = 60, .frames = 121}));
}

TEST(player, late_frames_are_skipped) {
  Player player = walk();
  player.go_to(10, 0);
  player.play(5);
  EXPECT_DOUBLE_EQ(*player.due(), 5 + 1 / 60.0);
  EXPECT_FALSE(player.advance(5.01));
  EXPECT_TRUE(player.advance(5.51));  // half a second: 30 frames
  EXPECT_EQ(player.frame(), 40);
  EXPECT_FALSE(player.advance(5.51));
  EXPECT_TRUE(player.advance(6.01));
  EXPECT_EQ(player.frame(), 70);
}

TEST(player, stops_at_the_end_and_begins_anew) {
  Player player = walk();
  player.play(0);
  EXPECT_TRUE(player.advance(7));
  EXPECT_EQ(player.frame(), 120);
  EXPECT_FALSE(player.is_playing());
  player.play(8);
  EXPECT_EQ(player.frame(), 0);
  EXPECT_TRUE(player.is_playing());
}

// Frame 120 is frame 0 again: a round has 120 frames. 2.51 s are 150 of them.
TEST(player, a_loop_goes_on_in_real_time) {
  Player player = walk();
  player.loops = true;
  player.play(0);
  EXPECT_TRUE(player.advance(2.51));
  EXPECT_EQ(player.frame(), 30);
  EXPECT_TRUE(player.is_playing());
  EXPECT_TRUE(player.advance(3.01));
  EXPECT_EQ(player.frame(), 60);
  EXPECT_TRUE(player.advance(20.26));  // ten rounds and a quarter of a second
  EXPECT_EQ(player.frame(), 15);
}

TEST(player, steps_pause_and_end_at_both_ends) {
  Player player = walk();
  player.step(-1);
  EXPECT_EQ(player.frame(), 0);
  player.play(0);
  player.step(1e9);
  EXPECT_FALSE(player.is_playing());
  EXPECT_EQ(player.frame(), 120);
  player.step(-1);
  EXPECT_EQ(player.frame(), 119);
  player.go_to(500, 0);
  EXPECT_EQ(player.frame(), 120);
  player.go_to(-2, 0);
  EXPECT_EQ(player.frame(), 0);
}

TEST(player, scrubbing_goes_on_from_there) {
  Player player = walk();
  player.play(0);
  player.advance(1);
  player.go_to(5, 1);
  EXPECT_TRUE(player.is_playing());
  player.advance(1.51);
  EXPECT_EQ(player.frame(), 35);
}

// A held key makes parts of a step, which add up; one that is pressed anew is one frame, whatever was left over.
TEST(player, parts_of_a_step_add_up) {
  Player player = walk();
  player.step(1);
  for (int k = 0; k < 8; ++k) player.step(0.375);
  EXPECT_EQ(player.frame(), 4);
  player.step(0.75);
  player.step(-1);
  EXPECT_EQ(player.frame(), 3);
  player.step(1);
  EXPECT_EQ(player.frame(), 4);
}

RC_GTEST_PROP(player, frames_never_go_back_while_it_plays, ()) {
  Player player = walk();
  double now = 3;
  player.play(now);
  for (int k = 0; k < 50 && player.is_playing(); ++k) {
    const int before = player.frame();
    now += *rc::gen::inRange(0, 100) / 1000.0;
    player.advance(now);
    RC_ASSERT(player.frame() >= before);
    RC_ASSERT(std::abs(player.frame() - std::min(120.0, 60 * (now - 3))) <= 1 + 1e-6);
  }
}

}  // namespace gnomon::viewer::player_test
