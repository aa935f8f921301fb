#pragma once
#include <gnomon/kit/clip.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::svbsp {

/// What counts as one and the same place: 10^-10 of the extent. Half a unit of float32, on which vertices and visible points
/// stand anyway, is 3 * 10^-8 of it; coordinates and cuts in double err by some 10^-15.
struct Epsilons {
  double across = 0;  ///< in x and y: meters for a sun, tangents for a lamp
  double meters = 0;  ///< from the plane of a triangle, in the world
};

/// A point as the light sees it: across in x and y, and how near in z, greater is nearer. A triangle of the world is a triangle
/// here, a plane a plane, and a shadow plane one along z: a line in x and y.
///
/// From a point light that is perspective, on the six faces of a cube around the light: x and y are -1 .. 1, z is one over the
/// distance along the face's axis. For a directional light there is one face, and all three are meters from the center of the
/// casters; z grows toward the light.
class LightSpace {
 public:
  LightSpace() = default;
  LightSpace(const glm::dvec4& light, const Bounds& casters) : is_point_(light.w != 0), origin_(light) {
    if (is_point_) {
      face_count_ = 6;
      return;
    }
    face_count_ = 1;
    origin_ = casters.empty() ? glm::dvec3(0) : 0.5 * (glm::dvec3(casters.min) + glm::dvec3(casters.max));
    const glm::dvec3 to = glm::normalize(glm::dvec3(light));
    const glm::dvec3 least = std::abs(to.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(least, to));
    axes_ = {u, glm::cross(to, u), to};
  }

  int face_count() const { return face_count_; }
  bool is_point() const { return is_point_; }

  /// The face in whose pyramid a point of the world lies.
  int face_of(const glm::dvec3& p) const {
    if (!is_point_) return 0;
    const glm::dvec3 q = p - origin_, a = glm::abs(q);
    const int k = a.x >= a.y ? (a.x >= a.z ? 0 : 2) : (a.y >= a.z ? 1 : 2);
    return 2 * k + (q[k] < 0);
  }

  /// Along the axes of a face, from the light or the center: before the perspective.
  glm::dvec3 turned(int face, const glm::dvec3& v) const {
    if (!is_point_) return {glm::dot(axes_[0], v), glm::dot(axes_[1], v), glm::dot(axes_[2], v)};
    const int k = face / 2;
    const double s = face % 2 ? -1 : 1;
    return {v[(k + 1) % 3], s * v[(k + 2) % 3], s * v[k]};
  }
  glm::dvec3 seen(int face, const glm::dvec3& p) const { return turned(face, p - origin_); }

  /// Of a point that `turned` gave and, for a point light, that lies before it.
  glm::dvec3 projected(const glm::dvec3& q) const {
    if (!is_point_) return q;
    const double z = 1 / q.z;
    return {q.x * z, q.y * z, z};
  }
  glm::dvec3 of_world(int face, const glm::dvec3& p) const { return projected(seen(face, p)); }

  glm::dvec3 to_world(int face, const glm::dvec3& p) const {
    if (!is_point_) return origin_ + p.x * axes_[0] + p.y * axes_[1] + p.z * axes_[2];
    const glm::dvec3 q = glm::dvec3(p.x, p.y, 1) / p.z;
    const int k = face / 2;
    const double s = face % 2 ? -1 : 1;
    glm::dvec3 v;
    v[(k + 1) % 3] = q.x, v[(k + 2) % 3] = s * q.y, v[k] = s * q.z;
    return origin_ + v;
  }

  /// Whether light space shows a triangle clockwise, whose corners and the light have this orient3d_sign: from a point light x,
  /// y and the way to the face are right-handed, so that it shows everything the other way about than the light sees it.
  bool is_clockwise(int facing) const { return is_point_ ? facing > 0 : facing < 0; }

  /// The plane of a triangle, positive on the light's side, where `facing` is orient3d_sign of its corners and the light. Its
  /// value at a point, divided by `meter(point)`, is the point's distance in the world.
  ClipPlane plane(int face, const glm::vec3* corners, int facing) const {
    const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
    const glm::dvec3 normal = glm::normalize(turned(face, glm::cross(b - a, c - a))) * static_cast<double>(facing);
    const double offset = -glm::dot(normal, seen(face, a));
    if (!is_point_) return {normal, offset};
    return {{normal.x, normal.y, offset}, normal.z};
  }
  double meter(const glm::dvec3& p) const { return is_point_ ? p.z : 1; }

  /// For casters that are `across` wide in light space, with coordinates up to `extent` in the world. From far away the casters
  /// are small on their face, whose rounding is 2^-53, and distances among them are small beside those from the light.
  Epsilons epsilons(double across, double extent) const {
    if (!is_point_) return {1e-10 * across, 1e-10 * extent};
    const double far = std::max({std::abs(origin_.x), std::abs(origin_.y), std::abs(origin_.z)});
    return {std::max(1e-10 * across, 0x1p-49), std::max(1e-10 * extent, 0x1p-48 * far)};
  }

 private:
  bool is_point_ = false;
  int face_count_ = 0;
  glm::dvec3 origin_{0};
  std::array<glm::dvec3, 3> axes_{};
};

}  // namespace gnomon::svbsp
