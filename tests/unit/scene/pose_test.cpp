// Poses of scenes, against positions derived on paper.
#include "measure/scene/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <utility>

#include "error_words.h"
#include "measure/scene/base_scene.h"

namespace pose_test {

using namespace gnomon;
using error_words::error_of;
using error_words::expect_words;
using Property = Track::Property;

/// A scene with a mesh m0, m1, ... for each rig: its base as it is, rounded.
Scene scene_of(Motion motion) {
  Scene scene{.name = "here"};
  for (std::size_t r = 0; r < motion.rigs.size(); ++r) {
    motion.rigs[r].mesh = static_cast<std::uint32_t>(r);
    Mesh mesh{.name = fmt::format("m{}", r)};
    for (const glm::dvec3& p : motion.rigs[r].base) mesh.positions.emplace_back(p);
    scene.meshes.push_back(std::move(mesh));
  }
  scene.motion = std::make_shared<const Motion>(std::move(motion));
  return scene;
}

std::vector<glm::vec3> posed(const Motion& motion, double seconds, std::size_t mesh = 0) {
  Scene scene = scene_of(motion);
  pose(scene, scene.motion->animations[0], seconds);
  return scene.meshes[mesh].positions;
}

void expect_near(const glm::vec3& p, const glm::dvec3& expected) {
  EXPECT_LE(extent(glm::dvec3(p) - expected), 1e-6)
      << '(' << p.x << ", " << p.y << ", " << p.z << ") for (" << expected.x << ", " << expected.y << ", " << expected.z << ')';
}

const double half_turn = std::sqrt(0.5);  ///< sine and cosine of 45 degrees: of a quaternion of 90

/// From nothing to this value within a second.
Track moved_to(std::uint32_t node, const glm::dvec3& offset) {
  return {.node = node, .times = {0, 1}, .values = {0, 0, 0, offset.x, offset.y, offset.z}};
}
Track turned_about_z(std::uint32_t node) {
  return {.node = node, .property = Property::rotation, .times = {0, 1}, .values = {0, 0, 0, 1, 0, 0, half_turn, half_turn}};
}

/// A bone at (0, 1, 0) that turns by 90 degrees about z within a second, and its root, which stands; one vertex at (0, 2, 0)
/// with these weights of root and bone.
Motion arm(const std::vector<double>& weights) {
  Motion motion;
  motion.nodes = {{}, {.parent = 0, .translation = {0, 1, 0}}};
  motion.animations = {{"bend", {turned_about_z(1)}}};
  motion.skins = {{{0, 1}, {glm::dmat4(1), glm::translate(glm::dmat4(1), glm::dvec3(0, -1, 0))}}};
  motion.rigs = {{.node = 0, .skin = 0, .base = {{0, 2, 0}}, .joints_per_vertex = 2, .joints = {0, 1}, .weights = weights}};
  return motion;
}

/// One node that its animation moves to (4, 0, 0), and a triangle there.
Motion slide() {
  Motion motion;
  motion.nodes.resize(1);
  motion.animations = {{"slide", {moved_to(0, {4, 0, 0})}}};
  motion.rigs = {{.base = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
  return motion;
}

TEST(Pose, of_a_skin_is_the_weighted_sum_of_its_joints_places) {
  // The bone takes (0, 2, 0), which is (0, 1, 0) above it, to (-1, 0, 0) beside it: (-1, 1, 0).
  expect_near(posed(arm({0, 1}), 0)[0], {0, 2, 0});
  expect_near(posed(arm({0, 1}), 1)[0], {-1, 1, 0});
  expect_near(posed(arm({0.5, 0.5}), 1)[0], {-0.5, 1.5, 0});
}

TEST(Pose, uses_weights_as_they_are_given) {
  expect_near(posed(arm({0, 0.5}), 1)[0], {-0.5, 0.5, 0});
  expect_near(posed(arm({1, 1}), 1)[0], {-1, 3, 0});
  expect_near(posed(arm({0, 0}), 1)[0], {0, 0, 0});
}

TEST(Pose, morphs_before_the_skin) {
  // Half of (2, 0, 0) takes the vertex to (1, 2, 0), which is (1, 1, 0) from the bone; turned (-1, 1, 0): (-1, 2, 0).
  Motion motion = arm({0, 1});
  motion.nodes[0].weights = {0.5};
  motion.rigs[0].targets = {{2, 0, 0}};
  expect_near(posed(motion, 1)[0], {-1, 2, 0});
}

TEST(Pose, adds_joints_and_targets_in_their_order_and_leaves_out_those_of_weight_0) {
  // 1e30 - 1e30 + 1 is 1, while 1e30 + 1 - 1e30 is 0; what weighs nothing may be infinite.
  constexpr double big = 1e30, infinite = std::numeric_limits<double>::infinity();
  const auto at = [](double x) { return glm::translate(glm::dmat4(1), glm::dvec3(x, 0, 0)); };
  Motion skinned;
  skinned.nodes = {{.matrix = at(big)}, {.matrix = at(-big)}, {.matrix = at(1)}, {.matrix = at(infinite)}, {}};
  skinned.animations = {{"any", {moved_to(4, {0, 0, 0})}}};
  skinned.skins = {{{0, 1, 2, 3, 4}, std::vector(5, glm::dmat4(1))}};
  skinned.rigs = {{.node = 4,
                   .skin = 0,
                   .base = {{0, 0, 0}, {0, 0, 0}},
                   .joints_per_vertex = 4,
                   .joints = {0, 3, 1, 2, 0, 3, 2, 1},
                   .weights = {1, 0, 1, 1, 1, 0, 1, 1}}};
  EXPECT_EQ(posed(skinned, 0), (std::vector<glm::vec3>{{1, 0, 0}, {0, 0, 0}}));

  Motion morphed = slide();
  morphed.nodes[0].weights = {1, 0, 1, 1};
  morphed.rigs[0].base = {{0, 0, 0}, {0, 0, 0}};
  morphed.rigs[0].targets = {{big, 0, 0},  {big, 0, 0}, {infinite, 0, 0}, {0, infinite, 0},
                             {-big, 0, 0}, {1, 0, 0},   {1, 0, 0},        {-big, 0, 0}};
  EXPECT_EQ(posed(morphed, 0), (std::vector<glm::vec3>{{1, 0, 0}, {0, 0, 0}}));
}

TEST(Pose, moves_what_is_below_a_node) {
  // From the inside: scaled by 2 to (2, 0, 0), moved by (0, 3, 0), turned by 90 degrees about z to (-3, 2, 0), moved by 10.
  Motion motion;
  motion.nodes = {{.translation = {10, 0, 0}}, {.parent = 0}, {.parent = 1, .translation = {0, 3, 0}, .scale = {2, 2, 2}}};
  motion.animations = {{"turn", {turned_about_z(1)}}};
  motion.rigs = {{.node = 2, .base = {{1, 0, 0}}}};
  expect_near(posed(motion, 1)[0], {7, 2, 0});
  expect_near(posed(motion, 0)[0], {12, 3, 0});
}

TEST(Pose, places_last_as_the_description_says) {
  // At (4, 0, 0) and beside it; doubled, turned by 90 degrees about y to -z, lifted by 1.
  Motion motion = slide();
  motion.rigs[0].placement = {.scale = glm::dvec3(2), .rotate_degrees = {0, 90, 0}, .translate = {0, 1, 0}};
  EXPECT_EQ(posed(motion, 1), (std::vector<glm::vec3>{{0, 1, -8}, {0, 1, -10}, {0, 3, -8}}));
}

TEST(Pose, ignores_the_node_of_a_mesh_with_a_skin) {
  Motion motion = arm({0, 1});
  motion.nodes.push_back({.translation = {50, 0, 0}});
  motion.rigs[0].node = 2;
  expect_near(posed(motion, 1)[0], {-1, 1, 0});
}

TEST(Pose, moves_weights_of_targets) {
  Motion motion = slide();
  motion.nodes[0].weights = {0, 0};
  motion.animations[0].tracks = {
      {.property = Property::weights, .times = {0, 2}, .values = {0, 0, 1, 0.5}}};  // at 1 s: 0.5 and 0.25
  motion.rigs[0].targets = {{8, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 4, 0}, {0, 0, 0}, {0, 0, 4}};
  EXPECT_EQ(posed(motion, 1), (std::vector<glm::vec3>{{4, 1, 0}, {1, 0, 0}, {0, 1, 1}}));
}

TEST(Pose, of_a_file_s_own_values_is_where_the_importer_puts_it) {
  Motion motion = slide();
  const glm::dvec4 q = glm::normalize(glm::dvec4(0.1, -0.7, 0.3, 0.9)), r = glm::normalize(glm::dvec4(3, 1, -2, 7));
  const glm::dvec3 t(0.1, 1.0 / 3, -7.7), s(1.1, 0.9, -1.3);
  motion.nodes = {{.translation = t, .rotation = q, .scale = s}, {.parent = 0, .translation = s, .rotation = r, .scale = t}};
  const Placement placement{.scale = glm::dvec3(0.3), .rotate_degrees = {10, 20, 90}, .translate = {0.1, 0.2, 0.3}};
  motion.rigs = {{.node = 1, .placement = placement, .base = {{0.1, 0.2, 0.3}, {-1.7, 9.9, 3.1}}}};
  motion.animations = {{"still",
                        {{.node = 0, .property = Property::rotation, .times = {0}, .values = {q.x, q.y, q.z, q.w}},
                         {.node = 1, .property = Property::scale, .times = {0}, .values = {t.x, t.y, t.z}}}}};
  const glm::dmat4 place = node_matrix(t, q, s) * node_matrix(s, r, t);
  EXPECT_EQ(node_matrices(motion, nullptr, 0)[1], place);
  EXPECT_EQ(node_matrices(motion, &motion.animations[0], 0.7)[1], place);
  const std::vector<glm::vec3> positions = posed(motion, 0.7);
  for (std::size_t v = 0; v < 2; ++v)
    EXPECT_EQ(positions[v], glm::vec3(placement.apply(glm::dvec3(place * glm::dvec4(motion.rigs[0].base[v], 1)))));
}

TEST(Pose, leaves_alone_what_an_animation_does_not_move) {
  Motion motion = slide();
  motion.nodes.resize(2);
  motion.rigs.push_back({.node = 1, .base = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  Scene scene = scene_of(motion);
  const std::vector<glm::vec3> odd = {{0.1f, -0.0f, 0}, {7, 7, 7}, {3, 2, 1}};  // not where its rig would place it
  scene.meshes[1].positions = odd;
  scene.meshes[1].shape = Box{};
  scene.meshes.push_back({.name = "no rig", .positions = odd});
  pose(scene, scene.motion->animations[0], 0.5);
  EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(2, 0, 0));
  EXPECT_EQ(scene.meshes[1].positions, odd);
  EXPECT_TRUE(std::signbit(scene.meshes[1].positions[0].y));
  EXPECT_TRUE(scene.meshes[1].shape);
  EXPECT_EQ(scene.meshes[2].positions, odd);
  EXPECT_TRUE(scene.notes.empty());
}

TEST(Pose, drops_the_exact_shape_of_what_moves) {
  Motion motion = slide();
  motion.rigs.push_back(motion.rigs[0]);
  Scene scene = scene_of(motion);
  scene.meshes[0].shape = Sphere{};
  scene.meshes[1].shape = Box{};
  for (const double t : {0.5, 1.0}) pose(scene, scene.motion->animations[0], t);
  EXPECT_FALSE(scene.meshes[0].shape || scene.meshes[1].shape);
  EXPECT_EQ(scene.notes, std::vector<std::string>{"mesh 'm0' moves: its triangles are taken, not its exact shape"});
}

TEST(Pose, takes_the_same_scene_to_any_time_and_back) {
  Scene scene = scene_of(slide());
  const std::vector<glm::vec3> before = scene.meshes[0].positions;
  for (const double t : {1.0, 0.25, 9.0, 0.0}) pose(scene, scene.motion->animations[0], t);
  EXPECT_EQ(scene.meshes[0].positions, before);
}

TEST(Pose, refuses_positions_out_of_range_with_mesh_vertex_and_time_and_moves_nothing) {
  Motion motion = slide();
  motion.rigs.push_back(motion.rigs[0]);
  motion.rigs[1].node = 1;
  motion.nodes.resize(2);
  motion.animations = {
      {"grow",
       {moved_to(0, {1, 0, 0}), {.node = 1, .property = Property::scale, .times = {0, 2}, .values = {1, 1, 1, 1e300, 1, 1}}}}};
  Scene scene = scene_of(motion);
  const std::vector<glm::vec3> before = scene.meshes[0].positions;
  expect_words(
      error_of([&] { pose(scene, scene.motion->animations[0], 1.5); }),
      {"mesh 'm1', vertex 1: position = (7.5e+299, 0, 0) at 1.5 s of animation 'grow'", std::string(coordinate_range)});
  EXPECT_EQ(scene.meshes[0].positions, before);

  // Half way between a turn and its opposite, cubic keys pass through a quaternion of length 0.
  motion.animations = {{"flip",
                        {{.node = 0,
                          .property = Property::rotation,
                          .interpolation = Track::Interpolation::cubic,
                          .times = {0, 1},
                          .values = {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, 0, 0}}}}};
  scene = scene_of(motion);
  expect_words(error_of([&] { pose(scene, scene.motion->animations[0], 0.5); }),
               {"the rotation of node 0 is no turn at 0.5 s", "passes (0, 0, 0, 0)", "animation 'flip'"});
}

TEST(Pose, refuses_times_that_are_none) {
  Scene scene = scene_of(slide());
  const auto error_at = [&](double t) { return error_of([&] { freeze(scene, {.seconds = t}); }); };
  EXPECT_EQ(error_at(-1), "time = -1 is below 0");
  EXPECT_EQ(error_at(std::numeric_limits<double>::infinity()), "time = inf is not a finite number of seconds");
  expect_words(error_at(std::nan("")), {"nan is not a finite number of seconds"});
  EXPECT_TRUE(scene.motion);
}

TEST(Pose, of_several_animations_is_that_of_the_one_that_is_named_or_the_first) {
  Motion motion = slide();
  motion.animations.push_back({"jump", {moved_to(0, {0, 6, 0})}});
  const auto frozen = [&](const PoseTime& at) {
    Scene scene = scene_of(motion);
    freeze(scene, at);
    EXPECT_FALSE(scene.motion);
    return scene.meshes[0].positions[0];
  };
  EXPECT_EQ(frozen({"", 0.5}), glm::vec3(2, 0, 0));
  EXPECT_EQ(frozen({"slide", 0.5}), glm::vec3(2, 0, 0));
  EXPECT_EQ(frozen({"jump", 0.5}), glm::vec3(0, 3, 0));
  EXPECT_EQ(frozen({"jump", 7}), glm::vec3(0, 6, 0));
  const Scene scene = scene_of(motion);
  expect_words(error_of([&] { animation_of(scene, "jum"); }),
               {"scene here has no animation jum", "did you mean jump?", "It has: slide, jump"});
  Scene still{.name = "still"};
  expect_words(error_of([&] { freeze(still, {.seconds = 1}); }), {"scene still has no animation"});
}

TEST(Pose, finds_what_an_animation_moves) {
  // Nodes: 0 above 1 above 2, and 3 alone. Rigs: at each node, a skin of 1 and 3 at node 2, and targets at node 3.
  Motion motion;
  motion.nodes = {{}, {.parent = 0}, {.parent = 1}, {.weights = {0}}};
  motion.skins = {{{1, 3}, {glm::dmat4(1), glm::dmat4(1)}}};
  for (std::uint32_t node = 0; node < 4; ++node) motion.rigs.push_back({.node = node, .base = {{0, 0, 0}}});
  motion.rigs.push_back({.node = 2, .skin = 0, .base = {{0, 0, 0}}});
  motion.rigs.push_back({.node = 3, .base = {{0, 0, 0}}, .targets = {{1, 0, 0}}});
  const auto moved_by = [&](std::uint32_t node, Property property) {
    const Animation animation{"any", {{.node = node, .property = property, .times = {0}, .values = {1, 1, 1}}}};
    const std::vector<bool> moved = moved_rigs(motion, animation);
    std::string digits;
    for (std::size_t r = 0; r < moved.size(); ++r) {
      EXPECT_EQ(moves(motion, animation, motion.rigs[r]), moved[r]);
      digits += moved[r] ? '1' : '0';
    }
    return digits;
  };
  EXPECT_EQ(moved_by(0, Property::translation), "111010");
  EXPECT_EQ(moved_by(1, Property::scale), "011010");
  EXPECT_EQ(moved_by(2, Property::rotation), "001000");
  EXPECT_EQ(moved_by(3, Property::translation), "000111");
  EXPECT_EQ(moved_by(3, Property::weights), "000001");
  EXPECT_EQ(moved_by(2, Property::weights), "000000");
}

}  // namespace pose_test
