// Frames of a scene whose meshes move: which file is whose, and that rays are traced through meshes where they are.
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "error_words.h"
#include "glass.h"
#include "hand_made.h"
#include "measure/frame/frame.h"
#include "measure/frame/light_rays.h"
#include "measure/scratch_folder.h"
#include "walking_world.h"

namespace posed_frame_test {

using namespace gnomon;
using error_words::error_of, error_words::expect_words;
using walking_world::in_row, walking_world::moved_to;

class PosedFrame : public testing::Test {
 protected:
  FrameKey at_rest() const { return {.view = scene.views[0], .width = 48, .height = 27, .truth = Truth::mesh}; }
  /// Moves the scene there.
  FrameKey at(const RowPose& pose) {
    FrameKey key = at_rest();
    key.pose = moved_to(posed, pose);
    return key;
  }

  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  Scene scene = walking_world::walking_scene();
  PosedScene posed{scene};
  FrameStore frames{scene, folder.path()};
};

TEST_F(PosedFrame, has_a_file_for_each_pose_whatever_row_it_belongs_to) {
  const auto still = frames.gbuffer_file(at_rest());
  const auto first = frames.gbuffer_file(at(in_row(0.25))), second = frames.gbuffer_file(at(in_row(0.5)));
  EXPECT_NE(first, still);
  EXPECT_NE(second, first);
  RowPose slower = in_row(0.25);
  slower.frame_rate = 4;
  EXPECT_EQ(frames.gbuffer_file(at(slower)), first) << "the same positions";
  posed.go_to({});
  EXPECT_EQ(frames.gbuffer_file(at_rest()), still);
  // A store that never saw the scene move has the same names.
  const Scene unmoved = walking_world::walking_scene();
  EXPECT_EQ(FrameStore(unmoved, folder.path()).gbuffer_file(at_rest()).filename(), still.filename());
}

TEST_F(PosedFrame, is_asked_for_in_the_pose_that_the_scene_is_in) {
  const FrameKey early = at(in_row(0.25)), late = at(in_row(0.5));
  frames.gbuffer(late);
  expect_words(error_of([&] { frames.gbuffer(early); }),
               {"a frame of scene walking at 0.25 s of animation walk is wanted while its meshes are elsewhere",
                late.pose->hash, early.pose->hash});
  expect_words(error_of([&] { frames.reference(at_rest(), scene.lights[0]); }), {"scene walking at rest is wanted"});
  posed.go_to({});
  frames.reference(at_rest(), scene.lights[0]);
  expect_words(error_of([&] { frames.gbuffer(late); }), {"at 0.5 s of animation walk"});
}

TEST_F(PosedFrame, rays_meet_meshes_where_they_are) {
  std::vector<std::vector<float>> masks;
  for (const RowPose& pose : {in_row(0.25), in_row(0.75), in_row(0.75, "lift"), in_row(0.25)}) {
    const FrameKey key = at(pose);
    const RayScene fresh(scene, key.truth, RayScene::Which::casters);  // all cast and are seen
    const GBuffer g = frames.gbuffer(key), expected = make_gbuffer(scene, fresh, key.view, key.width, key.height, key.truth);
    EXPECT_TRUE(std::ranges::equal(g.px, expected.px) && std::ranges::equal(g.mesh, expected.mesh));
    std::vector<float> mask(g.size());
    trace_shadows(fresh, scene, g, scene.lights[1], mask);
    const Reference reference = frames.reference(key, scene.lights[1]);
    EXPECT_TRUE(std::ranges::equal(reference.mask, mask)) << pose.seconds;
    EXPECT_TRUE(
        std::ranges::equal(reference.classes, classify(scene, fresh, g, scene.lights[1], mask, find_silhouettes(fresh, g))));
    masks.push_back(mask);
  }
  EXPECT_NE(masks[0], masks[1]);
  EXPECT_NE(masks[1], masks[2]);
  EXPECT_EQ(masks[0], masks[3]);
}

TEST_F(PosedFrame, the_scenes_hash_is_that_of_its_rest_wherever_it_is) {
  const std::string sun = frames.scene_hash({"sun"});
  posed.go_to(in_row(0.5));
  const Scene unmoved = walking_world::walking_scene();
  FrameStore fresh(unmoved, folder.path());
  EXPECT_EQ(frames.scene_hash({"sun"}), sun);
  EXPECT_EQ(frames.scene_hash({"point"}), fresh.scene_hash({"point"})) << "computed for the first time";
  EXPECT_EQ(frames.scene_hash({"sun"}, WithMotion::yes), fresh.scene_hash({"sun"}, WithMotion::yes));
  EXPECT_NE(frames.scene_hash({"sun"}, WithMotion::yes), sun);
  EXPECT_EQ(frames.scene_file().filename(), fresh.scene_file().filename());
}

// A mesh that moves is its triangles from the first frame on, where it is still at rest: of two balls one stays a sphere.
TEST(PosedFrames, of_a_shape_that_moves_are_of_its_triangles) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  Scene scene = walking_world::walking_scene();
  const Sphere ball{{-1, 1.5f, 0}, 0.75f}, other{{1.5f, 1.5f, 0}, 0.75f};
  scene.meshes = {tessellate(ground_plane(4), 4, "ground"), tessellate(ball, 6, "ball"), tessellate(other, 6, "other")};
  Motion motion = *scene.motion;
  motion.animations.pop_back();
  motion.rigs = {rig_at_rest(scene, 1, 0)};
  scene.motion = std::make_shared<const Motion>(std::move(motion));
  PosedScene posed(scene);
  FrameStore frames(scene, folder.path());
  FrameKey key{.view = scene.views[0], .width = 48, .height = 27, .truth = Truth::shape};
  const GBuffer at_rest = frames.gbuffer(key);
  const std::string hash = frames.scene_hash({"sun"});
  key.pose = moved_to(posed, in_row(0));
  ASSERT_TRUE(scene.has_curved_shapes());
  ASSERT_FALSE(scene.meshes[1].has_curved_shape());
  const RayScene fresh(scene, key.truth, RayScene::Which::casters);
  const GBuffer g = frames.gbuffer(key), expected = make_gbuffer(scene, fresh, key.view, key.width, key.height, key.truth);
  EXPECT_TRUE(std::ranges::equal(g.px, expected.px) && std::ranges::equal(g.nx, expected.nx));
  EXPECT_FALSE(std::ranges::equal(g.px, at_rest.px));
  EXPECT_EQ(frames.scene_hash({"sun"}), hash);
  posed.go_to({});
  EXPECT_EQ(FrameStore(scene, folder.path()).scene_hash({"sun"}), hash);
}

// In a scene with colored glass each channel of a light is traced through a copy of its own.
TEST(PosedFrames, of_the_channels_of_a_light_are_in_the_pose) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_frame");
  Scene scene = walking_world::walking_scene();
  scene.meshes[1] = glass::with_transmission(scene.meshes[1], {0.9f, 0.5f, 0.25f});
  split_lights(scene);
  ASSERT_EQ(scene.lights.size(), 6u);
  PosedScene posed(scene);
  FrameStore frames(scene, folder.path() / "a");
  const FrameKey at_rest{.view = scene.views[0], .width = 48, .height = 27, .truth = Truth::mesh};
  for (const double seconds : {0.25, 0.75}) {
    FrameKey key = at_rest;
    key.pose = moved_to(posed, in_row(seconds));
    Scene still = scene;
    still.motion = nullptr;
    FrameStore of_still(still, folder.path() / "b");
    for (const Light& light : scene.lights) {
      const Reference reference = frames.reference(key, light), expected = of_still.reference(at_rest, light);
      EXPECT_TRUE(std::ranges::equal(reference.mask, expected.mask)) << light.name << " at " << seconds;
      EXPECT_TRUE(std::ranges::equal(reference.surfaces, expected.surfaces)) << light.name << " at " << seconds;
    }
  }
}

}  // namespace posed_frame_test
