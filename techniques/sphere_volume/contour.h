#pragma once
#include <gnomon/scene.h>

#include <vector>

namespace sphere_volume {
using namespace gnomon;

/// What stands for a circle of the outline: a polygon inside, of equal area, around it; `exact` decides at the pixel's point.
enum Fit { inscribed, equal_area, circumscribed, exact };

/// A point of a polygon that stands for a circle of radius 1: at `angle`, `radius` from the center.
struct Corner {
  double angle, radius;
};

/// Factor on the radius of a regular polygon of `count` sides.
double radius_factor(Fit fit, int count);

/// The corners of a regular polygon.
std::vector<Corner> full_circle(Fit fit, int count);

/// An arc of a circle that `count` sides go around (fewer here, none longer). Both ends stay on the circle, so that tangents
/// meet it there. The polygon around it touches the arc at its ends and between corners; for equal area the same corners are
/// drawn in to the radius k that makes the fan from the center as large as the sector:
///   (n - 1) k^2 sin s + 2 k sin(s / 2) = n s,  s the step, n the number of inner corners.
std::vector<Corner> arc(Fit fit, double from, double to, int count);

/// Outline of a convex body as the light sees it, in double. Points are counter-clockwise seen from the light.
struct Contour {
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> away;  ///< where light that passes each point goes on; of a directional light all the same
  glm::dvec3 hub{0};             ///< of the light cap: a point inside the body
};

/// The light must not be inside the sphere, nor inside the cone or on its lateral surface. Of a disc that the light sees
/// edge-on, and of flat shapes, the contour is empty: the disc casts nothing, and flat shapes cast by their triangles.
Contour contour_of(const Shape& shape, const glm::dvec4& light, Fit fit, int segments);

}  // namespace sphere_volume
