#pragma once
#include <gnomon/kit/geometry/planes.h>
#include <gnomon/scene.h>

#include <algorithm>

namespace gnomon::distance_field {

/// Whether a mesh is flat and hides no light from any receiver, because all of them are on the side of it on which the light's
/// center is, as over a ground. `light` is homogeneous.
inline bool lies_behind_all(const Scene& scene, const Mesh& mesh, const glm::dvec4& light) {
  if (mesh.triangles.empty()) return true;
  const Triangle first = mesh.corners(0);
  const double length = glm::length(first.normal());
  if (!(length > 0)) return false;
  const glm::dvec3 origin(first.points[0]);
  const double toward = glm::dot(first.normal(), to_light(light, origin));
  const glm::dvec3 up = first.normal() / (toward < 0 ? -length : length);
  const double rounding = height_rounding(scene);
  const auto height = [&](const glm::vec3& p) { return glm::dot(up, glm::dvec3(p) - origin); };
  return std::ranges::all_of(mesh.positions, [&](const glm::vec3& p) { return height(p) <= rounding; }) &&
         std::ranges::all_of(scene.meshes, [&](const Mesh& other) {
           return (&other != &mesh && !other.receives) ||
                  std::ranges::all_of(other.positions, [&](const glm::vec3& p) { return height(p) >= -rounding; });
         });
}

/// The first caster without an inside that may hide the light; null where there is none. `light` is homogeneous.
inline const Mesh* sheet_in(const Scene& scene, const glm::dvec4& light) {
  for (const Mesh& mesh : scene.meshes)
    if (mesh.casts && !mesh.facts.closed() && !lies_behind_all(scene, mesh, light)) return &mesh;
  return nullptr;
}

}  // namespace gnomon::distance_field
