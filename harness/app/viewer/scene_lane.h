#pragma once
#include "app/viewer/board.h"

namespace gnomon::viewer {

/// Loads the selected scene.
class SceneLane : public Lane {
 public:
  using Lane::Lane;
  /// Before the first selection: a scene that need not be loaded again.
  void offer(std::shared_ptr<LoadedScene> loaded) { offered_ = std::move(loaded); }

 private:
  Work next() override;
  std::shared_ptr<const LoadedScene> load(const std::string& reference);

  std::shared_ptr<LoadedScene> offered_;
  std::string tried_;  ///< the scene that was loaded last, or could not be
};

}  // namespace gnomon::viewer
