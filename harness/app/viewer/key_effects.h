#pragma once
#include <gnomon/scene.h>

#include <optional>
#include <string>
#include <variant>

#include "app/viewer/compose.h"

namespace gnomon::viewer {

/// What a key does that changes no camera, light, scene or paint.
enum class Action {
  technique_before,
  technique_after,
  swap_sides,
  layer_after,
  silhouettes,
  magnifier,
  panels,
  reset_view,
  reset_light,
  save,
  copy_command,
  screenshot,
  help,
  quit,
  cancel,
};

// Steps of the camera and the light; what one step is says `moved_by_key`.
struct OrbitSteps {
  int right = 0, up = 0;
  bool operator==(const OrbitSteps&) const = default;
};
struct ZoomSteps {
  int nearer = 0;
  bool operator==(const ZoomSteps&) const = default;
};
struct FlySteps {
  int right = 0, up = 0, forward = 0;
  bool operator==(const FlySteps&) const = default;
};
struct LightSteps {
  int x = 0, y = 0;
  bool operator==(const LightSteps&) const = default;
};
/// Shows a scene with one of its parameters set; that scene declares the key.
struct SceneSetting {
  std::string scene, parameter, value;
  bool operator==(const SceneSetting&) const = default;
};

/// What a key does.
using KeyEffect = std::variant<Action, OrbitSteps, ZoomSteps, FlySteps, LightSteps, Layout, Paint, SceneSetting>;

/// The view after `count` steps: 5 degrees around the target, a tenth of the way to it, or `key_step` of flying each. Nothing
/// for keys that do not move the camera; `reset_view` is the session's.
std::optional<View> moved_by_key(const View& view, const Scene& scene, const KeyEffect& effect, double count);
/// The light after `count` steps: its handle moves by `key_step` each along the world's x or y. Nothing for other keys.
std::optional<Light> moved_by_key(const Light& light, const Scene& scene, const KeyEffect& effect, double count);

}  // namespace gnomon::viewer
