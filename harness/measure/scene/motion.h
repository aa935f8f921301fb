#pragma once
#include <gnomon/scene.h>

#include <string>
#include <string_view>

namespace gnomon {

/// Names of the paths that every scene has.
inline constexpr std::string_view slide_names[] = {"camera_slide", "light_slide"};

/// The path of this name: one of the scene's own, one of its animations (`Path::Moves::geometry`: at 60 frames a second from 0
/// to the last key, 2 .. most_motion_frames frames), or a slide that every scene has, made for this light and view:
/// `camera_slide` moves the eye sideways by 1 % of its distance to the target, `light_slide` the light sideways by 1 % of its
/// distance to the middle of the scene (a directional light turns by 0.01 radians); 16 frames, so that a step is below a pixel.
/// Throws Error with the nearest name.
Path find_path(const Scene& scene, const std::string& name, const Light& light, const View& view);

/// The light or view at a frame, 0 .. frame_count - 1; the same as given when the path moves the other. Keys are passed at
/// equal steps of time, in straight lines between them. A light with area moves its center; key positions of a directional
/// light are the directions in which it travels.
Light light_at(const Path& path, const Light& light, int frame);
View view_at(const Path& path, const View& view, int frame);

/// Throws Error with the number of the first frame, from 0, at which this light or view cannot be: an eye that passes through
/// its target, an `up` along the line of sight, a direction of zero; or at which a mesh of the scene cannot be. `name` is the
/// scene's in messages.
void check_frames(const Path& path, const Light& light, const View& view, const Scene& scene, const std::string& name);

}  // namespace gnomon
