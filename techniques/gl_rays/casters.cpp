#include "casters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace gnomon::gl_rays {

namespace {

/// Numbers of what meshes have of a kind, each once, in the order of the first meshes that have it; -1: nothing.
template <class Held>
std::vector<std::int32_t> numbered(const Scene& scene, std::shared_ptr<const Held> Mesh::*member) {
  std::map<const Held*, std::int32_t> number_of{{nullptr, -1}};
  std::vector<std::int32_t> numbers;
  for (const Mesh& mesh : scene.meshes)
    numbers.push_back(number_of.emplace((mesh.*member).get(), static_cast<std::int32_t>(number_of.size()) - 1).first->second);
  return numbers;
}

/// The corners of a triangle in the frame. Where a mesh moves, three places in a line become one, which no ray meets: float32
/// might give them an area. Such triangles of other meshes were dropped at load.
std::array<glm::vec3, 3> placed(const Mesh& mesh, std::uint32_t triangle, float scale) {
  const glm::uvec3& t = mesh.triangles[triangle];
  const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  if (!mesh.reach.empty() && is_degenerate(a, b, c)) return {scale * a, scale * a, scale * a};
  return {scale * a, scale * b, scale * c};
}

}  // namespace

std::size_t caster_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.casts) count += mesh.triangles.size();
  return count;
}

Support tree_support(std::size_t triangles, std::optional<std::size_t> device_texels) {
  constexpr std::size_t texels_per_triangle = 2 * sizeof(Node) / texel_bytes;
  const std::size_t most = std::min(device_texels.value_or(most_items * texels_per_triangle) / texels_per_triangle, most_items);
  if (triangles <= most) return Support::full();
  return Support::unsupported(
      fmt::format("{} triangles cast; the OpenGL device can read a tree over {} from a buffer", triangles, most));
}

Casters::Frame::Frame(const Scene& scene) {
  double extent = 0;
  for (const Mesh& mesh : scene.meshes) extent = std::max(extent, mesh.reached().extent());
  if (extent != 0 && (extent < 0x1p-10 || extent > 0x1p30))
    scale = static_cast<float>(std::exp2(std::min(-std::ilogb(extent), 100)));
  growth = static_cast<float>(0x1p-23 * scale * extent);
}

Casters::Casters(const Scene& scene) { build(scene); }

void Casters::build(const Scene& scene) {
  numbers_ = TriangleNumbers(scene);
  frame_ = Frame(scene);
  const std::vector<std::int32_t> masks = numbered(scene, &Mesh::alpha_mask), glass = numbered(scene, &Mesh::transmission);
  corners_.clear();
  corners_.reserve(3 * caster_count(scene));
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.casts) continue;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::int32_t tags[] = {static_cast<std::int32_t>(numbers_.first_of(m) + t), masks[m], glass[m]};
      const std::array<glm::vec3, 3> at = placed(mesh, t, frame_.scale);
      for (int k = 0; k < 3; ++k) corners_.push_back({at[k], tags[k]});
    }
  }
  std::vector<Bounds> boxes(triangle_count());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = box_at(i);
  tree_ = build_nodes(boxes);
  std::vector<Corner> ordered;
  ordered.reserve(corners_.size());
  for (const std::uint32_t item : tree_.order)
    ordered.insert(ordered.end(), corners_.begin() + 3 * std::ptrdiff_t{item}, corners_.begin() + 3 * std::ptrdiff_t{item} + 3);
  corners_ = std::move(ordered);
  tree_.order = {};
  built_cost_ = cost(tree_.nodes);
}

Bounds Casters::box_at(std::size_t place) const {
  Bounds box;
  for (int k = 0; k < 3; ++k) box.add(corners_[3 * place + k].at);
  return {box.min - frame_.growth, box.max + frame_.growth};
}

bool Casters::update(const Scene& scene, const Changes& changes) {
  if (!has_moved_caster(scene, changes)) return false;
  if (Frame(scene) != frame_) {
    build(scene);
    return true;
  }
  // Neighbors in the tree are of one mesh, mostly.
  std::uint32_t mesh = 0, first = 0, end = 0;
  for (std::size_t i = 0; i < corners_.size(); i += 3) {
    const auto number = static_cast<std::uint32_t>(corners_[i].tag);
    if (number < first || number >= end) {
      mesh = numbers_.mesh_of(number);
      first = numbers_.first_of(mesh);
      end = numbers_.end_of(mesh);
    }
    if (!has_moved(changes, mesh)) continue;
    const std::array<glm::vec3, 3> at = placed(scene.meshes[mesh], number - first, frame_.scale);
    for (int k = 0; k < 3; ++k) corners_[i + k].at = at[k];
  }
  refit(std::span(tree_.nodes), [&](std::size_t place) { return box_at(place); });
  if (is_decayed(cost(tree_.nodes), built_cost_)) build(scene);
  return true;
}

}  // namespace gnomon::gl_rays
