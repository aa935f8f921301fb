#include "light_hull.h"

#include <gnomon/kit/geometry/across.h>

#include <numbers>

namespace gnomon::penumbra_wedge {

LightHull hull_of(const Light& light) {
  LightHull hull;
  if (const auto* rect = std::get_if<RectLight>(&light.kind)) {
    hull.center = rect->center;
    const glm::dvec3 u = rect->half_u, v = rect->half_v;
    hull.corners = {hull.center - u - v, hull.center + u - v, hull.center + u + v, hull.center - u + v};
  } else if (const auto* disc = std::get_if<DiscLight>(&light.kind)) {
    hull.center = disc->center;
    constexpr int corner_count = 16;
    const double radius = disc->radius / std::cos(std::numbers::pi / corner_count) * (1 + 0x1p-40);
    const Across across(glm::normalize(glm::dvec3(disc->normal)));
    for (int k = 0; k < corner_count; ++k) {
      const double angle = 2 * std::numbers::pi * k / corner_count;
      hull.corners.push_back(hull.center + radius * (std::cos(angle) * across.u + std::sin(angle) * across.v));
    }
  } else {
    const auto& sphere = std::get<SphereLight>(light.kind);
    hull.center = sphere.center;
    hull.corners = {hull.center};
    hull.radius = sphere.radius;
  }
  glm::dvec3 low = hull.center, high = hull.center;
  for (const glm::dvec3& corner : hull.corners) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  const double more = hull.radius + 0x1p-21 * (extent(hull.center) + extent(high - low) + hull.radius);
  hull.box.add(glm::vec3(low - more));
  hull.box.add(glm::vec3(high + more));
  return hull;
}

}  // namespace gnomon::penumbra_wedge
