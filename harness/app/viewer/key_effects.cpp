#include "app/viewer/key_effects.h"

#include <numbers>

#include "app/viewer/moves.h"

namespace gnomon::viewer {

std::optional<View> moved_by_key(const View& view, const Scene& scene, const KeyEffect& effect, double count) {
  constexpr double turn = std::numbers::pi / 36;  // 5 degrees
  if (const auto* orbit = std::get_if<OrbitSteps>(&effect))
    return orbit_by(view, turn * count * glm::dvec2(orbit->right, orbit->up));
  if (const auto* way = std::get_if<ZoomSteps>(&effect)) return zoom(view, count * way->nearer);
  if (const auto* way = std::get_if<FlySteps>(&effect))
    return fly(view, count * glm::dvec3(way->right, way->up, way->forward), key_step(scene));
  return std::nullopt;
}

std::optional<Light> moved_by_key(const Light& light, const Scene& scene, const KeyEffect& effect, double count) {
  const auto* const way = std::get_if<LightSteps>(&effect);
  if (!way) return std::nullopt;
  return light_moved_to(scene, light, light_place(scene, light) + count * key_step(scene) * glm::dvec3(way->x, way->y, 0));
}

}  // namespace gnomon::viewer
