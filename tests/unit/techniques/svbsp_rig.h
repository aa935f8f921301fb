#pragma once
// The technique svbsp brought up to one light, in the orders it has.
#include <gnomon/registry.h>

#include "hand_made.h"
#include "small_world.h"

extern "C" void gnomon_technique_svbsp(gnomon::Registry& registry);

namespace gnomon::svbsp_rig {

inline small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_svbsp, settings, scene, light, gbuffer);
}

/// Without a picture to speak of.
inline std::unique_ptr<Technique> lit(const std::string& settings, const Scene& scene, const Light& light) {
  return run(settings, scene, light, hand_made::Picture(1, 1).gbuffer).technique;
}

inline constexpr const char* all_orders[] = {"", "order=bsp", "order=bsp,split=first",
                                             "order=bsp,free_cuts=false,split=fewest_splits", "order=face_planes"};

inline double area_of(const SurfaceDetail& detail, const DetailPolygon& polygon) {
  const glm::dvec3* p = detail.corners.data() + polygon.first;
  glm::dvec3 twice(0);
  for (std::uint32_t k = 1; k + 1 < polygon.count; ++k) twice += glm::cross(p[k] - p[0], p[k + 1] - p[0]);
  return glm::length(twice) / 2;
}

/// Of all lit, or all shadowed, polygons of a mesh.
inline double area(const SurfaceDetail& detail, std::uint32_t mesh, bool is_lit) {
  double sum = 0;
  for (const DetailPolygon& polygon : detail.polygons)
    if (polygon.mesh == mesh && polygon.is_lit == is_lit) sum += area_of(detail, polygon);
  return sum;
}

}  // namespace gnomon::svbsp_rig
