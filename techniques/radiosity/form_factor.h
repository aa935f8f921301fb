#pragma once
#include <glm/glm.hpp>
#include <span>

namespace gnomon::radiosity {

// Form factors in closed form: the share of what a small or flat receiver could get that a polygon of one radiance gives it, if
// nothing is between. Times pi and the radiance it is the irradiance. World space, meters, in double.

/// Of a point with this unit normal to a flat convex polygon, on whichever side of it the point lies: the sum over its edges of
/// their angles, each times the part of the normal across (Lambert 1760; Nishita and Nakamae 1985), after what lies below the
/// point's horizon is cut away. 0 where the point lies in the polygon's plane.
double factor_at(const glm::dvec3& point, const glm::dvec3& normal, std::span<const glm::dvec3> polygon);

/// A parallelogram, or half of it.
struct Patch {
  glm::dvec3 corner, u, v;  ///< corner + s * u + t * v
  bool is_triangle;         ///< s + t <= 1
  glm::dvec3 normal;        ///< unit
};

/// The same, averaged over a receiving patch: by the rule of Gauss with `order` * `order` points, 1 .. 16.
double mean_factor(const Patch& receiver, std::span<const glm::dvec3> polygon, int order);

/// Points of the unit square and their weights, which sum to 1, as Gauss places them; of a triangle those of the square folded
/// onto it (Duffy 1982). Exact for polynomials up to 2 * order - 1.
struct GaussPoint {
  glm::dvec2 place;
  double weight;
};
/// `order` in 1 .. 16.
std::span<const GaussPoint> gauss_points(int order, bool is_triangle);

}  // namespace gnomon::radiosity
