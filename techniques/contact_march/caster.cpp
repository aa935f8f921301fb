#include "caster.h"

namespace gnomon::contact_march {

namespace {

/// What the ray recipe does not count: the pixel's own triangle; its own curved shape, unless the ray leaves it from inside.
bool is_own(const Scene& scene, const GBuffer& gbuffer, std::size_t i, const RayScene::Hit& hit, const glm::dvec3& direction) {
  if (hit.mesh != gbuffer.mesh[i]) return false;
  const Mesh& mesh = scene.meshes[hit.mesh];
  if (gbuffer.truth == Truth::shape && mesh.has_curved_shape())
    return std::holds_alternative<Disc>(*mesh.shape) || glm::dot(hit.normal, direction) <= 0;
  return hit.triangle == gbuffer.triangle[i];
}

}  // namespace

Caster nearest_caster(const RayScene& casters, const GBuffer& gbuffer, const glm::dvec4& light, std::size_t i) {
  const glm::vec3 point = gbuffer.position(i);
  const glm::dvec3 lifted = glm::dvec3(point) + ray_offset(point) * glm::dvec3(gbuffer.normal(i));
  const glm::dvec3 to = to_light(light, lifted);
  const double length = glm::length(to), end = light.w != 0 ? length : INFINITY;
  const glm::dvec3 direction = to / length;
  // A ray to the closest hit has no filter: it goes on behind what does not count, farther by what rounding to float32 may move
  // a hit. A line meets a triangle or a convex shape twice at most.
  double start = 0;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 from = lifted + start * direction;
    const RayScene::Hit hit = casters.closest_caster(from, direction);
    const double distance = start + hit.t;
    if (hit.mesh == no_mesh || distance >= end) return {};
    const glm::dvec3 place = lifted + distance * direction;
    if (!is_own(casters.scene(), gbuffer, i, hit, direction)) return {hit.mesh, hit.triangle, distance, place};
    start = distance + 16 * 0x1p-24 * (extent(from) + distance);
  }
  return {};
}

}  // namespace gnomon::contact_march
