#pragma once
#include <gnomon/scene.h>

#include <string>
#include <string_view>

namespace gnomon {

/// Names of the paths that every scene has.
inline constexpr std::string_view built_in_paths[] = {"camera_slide", "light_slide", "camera_jump", "light_jump"};

/// The path of this name: one of the scene's own, one of its animations (`Path::Moves::geometry`: at 60 frames a second from 0
/// to the last key, 2 .. most_motion_frames frames), or one that every scene has, made for this light and view.
/// `camera_slide` moves the eye sideways by 1 % of its distance to the target, `light_slide` the light sideways by 1 % of its
/// distance to the middle of the scene (a directional light turns by the angle whose tangent is that share); 16 frames, so that
/// a step is below a pixel. `camera_jump` and `light_jump` go the same ways by 5 %, at once: frame 0 is at the start, frames
/// 1 .. 80 are at the end. Throws Error with the nearest name.
Path find_path(const Scene& scene, const std::string& name, const Light& light, const View& view);

/// Positions of a path that jumps: that of frame n is the n-th, later frames are at the last one. There is one for each frame,
/// so that a frame lies on a key to the bit and nothing is between two. `positions` are one or more, no more than the frames.
std::vector<glm::vec3> stepped(std::vector<glm::vec3> positions, int frame_count);

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
