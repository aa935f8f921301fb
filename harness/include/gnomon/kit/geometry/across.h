#pragma once
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace gnomon {

/// Two unit vectors across a unit axis; u, v, axis is right-handed.
struct Across {
  glm::dvec3 u, v;

  /// By the coordinate axis that the axis is farthest from, which makes the best conditioned pair.
  explicit Across(const glm::dvec3& axis) : Across(axis, least(axis)) {}
  /// u lies across `helper`, too: any direction but that of the axis.
  Across(const glm::dvec3& axis, const glm::dvec3& helper)
      : u(glm::normalize(glm::cross(helper, axis))), v(glm::cross(axis, u)) {}
  /// By the x axis, or by the y axis where |axis.x| is not below the limit.
  static Across by_x(const glm::dvec3& axis, double limit) {
    return {axis, glm::abs(axis.x) < limit ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)};
  }

 private:
  static glm::dvec3 least(const glm::dvec3& axis) {
    const glm::dvec3 a = glm::abs(axis);
    return a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0) : a.y <= a.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  }
};

/// For a place of the unit square, a unit direction on the side of `normal`, a unit vector, as likely as its cosine with it: a
/// place of the unit disc, lifted to the hemisphere (Malley's method).
inline glm::dvec3 cosine_direction(const glm::dvec3& normal, double x, double y) {
  const Across across(normal);
  const double radius = std::sqrt(x), angle = 2 * std::numbers::pi * y;
  return radius * std::cos(angle) * across.u + radius * std::sin(angle) * across.v + std::sqrt(1 - x) * normal;
}

/// To the side of a unit direction, across an `up` of any length; not normalized. Where the two run along each other any side
/// will do, and it is the same one every time.
inline glm::dvec3 sideways(const glm::dvec3& forward, const glm::dvec3& up) {
  const glm::dvec3 side = glm::cross(forward, up);
  if (glm::dot(side, side) > 1e-12 * glm::dot(up, up)) return side;
  return glm::cross(forward, glm::abs(forward.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1));
}

}  // namespace gnomon
