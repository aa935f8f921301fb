// Motion in the bytes of a scene: there and back, and damaged.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "measure/formats/motion_fields.h"
#include "measure/scene/blob.h"
#include "measure/scene/fields.h"
#include "measure/scene/posed_scene.h"
#include "moving_world.h"

namespace blob_motion_test {

using namespace gnomon;
using namespace moving_world;

/// The scene with something in every field of its motion.
Scene full_scene() {
  Scene world = scene();
  Motion motion = motion_of(world);
  motion.nodes[1].matrix = glm::translate(glm::dmat4(1), glm::dvec3(1, 2, 3));
  motion.animations[0].tracks.erase(motion.animations[0].tracks.begin() + 1);
  motion.animations[0].tracks[0].interpolation = Track::Interpolation::step;
  motion.animations[1].tracks[0].interpolation = Track::Interpolation::cubic;
  motion.animations[1].tracks[0].values = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0};
  set_motion(world, std::move(motion));
  world.paths = {{"slide", Path::Moves::light, {{0, 0, 0}, {1, 0, 0}}, 3}};
  return world;
}

TEST(blob_motion, comes_back_as_it_was) {
  const Scene world = full_scene(), back = scene_from_bytes(scene_bytes(world));
  ASSERT_TRUE(back.motion);
  EXPECT_EQ(scene_bytes(back), scene_bytes(world));
  const Motion &a = *world.motion, &b = *back.motion;
  ASSERT_EQ(b.nodes.size(), a.nodes.size());
  EXPECT_EQ(b.nodes[1].matrix, a.nodes[1].matrix);
  EXPECT_EQ(b.nodes[5].scale, glm::dvec3(0));
  EXPECT_EQ(b.nodes[3].weights, std::vector<double>{0});
  ASSERT_EQ(b.animations.size(), 2u);
  EXPECT_EQ(b.animations[1].name, "sleep");
  EXPECT_EQ(b.animations[1].tracks[0].values, a.animations[1].tracks[0].values);
  EXPECT_EQ(b.skins.at(0).joints, a.skins.at(0).joints);
  ASSERT_EQ(b.rigs.size(), a.rigs.size());
  EXPECT_EQ(b.rigs[1].placement.translate, glm::dvec3(0, 5, 0));
  EXPECT_EQ(b.rigs[3].targets, a.rigs[3].targets);
  EXPECT_EQ(b.rigs[2].joints, a.rigs[2].joints);
  EXPECT_EQ(back.paths.size(), 1u);
}

TEST(blob_motion, poses_as_it_did) {
  Scene world = scene(), back = scene_from_bytes(scene_bytes(world));
  PosedScene one(world), other(back);
  for (const double seconds : {0.3, 1.7}) {
    const RowPose at{.animation = "walk", .seconds = seconds, .frames = 1};
    one.go_to(at);
    other.go_to(at);
    EXPECT_EQ(one.hash(), other.hash());
  }
}

// A program that reads only scenes that stand still reads their layouts, and no other.
TEST(blob_motion, leaves_scenes_without_it_as_they_were) {
  Scene world = scene();
  EXPECT_EQ(static_cast<int>(scene_bytes(world).at(0)), 5);
  world.motion = nullptr;
  const auto still = scene_bytes(world);
  EXPECT_EQ(static_cast<int>(still.at(0)), 2);
  EXPECT_FALSE(scene_from_bytes(still).motion);
  const auto moving = scene_bytes(scene());
  ASSERT_GT(moving.size(), still.size());
  EXPECT_TRUE(std::equal(still.begin() + 4, still.end(), moving.begin() + 4));
}

TEST(blob_motion, is_part_of_the_identity_of_rows_that_follow_it_alone) {
  const Scene world = scene();
  Scene still = world, other = world;
  still.motion = nullptr;
  Motion motion = motion_of(other);
  motion.animations[0].tracks[0].values.back() = 1;
  set_motion(other, std::move(motion));
  const Light& light = world.lights[0];
  EXPECT_EQ(scene_hash(world, light), scene_hash(still, light));
  EXPECT_EQ(scene_hash(world, light), scene_hash(other, light));
  EXPECT_NE(scene_hash(world, light, WithMotion::yes), scene_hash(still, light));
  EXPECT_NE(scene_hash(world, light, WithMotion::yes), scene_hash(other, light, WithMotion::yes));
  EXPECT_EQ(scene_hash(still, light, WithMotion::yes), scene_hash(still, light));
  Scene noted = world;
  noted.notes = {"one"};
  EXPECT_EQ(scene_hash(noted, light, WithMotion::yes), scene_hash(world, light, WithMotion::yes));
}

TEST(blob_motion, whose_bytes_end_early_is_refused) {
  const std::vector<std::byte> bytes = scene_bytes(full_scene());
  for (std::size_t size = 0; size < bytes.size(); size += size < 4000 ? 1 : 7)
    EXPECT_THROW(scene_from_bytes(std::span(bytes).first(size)), Error) << size;
  EXPECT_NO_THROW(scene_from_bytes(bytes));
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Reads the scene above with a motion that is damaged so.
void read_with(const std::function<void(Motion&)>& damage) {
  Scene world = full_scene();
  Motion motion = motion_of(world);
  damage(motion);
  set_motion(world, std::move(motion));
  scene_from_bytes(scene_bytes(world));
}

TEST(blob_motion, whose_numbers_fit_nothing_is_refused) {
  EXPECT_NO_THROW(read_with([](Motion&) {}));
  const std::function<void(Motion&)> damages[] = {
      [](Motion& m) { m.nodes[2].parent = 2; },
      [](Motion& m) {
        m.nodes[0].rotation = {0, 0, 0, 2};
      },
      [](Motion& m) { m.nodes[1].matrix = glm::dmat4(nan); },
      [](Motion& m) { m.animations.clear(); },
      [](Motion& m) { m.animations[1].name = "walk"; },
      [](Motion& m) { m.animations[0].name = "Walk!"; },
      [](Motion& m) { m.animations[0].name = "slide"; },
      [](Motion& m) { m.animations[0].tracks.clear(); },
      [](Motion& m) { m.animations[0].tracks[0].node = 99; },
      [](Motion& m) { m.animations[0].tracks[0].node = 1; },
      [](Motion& m) {
        m.animations[0].tracks[0].times = {1, 0};
      },
      [](Motion& m) { m.animations[0].tracks[0].times = {}; },
      [](Motion& m) { m.animations[0].tracks[0].times[0] = -1; },
      [](Motion& m) { m.animations[0].tracks[0].values[4] = nan; },
      [](Motion& m) { m.animations[0].tracks[0].values.pop_back(); },
      [](Motion& m) { m.animations[0].tracks[0].property = static_cast<Property>(9); },
      [](Motion& m) { m.animations[0].tracks[0].interpolation = static_cast<Track::Interpolation>(3); },
      [](Motion& m) { m.animations[0].tracks.push_back(m.animations[0].tracks[0]); },
      [](Motion& m) { m.skins[0].joints[1] = 99; },
      [](Motion& m) { m.skins[0].inverse_bind.pop_back(); },
      [](Motion& m) { m.rigs[0].mesh = 99; },
      [](Motion& m) { m.rigs[0].mesh = m.rigs[1].mesh; },
      [](Motion& m) { m.rigs[0].node = 99; },
      [](Motion& m) { m.rigs[0].skin = 1; },
      [](Motion& m) { m.rigs[0].base.pop_back(); },
      [](Motion& m) { m.rigs[0].base[2].x = 1e18; },
      [](Motion& m) { m.rigs[0].placement.scale.y = nan; },
      [](Motion& m) { m.rigs[2].joints[3] = 2; },
      [](Motion& m) { m.rigs[2].weights.pop_back(); },
      [](Motion& m) { m.rigs[2].joints_per_vertex = 0; },
      [](Motion& m) { m.rigs[3].targets.pop_back(); },
  };
  for (std::size_t k = 0; k < std::size(damages); ++k) EXPECT_THROW(read_with(damages[k]), Error) << k;
}

TEST(blob_motion, paths_that_no_loader_makes_are_refused) {
  const auto read = [](const Path& path) {
    Scene world = scene();
    world.paths = {path};
    scene_from_bytes(scene_bytes(world));
  };
  const Path good{"slide", Path::Moves::camera, {{0, 0, 0}, {1, 0, 0}}, 3};
  EXPECT_NO_THROW(read(good));
  Path path = good;
  path.moves = Path::Moves::geometry;
  EXPECT_THROW(read(path), Error);
  path.moves = static_cast<Path::Moves>(3);
  EXPECT_THROW(read(path), Error);
  path = good;
  path.positions.pop_back();
  EXPECT_THROW(read(path), Error);
  path = good;
  path.frame_count = 0;
  EXPECT_THROW(read(path), Error);
}

}  // namespace blob_motion_test
