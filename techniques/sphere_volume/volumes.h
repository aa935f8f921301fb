#pragma once
#include <gnomon/kit/gl_volumes.h>

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
  void add(const Contour& contour, const glm::dvec4& light, std::uint32_t body, std::uint32_t mesh);
  std::size_t triangle_count(VolumeFace face) const { return indices[int(face)].size() / 3; }
  std::size_t bytes() const;
};

}  // namespace sphere_volume
