// What moves in the rows of a group: paths of camera and light, and animations, with the frames of each.
#include "measure/run/row_paths.h"

#include <gnomon/error.h>

#include <algorithm>
#include <cmath>

#include "measure/scene/channels.h"
#include "measure/scene/load.h"
#include "measure/scene/motion.h"
#include "measure/scene/names.h"
#include "measure/scene/time_reference.h"

namespace gnomon {

namespace {

/// Frames from the start to the last key of the animation, both included; a key of float32 may be rounded up. Throws Error
/// where a row cannot have so many.
int frames_to_end(const Animation& animation, double start, double frame_rate) {
  const double frames = std::ceil((animation.end() - start) * frame_rate - 1e-5) + 1;
  if (frames > most_frames)
    throw Error(
        "animation {} has {:.6g} frames from {} s to its last key at {} s, {} a second; a row has at most {}: give "
        "frames, or another frame_rate",
        animation.name, frames, start, animation.end(), frame_rate, most_frames);
  return static_cast<int>(std::max<double>(frames, least_frames));
}

/// An animation of a group by name. Throws Error with the nearest name, and where the name is that of something else.
void require_animation(const Scene& scene, const std::string& reference, const std::string& name) {
  if (!scene.motion || scene.motion->animations.empty())
    throw Error("{} has no animation{}; animations = {} follow a scene that moves", scene_in_words(reference),
                without_time(reference) == reference ? "" : ": it is a still", name);
  const std::vector<std::string> there = names_of(scene.motion->animations);
  const bool is_path = std::ranges::find(built_in_paths, name) != std::end(built_in_paths) || find_named(scene.paths, name);
  if (is_path)
    throw Error("{} is a path of {}, not an animation: name it in paths; its animations are {}", name,
                scene_in_words(reference), joined(there, ", "));
  require_words({name}, there, "animation", reference);
}

/// The names of the group's animations in this scene.
std::vector<std::string> animations_of(const SuiteGroup& group, const std::string& reference, const Scene& scene) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const std::string& name : group.animations) {
    if (name != every_animation || !scene.motion || scene.motion->animations.empty()) require_animation(scene, reference, name);
    if (name != every_animation)
      add(name);
    else
      for (const Animation& animation : scene.motion->animations) add(animation.name);
  }
  return names;
}

/// Every frame of the path, for each of these lights and views, must be one that can be drawn: nothing runs before that.
RowPath checked_path(const Scene& scene, const std::string& reference, const std::string& name, const FrameTimes& times,
                     const std::vector<RowLights>& rows, const std::vector<std::string>& views) {
  const Light& some_light = *find_named(scene.lights, rows.front().lights.front());
  const View& some_view = *find_named(scene.views, views.front());
  const auto path_of = [&](const Light& light, const View& view) { return followed_path(scene, name, light, view, times); };
  const Path path = path_of(some_light, some_view);
  RowPath result{.name = name, .times = {}, .frame_count = path.frame_count};
  // A path moves one of three and does not look at the others.
  switch (path.moves) {
    case Path::Moves::geometry:
      check_frames(path, some_light, some_view, scene, reference);
      result.times = {.frames = path.frame_count, .frame_rate = path.frame_rate, .start = path.start};
      break;
    case Path::Moves::camera:
      for (const std::string& view_name : views) {
        const View& view = *find_named(scene.views, view_name);
        check_frames(path_of(some_light, view), some_light, view, scene, reference);
      }
      break;
    case Path::Moves::light:
      for (const RowLights& row : rows) {
        if (const std::size_t count = whole_count(row.lights); count > 1)
          throw Error("path {} of {} moves the light, and {} is {} lights: a row on such a path has one", name,
                      scene_in_words(reference), row.name, count);
        const Light& light = *find_named(scene.lights, row.lights.front());
        check_frames(path_of(light, some_view), light, some_view, scene, reference);
      }
  }
  return result;
}

}  // namespace

Path followed_path(const Scene& scene, const std::string& name, const Light& light, const View& view, const FrameTimes& times) {
  Path path = find_path(scene, name, light, view);
  if (path.moves != Path::Moves::geometry) return path;
  path.start = times.start.value_or(path.start);
  path.frame_rate = times.frame_rate.value_or(path.frame_rate);
  if (times.frames)
    path.frame_count = *times.frames;
  else
    path.frame_count = frames_to_end(animation_of(scene, name), path.start, path.frame_rate);
  return path;
}

std::vector<RowPath> row_paths(const SuiteGroup& group, const std::string& reference, const Scene* scene,
                               const std::vector<RowLights>& lights, const std::vector<std::string>& views) {
  std::vector<RowPath> paths;
  if (scene) {
    for (const std::string& name : group.paths) paths.push_back(checked_path(*scene, reference, name, {}, lights, views));
    for (const std::string& name : animations_of(group, reference, *scene))
      paths.push_back(checked_path(*scene, reference, name, group.times, lights, views));
  } else {
    for (const std::string& name : group.paths) paths.push_back({.name = name});
    for (const std::string& name : group.animations)
      paths.push_back({.name = name == every_animation ? "-" : name, .times = group.times});
  }
  if (paths.empty()) paths.emplace_back();
  return paths;
}

std::string start_note(const Scene& scene, const std::string& animation, const FrameTimes& times) {
  const double start = times.start.value_or(0), end = animation_of(scene, animation).end();
  if (start < end) return {};
  return fmt::format("the row starts at {} s, and the last key of {} is at {} s: nothing moves", start, animation, end);
}

}  // namespace gnomon
