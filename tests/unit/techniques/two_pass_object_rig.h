#pragma once
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "hard_scenes.h"
#include "small_world.h"

extern "C" void gnomon_technique_two_pass_object(gnomon::Registry& registry);

/// Two-pass object precision brought up to masks and polygons.
namespace two_pass_object_rig {
using namespace gnomon;
using namespace hand_made;

inline small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_two_pass_object, settings, scene, light, gbuffer);
}

inline SurfaceDetail detail_of(const std::string& settings, const Scene& scene, const Light& light) {
  Picture nothing(1, 1);
  return run(settings, scene, light, nothing.gbuffer).technique->surface_detail().value();
}

inline Triangle triangle_of(const Scene& scene, std::uint32_t mesh, std::uint32_t triangle) {
  const Mesh& m = scene.meshes[mesh];
  const glm::uvec3& t = m.triangles[triangle];
  return {{m.positions[t.x], m.positions[t.y], m.positions[t.z]}};
}

/// Twice the area vector of a polygon.
inline glm::dvec3 area_vector(std::span<const glm::dvec3> corners) {
  glm::dvec3 sum(0);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) sum += glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
  return sum;
}

inline std::span<const glm::dvec3> corners_of(const SurfaceDetail& detail, const DetailPolygon& polygon) {
  return {detail.corners.data() + polygon.first, polygon.count};
}

}  // namespace two_pass_object_rig
