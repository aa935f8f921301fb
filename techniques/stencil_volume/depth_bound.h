#pragma once
#include <gnomon/kit/edges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace stencil_volume {

/// Above every number of shadow volumes that overlap at any point of space: half of the outline's edges, by count, that any
/// line of sight over the light's image crosses. Such a line is a half-plane about an axis through the light (point light), or
/// a plane along its rays (directional): the number of volumes changes only where it crosses an edge, and from `start` it must
/// come back to `end` volumes, so it never exceeds (start + end + crossed) / 2.
class DepthBound {
 public:
  static constexpr int bin_count = 4096;

  DepthBound(const gnomon::EdgeAdjacency& adjacency, const gnomon::Silhouette& silhouette)
      : adjacency_(adjacency), silhouette_(silhouette), light_(silhouette.light) {}

  std::int64_t operator()() {
    choose_axes();
    std::vector<std::int64_t> change(bin_count + 1, 0);
    std::int64_t everywhere = 0;
    const auto& positions = adjacency_.positions();
    for (const gnomon::SilhouetteEdge& edge : silhouette_.edges) {
      const std::int64_t count = std::abs(edge.count);
      if (!add_range(positions[edge.low], positions[edge.high], count, change)) everywhere += count;
    }
    std::int64_t crossed = 0, most = 0;
    for (int i = 0; i < bin_count; ++i) most = std::max(most, crossed += change[i]);
    return (most + everywhere + at_ends_) / 2;
  }

 private:
  /// Axis of the half-planes: along an axis of the world that leads past all casters, where there is one.
  void choose_axes() {
    gnomon::Bounds all;
    for (const gnomon::EdgeAdjacency::Part& part : adjacency_.parts())
      if (!part.bounds.empty()) all.add(part.bounds.min), all.add(part.bounds.max);
    if (light_.w == 0) {
      const glm::dvec3 along = glm::normalize(glm::dvec3(light_)), a = glm::abs(along);
      const glm::dvec3 aside = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                               : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                        : glm::dvec3(0, 0, 1);
      u_ = glm::normalize(glm::cross(along, aside));
      if (all.empty()) return;
      const glm::dvec3 middle = (glm::dvec3(all.min) + glm::dvec3(all.max)) / 2.0, half = glm::dvec3(all.max) - middle;
      const double reach = glm::dot(glm::abs(u_), half) * (1 + 1e-9) + 1e-300;
      low_ = glm::dot(u_, middle) - reach, per_bin_ = bin_count / (2 * reach);
      return;
    }
    light_ /= light_.w;
    const glm::dvec3 l(light_);
    int axis = 0;
    bool past = all.empty();
    for (int k = 0; k < 3 && !past; ++k)
      if (l[k] < all.min[k] || l[k] > all.max[k]) past = true, axis = (k + 1) % 3;
    axis_ = axis, u_ = glm::dvec3(0), v_ = glm::dvec3(0);
    u_[(axis + 1) % 3] = 1, v_[(axis + 2) % 3] = 1;
    if (!past) at_ends_ = near_axis();
  }

  /// At least as many triangles as the axis meets on both sides of the light.
  std::int64_t near_axis() const {
    std::int64_t count = 0;
    const auto& positions = adjacency_.positions();
    for (std::size_t t = 0; t < silhouette_.facing.size(); ++t) {
      if (silhouette_.facing[t] == 0) continue;
      glm::dvec2 low(INFINITY), high(-INFINITY);
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p = glm::dvec3(positions[adjacency_.triangles()[t][k]]) - glm::dvec3(light_);
        const glm::dvec2 q(glm::dot(u_, p), glm::dot(v_, p));
        low = glm::min(low, q), high = glm::max(high, q);
      }
      count += low.x <= 0 && high.x >= 0 && low.y <= 0 && high.y >= 0;
    }
    return count;
  }

  /// Position along the circle about the axis, 0 .. 4, growing with the angle.
  static double turn(const glm::dvec2& q) {
    const double r = q.y / (std::abs(q.x) + std::abs(q.y));
    return q.x < 0 ? 2 - r : r < 0 ? 4 + r : r;
  }

  /// Adds to all bins that the edge may touch; false when it may pass through the axis.
  bool add_range(const glm::dvec3& a, const glm::dvec3& b, std::int64_t count, std::vector<std::int64_t>& change) const {
    if (light_.w == 0) {
      const double s = (glm::dot(u_, a) - low_) * per_bin_, t = (glm::dot(u_, b) - low_) * per_bin_;
      add_bins(static_cast<int>(std::min(s, t)), static_cast<int>(std::max(s, t)), count, change);
      return true;
    }
    const glm::dvec3 p = a - glm::dvec3(light_), q = b - glm::dvec3(light_);
    const glm::dvec2 from(glm::dot(u_, p), glm::dot(v_, p)), to(glm::dot(u_, q), glm::dot(v_, q));
    const double cross = from.x * to.y - from.y * to.x, size = glm::length(from) * glm::length(to);
    // Seen along the axis the edge passes within rounding of the light, or ends there.
    if (!(std::abs(cross) > 1e-9 * size) && !(glm::dot(from, to) > 0.5 * size)) return false;
    if (size == 0) return false;
    const double s = turn(cross > 0 ? from : to), t = turn(cross > 0 ? to : from);
    const int first = static_cast<int>(s * (bin_count / 4)), last = static_cast<int>(t * (bin_count / 4));
    if (s <= t) {
      add_bins(first, last, count, change);
    } else {
      add_bins(first, bin_count - 1, count, change), add_bins(0, last, count, change);
    }
    if (first == 0) add_bins(bin_count - 1, bin_count - 1, count, change);
    if (last == bin_count - 1) add_bins(0, 0, count, change);
    return true;
  }

  /// One bin more on both sides, for rounding.
  static void add_bins(int first, int last, std::int64_t count, std::vector<std::int64_t>& change) {
    change[std::clamp(first - 1, 0, bin_count - 1)] += count;
    change[std::clamp(last + 2, 1, bin_count)] -= count;
  }

  const gnomon::EdgeAdjacency& adjacency_;
  const gnomon::Silhouette& silhouette_;
  glm::dvec4 light_;
  glm::dvec3 u_{0}, v_{0};
  int axis_ = 0;
  double low_ = 0, per_bin_ = 0;
  std::int64_t at_ends_ = 0;
};

}  // namespace stencil_volume
