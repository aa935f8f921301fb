#include "measure/scene/motion.h"

#include <gnomon/error.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/param.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "measure/scene/load.h"
#include "measure/scene/posed_scene.h"

namespace gnomon {

namespace {

/// A way sideways that every scene has, by this share of the distance.
struct Sideways {
  double share;
  int frame_count;
  bool jumps;
};
/// 80 frames after a jump are 4/3 s at 60 Hz.
constexpr Sideways slide{0.01, 16, false}, jump{0.05, 81, true};

Path path_along(const Sideways& way, const std::string& name, Path::Moves moves, std::vector<glm::vec3> ends) {
  if (way.jumps) ends = stepped(std::move(ends), way.frame_count);
  return {name, moves, std::move(ends), way.frame_count};
}

glm::dvec3 unit_sideways(const glm::dvec3& along, const glm::dvec3& up) {
  return glm::normalize(sideways(glm::normalize(along), up));
}

Path camera_path(const std::string& name, const Sideways& way, const View& view) {
  const glm::dvec3 eye = view.eye, along = glm::dvec3(view.target) - eye;
  const glm::dvec3 end = eye + unit_sideways(along, view.up) * (way.share * glm::length(along));
  return path_along(way, name, Path::Moves::camera, {view.eye, glm::vec3(end)});
}

/// Where the light is, or the way it travels.
glm::vec3& place_of(Light& light) {
  const auto place = [](auto& l) -> glm::vec3& {
    if constexpr (requires { l.position; })
      return l.position;
    else if constexpr (requires { l.center; })
      return l.center;
    else
      return l.direction;
  };
  return std::visit(place, light.kind);
}

Path light_path(const std::string& name, const Sideways& way, const Scene& scene, Light light) {
  const glm::vec3 start = place_of(light);
  const Bounds bounds = scene.bounds();
  const glm::dvec3 middle = (glm::dvec3(bounds.min) + glm::dvec3(bounds.max)) / 2.0;
  const bool is_directional = std::holds_alternative<DirectionalLight>(light.kind);
  glm::dvec3 along = is_directional ? glm::dvec3(start) : middle - glm::dvec3(start);
  if (glm::length(along) == 0) along = glm::dvec3(0, -glm::length(glm::dvec3(bounds.max) - middle), 0);
  const glm::dvec3 end = glm::dvec3(start) + unit_sideways(along, {0, 1, 0}) * (way.share * glm::length(along));
  return path_along(way, name, Path::Moves::light, {start, glm::vec3(end)});
}

/// All of an animation, as far as a row may have frames.
Path path_of(const Animation& animation) {
  Path path{.name = animation.name, .moves = Path::Moves::geometry};
  const double frames = std::ceil(animation.end() * path.frame_rate - 1e-5) + 1;
  path.frame_count = static_cast<int>(std::clamp(frames, 2.0, double{most_motion_frames}));
  return path;
}

glm::vec3 position_at(const Path& path, int frame) {
  assert(path.positions.size() >= 2 && frame >= 0 && frame < path.frame_count);
  const auto last = static_cast<double>(path.positions.size() - 1);
  const double at = path.frame_count > 1 ? last * frame / (path.frame_count - 1) : 0;
  const auto key = std::min(static_cast<std::size_t>(at), path.positions.size() - 2);
  return glm::vec3(glm::mix(glm::dvec3(path.positions[key]), glm::dvec3(path.positions[key + 1]), at - double(key)));
}

}  // namespace

std::vector<glm::vec3> stepped(std::vector<glm::vec3> positions, int frame_count) {
  assert(!positions.empty() && std::size(positions) <= static_cast<std::size_t>(frame_count));
  const glm::vec3 last = positions.back();
  positions.resize(static_cast<std::size_t>(frame_count), last);
  return positions;
}

Path find_path(const Scene& scene, const std::string& name, const Light& light, const View& view) {
  std::vector<std::string> names(std::begin(built_in_paths), std::end(built_in_paths));
  for (const Path& path : scene.paths) {
    if (path.name == name) return path;
    names.push_back(path.name);
  }
  const std::span<const Animation> animations = scene.motion ? scene.motion->animations : std::span<const Animation>();
  for (const Animation& animation : animations) {
    if (animation.name == name) return path_of(animation);
    names.push_back(animation.name);
  }
  if (name == "camera_slide") return camera_path(name, slide, view);
  if (name == "light_slide") return light_path(name, slide, scene, light);
  if (name == "camera_jump") return camera_path(name, jump, view);
  if (name == "light_jump") return light_path(name, jump, scene, light);
  throw Error("scene {} has no path {}; did you mean {}? It has: {}", scene.name, name, nearest_word(name, names),
              joined(names, ", "));
}

Light light_at(const Path& path, const Light& light, int frame) {
  Light moved = light;
  if (path.moves == Path::Moves::light) place_of(moved) = position_at(path, frame);
  return usable(moved);
}

View view_at(const Path& path, const View& view, int frame) {
  View moved = view;
  if (path.moves == Path::Moves::camera) moved.eye = position_at(path, frame);
  return moved;
}

namespace {

/// The frame as errors name it.
std::string frame_name(const std::string& scene, const Path& path, int frame) {
  return fmt::format("{}, path {}, frame {}", scene_in_words(scene), path.name, frame);
}

void check_poses(const Path& path, const Scene& scene, const std::string& name) {
  const Animation& animation = animation_of(scene, path.name);
  const std::vector<bool> moved = moved_rigs(*scene.motion, animation);
  for (int frame = 0; frame < path.frame_count; ++frame) {
    try {
      posed_positions(scene, animation, pose_at(path, frame)->seconds, moved);
    } catch (const Error& error) {
      throw Error("{} ({})", error.what(), frame_name(name, path, frame));
    }
  }
}

}  // namespace

void check_frames(const Path& path, const Light& light, const View& view, const Scene& scene, const std::string& name) {
  if (path.moves == Path::Moves::geometry) {
    check_poses(path, scene, name);
    return;
  }
  // Straight lines between rounded keys miss a point that they go through by some last digits, and what is left is no
  // direction.
  constexpr double least_share = 1e-6;
  const bool moves_camera = path.moves == Path::Moves::camera;
  const bool has_middle = moves_camera || std::holds_alternative<DirectionalLight>(light.kind);
  const glm::dvec3 middle = moves_camera ? glm::dvec3(view.target) : glm::dvec3(0);
  double farthest = 0;
  for (const glm::vec3& key : path.positions) farthest = std::max(farthest, glm::distance(glm::dvec3(key), middle));
  for (int frame = 0; frame < path.frame_count; ++frame) {
    const glm::vec3 position = position_at(path, frame);
    const auto where = [&] { return frame_name(name, path, frame); };
    if (has_middle && glm::distance(glm::dvec3(position), middle) <= least_share * farthest)
      throw Error("{} '{}': {} = ({}, {}, {}) is {} ({})", moves_camera ? "view" : "light",
                  moves_camera ? view.name : light.name, moves_camera ? "eye" : "direction", position.x, position.y, position.z,
                  moves_camera ? "at its target" : "not a direction", where());
    moves_camera ? check(view_at(path, view, frame), where()) : check(light_at(path, light, frame), where());
  }
}

}  // namespace gnomon
