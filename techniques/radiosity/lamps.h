#pragma once
#include <gnomon/light.h>

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace gnomon::radiosity {

/// What sends light in one shot: a flat convex polygon, on the side of its normal. World space, meters.
struct Sender {
  std::array<glm::dvec3, 4> corners;
  std::size_t corner_count = 4;
  glm::dvec3 normal;  ///< unit
  double area;        ///< square meters
  std::span<const glm::dvec3> polygon() const { return {corners.data(), corner_count}; }
  glm::dvec3 center() const;
  /// A point of it for two numbers in 0 .. 1, and how much area they represent there, 1 on the average.
  struct Spot {
    glm::dvec3 point;
    double weight;
  };
  Spot at(const glm::dvec2& square) const;
};
/// With normal and area of these corners, in order around it; the normal turned to the side of `front`.
Sender make_sender(std::span<const glm::dvec3> corners, const glm::dvec3& front);

/// A light with area as polygons that emit: a rectangle in parts no longer than `size` meters, 8 x 8 at most; a disc in a grid
/// of such parts laid out concentrically (Shirley and Chiu 1997), a sphere in the faces of a cube blown up, 2 x 2 parts or more
/// each, both scaled so that they have the light's area. One sender for each side that emits.
std::vector<Sender> senders_of(const Light& light, double size);

}  // namespace gnomon::radiosity
