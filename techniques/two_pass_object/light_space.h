#pragma once
#include <gnomon/kit/clip.h>
#include <gnomon/light.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>

namespace gnomon::two_pass_object {

/// A point as the light sees it: its place, and its depth in meters along the axis of a face, away from the light. Of two
/// points in one direction from the light the farther one has the larger depth.
struct Seen {
  double u, v, depth;
};

/// What the light looks at: one square across the rays of a directional light; the six faces of a cube around any other, along
/// the axes of the world. Places on a face lie within -1 .. 1, for a directional light within -2 .. 2.
class LightSpace {
 public:
  LightSpace() = default;
  LightSpace(const glm::dvec4& light, const Bounds& bounds) : light_(light) {
    if (bounds.empty()) return;
    const glm::dvec3 low(bounds.min), high(bounds.max);
    for (int k = 0; k < 3; ++k) extent_ = std::max({extent_, std::abs(low[k]), std::abs(high[k])});
    diagonal_ = glm::distance(low, high);
    origin_ = is_parallel() ? (low + high) / 2.0 : glm::dvec3(light);
    deepest_ = glm::distance(origin_, (low + high) / 2.0) + diagonal_ / 2;
    if (!is_parallel()) return;
    axes_[2] = -glm::dvec3(light) / glm::length(glm::dvec3(light));
    const glm::dvec3 size = glm::abs(axes_[2]);
    glm::dvec3 beside(0);
    beside[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1;
    axes_[0] = glm::normalize(glm::cross(beside, axes_[2]));
    axes_[1] = glm::cross(axes_[2], axes_[0]);
  }

  const glm::dvec4& light() const { return light_; }
  bool is_parallel() const { return light_.w == 0; }
  int face_count() const { return is_parallel() ? 1 : 6; }

  /// Largest coordinate of the scene, meters: what float32 rounds by.
  double extent() const { return extent_; }
  double diagonal() const { return diagonal_; }
  /// Nothing of the scene lies deeper, in meters.
  double deepest() const { return deepest_; }
  /// Corners this close to a plane count as on it. Cuts of cuts in double err by some 1e-15 of the extent, float32 corners
  /// stand 6e-8 of it apart: 1e-10 is far from both.
  double epsilon() const { return 1e-10 * extent_; }
  /// More than a receiver's point in float32 lies off its triangle: the root of 3 times half a unit in the last place.
  double rounding() const { return 0x1p-22 * extent_; }
  /// Points this close to a shadow plane are not decided by polygons; planes that may err by more than a quarter are not used.
  double doubt() const { return 0x1p-24 * extent_; }

  int face_of(const glm::dvec3& p) const {
    if (is_parallel()) return 0;
    const glm::dvec3 d = p - origin_, size = glm::abs(d);
    const int k = size.z >= size.x && size.z >= size.y ? 2 : size.x >= size.y ? 0 : 1;
    return 2 * k + (d[k] < 0);
  }
  double depth(int face, const glm::dvec3& p) const {
    const glm::dvec3 d = p - origin_;
    return is_parallel() ? glm::dot(axes_[2], d) : face % 2 ? -d[face / 2] : d[face / 2];
  }
  /// In a cube, of points with positive depth.
  Seen seen(int face, const glm::dvec3& p) const {
    const glm::dvec3 d = p - origin_;
    if (is_parallel()) return {glm::dot(axes_[0], d) / extent_, glm::dot(axes_[1], d) / extent_, glm::dot(axes_[2], d)};
    const int k = face / 2;
    const double z = face % 2 ? -d[k] : d[k];
    return {d[(k + 1) % 3] / z, d[(k + 2) % 3] / z, z};
  }
  /// The plane of all points of depth > 0 whose place has `at` as its u (axis 0) or v (axis 1), positive where that is more.
  ClipPlane border(int face, int axis, double at) const {
    if (is_parallel()) return {axes_[axis], -glm::dot(axes_[axis], origin_) - at * extent_};
    glm::dvec3 normal(0);
    normal[(face / 2 + 1 + axis) % 3] = 1;
    normal[face / 2] = face % 2 ? at : -at;
    normal /= std::sqrt(1 + at * at);
    return {normal, -glm::dot(normal, origin_)};
  }
  /// The point at a place, in a depth.
  glm::dvec3 point_at(int face, const Seen& s) const {
    if (is_parallel()) return origin_ + extent_ * (s.u * axes_[0] + s.v * axes_[1]) + s.depth * axes_[2];
    const int k = face / 2;
    glm::dvec3 d;
    d[k] = face % 2 ? -s.depth : s.depth, d[(k + 1) % 3] = s.u * s.depth, d[(k + 2) % 3] = s.v * s.depth;
    return origin_ + d;
  }
  /// How far the light is from a plane; for a directional light how much a step along its rays, away from it, adds to that.
  double height(const ClipPlane& plane) const { return is_parallel() ? glm::dot(plane.normal, axes_[2]) : plane.at(origin_); }
  /// A plane's value as a function of the place, u * x + v * y + z: for a directional light that of the point with the depth 0;
  /// for any other what a point there is off the plane through the light, by its depth.
  glm::dvec3 line(int face, const glm::dvec3& normal, const glm::dvec3& on_plane) const {
    if (is_parallel())
      return {extent_ * glm::dot(normal, axes_[0]), extent_ * glm::dot(normal, axes_[1]), glm::dot(normal, origin_ - on_plane)};
    const int k = face / 2;
    return {normal[(k + 1) % 3], normal[(k + 2) % 3], face % 2 ? -normal[k] : normal[k]};
  }

 private:
  glm::dvec4 light_{0};
  double extent_ = 0, diagonal_ = 0, deepest_ = 0;
  glm::dvec3 origin_{0}, axes_[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

}  // namespace gnomon::two_pass_object
