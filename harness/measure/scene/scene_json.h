#pragma once
#include <gnomon/scene.h>

#include <string>
#include <utility>
#include <vector>

#include "measure/json.h"

namespace gnomon {

/// The numbers of a light, view or shape under the keys of a scene file, in its units: meters, degrees. A float has as few
/// digits as read back as the same float.
using SceneKeys = std::vector<std::pair<std::string, Json>>;
SceneKeys scene_keys(const Light& light);
SceneKeys scene_keys(const View& view);
SceneKeys scene_keys(const Shape& shape);

Json number_json(float value);
Json number_json(const glm::vec3& v);

/// "repeat", "mirror", "clamp".
std::string_view wrap_name(AlphaMask::Wrap wrap);

/// {"name", "kind", and its keys}; of a view without a kind, of a shape without a name.
Json scene_json(const Light& light);
Json scene_json(const View& view);
Json scene_json(const Shape& shape);

}  // namespace gnomon
