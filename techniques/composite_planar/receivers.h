#pragma once
#include <gnomon/kit/across.h>
#include <gnomon/kit/planes.h>

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

/// The planes on which shadows are answered. Curved shapes are none, whatever their triangles say.
struct Receivers {
  std::vector<Receiver> planes;
  double tolerance = 0;      ///< points up to this far off a plane lie on it, meters
  double covered_share = 0;  ///< of the receiving area
};

inline bool is_sheet(const Mesh& mesh) { return !mesh.has_curved_shape() || std::holds_alternative<Disc>(*mesh.shape); }

inline double area_of(const Mesh& mesh) {
  double area = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    area += glm::length(glm::cross(b - a, c - a)) / 2;
  }
  return area;
}

inline Receivers find_receivers(const Scene& scene, double min_share) {
  Scene flat;
  double curved_area = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.receives) continue;
    if (is_sheet(mesh))
      flat.meshes.push_back(mesh);
    else
      curved_area += area_of(mesh);
  }
  const ReceiverPlanes found = find_receiver_planes(flat, min_share);
  Receivers receivers;
  receivers.tolerance = found.tolerance + height_rounding(scene);
  const double whole = found.receiving_area + curved_area;
  receivers.covered_share = whole > 0 ? found.planar_area / whole : 0;

  // Each side of a rectangle goes through the point that is farthest out.
  for (const ReceiverPlane& plane : found.planes) {
    const auto [u, v] = Across(glm::dvec3(plane.plane));
    receivers.planes.push_back(
        {plane.plane,
         {glm::dvec4(u, -INFINITY), glm::dvec4(-u, -INFINITY), glm::dvec4(v, -INFINITY), glm::dvec4(-v, -INFINITY)}});
  }
  const auto reach = [&](Receiver& receiver, const glm::vec3& p, double radius) {
    for (glm::dvec4& side : receiver.sides)
      side.w = std::max(side.w, receivers.tolerance + radius - glm::dot(glm::dvec3(side), glm::dvec3(p)));
  };
  const auto face = [](Receiver& receiver, const glm::dvec3& normal) {
    const glm::dvec3 n = glm::normalize(normal), up(receiver.plane);
    // G-buffer and shader round three numbers up to 1 each.
    receiver.turn = std::max(receiver.turn, std::min(glm::distance(n, up), glm::distance(n, -up)) + 0x1p-21);
  };
  std::size_t triangle = 0;
  for (const Mesh& mesh : flat.meshes) {
    // A disc reaches beyond its triangles, which are inscribed.
    const auto* disc = mesh.shape ? std::get_if<Disc>(&*mesh.shape) : nullptr;
    for (const glm::uvec3& t : mesh.triangles) {
      const std::uint32_t plane = found.plane_of[triangle++];
      if (plane == no_plane) continue;
      const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
      face(receivers.planes[plane], glm::cross(b - a, c - a));
      if (disc) face(receivers.planes[plane], disc->normal);
      if (disc) reach(receivers.planes[plane], disc->center, disc->radius);
      for (const std::uint32_t v : {t.x, t.y, t.z}) reach(receivers.planes[plane], mesh.positions[v], 0);
    }
  }
  // The base of a cone counts for no plane, but it may lie in one.
  for (const Mesh& mesh : scene.meshes) {
    const auto* cone = mesh.receives && mesh.shape ? std::get_if<Cone>(&*mesh.shape) : nullptr;
    if (!cone) continue;
    for (Receiver& receiver : receivers.planes) {
      const glm::dvec3 lean = glm::cross(glm::normalize(glm::dvec3(cone->axis)), glm::dvec3(receiver.plane));
      const double off = std::abs(glm::dot(receiver.plane, glm::dvec4(cone->base, 1))) + cone->radius * glm::length(lean);
      if (off <= receivers.tolerance) reach(receiver, cone->base, cone->radius);
    }
  }
  return receivers;
}

}  // namespace composite_planar
