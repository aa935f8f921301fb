#pragma once
#include "measure/run/batch.h"

namespace gnomon {

/// Rows that have some of their processes and wait for the others: OUT/unfinished.jsonl, a file of records. A run writes it
/// after each process of a batch, so that one that is killed and resumed repeats no process that had come to its end.
class UnfinishedRows {
 public:
  /// Reads the rows of these jobs that a killed run has left in the folder; of others, and of a file that cannot be read, none.
  /// With `retry_failed` without those that failed.
  UnfinishedRows(const std::filesystem::path& out, const Suite& suite, const std::set<std::string>& jobs, bool retry_failed);

  /// A row that is to begin and has all facts from before the run goes on with the processes that it has: where build,
  /// machine, scene, technique and the effort of the suite are as they were, and its pictures are there.
  void go_on(PendingRow& row);
  /// Writes the rows of a batch as they are now, and those that nobody went on with. Without any, the file goes.
  void write(std::span<const PendingRow> batch);

 private:
  std::filesystem::path out_, file_;
  Json effort_;                            ///< what the suite requires of each process, in the context of these records
  std::map<std::string, Record> waiting_;  ///< by job
};

}  // namespace gnomon
