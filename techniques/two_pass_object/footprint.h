#pragma once
#include <array>
#include <functional>

#include "triangles.h"

namespace gnomon::two_pass_object {

/// What the light sees of a triangle on a face: a box around its places, and bounds of its depths there.
struct Footprint {
  double u0, v0, u1, v1;
  std::uint32_t triangle;
  double nearest = -INFINITY, farthest = INFINITY;  ///< of its corners
  glm::dvec3 rise{0};                               ///< u * x + v * y + z is 1 / depth, and -depth for a directional light
  double reach = INFINITY;                          ///< more than a point that belongs to it lies off its place, in depth
  double area = INFINITY;                           ///< of its places
  bool is_bounded() const { return reach < INFINITY; }
};

/// More than rounding of a line's values at the places of a face.
inline double slack_of(const glm::dvec3& line) { return 0x1p-24 * (std::abs(line.x) + std::abs(line.y) + std::abs(line.z)); }

/// A rectangle of places.
struct Places {
  double u0, v0, u1, v1;
  double area() const { return (u1 - u0) * (v1 - v0); }
};

/// Bounds of what a triangle's points may have for depth in a rectangle of places that it touches.
struct Depths {
  double nearest, farthest;
};
Depths depths(const SceneLightSpace& space, const Footprint& f, const Places& in);

/// Calls visit(face, footprint) for each face that sees a part of the triangle.
void for_footprints(const Triangles& triangles, std::uint32_t i, const std::function<void(int, const Footprint&)>& visit);

/// The footprints of all triangles that take part, by face.
using Footprints = std::array<std::vector<Footprint>, 6>;
Footprints find_footprints(const Triangles& triangles);

}  // namespace gnomon::two_pass_object
