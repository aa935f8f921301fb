#include "measure/scene/scene_json.h"

#include <fmt/format.h>

namespace gnomon {

namespace {

SceneKeys keys_of(const PointLight& light) { return {{"position", number_json(light.position)}}; }
SceneKeys keys_of(const SpotLight& light) {
  return {{"position", number_json(light.position)},
          {"direction", number_json(light.direction)},
          {"inner_degrees", number_json(light.inner_degrees)},
          {"outer_degrees", number_json(light.outer_degrees)}};
}
SceneKeys keys_of(const DirectionalLight& light) { return {{"direction", number_json(light.direction)}}; }
SceneKeys keys_of(const RectLight& light) {
  return {{"center", number_json(light.center)},
          {"half_u", number_json(light.half_u)},
          {"half_v", number_json(light.half_v)},
          {"one_sided", light.emits == Emits::in_front}};
}
SceneKeys keys_of(const DiscLight& light) {
  return {{"center", number_json(light.center)},
          {"normal", number_json(light.normal)},
          {"radius", number_json(light.radius)},
          {"one_sided", light.emits == Emits::in_front}};
}
SceneKeys keys_of(const SphereLight& light) {
  return {{"center", number_json(light.center)}, {"radius", number_json(light.radius)}};
}

SceneKeys keys_of(const Sphere& s) { return {{"center", number_json(s.center)}, {"radius", number_json(s.radius)}}; }
SceneKeys keys_of(const Cone& c) {
  return {{"base", number_json(c.base)},
          {"axis", number_json(c.axis)},
          {"radius", number_json(c.radius)},
          {"height", number_json(c.height)}};
}
SceneKeys keys_of(const Disc& d) {
  return {{"center", number_json(d.center)}, {"normal", number_json(d.normal)}, {"radius", number_json(d.radius)}};
}
SceneKeys keys_of(const Triangle& t) {
  return {{"points", Json::array({number_json(t.points[0]), number_json(t.points[1]), number_json(t.points[2])})}};
}
SceneKeys keys_of(const Plane& p) {
  return {{"center", number_json(p.center)}, {"half_u", number_json(p.half_u)}, {"half_v", number_json(p.half_v)}};
}
SceneKeys keys_of(const Box& b) { return {{"min", number_json(b.min)}, {"max", number_json(b.max)}}; }

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

Json scene_json(const Light& light) {
  return object(json_object({{"name", light.name}, {"kind", kind_name(light)}}), scene_keys(light));
}
Json scene_json(const View& view) { return object(json_object({{"name", view.name}}), scene_keys(view)); }
Json scene_json(const Shape& shape) { return object(json_object({{"kind", kind_name(shape)}}), scene_keys(shape)); }

}  // namespace gnomon
