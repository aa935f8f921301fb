#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/volumes/gl_volumes.h>

#include <algorithm>
#include <array>

#include "bodies.h"

namespace sphere_volume {

/// Triangles of one draw, all of one body.
struct DrawRange {
  std::uint32_t first = 0, count = 0;  ///< indices
  std::uint32_t own_mesh = 0;          ///< the body's mesh plus one
};

/// Faces of the shadow volumes of bodies as homogeneous triangles, made anew for each light.
struct Volumes {
  std::vector<glm::vec4> vertices;
  std::vector<std::uint32_t> body_of;                 ///< of each vertex
  std::array<std::vector<std::uint32_t>, 3> indices;  ///< by VolumeFace
  std::array<std::vector<DrawRange>, 3> ranges;       ///< into `indices`; in the order of the bodies

  void clear() { *this = {}; }
  /// The volume of the body with number `body`, of mesh `mesh`.
  void add(const Contour& contour, const glm::dvec4& light, std::uint32_t body, std::uint32_t mesh) {
    const auto n = static_cast<std::uint32_t>(contour.points.size()), first = static_cast<std::uint32_t>(vertices.size());
    for (const glm::dvec3& p : contour.points) vertices.emplace_back(glm::dvec4(p, 1));
    // All light of a directional light goes on to one point.
    const bool one_end = light.w == 0;
    for (std::uint32_t i = 0; i < (one_end ? std::min(n, 1u) : n); ++i) vertices.emplace_back(glm::dvec4(contour.away[i], 0));
    const auto hub = static_cast<std::uint32_t>(vertices.size());
    if (n) vertices.emplace_back(glm::dvec4(contour.hub, 1));
    body_of.resize(vertices.size(), body);

    const auto size = [&](int face) { return static_cast<std::uint32_t>(indices[face].size()); };
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
    for (int f = 0; f < 3; ++f) ranges[f].push_back({start[f], size(f) - start[f], mesh + 1});
  }

  std::size_t triangle_count(VolumeFace face) const { return indices[int(face)].size() / 3; }
  std::size_t bytes() const {
    std::size_t sum = bytes_of(vertices, body_of);
    for (int f = 0; f < 3; ++f) sum += bytes_of(indices[f], ranges[f]);
    return sum;
  }
};

}  // namespace sphere_volume
