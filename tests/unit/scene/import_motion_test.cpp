// What moves the meshes of a file, from the importer's answer into the scene. Answers are made by hand.
#include "measure/scene/import_motion.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <random>

#include "../error_words.h"
#include "../moving_file.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/blob.h"
#include "measure/scene/channels.h"
#include "measure/scene/pose.h"

namespace import_motion_test {

using namespace gnomon;
using namespace moving_file;
using error_words::has_note;

/// The positions' bits: minus zero is not zero.
bool same_bits(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(glm::vec3)) == 0;
}

std::vector<std::vector<glm::vec3>> positions_of(const Scene& scene) {
  std::vector<std::vector<glm::vec3>> positions;
  for (const Mesh& mesh : scene.meshes) positions.push_back(mesh.positions);
  return positions;
}

Scene posed(Scene scene, const PoseTime& at) {
  freeze(scene, at);
  return scene;
}

// --- the file's own pose ---

/// Numbers that repeat with the seed.
struct Numbers {
  std::mt19937 engine;
  double number(double low, double high) { return std::uniform_real_distribution(low, high)(engine); }
  std::uint32_t below(std::uint32_t count) { return std::uniform_int_distribution(0u, count - 1)(engine); }
  glm::dvec3 vector() { return {number(-3, 3), number(-3, 3), number(-3, 3)}; }
  glm::dvec4 turn() { return glm::normalize(glm::dvec4(vector(), number(-3, 3))); }
};

/// A tree of nodes, some with a matrix, and an animation whose keys have the nodes' own values.
Motion resting_motion(Numbers& numbers) {
  Motion motion;
  Animation rest{.name = "rest", .tracks = {}};
  const auto hold = [&](std::uint32_t node, Track::Property property, const std::vector<double>& value) {
    Track held{.node = node,
               .property = property,
               .interpolation = static_cast<Track::Interpolation>(numbers.below(3)),
               .times = {0.5, 1.5},
               .values = {}};
    const std::vector<double> tangents(value.size(), numbers.number(-1, 1));
    for (std::size_t k = 0; k < held.times.size(); ++k)
      for (const auto* part : {&tangents, &value, &tangents})
        if (part == &value || held.interpolation == Track::Interpolation::cubic)
          held.values.insert(held.values.end(), part->begin(), part->end());
    rest.tracks.push_back(std::move(held));
  };
  for (std::uint32_t n = 0; n < 7; ++n) {
    MotionNode node;
    if (n > 0 && numbers.below(4) > 0) node.parent = numbers.below(n);
    node.translation = numbers.vector();
    node.rotation = numbers.turn();
    node.scale = numbers.vector();
    node.weights = {numbers.number(-1, 1), 0, numbers.number(0, 2)};
    const auto &t = node.translation, &s = node.scale;
    const auto& r = node.rotation;
    if (n == 3) {
      node.matrix = node_matrix(t, r, s);
    } else {
      hold(n, Track::Property::translation, {t.x, t.y, t.z});
      hold(n, Track::Property::rotation, {r.x, r.y, r.z, r.w});
      hold(n, Track::Property::scale, {s.x, s.y, s.z});
    }
    hold(n, Track::Property::weights, node.weights);
    motion.nodes.push_back(std::move(node));
  }
  Skin skin{.joints = {5, 2, 3}, .inverse_bind = {}};
  for (int j = 0; j < 3; ++j) skin.inverse_bind.push_back(node_matrix(numbers.vector(), numbers.turn(), numbers.vector()));
  motion.skins.push_back(std::move(skin));
  motion.animations.push_back(std::move(rest));
  return motion;
}

/// A mesh of random triangles with morph targets, with a skin or at two nodes, whose positions are those of the file's pose.
ImportedMesh resting_mesh(Numbers& numbers, const Motion& motion, bool has_targets, bool has_skin) {
  const std::vector<glm::dmat4> world = node_matrices(motion, nullptr, 0);
  ImportedMesh mesh;
  for (int v = 0; v < 12; ++v) mesh.base.push_back(numbers.vector());
  for (std::uint32_t f = 0; f < 4; ++f) mesh.add_triangle(3 * f, 3 * f + 1, 3 * f + 2);
  mesh.nodes = {numbers.below(7)};
  mesh.positions = mesh.base;
  const std::vector<double>& shares = motion.nodes[mesh.nodes[0]].weights;
  for (std::size_t t = 0; has_targets && t < shares.size(); ++t)
    for (glm::dvec3& p : mesh.positions) {
      mesh.targets.push_back(numbers.vector());
      if (shares[t] != 0) p += shares[t] * mesh.targets.back();
    }
  if (!has_skin) {
    mesh.places = {world[mesh.nodes[0]]};
    if (has_targets) return mesh;
    mesh.base.clear();  // the positions are it
    mesh.nodes.push_back(numbers.below(7));
    mesh.places.push_back(world[mesh.nodes[1]]);
    return mesh;
  }
  mesh.skin = 0;
  mesh.places = {glm::dmat4(1)};
  mesh.joints_per_vertex = 4;
  for (glm::dvec3& p : mesh.positions) {
    glm::dmat4 sum(0);
    for (int k = 0; k < 4; ++k) {
      mesh.joints.push_back(numbers.below(3));
      mesh.weights.push_back(k == 2 ? 0 : numbers.number(0, 0.5));
      const Skin& skin = motion.skins[0];
      if (k != 2) sum += mesh.weights.back() * (world[skin.joints[mesh.joints.back()]] * skin.inverse_bind[mesh.joints.back()]);
    }
    p = glm::dvec3(sum * glm::dvec4(p, 1));
  }
  return mesh;
}

TEST(import_motion, the_files_own_pose_is_the_imported_one_bit_for_bit) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Numbers numbers{std::mt19937(seed)};
    MeshFile file;
    file.motion = resting_motion(numbers);
    for (const bool has_targets : {false, true})
      for (const bool has_skin : {false, true})
        file.meshes.push_back(resting_mesh(numbers, file.motion, has_targets, has_skin));
    const Placement placement{
        .scale = glm::dvec3(numbers.number(0.1, 4)), .rotate_degrees = numbers.vector() * 50.0, .translate = numbers.vector()};
    const Scene scene = imported(file, placement);
    ASSERT_EQ(scene.meshes.size(), 5u);
    ASSERT_EQ(scene.motion->rigs.size(), 5u);
    for (const double seconds : {0.0, 0.5, 1.5, 9.0}) {
      const Scene still = posed(scene, {"rest", seconds});
      for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        EXPECT_TRUE(same_bits(still.meshes[m].positions, scene.meshes[m].positions)) << "seed " << seed << ", mesh " << m;
    }
  }
}

// --- what becomes of a file's motion ---

TEST(import_motion, a_mesh_gets_a_rig_of_its_vertices_and_its_placement) {
  const Placement placement{.scale = glm::dvec3(2), .translate = {0, 0, 1}};
  const Scene scene = imported(walking(), placement);
  ASSERT_TRUE(scene.motion);
  ASSERT_EQ(scene.motion->rigs.size(), 1u);
  const Rig& rig = scene.motion->rigs[0];
  EXPECT_EQ(rig.mesh, 0u);
  EXPECT_EQ(rig.node, 0u);
  EXPECT_EQ(rig.skin, Rig::no_skin);
  EXPECT_EQ(rig.base, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(scene.meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 1}, {2, 0, 1}, {0, 2, 1}}));
  EXPECT_EQ(posed(scene, {"walk", 1}).meshes[0].positions, (std::vector<glm::vec3>{{0, 0, 5}, {2, 0, 5}, {0, 2, 5}}))
      << "2 along z, then the scale 2, then 1 along z";
}

TEST(import_motion, each_place_of_a_mesh_moves_with_its_own_node) {
  MeshFile file = walking();
  file.motion.nodes.resize(2);
  file.meshes[0].nodes = {0, 1};
  file.meshes[0].places = {glm::dmat4(1), glm::dmat4(1)};
  const Scene still = posed(imported(file), {"", 1});
  EXPECT_EQ(still.meshes[0].positions[1], glm::vec3(1, 0, 2));
  EXPECT_EQ(still.meshes[1].positions[1], glm::vec3(1, 0, 0)) << "node 1 stands still";
}

TEST(import_motion, a_file_in_which_nothing_moves_brings_no_motion) {
  MeshFile file = walking();
  file.meshes[0].nodes.clear();
  EXPECT_FALSE(imported(file).motion);
}

TEST(import_motion, numbers_and_names_of_several_files_are_kept_apart) {
  Scene scene = imported(bending());
  add(walking(), scene);
  add(bending(), scene, {.translate = {5, 0, 0}});
  MeshFile named = walking();
  named.motion.animations[0].name = "Bend";
  add(named, scene);
  ASSERT_EQ(scene.motion->animations.size(), 4u);
  EXPECT_EQ(scene.motion->animations[0].name, "bend");
  EXPECT_EQ(scene.motion->animations[1].name, "walk");
  EXPECT_EQ(scene.motion->animations[2].name, "bend_2");
  EXPECT_EQ(scene.motion->animations[3].name, "bend_3");
  EXPECT_EQ(scene.motion->nodes.size(), 8u);
  EXPECT_EQ(scene.motion->rigs[2].skin, 1u);
  for (std::uint32_t m = 0; m < 4; ++m) EXPECT_EQ(scene.motion->rigs[m].mesh, m);
  const auto rest = positions_of(scene);
  const auto first = positions_of(posed(scene, {"bend", 1})), second = positions_of(posed(scene, {"bend_2", 1}));
  EXPECT_EQ(first[0], posed(imported(bending()), {"", 1}).meshes[0].positions) << "as alone";
  EXPECT_EQ(second[2], posed(imported(bending(), {.translate = {5, 0, 0}}), {"", 1}).meshes[0].positions);
  EXPECT_EQ(first[2], rest[2]) << "another file's animation does not move it";
  EXPECT_EQ(second[0], rest[0]);
  EXPECT_EQ(posed(scene, {"walk", 1}).meshes[1].positions[0], glm::vec3(0, 0, 2));
}

TEST(import_motion, names_of_animations_become_plain) {
  MeshFile file = walking();
  for (const char* name : {"Walk!", "", "\x1b\xff", "walk_"}) {
    file.motion.animations.push_back(file.motion.animations[0]);
    file.motion.animations.back().name = name;
  }
  file.motion.animations.push_back(file.motion.animations[0]);
  file.motion.animations.back().name = std::string(1000, 'a');
  const std::vector<Animation> animations = imported(file).motion->animations;
  const char* const expected[] = {"walk", "walk_", "animation", "animation_2", "walk__2"};
  for (int a = 0; a < 5; ++a) EXPECT_EQ(animations[a].name, expected[a]);
  EXPECT_TRUE(is_plain_name(animations[5].name)) << animations[5].name;
}

// --- vertices ---

TEST(import_motion, vertices_of_a_rigid_mesh_are_those_of_a_still_one) {
  MeshFile file = walking();
  ImportedMesh& mesh = file.meshes[0];
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, -0.0, 0}, {1, 1, 0}, {7, 7, 7}};
  mesh.add_triangle(3, 4, 5);  // repeats two corners; vertex 6 has no face
  const Scene moving = imported(file);
  mesh.nodes.clear();
  const Scene still = imported(file);
  EXPECT_TRUE(same_bits(moving.meshes[0].positions, still.meshes[0].positions));
  EXPECT_EQ(moving.meshes[0].triangles, still.meshes[0].triangles);
  EXPECT_EQ(moving.meshes[0].positions.size(), 4u);
  EXPECT_EQ(moving.motion->rigs[0].base.size(), 4u);
}

TEST(import_motion, vertices_that_may_part_are_not_welded) {
  // Two triangles side by side, whose six corners are four positions: corners 3 and 4 repeat 2 and 1.
  const auto vertex_count = [](const std::function<void(ImportedMesh&)>& change) {
    MeshFile file = bending();
    ImportedMesh& mesh = file.meshes[0];
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}};
    mesh.add_triangle(3, 4, 5);
    mesh.targets.assign(12, glm::dvec3(0, 0, 1));
    mesh.joints = {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
    mesh.weights.assign(12, 0.5);
    change(mesh);
    const Scene scene = imported(file);
    EXPECT_EQ(scene.motion->rigs[0].base.size(), scene.meshes[0].positions.size());
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
    return scene.meshes[0].positions.size();
  };
  EXPECT_EQ(vertex_count([](ImportedMesh&) {}), 4u) << "all alike: welded";
  EXPECT_EQ(vertex_count([](ImportedMesh& mesh) { mesh.targets[6 + 3] = glm::dvec3(0, 0, 2); }), 5u) << "the second target";
  EXPECT_EQ(vertex_count([](ImportedMesh& mesh) { mesh.joints[2 * 3 + 1] = 0; }), 5u);
  EXPECT_EQ(vertex_count([](ImportedMesh& mesh) { mesh.weights[2 * 4] = 0.25; }), 5u);
  EXPECT_EQ(vertex_count([](ImportedMesh& mesh) {
              mesh.base = mesh.positions;
              mesh.base[3].z = 1;
              mesh.base[4].z = 1;
            }),
            6u);
  EXPECT_EQ(vertex_count([](ImportedMesh& mesh) {
              for (const std::size_t i : {4, 6}) mesh.weights[i] = 0;
              mesh.joints[4] = 1;
              mesh.joints[6] = 77;
            }),
            4u)
      << "a joint of weight 0 counts for nothing, whatever it is";
}

TEST(import_motion, a_mesh_of_no_size_in_the_files_pose_is_there_later) {
  MeshFile file = walking();
  file.motion.nodes[0].scale = glm::dvec3(0);
  file.motion.animations[0].tracks = {track(0, Track::Property::scale, {0, 0, 0, 1, 1, 1})};
  file.meshes[0].places = {node_matrix({0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0})};
  file.meshes.push_back(triangle("still", 0));
  file.meshes[1].nodes.clear();
  Scene scene = imported(file);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].positions.size(), 3u);
  Scene later = posed(scene, {"walk", 1});
  finish_scene(later, "test");
  EXPECT_EQ(later.meshes.size(), 2u);
  EXPECT_EQ(later.meshes[0].positions[2], glm::vec3(0, 1, 0));
  finish_scene(scene, "test");
  ASSERT_EQ(scene.meshes.size(), 2u) << "a row that follows the animation needs it";
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  ASSERT_TRUE(scene.motion);
  EXPECT_EQ(scene.motion->rigs.size(), 1u);
}

TEST(import_motion, triangles_that_a_masked_mesh_has_twice_are_merged) {
  MeshFile file = walking();
  file.mask_images.push_back(
      {.name = "leaf.png", .bytes = {}, .width = 2, .height = 1, .alpha = {255, 0}, .colors = {}, .failure = {}});
  ImportedMesh& mesh = file.meshes[0];
  mesh.mask.image = 0;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.uv = {{0, 0}, {1, 0}, {0, 1}, {0, 0}, {1, 0}, {0, 1}};
  mesh.add_triangle(5, 4, 3);
  const Scene scene = imported(file);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
  EXPECT_EQ(scene.meshes[0].uv.size(), 3u);
  EXPECT_EQ(scene.motion->rigs[0].base.size(), 3u);
  EXPECT_TRUE(has_note(scene, "1 triangle of masked meshes is an exact duplicate"));
}

// --- what does not change ---

TEST(import_motion, the_hash_of_a_scene_has_no_motion_and_copies_share_it) {
  Scene scene = imported(bending());
  scene.lights = {{"a", PointLight{{0, 5, 0}}}};
  scene.views = {{}};
  Scene still = scene;
  still.motion = nullptr;
  EXPECT_EQ(scene_hash(scene, std::vector<std::string>{}), scene_hash(still, std::vector<std::string>{}));
  EXPECT_EQ(in_channel(scene, Channel::red).motion, scene.motion);
}

}  // namespace import_motion_test
