#pragma once
#include <gnomon/technique.h>

#include "trees.h"

namespace gnomon::area_svbsp {

/// What a fragment's corners see, linear in each triangle between the first corner and an edge; at a point in the plane of the
/// fragment but for rounding. Outside of it: at the nearest of these triangles' borders, or so.
double interpolated(std::span<const ShadedCorner> corners, const glm::dvec3& point);

/// The fragments of all receiving triangles, of the side that is turned to the light; where both are, of the one where it runs
/// counter-clockwise. Triangles whose fragments are all of one kind are left whole, those without a tree are penumbra. What is
/// behind a one-sided light is lit, as it is in masks.
SurfaceDetail divide_triangles(const Casters& casters, const Trees& trees, const LightBody& light, double epsilon);

}  // namespace gnomon::area_svbsp
