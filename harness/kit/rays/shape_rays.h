#pragma once
#include <gnomon/scene.h>

namespace gnomon {

struct ShapeHit {
  bool found = false;
  double t = 0;
  glm::dvec3 normal{0};  ///< unit, outward; of a disc: its own
};

/// First crossing of origin + t * direction, tnear <= t <= tfar, with the surface of a curved shape, in double.
ShapeHit first_hit(const Shape& shape, const glm::dvec3& origin, const glm::dvec3& direction, double tnear, double tfar);

/// Box around a curved shape, rounded outward.
Bounds shape_bounds(const Shape& shape);

}  // namespace gnomon
