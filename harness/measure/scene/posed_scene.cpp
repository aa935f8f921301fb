#include "measure/scene/posed_scene.h"

#include <gnomon/error.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <span>

#include "measure/scene/blob.h"

namespace gnomon {
namespace {

double time_of(const RowPose& row, int frame) { return row.start + frame / row.frame_rate; }

/// Requests of other programs come here as they are.
void check(const RowPose& at) {
  if (at.animation.empty()) throw Error("a pose has no animation; one is needed");
  if (!(at.start >= 0 && std::isfinite(at.start)))
    throw Error("animation {}: start = {} is not a number of seconds, 0 or more", at.animation, at.start);
  if (!(at.frame_rate > 0 && std::isfinite(at.frame_rate)))
    throw Error("animation {}: frame_rate = {} is not a number of frames per second above 0", at.animation, at.frame_rate);
  if (at.frames < 1 || at.frames > most_motion_frames)
    throw Error("animation {}: frames = {} is outside 1 .. {}", at.animation, at.frames, most_motion_frames);
}

/// Of each rig's mesh the union of its bounds over all times of the row; empty where the animation does not move it.
std::vector<Bounds> reach_over(const RowPose& row, const Scene& scene, const Animation& animation,
                               const std::vector<bool>& moved) {
  std::vector<Bounds> reach(moved.size());
  for (int frame = 0; frame < row.frames; ++frame) {
    const auto posed = posed_positions(scene, animation, time_of(row, frame), moved);
    for (std::size_t r = 0; r < reach.size(); ++r) reach[r].add(posed[r]);
  }
  return reach;
}

bool have_same_bits(const glm::vec3& a, const glm::vec3& b) {
  using Bits = std::array<std::uint32_t, 3>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}
bool have_same_bits(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
  assert(a.size() == b.size());
  for (std::size_t v = 0; v < a.size(); ++v)
    if (!have_same_bits(a[v], b[v])) return false;
  return true;
}

/// Gives a mesh change the range of vertices that holds all that differ. At least one does.
void set_range(std::span<const glm::vec3> before, std::span<const glm::vec3> now, MeshChange& change) {
  std::size_t first = 0, end = now.size();
  while (have_same_bits(before[first], now[first])) ++first;
  while (have_same_bits(before[end - 1], now[end - 1])) --end;
  change.first = static_cast<std::uint32_t>(first);
  change.count = static_cast<std::uint32_t>(end - first);
}

/// World from the base of a rig without a skin: of a matrix only what places points counts.
glm::dmat4 world_from_base(const Rig& rig, const glm::dmat4& world_from_node) {
  const Placement turned{.scale = rig.placement.scale, .rotate_degrees = rig.placement.rotate_degrees, .translate = {}};
  glm::dmat4 placed(1), place = world_from_node;
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 axis(0);
    axis[k] = 1;
    placed[k] = glm::dvec4(turned.apply(axis), 0);
    place[k].w = 0;
  }
  placed[3] = glm::dvec4(rig.placement.apply(glm::dvec3(0)), 1);
  place[3].w = 1;
  return placed * place;
}

/// The inverse of an affine matrix; nothing of one that is flat, but for rounding.
std::optional<glm::dmat4> inverse_of(const glm::dmat4& m) {
  constexpr double least_share = 1e-12;  // of the volume of a box with the same edges
  const glm::dmat3 turn(m);
  const double most = glm::length(turn[0]) * glm::length(turn[1]) * glm::length(turn[2]);
  const double volume = std::abs(glm::determinant(turn));
  if (!(volume > least_share * most) || !std::isfinite(most) || !std::isnormal(volume)) return std::nullopt;
  return glm::inverse(m);
}

/// By which one matrix a mesh moved from some nodes to others; nothing where there is none.
std::optional<glm::dmat4> rigid_move(const Rig& rig, const std::vector<MotionNode>& before, const std::vector<MotionNode>& now,
                                     const glm::dmat4& node_before, const glm::dmat4& node_now) {
  if (rig.skin != Rig::no_skin) return std::nullopt;
  if (!rig.targets.empty() && before[rig.node].weights != now[rig.node].weights) return std::nullopt;
  const std::optional<glm::dmat4> base_from_world = inverse_of(world_from_base(rig, node_before));
  if (!base_from_world) return std::nullopt;
  return world_from_base(rig, node_now) * *base_from_world;
}

Bounds bounds_of(std::span<const glm::vec3> positions) {
  Bounds bounds;
  bounds.add(positions);
  return bounds;
}

}  // namespace

bool RowPose::is_of_row(const RowPose& other) const {
  return animation == other.animation && start == other.start && frame_rate == other.frame_rate && frames == other.frames;
}

std::optional<RowPose> pose_at(const Path& path, int frame) {
  if (path.moves != Path::Moves::geometry) return std::nullopt;
  assert(frame >= 0 && frame < path.frame_count);
  RowPose at{.animation = path.name, .start = path.start, .frame_rate = path.frame_rate, .frames = path.frame_count};
  at.seconds = time_of(at, frame);
  return at;
}

std::string pose_hash(const Scene& scene) {
  std::string hashes;
  for (const Mesh& mesh : scene.meshes) hashes += content_hash(std::as_bytes(std::span(mesh.positions)));
  return content_hash(hashes);
}

PosedScene::PosedScene(Scene& scene) : scene_(scene), taken_number_(scene.pose_number) {
  if (!scene.motion) return;
  for (const Rig& rig : scene.motion->rigs) {
    const Mesh& mesh = scene.meshes[rig.mesh];
    moving_.push_back({mesh.positions, mesh.positions, mesh.shape});
  }
}

bool PosedScene::go_to(const std::optional<RowPose>& at) {
  if (at == now_) return true;
  const bool is_same_row = at && now_ && at->is_of_row(*now_);
  std::vector<bool> moved(moving_.size());
  std::vector<std::vector<glm::vec3>> posed;
  std::vector<Bounds> reach(moving_.size());
  if (at) {
    check(*at);
    const Animation& animation = animation_of(scene_, at->animation);
    moved = moved_rigs(*scene_.motion, animation);
    posed = posed_positions(scene_, animation, at->seconds, moved);
    if (!is_same_row) reach = reach_over(*at, scene_, animation, moved);
  }
  bool has_changed = false;
  for (std::size_t r = 0; r < moving_.size(); ++r) {
    Mesh& mesh = mesh_of(r);
    const std::vector<glm::vec3>& target = moved[r] ? posed[r] : moving_[r].rest;
    if (!have_same_bits(mesh.positions, target)) {
      std::ranges::copy(target, mesh.positions.begin());
      has_changed = true;
    }
    mesh.shape = moved[r] ? std::nullopt : moving_[r].shape;
    if (!is_same_row) mesh.reach = reach[r];
  }
  if (has_changed) ++scene_.pose_number;
  now_ = at;
  hash_.clear();
  return is_same_row;
}

std::vector<MotionNode> PosedScene::nodes_of(const std::optional<RowPose>& at) const {
  const Animation* const animation = at ? &animation_of(scene_, at->animation) : nullptr;
  return nodes_at(*scene_.motion, animation, at ? at->seconds : 0);
}

Changes PosedScene::take_changes() {
  if (taken_bounds_.empty()) {
    for (const Mesh& mesh : scene_.meshes) taken_bounds_.push_back(bounds_of(mesh.positions));
    for (std::size_t r = 0; r < moving_.size(); ++r) taken_bounds_[scene_.motion->rigs[r].mesh] = bounds_of(moving_[r].taken);
  }
  Changes changes;
  for (const Bounds& bounds : taken_bounds_) changes.meshes.push_back({.before = bounds, .after = bounds});
  if (has_moved()) {
    const std::vector<MotionNode> before = nodes_of(taken_at_), now = nodes_of(now_);
    const std::vector<glm::dmat4> matrices_before = node_matrices(before), matrices_now = node_matrices(now);
    for (std::size_t r = 0; r < moving_.size(); ++r) {
      const std::vector<glm::vec3>& positions = mesh_of(r).positions;
      if (have_same_bits(moving_[r].taken, positions)) continue;
      const Rig& rig = scene_.motion->rigs[r];
      MeshChange& change = changes.meshes[rig.mesh];
      set_range(moving_[r].taken, positions, change);
      const auto matrix = rigid_move(rig, before, now, matrices_before[rig.node], matrices_now[rig.node]);
      change.kind = matrix ? MeshChange::Kind::rigid : MeshChange::Kind::deformed;
      if (matrix) change.matrix = *matrix;
      change.after = taken_bounds_[rig.mesh] = bounds_of(positions);
      std::ranges::copy(positions, moving_[r].taken.begin());
    }
  }
  taken_at_ = now_;
  taken_number_ = scene_.pose_number;
  return changes;
}

bool PosedScene::has_moved() const {
  if (scene_.pose_number == taken_number_) return false;
  for (std::size_t r = 0; r < moving_.size(); ++r)
    if (!have_same_bits(moving_[r].taken, mesh_of(r).positions)) return true;
  return false;
}

const std::string& PosedScene::hash() {
  if (now_ && hash_.empty()) hash_ = pose_hash(scene_);
  return hash_;
}

}  // namespace gnomon
