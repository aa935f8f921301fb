// Copies of a scene in its poses: each is right, few stay, and the scene itself does not move.
#include "app/viewer/posed_copies.h"

#include <gtest/gtest.h>

#include "measure/scene/load.h"

namespace gnomon::viewer::posed_copies_test {

RowPose at(double seconds) { return {.animation = "walk", .seconds = seconds, .start = 0, .frame_rate = 60, .frames = 121}; }

std::shared_ptr<const Scene> boxes() { return std::make_shared<const Scene>(load_scene("walking_boxes:count=3")); }

TEST(posed_copies, a_copy_is_in_its_pose_and_the_scene_at_rest) {
  const auto scene = boxes();
  const std::string before = pose_hash(*scene);
  const PosedCopy copy(*scene, at(0.25));
  EXPECT_EQ(pose_hash(*scene), before);
  Scene posed = *scene;
  pose(posed, animation_of(posed, "walk"), 0.25);
  for (std::size_t m = 0; m < posed.meshes.size(); ++m)
    EXPECT_EQ(copy.scene().meshes[m].positions, posed.meshes[m].positions) << m;
  EXPECT_EQ(copy.hash(), pose_hash(posed));
  EXPECT_NE(copy.hash(), before);
  EXPECT_EQ(&copy.scene(scene->lights[0]), &copy.scene()) << "no glass colors the light";
}

TEST(posed_copies, the_last_times_are_remembered_whatever_their_row) {
  const auto scene = boxes();
  PosedCopies copies;
  const auto first = copies.of(scene, at(0));
  EXPECT_EQ(copies.of(scene, as_still(at(0))), first);
  EXPECT_EQ(copies.size(), 1u);
  for (int k = 1; k < 4; ++k) copies.of(scene, at(k / 60.0));
  EXPECT_EQ(copies.of(scene, at(0)), first);  // the newest again
  copies.of(scene, at(4 / 60.0));             // the oldest goes: 1/60
  EXPECT_EQ(copies.size(), PosedCopies::most);
  EXPECT_EQ(copies.of(scene, at(0)), first);
  copies.of(boxes(), at(0));
  EXPECT_EQ(copies.size(), 1u) << "another scene";
}

TEST(posed_copies, a_pose_that_cannot_be_is_an_error_and_leaves_the_others) {
  const auto scene = boxes();
  PosedCopies copies;
  copies.of(scene, at(0));
  RowPose other = at(0);
  other.animation = "run";
  EXPECT_THROW(copies.of(scene, other), Error);
  EXPECT_THROW(copies.of(scene, at(-1)), Error);
  EXPECT_EQ(copies.size(), 1u);
}

TEST(posed_copies, a_still_is_a_row_of_one_frame) {
  const RowPose still = as_still(at(0.5));
  EXPECT_EQ(still, (RowPose{.animation = "walk", .seconds = 0.5, .start = 0.5, .frame_rate = 60, .frames = 1}));
  EXPECT_EQ(as_still(still), still);
  EXPECT_TRUE(are_same_time(still, at(0.5)));
  EXPECT_FALSE(are_same_time(still, at(0.25)));
  EXPECT_FALSE(are_same_time(still, std::nullopt));
  EXPECT_TRUE(are_same_time(std::nullopt, std::nullopt));
}

}  // namespace gnomon::viewer::posed_copies_test
