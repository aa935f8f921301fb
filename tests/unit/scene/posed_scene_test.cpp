// Scenes that are moved in place, from pose to pose and back.
#include "measure/scene/posed_scene.h"

#include <gtest/gtest.h>

#include <bit>

#include "error_words.h"
#include "measure/scene/blob.h"
#include "moving_world.h"

namespace posed_scene_test {

using namespace gnomon;
using namespace moving_world;
using error_words::error_of;
using error_words::expect_words;
using Kind = MeshChange::Kind;

/// Frame `frame` of nine, four a second.
RowPose walk(int frame) { return {.animation = "walk", .seconds = frame / 4.0, .start = 0, .frame_rate = 4, .frames = 9}; }
RowPose sleep(int frame) { return {.animation = "sleep", .seconds = frame / 4.0, .start = 0, .frame_rate = 4, .frames = 9}; }

std::vector<const glm::vec3*> addresses(const Scene& scene) {
  std::vector<const glm::vec3*> all;
  for (const Mesh& mesh : scene.meshes) all.push_back(mesh.positions.data());
  return all;
}

TEST(posed_scene, goes_where_pose_goes_and_arrays_stay_in_place) {
  Scene world = scene();
  const auto places = addresses(world);
  PosedScene posed(world);
  for (const int frame : {3, 8, 0, 5}) {
    posed.go_to(walk(frame));
    Scene due = scene();
    pose(due, due.motion->animations[0], frame / 4.0);
    for (std::uint32_t m = 0; m < mesh_count; ++m) EXPECT_EQ(world.meshes[m].positions, due.meshes[m].positions) << m;
    EXPECT_EQ(world.notes, std::vector<std::string>{});
  }
  EXPECT_EQ(addresses(world), places);
}

// 0.25 m a frame, of 4 frames a second: whole quarters are float32, and so is their sum with a half.
TEST(posed_scene, a_slab_walks_a_quarter_of_a_meter_a_frame_and_comes_back) {
  Scene world = scene();
  PosedScene posed(world);
  for (int step = 0; step <= 16; ++step) {
    const int frame = step <= 8 ? step : 16 - step;
    posed.go_to(walk(frame));
    const glm::vec3 by(0.25f * static_cast<float>(frame), 0, 0);
    for (std::size_t v = 0; v < 4; ++v)
      EXPECT_EQ(world.meshes[slab].positions[v], hand_made::square(0.5f, 1).positions[v] + by) << frame;
  }
}

TEST(posed_scene, at_rest_again_it_is_the_scene_to_the_bit) {
  Scene world = scene();
  world.notes = {"one"};
  const auto bytes = scene_bytes(world);
  PosedScene posed(world);
  for (const RowPose& at : {walk(3), walk(8), sleep(8), walk(0), sleep(2)}) posed.go_to(at);
  EXPECT_NE(scene_bytes(world), bytes);
  posed.go_to(std::nullopt);
  EXPECT_EQ(scene_bytes(world), bytes) << "positions, shapes, notes";
  for (const Mesh& mesh : world.meshes) EXPECT_TRUE(mesh.reach.empty());
}

TEST(posed_scene, a_mesh_that_moves_has_no_exact_shape_until_it_rests) {
  Scene world = scene();
  PosedScene posed(world);
  ASSERT_TRUE(world.meshes[ball].shape);
  posed.go_to(walk(0));
  EXPECT_FALSE(world.meshes[ball].shape);
  posed.go_to(sleep(4));
  EXPECT_TRUE(world.meshes[ball].shape) << "this animation leaves it alone";
  EXPECT_EQ(world.meshes[slab].positions, scene().meshes[slab].positions);
}

TEST(posed_scene, changes_tell_what_moved_and_how) {
  Scene world = scene();
  PosedScene posed(world);
  EXPECT_TRUE(posed.take_changes().empty());
  posed.go_to(walk(4));
  EXPECT_TRUE(posed.has_moved());
  const Changes changes = posed.take_changes();
  ASSERT_EQ(changes.meshes.size(), std::size_t{mesh_count});
  EXPECT_FALSE(changes.empty());
  const auto expect = [&](std::uint32_t mesh, Kind kind, std::uint32_t first, std::uint32_t count) {
    const MeshChange& change = changes.meshes[mesh];
    EXPECT_EQ(name(change.kind), name(kind)) << mesh;
    EXPECT_EQ(change.first, first) << mesh;
    EXPECT_EQ(change.count, count) << mesh;
  };
  expect(ground, Kind::still, 0, 0);
  expect(slab, Kind::rigid, 0, 4);
  expect(turned, Kind::rigid, 0, 4);
  expect(strip, Kind::deformed, 2, 2);
  expect(wing, Kind::deformed, 2, 1);
  expect(ball, Kind::rigid, 0, static_cast<std::uint32_t>(world.meshes[ball].positions.size()));
  expect(sleeper, Kind::still, 0, 0);
  EXPECT_EQ(changes.meshes[slab].before.min, glm::vec3(-0.5f, 1, -0.5f));
  EXPECT_EQ(changes.meshes[slab].after.min, glm::vec3(0.5f, 1, -0.5f)) << "1 m along x";
  EXPECT_EQ(changes.meshes[slab].after.max, glm::vec3(1.5f, 1, 0.5f));
  EXPECT_EQ(changes.meshes[wing].before.max, glm::vec3(4, 1, 1));
  EXPECT_EQ(changes.meshes[wing].after.max, glm::vec3(4, 1.5f, 1));
  EXPECT_EQ(changes.meshes[ground].before.max, changes.meshes[ground].after.max);
  EXPECT_EQ(changes.meshes[ground].after.max, glm::vec3(8, 0, 8));
  EXPECT_FALSE(posed.has_moved());
  EXPECT_TRUE(posed.take_changes().empty());
}

TEST(posed_scene, a_rigid_change_has_the_matrix_from_before_to_now) {
  Scene world = scene();
  PosedScene posed(world);
  for (const int frame : {2, 7, 4}) {
    const auto before = world.meshes;
    posed.go_to(walk(frame));
    const Changes changes = posed.take_changes();
    for (const std::uint32_t m : {std::uint32_t{slab}, std::uint32_t{turned}, std::uint32_t{ball}}) {
      ASSERT_EQ(changes.meshes[m].kind, Kind::rigid) << m;
      for (std::size_t v = 0; v < before[m].positions.size(); ++v) {
        const glm::dvec3 due(changes.meshes[m].matrix * glm::dvec4(before[m].positions[v], 1));
        EXPECT_LE(glm::distance(due, glm::dvec3(world.meshes[m].positions[v])), 2e-6) << m << ' ' << v;
      }
    }
  }
}

TEST(posed_scene, changes_are_since_they_were_taken_last) {
  Scene world = scene();
  PosedScene posed(world);
  posed.go_to(walk(2));
  posed.take_changes();
  posed.go_to(walk(3));
  posed.go_to(walk(6));
  const Changes two = posed.take_changes();
  EXPECT_EQ(two.meshes[slab].before.min.x, 0);
  EXPECT_EQ(two.meshes[slab].after.min.x, 1);
  posed.go_to(walk(1));
  posed.go_to(walk(6));
  EXPECT_FALSE(posed.has_moved()) << "there and back";
  EXPECT_TRUE(posed.take_changes().empty());
  EXPECT_EQ(posed.take_changes().meshes[slab].after.min.x, 1);
}

TEST(posed_scene, a_mesh_that_comes_from_no_size_is_deformed) {
  Scene world = scene();
  PosedScene posed(world);
  posed.go_to(sleep(4));
  EXPECT_EQ(posed.take_changes().meshes[sleeper].kind, Kind::deformed);
  posed.go_to(sleep(8));
  EXPECT_EQ(posed.take_changes().meshes[sleeper].kind, Kind::rigid) << "from one size to another";
  posed.go_to(sleep(0));
  EXPECT_EQ(posed.take_changes().meshes[sleeper].kind, Kind::rigid) << "flat now, not before";
}

TEST(posed_scene, a_row_gives_its_meshes_the_reach_of_all_its_frames) {
  Scene world = scene();
  PosedScene posed(world);
  EXPECT_FALSE(posed.go_to(walk(0)));
  EXPECT_EQ(world.meshes[slab].reach.min, glm::vec3(-0.5f, 1, -0.5f));
  EXPECT_EQ(world.meshes[slab].reach.max, glm::vec3(2.5f, 1, 0.5f));
  EXPECT_EQ(world.meshes[wing].reach.max, glm::vec3(4, 2, 1));
  EXPECT_TRUE(world.meshes[ground].reach.empty());
  EXPECT_TRUE(world.meshes[sleeper].reach.empty());
  EXPECT_EQ(world.meshes[ground].reached().max, glm::vec3(8, 0, 8));
  const Bounds reach = world.meshes[turned].reach;
  EXPECT_TRUE(posed.go_to(walk(5))) << "the same row";
  EXPECT_EQ(world.meshes[turned].reach.max, reach.max);

  RowPose half = walk(0);
  half.frames = 5;
  EXPECT_FALSE(posed.go_to(half)) << "another row of the same animation";
  EXPECT_EQ(world.meshes[slab].reach.max.x, 1.5f);
  EXPECT_FALSE(posed.go_to(sleep(0)));
  EXPECT_TRUE(world.meshes[slab].reach.empty());
  EXPECT_EQ(world.meshes[sleeper].reach.max, glm::vec3(1, 3, 1));
  EXPECT_FALSE(posed.go_to(std::nullopt));
  EXPECT_TRUE(posed.go_to(std::nullopt));
  EXPECT_TRUE(world.meshes[sleeper].reach.empty());
}

TEST(posed_scene, the_pose_number_rises_where_a_position_changes_alone) {
  Scene world = scene();
  PosedScene posed(world);
  const std::uint64_t first = world.pose_number;
  posed.go_to(walk(0));
  EXPECT_EQ(world.pose_number, first) << "0 s is the pose at rest";
  posed.go_to(walk(1));
  const std::uint64_t second = world.pose_number;
  EXPECT_GT(second, first);
  posed.go_to(walk(1));
  EXPECT_EQ(world.pose_number, second);
  posed.go_to(std::nullopt);
  EXPECT_GT(world.pose_number, second);
}

TEST(posed_scene, a_pose_that_cannot_be_leaves_the_scene_as_it_was) {
  Scene world = scene();
  Motion motion = motion_of(world);
  motion.animations[0].tracks[0].values = {0, 0, 0, 8e17, 0, 0};
  set_motion(world, std::move(motion));
  PosedScene posed(world);
  posed.go_to(sleep(2));
  const auto bytes = scene_bytes(world);
  expect_words(error_of([&] { posed.go_to(walk(0)); }),
               {"mesh 'm1', vertex 0", "at 0.5 s of animation 'walk'", "-1e17 .. 1e17"});
  EXPECT_EQ(scene_bytes(world), bytes);
  EXPECT_EQ(posed.now(), sleep(2));
  EXPECT_TRUE(world.meshes[slab].reach.empty());
}

TEST(posed_scene, times_that_are_no_row_are_refused) {
  Scene world = scene();
  PosedScene posed(world);
  const auto refused = [&](auto change, const std::vector<std::string>& words) {
    RowPose at = walk(1);
    change(at);
    expect_words(error_of([&] { posed.go_to(at); }), words);
  };
  refused([](RowPose& at) { at.frames = 0; }, {"frames = 0 is outside 1 .. 10000"});
  refused([](RowPose& at) { at.frames = 10'001; }, {"frames = 10001"});
  refused([](RowPose& at) { at.frame_rate = 0; }, {"frame_rate = 0"});
  refused([](RowPose& at) { at.frame_rate = NAN; }, {"frame_rate = nan"});
  refused([](RowPose& at) { at.start = -1; }, {"start = -1"});
  refused([](RowPose& at) { at.start = INFINITY; }, {"start = inf"});
  refused([](RowPose& at) { at.seconds = NAN; }, {"time = nan"});
  refused([](RowPose& at) { at.animation = ""; }, {"no animation"});
  refused([](RowPose& at) { at.animation = "wolk"; }, {"wolk", "walk"});
  EXPECT_FALSE(posed.now());
  Scene still = scene();
  still.motion = nullptr;
  PosedScene none(still);
  EXPECT_TRUE(none.go_to(std::nullopt));
  EXPECT_EQ(none.take_changes().meshes.size(), std::size_t{mesh_count});
  expect_words(error_of([&] { none.go_to(walk(0)); }), {"no animation"});
}

TEST(posed_scene, the_hash_is_of_all_positions_to_the_bit) {
  Scene world = scene();
  PosedScene posed(world);
  EXPECT_EQ(posed.hash(), "") << "at rest";
  posed.go_to(walk(3));
  const std::string third = posed.hash();
  EXPECT_EQ(third, pose_hash(world));
  posed.go_to(walk(4));
  EXPECT_NE(posed.hash(), third);
  posed.go_to(walk(3));
  EXPECT_EQ(posed.hash(), third);
  float& x = world.meshes[ground].positions[2].x;
  x = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) + 1);
  EXPECT_NE(pose_hash(world), third) << "of meshes that stand still, too";
  posed.go_to(std::nullopt);
  EXPECT_EQ(posed.hash(), "");
}

TEST(posed_scene, a_pose_is_of_a_row_with_the_same_animation_and_times) {
  EXPECT_TRUE(walk(1).is_of_row(walk(7)));
  EXPECT_FALSE(walk(1).is_of_row(sleep(1)));
  RowPose other = walk(1);
  other.start = 0.5;
  EXPECT_FALSE(other.is_of_row(walk(1)));
  other = walk(1);
  other.frame_rate = 60;
  EXPECT_FALSE(other.is_of_row(walk(1)));
}

TEST(posed_scene, frames_of_a_path_that_moves_geometry_have_a_pose) {
  const Path path{.name = "walk", .moves = Path::Moves::geometry, .frame_count = 9, .start = 0.5, .frame_rate = 4};
  const auto at = pose_at(path, 3);
  ASSERT_TRUE(at);
  EXPECT_EQ(*at, (RowPose{.animation = "walk", .seconds = 1.25, .start = 0.5, .frame_rate = 4, .frames = 9}));
  EXPECT_FALSE(pose_at({"slide", Path::Moves::light, {{0, 0, 0}, {1, 0, 0}}, 3}, 1));
}

}  // namespace posed_scene_test
