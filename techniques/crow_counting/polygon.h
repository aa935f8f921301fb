#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/edges.h>

#include <algorithm>
#include <cmath>

#include "crossing.h"

namespace gnomon::crow_counting {

/// Coordinates around a start: x to the right, y up, z forward, as the view looks. The axes are orthonormal to a few units of
/// 2^-53.
struct Frame {
  glm::vec3 start{0};
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};

  Frame() = default;
  Frame(const View& view, const glm::vec3& start);
  glm::dvec3 turned(const glm::dvec3& v) const { return {glm::dot(right, v), glm::dot(up, v), glm::dot(forward, v)}; }
  glm::dvec3 seen(const glm::vec3& p) const { return turned(glm::dvec3(p) - glm::dvec3(start)); }
};

/// Relative error of everything below: about twenty roundings of 2^-53 lie between the floats and the value of a plane, each
/// carried by a factor of at most the square root of three. 2^-46 is 128 of them.
inline constexpr double relative_error = 0x1p-46;

/// A side quad or a light cap as the start sees it. The way to a point p (in the frame) crosses it exactly when p is beyond the
/// plane and inside three planes through the start: dot(plane, p) > distance and dot(inside[k], p) > 0. Normals are at most 1
/// long, so a value is off by at most relative_error * |p|, that of the plane by `slack` more.
struct Polygon {
  glm::dvec3 plane{0};
  double distance = 0, slack = 0;
  glm::dvec3 inside[3] = {};
  int step = 0;  ///< what crossing it adds to the number of volumes; 0 where the start lies on the plane of a side quad
};

Polygon side_polygon(const Frame& frame, const glm::vec3& a, const glm::vec3& b, const glm::dvec4& light, int count);

/// Nothing crosses a cap with step 0: the start lies on its plane.
Polygon cap_polygon(const Frame& frame, const Triangle& triangle, int facing);

/// Where a polygon appears in the picture plane z = 1 of the start, and how far in front of it it begins; grown by rounding.
/// Everywhere where a corner is not in front of the start.
struct Outline {
  float x0 = -INFINITY, x1 = INFINITY, y0 = -INFINITY, y1 = INFINITY, z0 = -INFINITY;
  static Outline nowhere() { return {INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY}; }
};

/// Of the hull of corners in the frame; w = 0 is a direction.
Outline outline_of(std::span<const glm::dvec4> corners);

}  // namespace gnomon::crow_counting
