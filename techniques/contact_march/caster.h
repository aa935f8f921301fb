#pragma once
#include <gnomon/kit/rays/rays.h>

namespace gnomon::contact_march {

/// What casts a pixel's shadow next to it.
struct Caster {
  std::uint32_t mesh = no_mesh, triangle = 0;
  double distance = INFINITY;  ///< meters from the pixel's point
  glm::dvec3 point{0};
};

/// The first caster on the way from a pixel's point to a homogeneous light, by the ray recipe of docs/method.md; without a mesh
/// where nothing casts. `casters` under the truth of the G-buffer.
Caster nearest_caster(const RayScene& casters, const GBuffer& gbuffer, const glm::dvec4& light, std::size_t i);

}  // namespace gnomon::contact_march
