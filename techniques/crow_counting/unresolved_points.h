#pragma once
#include <atomic>
#include <bitset>

#include "tiles.h"
#include "volumes.h"

namespace gnomon::crow_counting {

// Points that rounding put behind their own triangle, and for which the count and the caps near them do not say enough.
//
// Such a point P may have come out of a closed body again, of which only the half that faces the light counts: a triangle of
// the other half then blocks its light, between P and the own triangle. And with a grazing light the way from P leaves the
// plane of its own triangle far from P, under a triangle of the same plane that no way from the start to the neighbors of P
// crosses. In both cases only the beginning of the way to the light matters, up to that plane: all casters near it are tested.

/// The way from a point behind its own triangle to the light, up to the triangle's plane and, for rounding, a little farther.
struct SegmentToOwnPlane {
  glm::dvec3 from, to;
  double length;

  /// `extent` is the largest coordinate of the scene. What the products of a plane's normal round is far below `error`.
  SegmentToOwnPlane(const Triangle& own, const glm::vec3& point, const glm::dvec4& light, double extent) : from(point) {
    const glm::dvec3 a(own.points[0]), u = glm::dvec3(own.points[1]) - a, v = glm::dvec3(own.points[2]) - a,
                                       normal = glm::cross(u, v), way = to_light(light, from);
    const double error = 0x1p-46 * glm::length(u) * glm::length(v), far = glm::length(way);
    const double rise = std::abs(glm::dot(normal, way)) - error * far;
    const double depth = std::abs(glm::dot(normal, a - from)) + error * glm::length(a - from);
    const double most = light.w != 0 ? 1 : 4 * extent / far;  // the light itself, or where no caster is any more
    const double share = depth < most * rise ? depth / rise : most;
    to = from + share * way;
    length = share * far;
  }

  /// Grown by more than float32 rounds.
  Bounds box() const {
    const glm::dvec3 margin(0x1p-22 * std::max(extent(from), extent(to)));
    Bounds box;
    for (const glm::dvec3& end : {from, to})
      for (const double sign : {-1.0, 1.0}) box.add(glm::vec3(end + sign * margin));
    return box;
  }

  /// Whether the way may cross the plane outside of the tile of the point (Tile::add), which is `seen` in the frame of the
  /// start: there a step of length s moves a point q by s (1 + |q| / z) / (z - s) or less.
  bool leaves_tile(const glm::dvec3& seen) const {
    const double z = seen.z, far = glm::length(seen);
    return !(length * (z + far) < Tile::margin * extent(from) * (z - length)) && z > Tile::narrowest * far;
  }

  /// Whether the point comes so near to an edge of a triangle around it that the way may have left the body beside the edge:
  /// the body's faces there turn back by 1 / 64 rad or more.
  bool is_near_edge(const Triangle& triangle) const {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a(triangle.points[k]), edge = glm::dvec3(triangle.points[(k + 1) % 3]) - a,
                                              across = glm::cross(from - a, edge);
      if (glm::dot(across, across) <= 64 * 64 * length * length * glm::dot(edge, edge)) return true;
    }
    return false;
  }
};

/// A point for which all casters near the beginning of its way are tested.
struct UnresolvedPoint {
  std::size_t pixel;
  std::int64_t depth;       ///< volumes that hold the point, its own ones included
  std::uint32_t crossings;  ///< polygons met on the way, its own ones included
  bool is_grazed;           ///< caps far away may hold it, too
  Bounds box;               ///< around the beginning of its way
  std::int32_t own = 0;     ///< own volumes that hold it
  std::int32_t behind = 0;  ///< triangles without a volume that block its light
};

/// Coarse cells of space into which some boxes reach: a quick test that most other boxes meet none of these.
class ReachedCells {
 public:
  explicit ReachedCells(const Bounds& all)
      : low_(all.min), per_cell_(static_cast<float>(side) / glm::max(all.max - all.min, glm::vec3(1e-30f))) {}
  void add(const Bounds& box) {
    any(box, [&](std::size_t cell) {
      reached_.set(cell);
      return false;
    });
  }
  bool may_meet(const Bounds& box) const {
    const glm::ivec3 count = cell(box.max) - cell(box.min) + 1;
    return count.x * count.y * count.z > 64 || any(box, [&](std::size_t cell) { return reached_.test(cell); });
  }

 private:
  static constexpr int side = 32;
  glm::ivec3 cell(const glm::vec3& p) const {
    return glm::ivec3(glm::clamp((p - low_) * per_cell_, 0.0f, static_cast<float>(side - 1)));
  }
  bool any(const Bounds& box, const auto& visit) const {
    const glm::ivec3 from = cell(box.min), to = cell(box.max);
    for (int z = from.z; z <= to.z; ++z)
      for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x)
          if (visit(static_cast<std::size_t>((z * side + y) * side + x))) return true;
    return false;
  }

  glm::vec3 low_, per_cell_;
  std::bitset<std::size_t{side} * side * side> reached_;
};

/// Finds `behind` of all points and `own` of those that are grazed, on all threads; `start` is what the volumes were counted
/// from.
inline void test_casters(const Volumes& volumes, const OwnVolumes& own, const GBuffer& gbuffer, const glm::vec3& start,
                         std::span<UnresolvedPoint> unresolved) {
  const EdgeAdjacency& adjacency = volumes.adjacency();
  const Silhouette& silhouette = volumes.silhouette();
  std::vector<Bounds> boxes;
  Bounds all;
  bool is_any_grazed = false;
  for (UnresolvedPoint& point : unresolved) {
    boxes.push_back(point.box);
    all.add(point.box);
    is_any_grazed |= point.is_grazed;
    const NumberedReceiver surface = own.surface(gbuffer, point.pixel);
    if (point.is_grazed) point.own = OwnVolumes::holds(volumes, surface.first_own, surface.point, start);
  }
  const BoxTree tree(boxes);
  ReachedCells cells(all);
  for (const Bounds& box : boxes) cells.add(box);
  const auto test = [&](UnresolvedPoint& point, std::uint32_t t, const Triangle& triangle) {
    const NumberedReceiver surface = own.surface(gbuffer, point.pixel);
    if (surface.is_own(t)) return;
    const bool is_coplanar = coplanar(adjacency.corners(surface.first_own), triangle.points);
    if (point.is_grazed && silhouette.facing[t] != 0 && is_coplanar && OwnVolumes::holds(volumes, t, surface.point, start))
      ++std::atomic_ref(point.own);
    if (silhouette.facing[t] == 0 && !is_coplanar && crosses({surface.point, silhouette.light}, triangle) != Crossing::none)
      ++std::atomic_ref(point.behind);
  };
  for_blocks(adjacency.triangles().size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (adjacency.part_of()[t] == EdgeAdjacency::no_part || (silhouette.facing[t] != 0 && !is_any_grazed)) continue;
      const Triangle triangle = adjacency.corners(t);
      Bounds box;
      box.add(triangle.points);
      if (glm::any(glm::lessThan(box.max, all.min)) || glm::any(glm::greaterThan(box.min, all.max))) continue;
      if (!cells.may_meet(box)) continue;
      const glm::vec3 middle = 0.5f * box.min + 0.5f * box.max;
      const double reach = extent(glm::max(glm::dvec3(box.max) - glm::dvec3(middle), glm::dvec3(middle) - glm::dvec3(box.min)));
      tree.any(SegmentSlabs(Segment{middle, glm::dvec4(middle, 1)}), reach, [&](std::uint32_t place) {
        test(unresolved[tree.order()[place]], static_cast<std::uint32_t>(t), triangle);
        return false;
      });
    }
  });
}

}  // namespace gnomon::crow_counting
