#pragma once
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/light.h>

#include <array>

namespace gnomon::area_svbsp {

/// A convex body with corners that holds all of a light with area: a rectangle is it; around a disc stands a polygon of eight
/// corners, around a sphere an icosahedron. What sees the light in full, and what sees nothing of it, is so said on the safe
/// side: a point that sees all of the body sees all of the light, and one that sees none of the body sees none of the light.
struct LightBody {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::uint32_t, 2>> edges;
  bool is_flat = false;       ///< corners and edges then run around a polygon
  bool is_one_sided = false;  ///< a flat one that sends light to the positive side of its plane only
  ClipPlane plane;            ///< of a flat one, unit, positive in front; zero where it has no area

  /// A flat body with these corners.
  void set_corners(std::span<const Corner> polygon);
};

LightBody body_of(const Light& light);

/// The two halves of a flat body, across its longest edge.
std::array<LightBody, 2> halves(const LightBody& body);

}  // namespace gnomon::area_svbsp
