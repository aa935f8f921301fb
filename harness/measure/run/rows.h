#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "measure/run/batch.h"
#include "measure/run/jobs.h"

namespace gnomon {

/// A folder that goes away with its owner.
class ScratchFolder {
 public:
  explicit ScratchFolder(std::filesystem::path path);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A batch that is done: its rows are complete.
struct BatchDone {
  const std::vector<Row>& rows;
  bool was_run = false;  ///< false: its scene is not fetched
  double opening = 0;    ///< seconds beside the rows, by process
};

/// How rows are run, and what is done with them.
struct RowsPlan {
  const Suite& suite;
  SceneLibrary& library;
  std::span<const Side> sides;
  std::filesystem::path scratch;  ///< for masks on their way from a worker; must exist
  /// Of the records of a batch, asked when it starts; by side.
  std::function<std::vector<Json>()> contexts;
  std::function<void(const BatchDone&)> done;
};

/// Runs rows that have their job and side, scene by scene in the order of first appearance, in batches. Processes beyond the
/// suite's fixed ones share its budget: every batch may spend its part of what is left. Scenes are forgotten when done.
void run_rows(std::vector<Row> rows, const RowsPlan& plan, Progress& progress);

}  // namespace gnomon
