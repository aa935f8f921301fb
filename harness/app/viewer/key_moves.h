#pragma once
#include <gnomon/scene.h>

#include <optional>

#include "app/viewer/keys.h"

namespace gnomon::viewer {

/// The view after `steps` of a camera key: 5 degrees around the target, a tenth of the way, or `key_step` of flying each.
/// Nothing for keys that do not move the camera; resets are the caller's.
std::optional<View> moved_by_key(const View& view, const Scene& scene, Action action, double steps);

/// The light after `steps` of a light key: its handle moves by `key_step` each along the world's x or y. Nothing for other
/// keys.
std::optional<Light> moved_by_key(const Light& light, const Scene& scene, Action action, double steps);

}  // namespace gnomon::viewer
