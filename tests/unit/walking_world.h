#pragma once
// A small scene that moves, and its poses.
#include <gnomon/kit/geometry/circling.h>

#include "measure/scene/posed_scene.h"
#include "small_world.h"

namespace walking_world {
using namespace gnomon;

/// A ground that stands still and two boxes. Animation `walk` moves both by 2 m along x in a second, `lift` the second one up
/// by 1 m in a second. Whole eighths of a second are exact in float32, and at 0 s all is as at rest.
inline Scene walking_scene() {
  Scene scene;
  scene.name = "walking";
  scene.meshes = {small_world::ground(4), small_world::box({-1.5f, 0.5f, -0.5f}, {-1, 1, 0.5f}),
                  small_world::box({-0.5f, 1, -0.25f}, {0, 1.5f, 0.25f})};
  const auto moved = [](std::uint32_t node, const glm::dvec3& by) {
    return Track{.node = node, .times = {0, 1}, .values = {0, 0, 0, by.x, by.y, by.z}};
  };
  auto motion = std::make_shared<Motion>();
  motion->nodes.resize(2);
  motion->animations = {{"walk", {moved(0, {2, 0, 0}), moved(1, {2, 0, 0})}}, {"lift", {moved(1, {0, 1, 0})}}};
  motion->rigs = {rig_at_rest(scene, 1, 0), rig_at_rest(scene, 2, 1)};
  scene.motion = std::move(motion);
  scene.lights = {{.name = "point", .kind = PointLight{{1, 6, 1}}},
                  {.name = "sun", .kind = DirectionalLight{{0.5f, -2, 0.25f}}}};
  scene.views = {View{.eye = {1, 6, 7}}};
  return scene;
}

/// A second of an animation at eight frames a second.
inline RowPose in_row(double seconds, const std::string& animation = "walk") {
  return {.animation = animation, .seconds = seconds, .start = 0, .frame_rate = 8, .frames = 9};
}

/// Moves the scene there, and has others come along.
inline WantedPose moved_to(PosedScene& posed, const RowPose& at) {
  posed.go_to(at);
  return {at, posed.hash()};
}

}  // namespace walking_world
