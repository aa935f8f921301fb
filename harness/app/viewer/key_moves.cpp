#include "app/viewer/key_moves.h"

#include <numbers>

#include "app/viewer/moves.h"

namespace gnomon::viewer {

std::optional<View> moved_by_key(const View& view, const Scene& scene, Action action, double steps) {
  constexpr double turn = std::numbers::pi / 36;  // 5 degrees
  switch (action) {
    case Action::orbit_left:
      return orbit_by(view, {-turn * steps, 0});
    case Action::orbit_right:
      return orbit_by(view, {turn * steps, 0});
    case Action::orbit_up:
      return orbit_by(view, {0, turn * steps});
    case Action::orbit_down:
      return orbit_by(view, {0, -turn * steps});
    case Action::nearer:
      return zoom(view, steps);
    case Action::farther:
      return zoom(view, -steps);
    case Action::fly_left:
      return fly(view, {-steps, 0, 0}, key_step(scene));
    case Action::fly_right:
      return fly(view, {steps, 0, 0}, key_step(scene));
    case Action::fly_down:
      return fly(view, {0, -steps, 0}, key_step(scene));
    case Action::fly_up:
      return fly(view, {0, steps, 0}, key_step(scene));
    case Action::fly_back:
      return fly(view, {0, 0, -steps}, key_step(scene));
    case Action::fly_forward:
      return fly(view, {0, 0, steps}, key_step(scene));
    default:
      return std::nullopt;
  }
}

std::optional<Light> moved_by_key(const Light& light, const Scene& scene, Action action, double steps) {
  const auto by = [&](const glm::dvec3& way) {
    return light_moved_to(scene, light, light_place(scene, light) + steps * key_step(scene) * way);
  };
  switch (action) {
    case Action::light_left:
      return by({-1, 0, 0});
    case Action::light_right:
      return by({1, 0, 0});
    case Action::light_down:
      return by({0, -1, 0});
    case Action::light_up:
      return by({0, 1, 0});
    default:
      return std::nullopt;
  }
}

}  // namespace gnomon::viewer
