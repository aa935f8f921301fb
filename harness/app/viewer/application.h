#pragma once
#include <filesystem>
#include <vector>

#include "app/viewer/engine.h"
#include "app/viewer/keys.h"

namespace gnomon::viewer {

struct ViewOptions {
  Selection selection;                  ///< what is shown at first: all of it checked
  std::shared_ptr<LoadedScene> loaded;  ///< that the selection names
  WorkerOptions workers;
  double timeout_seconds = 120;
  std::filesystem::path out;         ///< for what is saved
  std::vector<ScriptStep> keys;      ///< done one after the other, each when the one before has had its effect
  std::filesystem::path screenshot;  ///< written when all is finished; empty: none
  double speed_seconds = 0;          ///< measure pictures a second, for so long in each situation; 0: do not
  bool ends_by_itself = false;       ///< when keys, screenshot and measurement are through
};

/// Opens the window and stays until it is closed. Throws Error when there is no display.
int run_viewer(const ViewOptions& options);

}  // namespace gnomon::viewer
