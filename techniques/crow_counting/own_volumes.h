#pragma once
#include <gnomon/kit/box_tree.h>
#include <gnomon/kit/receiver.h>

#include <algorithm>

#include "volumes.h"

namespace gnomon::crow_counting {

/// Volumes that hold a point only because of the surface that it lies on, and which therefore never shade it: those of the
/// triangles that kit/receiver.h leaves out.
class OwnVolumes {
 public:
  void build(const Scene& scene) {
    scene_ = &scene;
    numbers_ = TriangleNumbers(scene);
    curved_.clear();
    for (const Mesh& mesh : scene.meshes) {
      curved_.emplace_back();
      if (!mesh.has_curved_shape() || !mesh.casts) continue;
      std::vector<Bounds> bounds(mesh.triangles.size());
      for (std::size_t t = 0; t < bounds.size(); ++t)
        for (int k = 0; k < 3; ++k) bounds[t].add(mesh.positions[mesh.triangles[t][k]]);
      curved_.back() = BoxTree(bounds);
    }
  }

  using Surface = NumberedReceiver;
  Surface surface(const GBuffer& gbuffer, std::size_t i) const { return numbers_.numbered(receiver_at(*scene_, gbuffer, i)); }

  /// How many of them hold the point, seen from the start that the volumes were counted from: where the way to the light goes
  /// exactly through an edge, the point is taken a vanishing step nearer to the start, as the count takes it. `near` are
  /// light caps that ways from the start to the point and its neighbors may cross. A way from the lit side of the own triangle
  /// crosses its plane just before a point below it, so they hold every coplanar triangle that matters; from any other start
  /// all caps are asked.
  int count(const Volumes& volumes, const Surface& surface, const glm::vec3& start, std::span<const std::uint32_t> near) const {
    const glm::dvec4& light = volumes.silhouette().light;
    const auto holds = [&](std::uint32_t triangle) {
      const Triangle t = volumes.corners(triangle);
      const glm::vec3* p = t.points;
      if (volumes.silhouette().facing[triangle] == 0) return false;
      if (orient3d_sign(p[0], p[1], p[2], surface.point) != -volumes.silhouette().facing[triangle]) return false;
      int turns = 0;
      for (int k = 0; k < 3; ++k) {
        const int turn = orient3d_sign(surface.point, p[k], p[(k + 1) % 3], light);
        turns += turn != 0 ? turn : orient3d_sign(start, p[k], p[(k + 1) % 3], light);
      }
      return std::abs(turns) == 3;
    };
    int sum = 0;
    if (!surface.has_triangle()) {
      const BoxTree& tree = curved_[surface.mesh];
      tree.any(SegmentSlabs(Segment{surface.point, light}), 0, [&](std::uint32_t place) {
        sum += holds(surface.first_own + tree.order()[place]);
        return false;
      });
      return sum;
    }
    const Triangle own = volumes.corners(surface.first_own);
    const glm::vec3* p = own.points;
    // From the plane itself or the light's side of it, no way to the light crosses the plane.
    const int of_light = orient3d_sign(p[0], p[1], p[2], light);
    if (orient3d_sign(p[0], p[1], p[2], surface.point) * of_light >= 0) return 0;
    sum = holds(surface.first_own);
    for (const std::uint32_t triangle : orient3d_sign(p[0], p[1], p[2], start) == of_light ? near : volumes.caps())
      if (!surface.is_own(triangle) && coplanar(own, volumes.corners(triangle).points)) sum += holds(triangle);
    return sum;
  }

  /// Whether the edge a b is one of what is left out.
  bool is_own_edge(const Volumes& volumes, const Surface& surface, const glm::vec3& a, const glm::vec3& b) const {
    if (!surface.has_triangle()) {
      const std::vector<glm::vec3>& positions = scene_->meshes[surface.mesh].positions;
      return std::ranges::find(positions, a) != positions.end() && std::ranges::find(positions, b) != positions.end();
    }
    const Triangle own = volumes.corners(surface.first_own);
    const auto on_plane = [&](const glm::vec3& p) { return coplanar(own.points[0], own.points[1], own.points[2], p); };
    return on_plane(a) && on_plane(b);
  }

  std::size_t bytes() const {
    std::size_t sum = curved_.capacity() * (sizeof(BoxTree) + sizeof(std::uint32_t));  // and the numbers of meshes
    for (const BoxTree& tree : curved_) sum += tree.bytes();
    return sum;
  }

 private:
  const Scene* scene_ = nullptr;
  TriangleNumbers numbers_;
  std::vector<BoxTree> curved_;  // of each mesh with an exact curved shape
};

}  // namespace gnomon::crow_counting
