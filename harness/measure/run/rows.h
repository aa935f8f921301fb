#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "measure/run/batch.h"
#include "measure/run/jobs.h"

namespace gnomon {

/// A batch that is done: its rows are complete.
struct BatchDone {
  const std::vector<PendingRow>& rows;
  bool was_run = false;  ///< false: its scene is not fetched
  double opening = 0;    ///< seconds beside the rows, by process
};

/// How rows are run, and what is done with them.
struct RowsPlan {
  const Suite& suite;
  SceneLibrary& library;
  std::span<const Side> sides;
  std::filesystem::path scratch;  ///< for masks on their way from a worker; must exist
  /// The contexts of the records of a batch, by side; called when the batch starts.
  std::function<std::vector<Json>()> contexts;
  std::function<void(const BatchDone&)> done;
};

/// Runs rows that have their job and side, scene by scene in the order of first appearance, in batches. Processes beyond the
/// suite's fixed ones share its budget: every batch may spend its part of what is left. Scenes are forgotten when done.
void run_rows(std::vector<PendingRow> rows, const RowsPlan& plan, Progress& progress);

}  // namespace gnomon
