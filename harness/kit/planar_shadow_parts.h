#pragma once
// Private to kit/planar_shadow: the flat parts of a shape or of its image.
#include <gnomon/kit/contour.h>
#include <gnomon/kit/planar_shadow.h>

namespace gnomon {

using Parts = std::array<FlatPart, 3>;

/// Angles and lengths that differ from what a form wants by less than this share do so by rounding of float32 coordinates.
inline constexpr double alike = 1e-5;

inline double height_of(const glm::dvec4& plane, const glm::dvec3& point) { return glm::dot(plane, glm::dvec4(point, 1)); }

inline FlatPart disc_part(const glm::dvec3& center, const glm::dvec3& normal, double radius) {
  const auto [u, v] = Across(normal);
  return {.corner_count = 0, .points = {center, center + radius * u, center + radius * v, center}};
}

inline FlatPart triangle_part(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return {.corner_count = 3, .points = {a, b, c, a}};
}

/// The paper's formulas of a form other than exact, in `parts`; says how many. There must be no objection.
std::size_t image_parts(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form, Parts& parts);

/// What the paper asks of the shape and its place; it knows four shapes.
std::string paper_objection(const Shape& shape, const glm::dvec4& plane, ShadowForm form);

}  // namespace gnomon
