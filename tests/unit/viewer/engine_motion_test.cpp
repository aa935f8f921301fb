// The viewer's engine on a scene that moves: masks, references and pictures are those of one pose, and updates replace
// builds.
#include <gtest/gtest.h>

#include "engine_rig.h"
#include "measure/scene/motion.h"

namespace gnomon::viewer::engine_motion_test {

using namespace engine_rig;

/// Looks at boxes that walk.
struct BoxesRig : TestRig {
  BoxesRig() { open("walking_boxes:count=4"); }
  /// A frame of the animation, in the row of all its frames.
  RowPose at(int frame) const {
    return *pose_at(find_path(selection.loaded->scene, "walk", selection.light, selection.view), frame);
  }
  EngineState finish_at(int frame) {
    selection.at = at(frame);
    return finish();
  }
};

std::optional<double> ms(const EngineState& state, Stage stage) { return state.sides[0].newest_ms[static_cast<int>(stage)]; }

// Also the fit of a map is that of the pose alone. At rest the scene is as its file has it.
TEST(viewer_engine_motion, a_still_is_what_render_makes) {
  BoxesRig rig;
  expect_as_rendered(rig.selection, rig.finish());
  for (const int frame : {30, 47}) {
    rig.selection.at = as_still(rig.at(frame));
    expect_as_rendered(rig.selection, rig.finish());
  }
  rig.selection.at.reset();
  expect_as_rendered(rig.selection, rig.finish());
}

TEST(viewer_engine_motion, a_time_has_one_picture) {
  BoxesRig rig;
  const EngineState first = rig.finish_at(10), other = rig.finish_at(40), again = rig.finish_at(10);
  for (const EngineState* state : {&first, &other, &again}) {
    EXPECT_EQ(state->sides[0].phase, Phase::done) << state->sides[0].words;
    EXPECT_EQ(state->sides[0].answer->frame, state->frame);
    EXPECT_EQ(state->reference->frame, state->frame);
    EXPECT_TRUE(state->sides[0].verdict && state->sides[0].verdict->has_causes);
  }
  EXPECT_NE(first.sides[0].answer->mask, other.sides[0].answer->mask);
  EXPECT_NE(first.reference->mask, other.reference->mask);
  EXPECT_EQ(first.sides[0].answer->mask, again.sides[0].answer->mask);
  EXPECT_EQ(first.reference->mask, again.reference->mask);
  EXPECT_EQ(first.sides[0].verdict->causes, again.sides[0].verdict->causes);
  EXPECT_EQ(first.frame->pose->hash, again.frame->pose->hash);
}

// Another row, at rest too, is built for; within one row there are updates alone, forward and back.
TEST(viewer_engine_motion, update_stands_in_for_build) {
  BoxesRig rig;
  const EngineState rest = rig.finish();
  EXPECT_TRUE(ms(rest, Stage::build));
  EXPECT_FALSE(ms(rest, Stage::update));
  const EngineState opened = rig.finish_at(0);
  EXPECT_TRUE(ms(opened, Stage::build));
  EXPECT_FALSE(ms(opened, Stage::update));
  for (const int frame : {1, 60, 2}) {
    const EngineState state = rig.finish_at(frame);
    EXPECT_FALSE(ms(state, Stage::build)) << frame;
    EXPECT_TRUE(ms(state, Stage::update)) << frame;
    EXPECT_EQ(ms(state, Stage::setup), ms(rest, Stage::setup)) << frame;
  }
  rig.selection.at = as_still(rig.at(2));
  EXPECT_TRUE(ms(rig.finish(), Stage::build));
}

// A camera that moves at one time needs neither.
TEST(viewer_engine_motion, a_view_at_the_same_time_updates_nothing) {
  BoxesRig rig;
  rig.finish_at(0);
  const EngineState before = rig.finish_at(5);
  rig.selection.view.eye.x += 0.25f;
  const EngineState after = rig.finish();
  EXPECT_EQ(ms(before, Stage::update), ms(after, Stage::update));
  EXPECT_EQ(ms(before, Stage::relight), ms(after, Stage::relight));
  EXPECT_EQ(before.frame->posed, after.frame->posed);
  EXPECT_NE(before.sides[0].answer->mask, after.sides[0].answer->mask);
}

// Times come faster than answers. Whatever is shown meanwhile is of one pose, and the last time is reached.
TEST(viewer_engine_motion, what_is_late_is_skipped_and_nothing_mixes_poses) {
  BoxesRig rig;
  rig.finish_at(0);
  rig.selection.is_moving = true;
  std::uint64_t number = 0;
  for (int frame = 1; frame <= 60; ++frame) {
    rig.selection.at = rig.at(frame);
    number = rig.engine().select(rig.selection);
    const EngineState state = rig.engine().state();
    if (state.frame) {
      ASSERT_TRUE(state.frame->pose && state.frame->posed);
      EXPECT_EQ(state.frame->pose->hash, pose_hash(state.frame->scene()));
    }
    if (const auto& answer = state.sides[0].answer) {
      EXPECT_EQ(answer->mask.size(), answer->frame->gbuffer.size());
    }
    if (frame % 10 == 0)
      rig.until([&](const EngineState& s) { return s.selection_number == number && s.frame->at() == rig.selection.at; });
  }
  rig.selection.is_moving = false;
  const EngineState state = rig.finish();
  EXPECT_TRUE(state.frame->is_full());
  EXPECT_EQ(state.frame->at(), rig.selection.at);
  EXPECT_EQ(state.sides[0].answer->frame, state.frame);
  BoxesRig fresh;
  EXPECT_EQ(fresh.finish_at(60).sides[0].answer->mask, state.sides[0].answer->mask);
}

TEST(viewer_engine_motion, a_time_that_cannot_be_is_said_and_the_next_one_comes) {
  BoxesRig rig;
  rig.finish_at(0);
  rig.selection.at->animation = "run";
  EXPECT_NE(rig.finish().trouble.find("run"), std::string::npos);
  const EngineState state = rig.finish_at(3);
  EXPECT_EQ(state.trouble, "");
  EXPECT_EQ(state.sides[0].phase, Phase::done);
}

}  // namespace gnomon::viewer::engine_motion_test
