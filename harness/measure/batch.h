#pragma once
#include <vector>

#include "measure/progress.h"
#include "measure/row.h"

namespace gnomon {

/// One row on its way: its record, and the seat that works for it.
struct Row {
  Job job;
  Record record;
  std::size_t contender = 0;  ///< index into the contenders of its batch
  bool over = false;          ///< unsupported or failed: nothing more to do
};

/// A scene's rows in batches of about equally many contenders: all workers of a batch live at once and each holds the scene, so
/// a long sweep takes turns. Contenders of one batch are interleaved.
std::vector<std::vector<Row>> split(std::vector<Row> rows);

/// Runs the rows of one batch: each comes back with its record complete, or failed with the reason. Pictures go below `out`.
void run_batch(SceneRun& run, const WorkerOptions& worker, const std::filesystem::path& out, std::vector<Row>& rows,
               Progress& progress);

}  // namespace gnomon
