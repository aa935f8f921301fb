#pragma once
// Lights with area for tests.
#include <cmath>

#include "small_world.h"

namespace gnomon {

inline Light rect(const glm::vec3& center, const glm::vec3& half_u, const glm::vec3& half_v,
                  Emits emits = Emits::on_both_sides) {
  return {.name = "rect", .kind = RectLight{center, half_u, half_v, emits}};
}
inline Light disc(const glm::vec3& center, const glm::vec3& normal, float radius) {
  return {.name = "disc", .kind = DiscLight{center, normal, radius}};
}
inline Light sphere(const glm::vec3& center, float radius) { return {.name = "sphere", .kind = SphereLight{center, radius}}; }

/// Each kind, above a scene and among its casters of -2 .. 2, larger and smaller than they are.
inline Light random_light(Random& random) {
  const glm::vec3 center(random.below(2) ? random.uniform({-3, 3, -3}, {3, 6, 3})
                                         : random.uniform(glm::dvec3(-2), glm::dvec3(2)));
  const double size = std::pow(10.0, random.uniform(-2, 0.5));
  if (random.below(3) == 0) return sphere(center, static_cast<float>(size));
  const glm::vec3 u(size * small_world::direction_of(random)), v(size * small_world::direction_of(random));
  if (random.below(2)) return disc(center, u, static_cast<float>(size));
  return rect(center, u, v, random.below(4) ? Emits::on_both_sides : Emits::in_front);
}

}  // namespace gnomon
