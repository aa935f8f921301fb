// Motions that are joined, and meshes that leave a scene that moves.
#include "measure/scene/motion_data.h"

#include <gtest/gtest.h>

#include "../moving_file.h"
#include "measure/scene/pose.h"

namespace motion_data_test {

using namespace gnomon;
using namespace moving_file;

/// Of four meshes: the first two move, the third stands still, the last moves. Those of `empty` have triangles without area.
Scene four_meshes(std::initializer_list<std::size_t> empty) {
  MeshFile file = walking();
  for (const char* name : {"b", "c", "d"}) file.meshes.push_back(triangle(name, 0));
  file.meshes[2].nodes.clear();
  for (const std::size_t m : empty) file.meshes[m].positions[2] = {3, 0, 0};
  Scene scene = imported(file);
  finish_scene(scene, "test");
  return scene;
}

TEST(motion_data, rigs_follow_their_meshes_where_others_are_dropped) {
  const Scene all = four_meshes({});
  ASSERT_EQ(all.motion->rigs.size(), 3u);
  EXPECT_EQ(all.motion->rigs[2].mesh, 3u);

  const Scene some = four_meshes({0, 2});
  ASSERT_EQ(some.meshes.size(), 2u);
  ASSERT_EQ(some.motion->rigs.size(), 2u);
  EXPECT_EQ(some.motion->rigs[0].mesh, 0u);
  EXPECT_EQ(some.motion->rigs[1].mesh, 1u);
  Scene still = some;
  freeze(still, {"walk", 1});
  EXPECT_EQ(still.meshes[0].name, "b");
  EXPECT_EQ(still.meshes[0].positions[1], glm::vec3(1, 0, 2));
  EXPECT_EQ(still.meshes[1].name, "d");
  EXPECT_EQ(still.meshes[1].positions[1], glm::vec3(1, 0, 2));
}

TEST(motion_data, a_scene_keeps_its_animations_where_nothing_that_moves_is_left) {
  const Scene scene = four_meshes({0, 1, 3});
  EXPECT_TRUE(scene.motion->rigs.empty());
  EXPECT_EQ(scene.motion->animations.size(), 1u);
  EXPECT_EQ(four_meshes({0, 1, 3}).meshes.size(), 1u);
}

TEST(motion_data, dropping_meshes_leaves_the_motion_of_other_scenes_alone) {
  MeshFile file = walking();
  file.meshes.push_back(triangle("b", 0));
  Scene scene = imported(file);
  const Scene copy = scene;
  scene.meshes[0].triangles.clear();
  drop_empty_meshes(scene);
  EXPECT_EQ(scene.motion->rigs.size(), 1u);
  EXPECT_EQ(copy.motion->rigs.size(), 2u);
}

TEST(motion_data, thousands_of_equal_names_become_unique_at_once) {
  Motion motion;
  motion.nodes.resize(1);
  motion.animations.assign(20'000, {.name = "walk", .tracks = {track(0, Track::Property::translation, {0, 0, 0, 1, 0, 0})}});
  Scene scene;
  append_motion(motion, scene);
  append_motion(motion, scene);
  EXPECT_EQ(scene.motion->animations.front().name, "walk");
  EXPECT_EQ(scene.motion->animations.back().name, "walk_40000");
  EXPECT_EQ(scene.motion->animations.back().tracks[0].node, 1u);
}

// Two panes of glass at one place, the second of which moves up: one surface at rest, two later.
TEST(motion_data, glass_that_parts_is_merged_where_it_lies_on_other_glass_alone) {
  Scene scene;
  scene.name = "panes";
  Mesh panes;
  panes.positions = {{0, 1, 0}, {0, 1, 1}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {1, 1, 0}};
  panes.triangles = {{0, 1, 2}, {3, 4, 5}};
  panes.transmission = std::make_shared<const Transmission>(1, 1, 1, std::vector<float>{0.5f}, Transmission::Wrap::clamp,
                                                            Transmission::Wrap::clamp);
  scene.meshes = {panes};
  Motion motion;
  motion.nodes.emplace_back().weights = {0};
  motion.animations = {{"part", {track(0, Track::Property::weights, {0, 1})}}};
  Rig& rig = motion.rigs.emplace_back();
  for (const glm::vec3& p : panes.positions) rig.base.emplace_back(p);
  rig.targets.resize(6);
  for (int v = 3; v < 6; ++v) rig.targets[v] = {0, 1, 0};
  scene.motion = std::make_shared<const Motion>(motion);
  Scene rest = scene, start = scene, later = scene;
  merge_duplicates(rest);
  EXPECT_EQ(rest.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(rest.notes, std::vector<std::string>{"1 triangles of meshes that move lie on others and are merged"});
  freeze(start, {"part", 0});
  EXPECT_EQ(start.meshes[0].triangles.size(), 1u);
  freeze(later, {"part", 1});
  EXPECT_EQ(later.meshes[0].triangles.size(), 2u);
  EXPECT_TRUE(later.notes.empty());
}

}  // namespace motion_data_test
