#pragma once
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/geometry/planes.h>

#include <algorithm>
#include <array>

namespace composite_planar {
using namespace gnomon;

/// A receiver plane with the rectangle that what lies on it fills or lies in.
struct Receiver {
  glm::dvec4 plane{0};
  std::array<glm::dvec4, 4> sides;  ///< of the rectangle: half-spaces, dot(side, (p, 1)) >= 0 inside
  /// Unit normals of what lies on the plane are this near its own. It keeps apart what crosses the plane at a small angle.
  double turn = 0;
};

/// The planes that receive shadows. Curved shapes are none, whatever their triangles are.
struct ReceiverSet {
  std::vector<Receiver> planes;
  double tolerance = 0;      ///< points up to this far off a plane lie on it, meters
  double covered_share = 0;  ///< of the receiving area
};

inline double area_of(const Mesh& mesh) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area += glm::length(mesh.corners(t).normal()) / 2;
  return area;
}

/// A receiver whose rectangle is still empty.
inline Receiver begin(const glm::dvec4& plane) {
  const auto [u, v] = Across(glm::dvec3(plane));
  return {plane, {glm::dvec4(u, -INFINITY), glm::dvec4(-u, -INFINITY), glm::dvec4(v, -INFINITY), glm::dvec4(-v, -INFINITY)}};
}

/// Each side of the rectangle goes through the point that is farthest out.
inline void reach(Receiver& receiver, const glm::vec3& p, double radius) {
  for (glm::dvec4& side : receiver.sides) side.w = std::max(side.w, radius - glm::dot(glm::dvec3(side), glm::dvec3(p)));
}

/// G-buffer and shader round three numbers up to 1 each.
inline void turn_to(Receiver& receiver, const glm::dvec3& normal) {
  const glm::dvec3 n = glm::normalize(normal), up(receiver.plane);
  receiver.turn = std::max(receiver.turn, std::min(glm::distance(n, up), glm::distance(n, -up)) + 0x1p-21);
}

/// Adds the parts of a sheet on the planes. A disc reaches beyond its triangles, which are inscribed.
inline void add_sheet(const Mesh& mesh, std::span<const std::uint32_t> plane_of, ReceiverSet& receivers) {
  const auto* disc = mesh.shape ? std::get_if<Disc>(&*mesh.shape) : nullptr;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (plane_of[t] == no_plane) continue;
    Receiver& receiver = receivers.planes[plane_of[t]];
    const Triangle triangle = mesh.corners(t);
    turn_to(receiver, triangle.normal());
    if (disc) {
      turn_to(receiver, disc->normal);
      reach(receiver, disc->center, receivers.tolerance + disc->radius);
    }
    for (const glm::vec3& corner : triangle.points) reach(receiver, corner, receivers.tolerance);
  }
}

/// The base of a cone makes no plane, but it may lie in one.
inline void add_base(const Cone& cone, ReceiverSet& receivers) {
  for (Receiver& receiver : receivers.planes) {
    const glm::dvec3 lean = glm::cross(glm::normalize(glm::dvec3(cone.axis)), glm::dvec3(receiver.plane));
    const double off = std::abs(glm::dot(receiver.plane, glm::dvec4(cone.base, 1))) + cone.radius * glm::length(lean);
    if (off <= receivers.tolerance) reach(receiver, cone.base, receivers.tolerance + cone.radius);
  }
}

inline ReceiverSet find_receivers(const Scene& scene, double min_share) {
  Scene flat;
  double curved_area = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.receives) continue;
    if (!mesh.has_curved_shape() || std::holds_alternative<Disc>(*mesh.shape))
      flat.meshes.push_back(mesh);
    else
      curved_area += area_of(mesh);
  }
  const ReceiverPlanes found = find_receiver_planes(flat, min_share);
  ReceiverSet receivers;
  receivers.tolerance = found.tolerance + height_rounding(scene);
  const double whole = found.receiving_area + curved_area;
  receivers.covered_share = whole > 0 ? found.planar_area / whole : 0;
  for (const ReceiverPlane& plane : found.planes) receivers.planes.push_back(begin(plane.plane));
  for (std::size_t m = 0; m < flat.meshes.size(); ++m)
    add_sheet(flat.meshes[m], std::span(found.plane_of).subspan(found.first_triangle[m]), receivers);
  for (const Mesh& mesh : scene.meshes)
    if (const auto* cone = mesh.receives && mesh.shape ? std::get_if<Cone>(&*mesh.shape) : nullptr) add_base(*cone, receivers);
  return receivers;
}

/// The receiver turned toward the light; nothing for a light in the plane, as far as float32 can tell.
inline std::optional<Receiver> facing(const Receiver& receiver, const glm::dvec4& light, double tolerance) {
  Receiver turned = receiver;
  if (glm::dot(turned.plane, light) < 0) turned.plane = -turned.plane;
  const bool is_edge_on = glm::dot(turned.plane, light) <= (light.w != 0 ? tolerance : 0x1p-24 * glm::length(light));
  return is_edge_on ? std::nullopt : std::optional(turned);
}

/// Whether some of the shape lies over the plane and below the light.
inline bool may_cast(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, double tolerance) {
  const auto [low, high] = heights_over(shape, plane);
  return high > tolerance && (light.w == 0 || low < glm::dot(plane, light));
}

}  // namespace composite_planar
