#pragma once
#include <gnomon/kit/geometry/across.h>
#include <gnomon/scene.h>

#include <utility>

namespace gnomon {

// Exact shapes as a light sees them, in double, world space: where tangents from the light touch them, how high they reach and
// which points they hold. A light is homogeneous, (position, 1) or (-direction, 0) as `homogeneous` gives it, and not inside
// the shape.

/// The circle in which the tangents from a light touch a sphere. Of a directional light it is the great circle across it; of a
/// light on the sphere it is a point.
struct TangencyCircle {
  glm::dvec3 center, axis;      ///< unit axis, away from the light
  glm::dvec3 u, v;              ///< unit; u, v, -axis is right-handed
  double radius;                ///< meters
  double sin_alpha, cos_alpha;  ///< of the angle between the axis and a tangent

  /// Unit vector from the center to the circle; angles grow clockwise seen from the light.
  glm::dvec3 arm(double angle) const { return std::cos(angle) * v + std::sin(angle) * u; }
  glm::dvec3 point(double angle, double factor = 1) const { return center + factor * radius * arm(angle); }
};
TangencyCircle tangency_circle(const Sphere& sphere, const glm::dvec4& light);

/// The outline of a cone: either its base's circle, or its peak with one arc of that circle, from the one tangent to the other.
/// The generator at the angle b from the light's side faces the light when h e cos b > r (h L_w - l), where l is the light's
/// height over the base and e its distance from the axis, both times L_w.
struct ConeOutline {
  glm::dvec3 base, axis;  ///< unit axis, from the base to the peak
  double height, radius;
  Across frame;               ///< u at the angle 0, v at pi / 2
  bool base_faces;            ///< the base faces the light
  bool is_circle;             ///< the light sees all generators or none
  double side = 0, half = 0;  ///< otherwise generators side - half .. side + half face the light, half in 0 .. pi

  ConeOutline(const Cone& cone, const glm::dvec4& light);
  glm::dvec3 peak() const { return base + height * axis; }
  /// A point of the base's circle, or off it by a factor on the radius.
  glm::dvec3 rim(double angle, double factor = 1) const {
    return base + radius * factor * (std::cos(angle) * frame.u + std::sin(angle) * frame.v);
  }
};

/// Where a point is relative to a cone: height over the base, and distance from the lateral surface continued, negative inside.
struct ConePlace {
  double along, off;
  ConePlace(const Cone& cone, const glm::dvec3& point);
};

/// Whether `point` is strictly inside the solid that a sphere or a cone bounds; other shapes hold no point.
bool contains(const Shape& shape, const glm::dvec3& point);

/// Heights of the lowest and the highest point of a shape over a plane of unit normal.
std::pair<double, double> heights_over(const Shape& shape, const glm::dvec4& plane);

}  // namespace gnomon
