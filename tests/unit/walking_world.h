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

/// The scene in a row of frames 0 .. 8, at the first one. Of `lift` the ground and the first box stand still, 14 triangles, and
/// the second box moves, 12 triangles; of `walk` both boxes move.
struct Row {
  Scene scene;
  PosedScene posed;
  std::string animation;
  int width;  ///< of its pictures, pixels

  explicit Row(std::string animation = "lift", Scene with = walking_scene(), int width = 96)
      : scene(std::move(with)), posed(scene), animation(std::move(animation)), width(width) {
    go_to(0);
    posed.take_changes();
  }
  void go_to(int frame) { posed.go_to(in_row(frame / 8.0, animation)); }
  const Light& point() const { return scene.lights[0]; }
  const Light& sun() const { return scene.lights[1]; }
  GBuffer picture() const { return small_world::make_gbuffer(scene, scene.views[0], width, width * 3 / 4); }
};

/// A technique, set up and built; `more` may set what `settings` set.
inline std::unique_ptr<Technique> made(const std::string& id, const std::string& settings, const Scene& scene,
                                       const std::string& more = "") {
  auto technique = registry().technique(id).make();
  technique->apply(settings);
  technique->apply(more);
  technique->setup();
  technique->build(scene);
  return technique;
}

/// Moves the scene there, and has others come along.
inline WantedPose moved_to(PosedScene& posed, const RowPose& at) {
  posed.go_to(at);
  return {at, posed.hash()};
}

}  // namespace walking_world
