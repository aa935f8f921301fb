#pragma once
// Scenes that move, for adjacency and shadow volumes that follow them: boxes that touch and part, bodies whose triangles lose
// their area for a while, and the generated scenes.
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/random.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "generated_scene.h"
#include "measure/scene/motion_data.h"
#include "measure/scene/posed_scene.h"
#include "small_world.h"

namespace moving_volumes {
using namespace gnomon;
using small_world::box;
using small_world::mask_of;

/// Meshes of `touching_boxes`.
enum : std::uint32_t { ground, left, right, walker, folder, vanisher, mesh_count };
/// Seconds at which the folder's triangles, and the vanisher's, have no area.
constexpr double folded = 1, vanished = 1.5;

/// The same with its vertices in the opposite order.
inline Mesh numbered_backwards(Mesh mesh) {
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  std::ranges::reverse(mesh.positions);
  for (glm::uvec3& t : mesh.triangles) t = last - t;
  return mesh;
}

/// The scene is then one of a row that follows an animation.
inline void follow_animation(Scene& scene) {
  for (const Rig& rig : scene.motion->rigs) scene.meshes[rig.mesh].reach.add(scene.meshes[rig.mesh].positions);
}

/// Two boxes that stand still and share a face, and in 2 s of animation `move`
///   walker    stands at a face of the right one, and walks away from it by 2 m;
///   folder    is a cube of which one corner comes to another one, and goes back;
///   vanisher  is a box that shrinks to a point, and grows again.
inline Scene touching_boxes() {
  Scene scene{.name = "touching"};
  scene.meshes = {small_world::ground(5),
                  box({-1, 0.25f, -0.5f}, {0, 1.25f, 0.5f}),
                  box({0, 0.25f, -0.5f}, {1, 1.25f, 0.5f}),
                  numbered_backwards(box({1, 0.25f, -0.5f}, {2, 1.25f, 0.5f})),
                  box({-2, 1, 1}, {-1, 2, 2}),
                  box({0.5f, 1.5f, 1}, {1.5f, 2.25f, 1.75f})};
  auto motion = std::make_shared<Motion>();
  motion->nodes.resize(3);
  for (std::uint32_t k = 0; k < 3; ++k) motion->rigs.push_back(rig_at_rest(scene, walker + k, k));
  Rig& folding = motion->rigs[1];
  folding.targets.assign(8, {});
  folding.targets[7] = folding.base[3] - folding.base[7];
  motion->nodes[1].weights = {0};
  const auto track = [](std::uint32_t node, Track::Property property, std::vector<double> times, std::vector<double> values) {
    return Track{node, property, Track::Interpolation::linear, std::move(times), std::move(values)};
  };
  using Property = Track::Property;
  motion->animations = {
      {"move",
       {track(0, Property::translation, {0, 2}, {0, 0, 0, 2, 0, 0}), track(1, Property::weights, {0, folded, 2}, {0, 1, 0}),
        track(2, Property::scale, {0, vanished, 2}, {1, 1, 1, 0, 0, 0, 1, 1, 1})}}};
  scene.motion = std::move(motion);
  scene.lights = {{.name = "point", .kind = PointLight{{0.75f, 6, 1.5f}}},
                  {.name = "sun", .kind = DirectionalLight{{0.25f, -1, -0.5f}}}};
  scene.views = {{.name = "view", .eye = {1, 5, 7}, .target = {0, 0.5f, 0}}};
  for (std::uint32_t m = 0; m < mesh_count; ++m) scene.meshes[m].name = fmt::format("mesh_{}", m);
  finish_meshes(scene);
  follow_animation(scene);
  return scene;
}

inline std::vector<Scene> all_scenes() {
  std::vector<Scene> scenes;
  scenes.push_back(touching_boxes());
  scenes.push_back(generated::make("walking_boxes", "count=5"));
  scenes.push_back(generated::make("bending_tube", "rings=12,segments=8,joints=4"));
  scenes.push_back(generated::make("swarm", "count=40,reach=1.6"));
  for (Scene& scene : scenes) {
    finish_meshes(scene);
    follow_animation(scene);
  }
  return scenes;
}

/// Goes through the poses of its first animation.
class Posed {
 public:
  explicit Posed(Scene the_scene) : scene_(std::move(the_scene)), posed_(scene_) { go_to(0); }

  const Scene& scene() const { return scene_; }
  double seconds() const { return scene_.motion->animations[0].end(); }
  /// What moved since the last call.
  Changes go_to(double at) {
    posed_.go_to(RowPose{.animation = scene_.motion->animations[0].name, .seconds = at});
    return posed_.take_changes();
  }
  /// Anywhere; now and then where it was, and of touching boxes where triangles have no area.
  Changes go_anywhere(Random& random) {
    const std::uint32_t kind = random.below(5);
    if (kind == 1 && scene_.name == "touching") at_ = random.below(2) ? folded : vanished;
    if (kind > 1) at_ = random.uniform(0, seconds());
    return go_to(at_);
  }

 private:
  Scene scene_;
  PosedScene posed_;
  double at_ = 0;
};

/// What a technique counted, as text, without bytes.
inline std::string work_of(const Technique& technique) {
  std::string text;
  for (const Count& count : technique.counts())
    if (count.unit != "byte") text += fmt::format("{} {}, ", count.name, count.value);
  return text;
}
inline double bytes_of(const Technique& technique) {
  for (const Count& count : technique.counts())
    if (count.name == "bytes") return count.value;
  return 0;
}

}  // namespace moving_volumes
