#pragma once
#include <numbers>

#include "small_world.h"

// Scenes for whoever looks at maps.
namespace map_scenes {
using namespace gnomon;

/// Loose triangles and a box over a ground: casters at every height, before and beside each other.
inline Scene soup_over_ground(unsigned seed) {
  std::mt19937 random(seed);
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::random_soup(random, 25, 1.5f, 0.6f, 2.0f, 0.6f),
                  small_world::box({-2.5f, 0, -2.5f}, {-1.5f, 1, -1.2f})};
  return scene;
}

/// Whether the reference answers otherwise somewhere within `radius` of the point, across the light ray: such points are cut
/// with the tangent plane along their own light rays, as a texel's center is.
inline bool near_shadow_edge(const Scene& scene, const Light& light, const glm::dvec3& point, const glm::dvec3& normal,
                             double radius, bool dark) {
  const glm::dvec4 l = homogeneous(light);
  const glm::dvec3 to = glm::normalize(to_light(l, point));
  const glm::dvec3 u = glm::normalize(glm::cross(to, std::abs(to.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 v = glm::cross(to, u);
  for (int ring = 1; ring <= 6; ++ring)
    for (int k = 0; k < 24; ++k) {
      const double angle = 2 * std::numbers::pi * k / 24, r = radius * ring / 6;
      const glm::dvec3 moved = point + (u * std::cos(angle) + v * std::sin(angle)) * r;
      const glm::dvec3 ray = to_light(l, moved);
      const glm::dvec3 cut = moved + ray * (glm::dot(normal, point - moved) / glm::dot(normal, ray));
      if ((small_world::caster_distance(scene, light, cut) < INFINITY) != dark) return true;
    }
  return false;
}

/// Of each kind without area, along axes and aside.
inline const std::vector<Light> all_kinds = {
    {.name = "point", .kind = PointLight{{1, 4, 0.5f}}},
    {.name = "inside", .kind = PointLight{{0.2f, 1.2f, 0.3f}}},  // in the box of the soup: near planes and all six faces
    {.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.2f}}},
    {.name = "down", .kind = DirectionalLight{{0, -3, 0}}},
    {.name = "along_x", .kind = DirectionalLight{{1, -0.2f, 0}}},
    {.name = "along_z", .kind = DirectionalLight{{0, -0.2f, -1}}},
    {.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}},
    {.name = "wide_spot", .kind = SpotLight{{1, 3, 1}, {-0.2f, -1, -0.2f}, 60, 75}}};

}  // namespace map_scenes
