#pragma once
#include <gnomon/kit/area/light_figure.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon {

/// The pyramid from a point over the box of a light's figure, above the horizon.
struct LightPyramid {
  glm::dvec3 point;
  glm::dvec3 low{0}, high{0};             ///< box around it, from the point
  std::array<glm::dvec4, 6> planes = {};  ///< inside, dot(plane, (x - point, 1)) >= 0

  /// `ends_at_light`: without what is beyond the light's plane.
  LightPyramid(const glm::dvec3& from, const LightFigure& figure, bool ends_at_light = false) : point(from) {
    const auto& [least, most] = figure.box();
    const std::array corners = {figure.at(least), figure.at({most.x, least.y}), figure.at(most), figure.at({least.x, most.y})};
    const double turn = glm::dot(glm::cross(corners[0], corners[1]), corners[2]) > 0 ? 1 : -1;
    for (int k = 0; k < 4; ++k) planes[k] = glm::dvec4(turn * glm::cross(corners[k], corners[(k + 1) % 4]), 0);
    planes[4] = glm::dvec4(figure.normal(), 0);
    const glm::dvec3 axis = glm::cross(figure.half_u(), figure.half_v());
    const double height = glm::dot(axis, figure.center());
    if (ends_at_light) planes[5] = glm::dvec4(height > 0 ? -axis : axis, std::abs(height));
    for (const glm::dvec3& corner : corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }

  /// Whether a box may have a part inside; never a false no.
  bool meets(const float* lower, const float* upper) const {
    const glm::dvec3 from = glm::dvec3(lower[0], lower[1], lower[2]) - point;
    const glm::dvec3 to = glm::dvec3(upper[0], upper[1], upper[2]) - point;
    if (glm::any(glm::lessThan(to, low)) || glm::any(glm::lessThan(high, from))) return false;
    return std::ranges::all_of(planes, [&](const glm::dvec4& p) {
      const glm::dvec3 best(p.x > 0 ? to.x : from.x, p.y > 0 ? to.y : from.y, p.z > 0 ? to.z : from.z);
      return glm::dot(glm::dvec3(p), best) + p.w >= 0;
    });
  }
};

}  // namespace gnomon
