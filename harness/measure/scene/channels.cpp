#include "measure/scene/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace gnomon {

std::optional<Channel> channel_of(std::string_view light) {
  const std::size_t dot = light.rfind('.');
  if (dot == light.npos) return std::nullopt;
  const auto* const found = std::ranges::find(channel_names, light.substr(dot + 1));
  if (found == std::end(channel_names)) return std::nullopt;
  return all_channels[found - std::begin(channel_names)];
}

std::string_view whole_name(std::string_view light) { return channel_of(light) ? light.substr(0, light.rfind('.')) : light; }

void split_lights(Scene& scene) {
  if (!scene.has_colored_transmission()) return;
  std::vector<Light> split;
  for (const Light& light : scene.lights)
    for (const Channel channel : all_channels) {
      split.push_back(light);
      split.back().name = fmt::format("{}.{}", light.name, name(channel));
    }
  scene.lights = std::move(split);
}

std::vector<Light> whole_lights(const std::vector<Light>& lights) {
  std::vector<Light> whole;
  for (const Light& light : lights) {
    const std::string_view name = whole_name(light.name);
    if (!whole.empty() && whole.back().name == name) continue;
    whole.push_back(light);
    whole.back().name = name;
  }
  return whole;
}

std::size_t whole_count(const std::vector<std::string>& names) {
  std::set<std::string_view> whole;
  for (const std::string& light : names) whole.insert(whole_name(light));
  return whole.size();
}

Scene in_channel(const Scene& scene, Channel channel) {
  Scene one = scene;
  std::map<const Transmission*, std::shared_ptr<const Transmission>> made;  // meshes that share one share its channel
  for (Mesh& mesh : one.meshes) {
    if (!mesh.transmission || !mesh.transmission->is_colored()) continue;
    std::shared_ptr<const Transmission>& gray = made[mesh.transmission.get()];
    if (!gray) {
      const Transmission& all = *mesh.transmission;
      std::vector<float> values;
      for (std::size_t i = static_cast<std::size_t>(channel); i < all.values().size(); i += 3)
        values.push_back(all.values()[i]);
      gray = std::make_shared<const Transmission>(all.width(), all.height(), 1, std::move(values), all.wrap_u(), all.wrap_v());
    }
    mesh.transmission = gray;
    if (!mesh.needs_uv()) mesh.uv.clear();
  }
  return one;
}

namespace {

/// Whether a scene that was made of the other is in the pose of that.
bool is_in_pose_of(const Scene& copy, const Scene& scene) {
  const auto are_equal = [](const Mesh& a, const Mesh& b) {
    return a.reach.min == b.reach.min && a.reach.max == b.reach.max && a.shape.has_value() == b.shape.has_value();
  };
  return copy.pose_number == scene.pose_number && std::ranges::equal(copy.meshes, scene.meshes, are_equal);
}

void take_pose(const Scene& from, Scene& to) {
  for (std::size_t m = 0; m < from.meshes.size(); ++m) {
    std::ranges::copy(from.meshes[m].positions, to.meshes[m].positions.begin());
    to.meshes[m].shape = from.meshes[m].shape;
    to.meshes[m].reach = from.meshes[m].reach;
  }
  to.pose_number = from.pose_number;
}

}  // namespace

const Scene& ChannelScenes::of(const Light& light) {
  const std::optional<Channel> channel = is_colored_ ? channel_of(light.name) : std::nullopt;
  if (!channel) return scene_;
  std::unique_ptr<Scene>& made = made_[static_cast<std::size_t>(*channel)];
  if (!made) made = std::make_unique<Scene>(in_channel(scene_, *channel));
  if (!is_in_pose_of(*made, scene_)) take_pose(scene_, *made);
  return *made;
}

}  // namespace gnomon
