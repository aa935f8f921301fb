// Motions that are joined, and meshes that leave a scene that moves.
#include "measure/scene/motion_data.h"

#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include "../error_words.h"
#include "../hand_made.h"
#include "../moving_file.h"
#include "measure/scene/load.h"
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
  EXPECT_EQ(rest.notes, std::vector<std::string>{"1 triangle of meshes that move lies on another and is merged"});
  freeze(start, {"part", 0});
  EXPECT_EQ(start.meshes[0].triangles.size(), 1u);
  freeze(later, {"part", 1});
  EXPECT_EQ(later.meshes[0].triangles.size(), 2u);
  EXPECT_TRUE(later.notes.empty());
}

// --- triangles without area in the pose of the file ---

/// A scene of one mesh that an animation moves, and a ground that nothing moves.
Scene of(Mesh mesh, Motion motion) {
  Scene scene{.name = "one"};
  scene.meshes = {hand_made::square(4, 0), std::move(mesh)};
  motion.rigs.at(0).mesh = 1;
  scene.motion = std::make_shared<const Motion>(std::move(motion));
  return scene;
}

/// What finish_scene makes of the second mesh.
Mesh finished(Mesh mesh, Motion motion) {
  Scene scene = of(std::move(mesh), std::move(motion));
  finish_scene(scene, "test");
  return scene.meshes.size() > 1 ? scene.meshes[1] : Mesh{};
}

/// A closed box, a rig for it whose node has this scale at rest, and an animation that moves the node.
std::pair<Mesh, Motion> box_of_size(const glm::dvec3& scale) {
  Mesh mesh = tessellate(Box{{-1, -1, -1}, {1, 1, 1}}, 8, "box");
  Motion motion;
  motion.nodes.emplace_back().scale = scale;
  motion.animations = {{"grow", {track(0, Track::Property::scale, {scale.x, scale.y, scale.z, 1, 1, 1})}}};
  Rig& rig = motion.rigs.emplace_back();
  for (glm::vec3& p : mesh.positions) {
    rig.base.emplace_back(p);
    p = glm::vec3(scale * glm::dvec3(p));
  }
  mesh.shape.reset();
  return {std::move(mesh), std::move(motion)};
}

TEST(motion_data, a_mesh_that_is_flat_at_rest_alone_keeps_its_triangles_and_is_closed) {
  for (const glm::dvec3 scale : {glm::dvec3(0), glm::dvec3(1, 0, 1), glm::dvec3(1)}) {
    const auto [mesh, motion] = box_of_size(scale);
    const Mesh found = finished(mesh, motion);
    EXPECT_EQ(found.triangles.size(), 12u) << scale.y;
    EXPECT_TRUE(found.facts.closed()) << scale.y;
    EXPECT_EQ(found.facts.degenerate_count, 0u) << scale.y;
  }
}

TEST(motion_data, a_still_of_it_drops_what_is_flat_then) {
  const auto [mesh, motion] = box_of_size({0, 0, 0});
  Scene at_start = of(mesh, motion), at_end = at_start;
  freeze(at_start, {"grow", 0});
  finish_scene(at_start, "test");
  EXPECT_EQ(at_start.meshes.size(), 1u);
  EXPECT_EQ(at_start.notes, std::vector<std::string>{"12 triangles without area are dropped"});
  freeze(at_end, {"grow", 1});
  finish_scene(at_end, "test");
  EXPECT_EQ(at_end.meshes.at(1).triangles.size(), 12u);
}

TEST(motion_data, what_is_flat_before_all_motion_stays_so_unless_targets_or_joints_spread_it) {
  // Corners on a line, and a corner twice.
  auto [mesh, motion] = box_of_size({1, 1, 1});
  mesh.positions = {{0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {0, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 1}, {0, 1, 3}};
  motion.rigs[0].base = {{0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {0, 1, 1}};
  const Mesh rigid = finished(mesh, motion);
  EXPECT_EQ(rigid.triangles, (std::vector<glm::uvec3>{{0, 1, 3}}));
  EXPECT_EQ(rigid.facts.degenerate_count, 2u);

  Motion morphing = motion;
  morphing.nodes[0].weights = {0};
  morphing.rigs[0].targets = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 0, 0}};
  const Mesh spread = finished(mesh, morphing);
  EXPECT_EQ(spread.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 1, 3}}));
  EXPECT_EQ(spread.facts.degenerate_count, 1u);
}

TEST(motion_data, a_mesh_whose_rig_no_animation_moves_is_finished_as_it_stands) {
  auto [mesh, motion] = box_of_size({1, 0, 1});
  motion.nodes.emplace_back();
  motion.animations[0].tracks[0].node = 1;
  const Mesh found = finished(mesh, motion);
  EXPECT_EQ(found.triangles.size(), 4u) << "bottom and top";
  EXPECT_EQ(found.facts.degenerate_count, 8u);
}

TEST(motion_data, a_scene_without_any_area_at_rest_is_refused_with_its_animations) {
  const auto [mesh, motion] = box_of_size({0, 0, 0});
  Scene scene = of(mesh, motion);
  scene.meshes.erase(scene.meshes.begin());
  Motion alone = motion;
  scene.motion = std::make_shared<const Motion>(std::move(alone));
  error_words::expect_words(error_words::error_of([&] { finish_scene(scene, "test"); }),
                            {"'one' has no geometry at rest", "grow"});
}

}  // namespace motion_data_test
