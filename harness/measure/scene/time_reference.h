#pragma once
// A still of a scene that moves, as a reference: SCENE@SECONDS, or SCENE@ANIMATION=SECONDS.
#include <optional>
#include <string>
#include <vector>

#include "measure/scene/pose.h"

namespace gnomon {

struct TimedReference {
  std::string scene;           ///< as load_scene takes it
  std::optional<PoseTime> at;  ///< nothing: the nodes are as the file has them
};

/// Splits at the last @, behind which are seconds, 0 or more, or the name of an animation and seconds. A reference with a slash
/// behind the @ has no time. Throws Error where something else follows, and the whole is not the name of a file.
TimedReference split_time(const std::string& reference);

/// The scene of a reference alone. Never throws: what is no time belongs to the scene.
std::string without_time(const std::string& reference);

/// The reference in its canonical form: the seconds in the fewest digits that read back.
std::string with_time(const std::string& scene, const PoseTime& at);

/// No more times of a scene are taken at once.
inline constexpr std::size_t most_times = 10'000;
/// Each scene at each time, the times of one scene together. Without times the scenes as they are, in canonical form. Throws
/// Error where a scene has a time already, where the animation is no plain name or has no time, and on a time that is not
/// finite or below 0.
std::vector<std::string> at_times(const std::vector<std::string>& scenes, const std::string& animation,
                                  const std::vector<double>& times);

}  // namespace gnomon
