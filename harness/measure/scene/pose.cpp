// Poses a scene: moves the vertices of its meshes to where they are at a time of an animation. The order of arithmetic is the
// importer's (measure/formats/gltf_deform.cpp, measure/scene/import_vertices.cpp), so that a file's own pose gives the imported
// bits.
#include "measure/scene/pose.h"

#include <gnomon/error.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>

#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"
#include "measure/scene/motion_data.h"
#include "measure/scene/names.h"
#include "measure/scene/time_reference.h"

namespace gnomon {
namespace {

std::vector<double> value_at(const Animation& animation, const Track& track, double seconds) {
  try {
    return sampled(track, seconds);
  } catch (const Error& error) {
    throw Error("{} (animation '{}')", error.what(), animation.name);
  }
}

/// Of each node whether an animation moves it, and whether it moves its weights.
struct MovedNodes {
  std::vector<bool> places, weights;

  MovedNodes(const Motion& motion, const Animation& animation) : places(motion.nodes.size()), weights(motion.nodes.size()) {
    for (const Track& track : animation.tracks)
      (track.property == Track::Property::weights ? weights : places)[track.node] = true;
    for (std::size_t n = 0; n < places.size(); ++n)
      if (const std::uint32_t parent = motion.nodes[n].parent; parent != MotionNode::none && places[parent]) places[n] = true;
  }

  bool move(const Motion& motion, const Rig& rig) const {
    if (!rig.targets.empty() && weights[rig.node]) return true;
    if (rig.skin == Rig::no_skin) return places[rig.node];
    return std::ranges::any_of(motion.skins[rig.skin].joints, [&](std::uint32_t joint) { return places[joint]; });
  }
};

/// What all rigs share at one time.
class Pose {
 public:
  Pose(const Motion& motion, const Animation& animation, double seconds)
      : motion_(motion),
        nodes_(nodes_at(motion, &animation, seconds)),
        matrices_(node_matrices(nodes_)),
        joints_(motion.skins.size()) {}

  /// Where a mesh is in double, before it is rounded.
  std::vector<glm::dvec3> points(const Rig& rig) {
    std::vector<glm::dvec3> points = morphed(rig);
    if (rig.skin == Rig::no_skin)
      for (glm::dvec3& p : points) p = glm::dvec3(matrices_[rig.node] * glm::dvec4(p, 1));
    else
      skin(rig, points);
    for (glm::dvec3& p : points) p = rig.placement.apply(p);
    return points;
  }

 private:
  std::vector<glm::dvec3> morphed(const Rig& rig) const {
    std::vector<glm::dvec3> points = rig.base;
    if (rig.targets.empty()) return points;
    const std::vector<double>& weights = nodes_[rig.node].weights;
    assert(rig.targets.size() == weights.size() * points.size());
    std::span<const glm::dvec3> targets(rig.targets);
    for (const double weight : weights) {
      if (weight != 0)
        for (std::size_t v = 0; v < points.size(); ++v) points[v] += weight * targets[v];
      targets = targets.subspan(points.size());
    }
    return points;
  }

  /// Places each vertex by the weighted sum of its joints' matrices, in the order in which the rig has them.
  void skin(const Rig& rig, std::vector<glm::dvec3>& points) {
    assert(rig.joints.size() == rig.joints_per_vertex * points.size() && rig.weights.size() == rig.joints.size());
    const std::vector<glm::dmat4>& matrices = joints_of(rig.skin);
    for (std::size_t v = 0; v < points.size(); ++v) {
      glm::dmat4 sum(0);
      for (std::size_t k = v * rig.joints_per_vertex; k < (v + 1) * rig.joints_per_vertex; ++k)
        if (rig.weights[k] != 0) sum += rig.weights[k] * matrices[rig.joints[k]];
      points[v] = glm::dvec3(sum * glm::dvec4(points[v], 1));
    }
  }

  /// World from mesh at rest, of each joint; found once.
  const std::vector<glm::dmat4>& joints_of(std::uint32_t skin_number) {
    const Skin& skin = motion_.skins[skin_number];
    std::vector<glm::dmat4>& matrices = joints_[skin_number];
    if (matrices.empty())
      for (std::size_t j = 0; j < skin.joints.size(); ++j) matrices.push_back(matrices_[skin.joints[j]] * skin.inverse_bind[j]);
    return matrices;
  }

  const Motion& motion_;
  std::vector<MotionNode> nodes_;
  std::vector<glm::dmat4> matrices_;             ///< world from node
  std::vector<std::vector<glm::dmat4>> joints_;  ///< of each skin that was needed
};

}  // namespace

std::vector<MotionNode> nodes_at(const Motion& motion, const Animation* animation, double seconds) {
  std::vector<MotionNode> nodes = motion.nodes;
  if (!animation) return nodes;
  for (const Track& track : animation->tracks) {
    assert(track.node < nodes.size());
    MotionNode& node = nodes[track.node];
    const std::vector<double> value = value_at(*animation, track, seconds);
    switch (track.property) {
      case Track::Property::translation:
        node.translation = {value[0], value[1], value[2]};
        break;
      case Track::Property::rotation:
        node.rotation = {value[0], value[1], value[2], value[3]};
        break;
      case Track::Property::scale:
        node.scale = {value[0], value[1], value[2]};
        break;
      case Track::Property::weights:
        node.weights = value;
        break;
    }
  }
  return nodes;
}

std::vector<glm::dmat4> node_matrices(const std::vector<MotionNode>& nodes) {
  std::vector<glm::dmat4> matrices;
  matrices.reserve(nodes.size());
  for (const MotionNode& node : nodes) {
    const glm::dmat4 local = node.matrix ? *node.matrix : node_matrix(node.translation, node.rotation, node.scale);
    assert(node.parent == MotionNode::none || node.parent < matrices.size());
    matrices.push_back(node.parent == MotionNode::none ? local : matrices[node.parent] * local);
  }
  return matrices;
}

std::vector<glm::dmat4> node_matrices(const Motion& motion, const Animation* animation, double seconds) {
  return node_matrices(nodes_at(motion, animation, seconds));
}

bool moves(const Motion& motion, const Animation& animation, const Rig& rig) {
  return MovedNodes(motion, animation).move(motion, rig);
}

std::vector<bool> moved_rigs(const Motion& motion, const Animation& animation) {
  const MovedNodes nodes(motion, animation);
  std::vector<bool> moved;
  moved.reserve(motion.rigs.size());
  for (const Rig& rig : motion.rigs) moved.push_back(nodes.move(motion, rig));
  return moved;
}

void add_framing_at_rest(Scene& scene) {
  if (!scene.views.empty() && !scene.lights.empty()) return;
  Scene rest = scene;
  for (Mesh& mesh : rest.meshes) finish(mesh);
  std::erase_if(rest.meshes, [](const Mesh& mesh) { return mesh.triangles.empty(); });
  if (rest.meshes.empty()) return;
  add_framing(rest);
  scene.views = std::move(rest.views);
  scene.lights = std::move(rest.lights);
  scene.notes = std::move(rest.notes);
}

std::vector<std::vector<glm::vec3>> posed_positions(const Scene& scene, const Animation& animation, double seconds,
                                                    const std::vector<bool>& moved) {
  if (!std::isfinite(seconds)) throw Error("time = {} is not a finite number of seconds", seconds);
  if (seconds < 0) throw Error("time = {} is below 0", seconds);
  if (!scene.motion) return {};
  const Motion& motion = *scene.motion;
  assert(moved.size() == motion.rigs.size());
  Pose at(motion, animation, seconds);
  std::vector<std::vector<glm::vec3>> posed(motion.rigs.size());
  for (std::size_t r = 0; r < posed.size(); ++r) {
    if (!moved[r]) continue;
    const Mesh& mesh = scene.meshes[motion.rigs[r].mesh];
    assert(mesh.positions.size() == motion.rigs[r].base.size());
    posed[r].reserve(mesh.positions.size());
    for (const glm::dvec3& p : at.points(motion.rigs[r])) {
      if (!is_sound(p))
        throw Error("mesh '{}', vertex {}: position = ({}, {}, {}) at {} s of animation '{}' is outside {}", mesh.name,
                    posed[r].size(), p.x, p.y, p.z, seconds, animation.name, coordinate_range);
      posed[r].emplace_back(p);
    }
  }
  return posed;
}

void pose(Scene& scene, const Animation& animation, double seconds) {
  const std::vector<bool> moved = scene.motion ? moved_rigs(*scene.motion, animation) : std::vector<bool>();
  const std::vector<std::vector<glm::vec3>> posed = posed_positions(scene, animation, seconds, moved);
  for (std::size_t r = 0; r < posed.size(); ++r) {
    if (!moved[r]) continue;
    Mesh& mesh = scene.meshes[scene.motion->rigs[r].mesh];
    std::ranges::copy(posed[r], mesh.positions.begin());
    if (mesh.has_curved_shape())
      scene.notes.push_back(fmt::format("mesh '{}' moves: its triangles are taken, not its exact shape", mesh.name));
    mesh.shape.reset();
  }
  if (std::ranges::find(moved, true) != moved.end()) ++scene.pose_number;
}

const Animation& animation_of(const Scene& scene, const std::string& name) {
  if (!scene.motion || scene.motion->animations.empty())
    throw Error("scene {} has no animation{}; a time needs one", scene.name,
                without_time(scene.name) == scene.name ? "" : ": it is a still");
  const std::vector<Animation>& animations = scene.motion->animations;
  if (name.empty()) return animations.front();
  require_words({name}, names_of(animations), "animation", scene.name);
  return *find_named(animations, name);
}

void freeze(Scene& scene, const PoseTime& at) {
  pose(scene, animation_of(scene, at.animation), at.seconds);
  merge_duplicates(scene);
  scene.motion = nullptr;
}

}  // namespace gnomon
