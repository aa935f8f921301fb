#pragma once
#include "measure/run/light_selection.h"
#include "measure/run/suite.h"

namespace gnomon {

/// The motion that rows of a group follow in one scene.
struct RowPath {
  std::string name = {};                 ///< of a path or an animation; empty: nothing moves
  std::optional<FrameTimes> times = {};  ///< where geometry moves; complete where the scene is there
  int frame_count = 1;
};

/// The scene's path or animation of that name, an animation at these times.
Path followed_path(const Scene& scene, const std::string& name, const Light& light, const View& view, const FrameTimes& times);

/// All motions of a group in this scene, each once: its paths, then its animations; one without a name where it has none of
/// both. Of a scene that is null, which is not fetched, `*` is called "-". Throws Error where the scene lacks one, and where
/// one of these lights, views or meshes cannot be drawn at one of the frames.
std::vector<RowPath> row_paths(const SuiteGroup& group, const std::string& reference, const Scene* scene,
                               const std::vector<RowLights>& lights, const std::vector<std::string>& views);

/// Why nothing moves in a row of such times: it starts behind the last key. Empty where something may.
std::string start_note(const Scene& scene, const std::string& animation, const FrameTimes& times);

}  // namespace gnomon
