#pragma once
#include <gnomon/kit/edges.h>
#include <gnomon/kit/gl_volumes.h>

#include <array>

#include "bodies.h"

namespace sphere_volume {

/// Triangles of one draw, all of one body or of the flat casters.
struct DrawRange {
  std::uint32_t first = 0, count = 0;  ///< indices
  std::uint32_t own_mesh = 0;          ///< the body's mesh plus one; 0: none is left out
  bool reversed = false;               ///< wound clockwise seen from outside
};

/// Faces of shadow volumes as homogeneous triangles, made anew for each light.
struct Volumes {
  std::vector<glm::vec4> vertices;
  std::vector<std::uint32_t> body_of;                 ///< of each vertex; 0 on flat casters
  std::array<std::vector<std::uint32_t>, 3> indices;  ///< by VolumeFace
  std::array<std::vector<DrawRange>, 3> bodies;       ///< into `indices`; in the order of the bodies
  std::array<std::vector<DrawRange>, 3> flat;

  void clear() { *this = {}; }
  std::size_t triangle_count(VolumeFace face) const { return indices[int(face)].size() / 3; }

  void add(const Contour& contour, const glm::dvec4& light, std::uint32_t index, std::uint32_t mesh) {
    const auto n = static_cast<std::uint32_t>(contour.points.size()), first = static_cast<std::uint32_t>(vertices.size());
    for (const glm::dvec3& p : contour.points) vertices.emplace_back(glm::dvec4(p, 1));
    // All light of a directional light goes on to one point.
    const bool one_end = light.w == 0;
    for (std::uint32_t i = 0; i < (one_end ? std::min(n, 1u) : n); ++i) vertices.emplace_back(glm::dvec4(contour.away[i], 0));
    const auto hub = static_cast<std::uint32_t>(vertices.size());
    if (n) vertices.emplace_back(glm::dvec4(contour.hub, 1));
    body_of.resize(vertices.size(), index);

    const std::array<std::uint32_t, 3> start{size(0), size(1), size(2)};
    auto& [sides, light_cap, dark_cap] = indices;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t next = (i + 1) % n, a = first + i, b = first + next;
      if (one_end) {
        sides.insert(sides.end(), {b, a, first + n});
      } else {
        sides.insert(sides.end(), {b, a, a + n, b, a + n, b + n});
        if (i > 0 && next > 0) dark_cap.insert(dark_cap.end(), {first + n, b + n, a + n});
      }
      light_cap.insert(light_cap.end(), {hub, a, b});
    }
    for (int f = 0; f < 3; ++f) bodies[f].push_back({start[f], size(f) - start[f], mesh + 1});
  }

  /// The volumes of the triangles themselves: a side quad for every silhouette edge, the facing triangles as they are for light
  /// caps, with the very vertices of the scene so that they tie with the depth of the view, and thrown to infinity for dark
  /// ones.
  void add(const EdgeAdjacency& adjacency, const Silhouette& silhouette) {
    const glm::dvec4& light = silhouette.light;
    const auto first = static_cast<std::uint32_t>(vertices.size()),
               n = static_cast<std::uint32_t>(adjacency.positions().size());
    const bool one_end = light.w == 0;
    for (const glm::vec3& p : adjacency.positions()) vertices.emplace_back(p, 1);
    if (one_end) {
      vertices.emplace_back(glm::dvec4(-glm::dvec3(light), 0));
    } else {
      for (const glm::vec3& p : adjacency.positions()) vertices.emplace_back(extruded(p, light));
    }
    body_of.resize(vertices.size(), 0);

    auto& [sides, light_cap, dark_cap] = indices;
    std::array<std::uint32_t, 3> start{size(0), size(1), size(2)};
    for (const SilhouetteEdge& edge : silhouette.edges) {
      // Both ways along the same diagonal.
      const std::uint32_t low = first + edge.low, high = first + edge.high;
      for (int k = 0; k < std::abs(edge.count); ++k) {
        if (one_end && edge.count > 0) sides.insert(sides.end(), {high, low, first + n});
        if (one_end && edge.count < 0) sides.insert(sides.end(), {low, high, first + n});
        if (!one_end && edge.count > 0) sides.insert(sides.end(), {low, low + n, high + n, low, high + n, high});
        if (!one_end && edge.count < 0) sides.insert(sides.end(), {low, high + n, low + n, low, high, high + n});
      }
    }
    flat[0].push_back({start[0], size(0) - start[0]});
    for (const int facing : {1, -1}) {
      start = {size(0), size(1), size(2)};
      for (std::size_t t = 0; t < silhouette.facing.size(); ++t) {
        if (silhouette.facing[t] != facing) continue;
        const glm::uvec3 triangle = adjacency.triangles()[t] + first;
        light_cap.insert(light_cap.end(), {triangle.x, triangle.y, triangle.z});
        if (!one_end) dark_cap.insert(dark_cap.end(), {triangle.x + n, triangle.y + n, triangle.z + n});
      }
      flat[1].push_back({start[1], size(1) - start[1], 0, facing < 0});
      flat[2].push_back({start[2], size(2) - start[2], 0, facing > 0});
    }
  }

  std::size_t bytes() const {
    std::size_t sum = vertices.capacity() * sizeof(glm::vec4) + body_of.capacity() * 4;
    for (int f = 0; f < 3; ++f) {
      sum += indices[f].capacity() * 4;
      sum += (bodies[f].capacity() + flat[f].capacity()) * sizeof(DrawRange);
    }
    return sum;
  }

 private:
  std::uint32_t size(int face) const { return static_cast<std::uint32_t>(indices[face].size()); }
};

}  // namespace sphere_volume
