#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/geometry/across.h>

#include <cmath>
#include <numbers>

namespace gnomon {

LightShape::LightShape(const Light& light) {
  if (const auto* rect = std::get_if<RectLight>(&light.kind)) {
    form = Form::rectangle;
    center = rect->center;
    half_u = rect->half_u;
    half_v = rect->half_v;
    across = glm::cross(half_u, half_v);
    is_one_sided = rect->emits == Emits::in_front;
  } else if (const auto* disc = std::get_if<DiscLight>(&light.kind)) {
    form = Form::disc;
    center = disc->center;
    radius = disc->radius;
    across = disc->normal;
    is_one_sided = disc->emits == Emits::in_front;
  } else {
    const auto& sphere = std::get<SphereLight>(light.kind);
    center = sphere.center;
    radius = sphere.radius;
  }
}

std::vector<glm::dvec3> LightShape::corners(int of_a_disc) const {
  if (form == Form::rectangle)
    return {center - half_u - half_v, center + half_u - half_v, center + half_u + half_v, center - half_u + half_v};
  std::vector<glm::dvec3> corners;
  const Across sides(front());
  const double far = radius / std::cos(std::numbers::pi / of_a_disc) * (1 + 1e-12);
  for (int k = 0; k < of_a_disc; ++k) {
    const double angle = 2 * std::numbers::pi * k / of_a_disc;
    corners.push_back(center + far * (std::cos(angle) * sides.u + std::sin(angle) * sides.v));
  }
  return corners;
}

}  // namespace gnomon
