#pragma once
#include <gnomon/light.h>
#include <gnomon/scene.h>

#include <vector>

namespace gnomon::penumbra_wedge {

/// A convex body that holds a light with area: all that is within a radius of the hull of some corners. Of a rectangle its
/// corners, of a disc those of a polygon around it, of a sphere its center and radius.
struct LightHull {
  std::vector<glm::dvec3> corners;
  glm::dvec3 center{0};
  double radius = 0;
  Bounds box;  ///< around it, wider by what rounding may have cut off
};

LightHull hull_of(const Light& light);

}  // namespace gnomon::penumbra_wedge
