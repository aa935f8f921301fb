#pragma once
#include <span>

#include "contour.h"

namespace sphere_volume {

/// A casting mesh with a curved shape.
struct Body {
  std::uint32_t mesh;
  Shape shape;
};

/// A point inside the body.
glm::dvec3 middle(const Shape& shape);

/// Whether `point` lies on a cone or disc, to a millionth of their size: no outline is seen from there.
bool is_on_surface(const Shape& shape, const glm::dvec3& point);

/// How far the outlines of polygons may be off at `point`, meters across the light's ray: the largest over the bodies whose
/// shadow the point is in or beside.
double outline_error(std::span<const Body> bodies, const glm::dvec4& light, const glm::dvec3& point, Fit fit, int segments);

/// Outline of a volume that holds the body's shadow volume with a margin: from a plane before the body (from the light itself
/// where it is too near for one), around the body.
Contour bounding_contour(const Shape& shape, const glm::dvec4& light);

}  // namespace sphere_volume
