#pragma once
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/maps/light_space.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>

namespace gnomon::svbsp {

/// What counts as one and the same place: 10^-10 of the extent. Vertices and visible points are rounded to float32 anyway, by
/// 3 * 10^-8 of it; coordinates and cuts in double err by some 10^-15.
struct Epsilons {
  double across = 0;  ///< in x and y: meters for a directional light, tangents for a point light
  double meters = 0;  ///< from the plane of a triangle, in the world
  bool operator==(const Epsilons&) const = default;
};

/// Light space in which planes stay planes, and z is how near a point is to the light: greater is nearer. x and y are a
/// point's place (kit/maps/light_space.h); z is one over the distance along the face's axis, for a directional light that
/// distance reversed. A shadow plane is one along z: a line in x and y.
class ProjectedSpace {
 public:
  ProjectedSpace() = default;
  ProjectedSpace(const glm::dvec4& light, const Bounds& casters) {
    if (light.w != 0) {
      space_ = LightSpace(glm::dvec3(light), glm::dmat3(1), OppositeFaces::turned, 0);
      return;
    }
    const glm::dvec3 to = glm::normalize(glm::dvec3(light));
    const auto [u, v] = Across::by_x(to, 0.6);
    const glm::dvec3 center = casters.empty() ? glm::dvec3(0) : 0.5 * (glm::dvec3(casters.min) + glm::dvec3(casters.max));
    space_ = LightSpace(LightSpaceFace{center, frame_of(u, v, -to), false});
  }

  bool operator==(const ProjectedSpace&) const = default;
  int face_count() const { return space_.face_count(); }
  bool is_point() const { return !space_.is_parallel(); }
  int face_of(const glm::dvec3& p) const { return space_.face_of(p); }

  /// A point of the world in the frame of a face, before it is projected.
  glm::dvec3 seen(int face, const glm::dvec3& p) const { return space_[face].seen(p); }
  /// Of a point in that frame; for a point light of one with z > 0.
  glm::dvec3 projected(const glm::dvec3& q) const {
    if (!is_point()) return {q.x, q.y, -q.z};
    const double z = 1 / q.z;
    return {q.x * z, q.y * z, z};
  }
  glm::dvec3 of_world(int face, const glm::dvec3& p) const { return projected(seen(face, p)); }
  /// The face that sees a point of the world, and its place and nearness there.
  std::pair<int, glm::dvec3> of_world(const glm::dvec3& p) const {
    const auto [face, at] = space_.seen(p);
    return {face, projected(at)};
  }
  glm::dvec3 to_world(int face, const glm::dvec3& p) const {
    return space_[face].to_world(is_point() ? glm::dvec3(p.x, p.y, 1) / p.z : glm::dvec3(p.x, p.y, -p.z));
  }

  /// Whether a triangle whose corners and the light have this orient3d_sign is clockwise here: from a point light x, y and the
  /// way to the face are right-handed, so that the winding is the reverse of what the light sees.
  bool is_clockwise(int facing) const { return is_point() ? facing > 0 : facing < 0; }

  /// The plane of a triangle, positive on the light's side, where `facing` is orient3d_sign of its corners and the light. Its
  /// value at a point, divided by `meter(point)`, is the point's distance in the world.
  ClipPlane plane(int face, const glm::vec3* corners, int facing) const {
    const glm::dvec3 a(corners[0]), b(corners[1]), c(corners[2]);
    const glm::dvec3 normal = glm::normalize(space_[face].turned(glm::cross(b - a, c - a))) * static_cast<double>(facing);
    const double offset = -glm::dot(normal, seen(face, a));
    if (!is_point()) return {{normal.x, normal.y, -normal.z}, offset};
    return {{normal.x, normal.y, offset}, normal.z};
  }
  double meter(const glm::dvec3& p) const { return is_point() ? p.z : 1; }

  /// For casters that are `across` wide here, with coordinates up to `extent` in the world. From far away the casters are small
  /// on their face, whose rounding is 2^-53, and distances among them are small beside those from the light.
  Epsilons epsilons(double across, double extent) const {
    if (!is_point()) return {1e-10 * across, 1e-10 * extent};
    const glm::dvec3 light = glm::abs(space_[0].origin);
    const double far = std::max({light.x, light.y, light.z});
    return {std::max(1e-10 * across, 0x1p-49), std::max(1e-10 * extent, 0x1p-48 * far)};
  }

 private:
  LightSpace space_;
};

}  // namespace gnomon::svbsp
