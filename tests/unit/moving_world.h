#pragma once
// A little scene whose meshes move in every way there is, with positions that are derived on paper.
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/geometry/shapes.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hand_made.h"

namespace gnomon::moving_world {

using Property = Track::Property;

/// Meshes of `scene()`.
enum : std::uint32_t { ground, slab, turned, strip, wing, ball, sleeper, mesh_count };

inline Track track(std::uint32_t node, Property property, std::vector<double> values, double seconds = 2) {
  return {.node = node, .property = property, .times = {0, seconds}, .values = std::move(values)};
}

/// Adds a mesh at a node of its own.
inline Rig& add_rigid(Scene& scene, Motion& motion, Mesh mesh) {
  scene.meshes.push_back(std::move(mesh));
  motion.nodes.emplace_back();
  motion.rigs.push_back(rig_at_rest(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1),
                                    static_cast<std::uint32_t>(motion.nodes.size() - 1)));
  return motion.rigs.back();
}

/// Six meshes over a ground. In 2 s `walk`
///   slab     moves by 2 m along x, which in steps of an eighth of that is exact in float32;
///   turned   turns by 90 degrees about y, and is then placed: twice as large, 5 m up;
///   strip    has a skin of two joints, of which the upper one moves by 1 m along z: its last two vertices follow;
///   wing     has a morph target, which moves its last vertex by 1 m up;
///   ball     is a sphere that moves by 1 m along x;
/// and `sleep` grows `sleeper` from no size, which it has at rest, to its own.
inline Scene scene() {
  Scene scene{.name = "moving"};
  Motion motion;
  scene.meshes.push_back(hand_made::square(8, 0));
  add_rigid(scene, motion, hand_made::square(0.5f, 1));
  Rig& placed = add_rigid(scene, motion, hand_made::square(1, 0));
  placed.placement = {.scale = {2, 2, 2}, .rotate_degrees = {}, .translate = {0, 5, 0}};
  for (glm::vec3& p : scene.meshes.back().positions) p = placed.placement.apply(p);

  Rig& skinned =
      add_rigid(scene, motion, hand_made::mesh_of({{0, 2, 0}, {1, 2, 0}, {0, 3, 0}, {1, 3, 0}}, {{0, 1, 2}, {2, 1, 3}}));
  skinned.skin = 0;
  skinned.joints_per_vertex = 1;
  skinned.joints = {0, 0, 1, 1};
  skinned.weights = {1, 1, 1, 1};
  Rig& morphed = add_rigid(scene, motion, hand_made::mesh_of({{3, 1, 0}, {4, 1, 0}, {3, 1, 1}}, {{0, 1, 2}}));
  morphed.targets = {{0, 0, 0}, {0, 0, 0}, {0, 1, 0}};
  motion.nodes[morphed.node].weights = {0};
  add_rigid(scene, motion, tessellate(Sphere{{-4, 2, 0}, 1}, 8, "ball"));
  Rig& asleep = add_rigid(scene, motion, hand_made::square(1, 3));
  motion.nodes[asleep.node].scale = {0, 0, 0};
  for (glm::vec3& p : scene.meshes.back().positions) p = {0, 0, 0};
  for (std::uint32_t m = 0; m < mesh_count; ++m) scene.meshes[m].name = "m" + std::to_string(m);

  const auto node_of = [&](std::uint32_t mesh) { return motion.rigs[mesh - 1].node; };
  const std::uint32_t lower = static_cast<std::uint32_t>(motion.nodes.size()), upper = lower + 1;
  motion.nodes.resize(motion.nodes.size() + 2);
  motion.skins = {{{lower, upper}, {glm::dmat4(1), glm::dmat4(1)}}};
  const double half_turn = std::sqrt(0.5);  // sine and cosine of 45 degrees
  motion.animations = {
      {"walk",
       {track(node_of(slab), Property::translation, {0, 0, 0, 2, 0, 0}),
        track(node_of(turned), Property::rotation, {0, 0, 0, 1, 0, half_turn, 0, half_turn}),
        track(upper, Property::translation, {0, 0, 0, 0, 0, 1}), track(node_of(wing), Property::weights, {0, 1}),
        track(node_of(ball), Property::translation, {0, 0, 0, 1, 0, 0})}},
      {"sleep", {track(node_of(sleeper), Property::scale, {0, 0, 0, 1, 1, 1})}}};
  scene.lights = {hand_made::point_light({0, 4, 0})};
  scene.views = {{.name = "view", .eye = {1, 9, 6}, .target = {0, 0, 0}}};
  scene.motion = std::make_shared<const Motion>(std::move(motion));
  return scene;
}

/// A copy of the motion to change.
inline Motion motion_of(const Scene& scene) { return *scene.motion; }
inline void set_motion(Scene& scene, Motion motion) { scene.motion = std::make_shared<const Motion>(std::move(motion)); }

}  // namespace gnomon::moving_world
