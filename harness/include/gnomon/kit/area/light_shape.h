#pragma once
#include <gnomon/light.h>

#include <vector>

namespace gnomon {

/// The surface of a light with area, world space, meters, in double: the one place that tells rectangle, disc and sphere apart.
struct LightShape {
  enum class Form { rectangle, disc, sphere };

  Form form = Form::sphere;
  glm::dvec3 center{0};
  glm::dvec3 half_u{0}, half_v{0};  ///< half sides of a rectangle
  double radius = 0;                ///< of a disc and of a sphere
  glm::dvec3 across{0};             ///< across a flat one on the side of its front, any length
  bool is_one_sided = false;        ///< emits from its front only

  /// `light` must have an area.
  explicit LightShape(const Light& light);

  bool is_flat() const { return form != Form::sphere; }
  /// Unit normal of the front of a flat one.
  glm::dvec3 front() const { return glm::normalize(across); }
  /// Corners of a convex polygon around a flat one, counter-clockwise seen from its front: of a rectangle its own, of a disc
  /// those of a regular polygon around it, larger by a share of 1e-12 for what rounding may have cut off.
  std::vector<glm::dvec3> corners(int of_a_disc) const;
};

}  // namespace gnomon
