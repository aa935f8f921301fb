#include "measure/frame/point_rays.h"

#include <gnomon/kit/geometry/holes.h>

#include "measure/frame/ray_packets.h"

namespace gnomon {

PointRays::Shares PointRays::ask(std::span<const SurfacePoint> points, std::span<Crossings, ray_lanes> crossings) const {
  Shares result;
  ShadowPacket packet{};
  std::uint32_t mesh[ray_lanes] = {}, triangle[ray_lanes] = {};
  glm::dvec3 origins[ray_lanes], ways[ray_lanes];
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SurfacePoint& point = points[k];
    if (point.mesh == no_mesh || !scene_.meshes[point.mesh].receives || !in_spot_cone(light_, point.position)) continue;
    if (!(glm::dot(glm::dvec3(point.normal), to_light(l_, point.position)) > 0)) continue;
    result.faces |= 1u << k;
    mesh[k] = point.mesh;
    triangle[k] = point.triangle;
    const glm::vec3 origin = point.position + static_cast<float>(ray_offset(point.position)) * point.normal;
    const glm::vec3 way = glm::vec3(l_) - static_cast<float>(l_.w) * origin;
    set_ray(packet, static_cast<int>(k), origin, way, end_of(l_));
    origins[k] = origin;
    ways[k] = way;
  }
  if (!result.faces) return result;
  const Receivers receivers{mesh, triangle};
  const bool has_transmission = casters_.has_transmission();
  const std::uint32_t blocked = has_transmission ? casters_.crossed(result.faces, packet, receivers, crossings)
                                                 : casters_.occluded(result.faces, packet, receivers);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!(result.faces >> k & 1) || blocked >> k & 1) continue;
    const auto along = [&](std::uint32_t m, std::uint32_t t) {
      return transmission_along(scene_.meshes[m], t, origins[k], ways[k]);
    };
    result.share[k] = has_transmission ? static_cast<float>(crossings[k].product(along).share.x) : 1.0f;
  }
  return result;
}

}  // namespace gnomon
