#pragma once
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/maps/light_space.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>

namespace gnomon::two_pass_object {

/// A point as the light sees it: its place on a face, and its depth in meters along the face's axis. Of two points with one
/// place the farther one has the larger depth.
struct PlaceAndDepth {
  double u, v, depth;
};

/// Light space (kit/maps/light_space.h) in which places are numbers about 1: within -1 .. 1 on the faces of a cube, and within
/// -2 .. 2 for a directional light, whose unit is the extent of the scene.
class SceneLightSpace {
 public:
  SceneLightSpace() = default;
  SceneLightSpace(const glm::dvec4& light, const Bounds& bounds) : light_(light) {
    if (bounds.empty()) return;
    const glm::dvec3 low(bounds.min), high(bounds.max), center = (low + high) / 2.0;
    extent_ = bounds.extent();
    diagonal_ = glm::distance(low, high);
    if (is_parallel()) {
      const glm::dvec3 away = -glm::dvec3(light) / glm::length(glm::dvec3(light));
      const auto [u, v] = Across(away);
      space_ = LightSpace(LightSpaceFace{center, frame_of(u, v, away), false});
    } else {
      space_ = LightSpace(glm::dvec3(light), glm::dmat3(1), OppositeFaces::mirrored, 2);
    }
    deepest_ = glm::distance(space_.main().origin, center) + diagonal_ / 2;
  }

  const glm::dvec4& light() const { return light_; }
  bool is_parallel() const { return light_.w == 0; }

  double diagonal() const { return diagonal_; }
  /// Nothing of the scene lies deeper, in meters.
  double deepest() const { return deepest_; }
  /// Corners this close to a plane count as on it. Cuts of cuts in double err by some 1e-15 of the extent, and neighbors in
  /// float32 are 6e-8 of it apart: 1e-10 is far from both.
  double epsilon() const { return 1e-10 * extent_; }
  /// More than a receiver's point in float32 lies off its triangle: the root of 3 times half a unit in the last place.
  double rounding() const { return 0x1p-22 * extent_; }
  /// Points this close to a shadow plane are not decided by polygons; planes that may err by more than a quarter are not used.
  double doubt() const { return 0x1p-24 * extent_; }
  /// Whether a place at this depth is not lost in rounding.
  bool has_place(double depth) const { return is_parallel() || depth > 0x1p-30 * extent_; }

  int face_of(const glm::dvec3& p) const { return space_.face_of(p); }
  double depth(int face, const glm::dvec3& p) const { return space_[face].seen(p).z; }
  /// In a cube, of points with positive depth.
  PlaceAndDepth seen(int face, const glm::dvec3& p) const { return place_of(space_[face].seen(p)); }
  /// The face that sees a point, and its place there.
  std::pair<int, PlaceAndDepth> seen(const glm::dvec3& p) const {
    const auto [face, q] = space_.seen(p);
    return {face, place_of(q)};
  }
  /// The plane of all points of depth > 0 whose place has `at` as its u (axis 0) or v (axis 1), positive where that is more.
  ClipPlane border(int face, int axis, double at) const {
    const LightSpaceFace& f = space_[face];
    if (is_parallel()) return {f.axis(axis), -glm::dot(f.axis(axis), f.origin) - at * extent_};
    const glm::dvec3 normal = (f.axis(axis) - at * f.axis(2)) / std::sqrt(1 + at * at);
    return {normal, -glm::dot(normal, f.origin)};
  }
  /// The point at a place, in a depth.
  glm::dvec3 point_at(int face, const PlaceAndDepth& p) const {
    const double unit = is_parallel() ? extent_ : p.depth;
    return space_[face].to_world({unit * p.u, unit * p.v, p.depth});
  }
  /// How far the light is from a plane; for a directional light how much a step along its rays, away from it, adds to that.
  double height(const ClipPlane& plane) const {
    const LightSpaceFace& f = space_.main();
    return is_parallel() ? glm::dot(plane.normal, f.axis(2)) : plane.at(f.origin);
  }
  /// A plane's value as a function of the place, u * x + v * y + z: for a directional light that of the point with the depth 0;
  /// for any other what a point there is off the plane through the light, by its depth.
  glm::dvec3 line(int face, const glm::dvec3& normal, const glm::dvec3& on_plane) const {
    const LightSpaceFace& f = space_[face];
    const glm::dvec3 n = f.turned(normal);
    return is_parallel() ? glm::dvec3(extent_ * n.x, extent_ * n.y, glm::dot(normal, f.origin - on_plane)) : n;
  }

 private:
  PlaceAndDepth place_of(const glm::dvec3& q) const {
    const double unit = is_parallel() ? extent_ : q.z;
    return {q.x / unit, q.y / unit, q.z};
  }

  glm::dvec4 light_{0};
  double extent_ = 0;  // largest coordinate of the scene, meters: what float32 rounds by
  double diagonal_ = 0, deepest_ = 0;
  LightSpace space_;
};

}  // namespace gnomon::two_pass_object
