#pragma once
#include "measure/frame/frame.h"
#include "measure/progress.h"
#include "measure/record/record.h"

namespace gnomon {

/// The scene of kept rows as it is today, with its frames; or why there is none.
struct CurrentScene {
  std::optional<Scene> scene;
  std::unique_ptr<FrameStore> frames;
  std::string missing;  ///< of a scene that is not fetched, or whose file moved: it costs its own rows only

  /// `reference` is shown in progress, `place` is what load_scene takes.
  CurrentScene(const std::string& reference, const std::string& place, Progress& progress);

  /// Why the mask of a row that stands still cannot be put beside today's reference; empty when it can.
  std::string obstacle(const Record& record);
};

}  // namespace gnomon
