#include "measure/scene/scene_json.h"

#include <fmt/format.h>

#include "measure/scene/parts.h"

namespace gnomon {

namespace {

/// Of a light's kind or a shape.
SceneKeys keys_of(const auto& kind) {
  SceneKeys keys;
  const auto add = [&](const char* key, const auto& value) { keys.emplace_back(key, number_json(value)); };
  if constexpr (requires { kind.points; })
    keys.emplace_back("points",
                      Json::array({number_json(kind.points[0]), number_json(kind.points[1]), number_json(kind.points[2])}));
  else
    for_each_part(kind, add, add, add, add);
  if constexpr (requires { kind.outer_degrees; }) {
    add("inner_degrees", kind.inner_degrees);
    add("outer_degrees", kind.outer_degrees);
  }
  if constexpr (requires { kind.emits; }) keys.emplace_back("one_sided", kind.emits == Emits::in_front);
  return keys;
}

Json object(Json named, const SceneKeys& keys) {
  for (const auto& [key, value] : keys) named[key] = value;
  return named;
}

}  // namespace

Json number_json(float value) { return parse_json(fmt::format("{}", value)); }
Json number_json(const glm::vec3& v) { return Json::array({number_json(v.x), number_json(v.y), number_json(v.z)}); }

SceneKeys scene_keys(const Light& light) {
  SceneKeys keys = std::visit([](const auto& kind) { return keys_of(kind); }, light.kind);
  keys.emplace_back("intensity", number_json(light.intensity));
  return keys;
}
SceneKeys scene_keys(const View& view) {
  SceneKeys keys{{"eye", number_json(view.eye)},
                 {"target", number_json(view.target)},
                 {"up", number_json(view.up)},
                 {"fov_y_degrees", number_json(view.fov_y_degrees)}};
  if (view.exposure > 0) keys.emplace_back("exposure", number_json(view.exposure));  // else automatic
  return keys;
}
SceneKeys scene_keys(const Shape& shape) {
  return std::visit([](const auto& kind) { return keys_of(kind); }, shape);
}

std::string_view wrap_name(AlphaMask::Wrap wrap) {
  static constexpr std::string_view names[] = {"repeat", "mirror", "clamp"};
  return names[static_cast<int>(wrap)];
}

Json scene_json(const Light& light) {
  return object(json_object({{"name", light.name}, {"kind", kind_name(light)}}), scene_keys(light));
}
Json scene_json(const View& view) { return object(json_object({{"name", view.name}}), scene_keys(view)); }
Json scene_json(const Shape& shape) { return object(json_object({{"kind", kind_name(shape)}}), scene_keys(shape)); }

}  // namespace gnomon
