#pragma once
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/exact.h>

#include <algorithm>
#include <cmath>

namespace gnomon::crow_counting {

// Whether the way from a start to a point crosses a polygon of a shadow volume, by signs alone.
//
// The point is taken a vanishing step nearer to the light than it is. So it is on the light's side of every triangle whose
// plane contains it: such a triangle, first of all the point's own, does not shade it. The step also settles every way through
// the line of a caster's edge, for side quad and light cap alike, as if it passed on the light's side. Two cases stay open: a
// point on the border of a volume itself, and a way through a side quad's border elsewhere. The second depends on the start.

enum class Meeting {
  none,
  crosses,
  touches,  ///< the point lies on the side quad: its way to the light goes through the edge or one of its ends
  unclear,  ///< to be tested again from another start
};

/// The side quad of an edge a b: all points X whose way to the light meets the edge. The start must not lie on it.
///
/// With [U V W X] for orient3d, e and p for the start and the point, Cramer's rule gives, for the point X where the way meets
/// the plane of a, b and the light l,
///
///   ([p a b l] - [e a b l]) X = -[e p b l] a + [e p a l] b - [e p a b] l.
///
/// X lies behind the edge when a and b have positive shares and l a negative one. So, if p is on the positive side and e on the
/// negative one, the way crosses the quad when [e p b l] < 0, [e p a l] > 0 and [e p a b] > 0; on exchanged sides all signs
/// are turned. With the point nearer to the light, a zero of the last becomes the sign of [e l a b] = [e a b l]: no crossing.
inline Meeting meet_side(const glm::vec3& from, const glm::vec3& to, const glm::vec3& a, const glm::vec3& b,
                         const glm::dvec4& light) {
  const int of_from = orient3d_sign(from, a, b, light), of_to = orient3d_sign(to, a, b, light);
  if (of_from == 0) return of_to == 0 ? Meeting::unclear : Meeting::none;
  if (of_to == of_from) return Meeting::none;
  const int turn = -of_from;
  const int behind = turn * orient3d_sign(from, to, a, b);
  if (behind <= 0) return Meeting::none;
  const int beside_a = turn * orient3d_sign(from, to, a, light), beside_b = -turn * orient3d_sign(from, to, b, light);
  if (beside_a < 0 || beside_b < 0) return Meeting::none;
  if (of_to == 0) return Meeting::touches;
  return beside_a == 0 || beside_b == 0 ? Meeting::unclear : Meeting::crosses;
}

/// A triangle that the light sees: facing +1 counter-clockwise, -1 clockwise. The start must not lie on it.
///
/// A point on its plane moves to the light's side, which is `facing`; a way through the line of edge a b becomes one on the
/// side of [e l a b] = [e a b l].
inline Meeting meet_cap(const glm::vec3& from, const glm::vec3& to, const Triangle& triangle, const glm::dvec4& light,
                        int facing) {
  const glm::vec3* corners = triangle.points;
  const int of_from = orient3d_sign(corners[0], corners[1], corners[2], from);
  int of_to = orient3d_sign(corners[0], corners[1], corners[2], to);
  if (of_to == 0) of_to = facing;
  if (of_from == 0 || of_from == of_to) return Meeting::none;
  bool unclear = false;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 &a = corners[k], &b = corners[(k + 1) % 3];
    int inside = of_to * orient3d_sign(from, to, a, b);
    if (inside == 0) inside = of_to * orient3d_sign(from, a, b, light);
    if (inside < 0) return Meeting::none;
    unclear |= inside == 0;
  }
  return unclear ? Meeting::unclear : Meeting::crosses;
}

/// Coordinates around a start: x to the right, y up, z forward, as the view looks. The axes are orthonormal to a few units of
/// 2^-53.
struct Frame {
  glm::vec3 start{0};
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};

  Frame() = default;
  Frame(const View& view, const glm::vec3& start) : start(start) {
    const glm::dvec3 gaze = glm::dvec3(view.target) - glm::dvec3(view.eye);
    if (glm::dot(gaze, gaze) > 0) forward = glm::normalize(gaze);
    right = glm::normalize(sideways(forward, view.up));
    right = glm::normalize(right - glm::dot(right, forward) * forward);  // a short one leaves more than a few units
    up = glm::cross(right, forward);
  }
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
  /// What crossing it adds to the number of volumes: it follows from the side of the plane on which the start is. 0 where the
  /// start lies on the plane of a side quad.
  int step = 0;
};

inline Polygon side_polygon(const Frame& frame, const glm::vec3& a, const glm::vec3& b, const glm::dvec4& light, int count) {
  const glm::dvec3 start(frame.start), pa = glm::dvec3(a) - start, pb = glm::dvec3(b) - start,
                                       ab = glm::dvec3(b) - glm::dvec3(a);
  const glm::dvec3 to_l = to_light(light, start), al = to_light(light, glm::dvec3(a));
  const int of_start = orient3d_sign(frame.start, a, b, light);
  Polygon polygon;
  polygon.step = -of_start * count;
  // [x a b l] = -(ab x al) . (x - a), of which the point must have the other sign than the start.
  const double turn = of_start == 0 ? 1 : -of_start;
  const glm::dvec3 normal = -turn / (glm::length(ab) * glm::length(al)) * glm::cross(ab, al);
  polygon.plane = frame.turned(normal);
  polygon.distance = glm::dot(normal, pa);
  polygon.slack = relative_error * glm::length(pa);
  if (of_start == 0) return polygon;  // the other planes are not defined: exact signs decide
  const double length_a = glm::length(pa), length_b = glm::length(pb), length_l = glm::length(to_l);
  polygon.inside[0] = frame.turned(turn / (length_a * length_b) * glm::cross(pa, pb));
  polygon.inside[1] = frame.turned(turn / (length_a * length_l) * glm::cross(pa, to_l));
  polygon.inside[2] = frame.turned(-turn / (length_b * length_l) * glm::cross(pb, to_l));
  return polygon;
}

/// Nothing crosses a cap with step 0: the start lies on its plane.
inline Polygon cap_polygon(const Frame& frame, const Triangle& triangle, int facing) {
  const glm::vec3* p = triangle.points;
  const glm::dvec3 start(frame.start);
  const int of_start = orient3d_sign(p[0], p[1], p[2], frame.start);
  Polygon polygon;
  polygon.step = of_start * facing;
  if (polygon.step == 0) return polygon;
  const double turn = -of_start;
  const glm::dvec3 corner[3] = {glm::dvec3(p[0]) - start, glm::dvec3(p[1]) - start, glm::dvec3(p[2]) - start};
  const glm::dvec3 u = glm::dvec3(p[1]) - glm::dvec3(p[0]), v = glm::dvec3(p[2]) - glm::dvec3(p[0]);
  const glm::dvec3 normal = turn / (glm::length(u) * glm::length(v)) * glm::cross(u, v);
  const double length[3] = {glm::length(corner[0]), glm::length(corner[1]), glm::length(corner[2])};
  polygon.plane = frame.turned(normal);
  polygon.distance = glm::dot(normal, corner[0]);
  polygon.slack = relative_error * length[0];
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    polygon.inside[k] = frame.turned(turn / (length[k] * length[next]) * glm::cross(corner[k], corner[next]));
  }
  return polygon;
}

/// The box around a polygon in the picture plane z = 1 of the start, and its least z; grown by rounding. Boundless where a
/// corner is not in front of the start.
struct Outline {
  float x0 = -INFINITY, x1 = INFINITY, y0 = -INFINITY, y1 = INFINITY, z0 = -INFINITY;
  static Outline nowhere() { return {INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY}; }
};

/// Of the hull of corners in the frame; w = 0 is a direction.
inline Outline outline_of(std::span<const glm::dvec4> corners) {
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY, z0 = INFINITY;
  for (const glm::dvec4& c : corners) {
    if (!(c.z > 0x1p-20 * std::max(std::abs(c.x), std::abs(c.y)))) return {};
    x0 = std::min(x0, c.x / c.z);
    x1 = std::max(x1, c.x / c.z);
    y0 = std::min(y0, c.y / c.z);
    y1 = std::max(y1, c.y / c.z);
    if (c.w != 0) z0 = std::min(z0, c.z);
  }
  const auto below = [](double v) { return static_cast<float>(v - 0x1p-20 * (std::abs(v) + 0x1p-20)); };
  const auto above = [](double v) { return static_cast<float>(v + 0x1p-20 * (std::abs(v) + 0x1p-20)); };
  return {below(x0), above(x1), below(y0), above(y1), static_cast<float>(z0 * (1 - 0x1p-20))};
}

}  // namespace gnomon::crow_counting
