#pragma once
#include <atomic>

#include "volumes.h"

namespace gnomon::crow_counting {

// Points that rounding put behind their own triangle, and for which the count and the caps near them do not say enough.
//
// Such a point P may have come out of a closed body again, of which only the half that faces the light counts: a triangle of
// the other half then blocks its light, between P and the own triangle. And with a grazing light the way from P leaves the
// plane of its own triangle far from P, under a triangle of the same plane that no way from the start to the neighbors of P
// crosses. In both cases what matters is met on the beginning of the way to the light, up to that plane, so all casters near
// it are asked.

/// The way from a point behind its own triangle to the light, up to the triangle's plane and, for rounding, a little farther.
struct Beginning {
  glm::dvec3 from, to;
  double length;

  /// `extent` is the largest coordinate of the scene. What the products of a plane's normal round is far below `error`.
  Beginning(const Triangle& own, const glm::vec3& point, const glm::dvec4& light, double extent) : from(point) {
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

/// A point that all casters near the beginning of its way are asked about.
struct Doubt {
  std::size_t pixel;
  std::int64_t depth;       ///< volumes that hold the point, its own ones included
  std::uint32_t crossings;  ///< polygons met on the way, its own ones included
  Bounds box;               ///< around the beginning of its way
  std::int32_t own = 0;     ///< own volumes that hold it
  std::int32_t behind = 0;  ///< triangles without a volume that block its light
};

/// Finds `own` and `behind` of all doubts, on all threads; `start` is what the volumes were counted from.
inline void ask_casters(const Volumes& volumes, const OwnVolumes& own, const GBuffer& gbuffer, const glm::vec3& start,
                        std::span<Doubt> doubts) {
  const EdgeAdjacency& adjacency = volumes.adjacency();
  const Silhouette& silhouette = volumes.silhouette();
  std::vector<Bounds> boxes;
  Bounds all;
  for (Doubt& doubt : doubts) {
    boxes.push_back(doubt.box);
    all.add(doubt.box);
    const NumberedReceiver surface = own.surface(gbuffer, doubt.pixel);
    doubt.own = OwnVolumes::holds(volumes, surface.first_own, surface.point, start);
  }
  const BoxTree tree(boxes);
  const auto ask = [&](Doubt& doubt, std::uint32_t t, const Triangle& triangle) {
    const NumberedReceiver surface = own.surface(gbuffer, doubt.pixel);
    if (surface.is_own(t)) return;
    const bool is_coplanar = coplanar(adjacency.corners(surface.first_own), triangle.points);
    if (silhouette.facing[t] != 0 && is_coplanar && OwnVolumes::holds(volumes, t, surface.point, start))
      ++std::atomic_ref(doubt.own);
    if (silhouette.facing[t] == 0 && !is_coplanar && crosses({surface.point, silhouette.light}, triangle) != Crossing::none)
      ++std::atomic_ref(doubt.behind);
  };
  for_blocks(adjacency.triangles().size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (adjacency.part_of()[t] == EdgeAdjacency::no_part) continue;
      const Triangle triangle = adjacency.corners(t);
      Bounds box;
      box.add(triangle.points);
      if (glm::any(glm::lessThan(box.max, all.min)) || glm::any(glm::greaterThan(box.min, all.max))) continue;
      const glm::vec3 middle = 0.5f * box.min + 0.5f * box.max;
      const double reach = extent(glm::max(glm::dvec3(box.max) - glm::dvec3(middle), glm::dvec3(middle) - glm::dvec3(box.min)));
      tree.any(SegmentSlabs(Segment{middle, glm::dvec4(middle, 1)}), reach, [&](std::uint32_t place) {
        ask(doubts[tree.order()[place]], static_cast<std::uint32_t>(t), triangle);
        return false;
      });
    }
  });
}

}  // namespace gnomon::crow_counting
