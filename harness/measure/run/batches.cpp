// The rows of each batch, and when it has had enough processes.
#include "measure/run/batch.h"

namespace gnomon {

bool is_narrow(const Record& record, double interval) {
  for (const Stage stage : frame_stages) {
    const ProcessTimes& times = record.times(stage);
    const auto time = median_of_medians(times);
    if (!time || *time < least_time) continue;
    if (times.size() < least_processes) return false;
    const auto estimate = bootstrap(times);
    if (!estimate || estimate->high - estimate->low > interval * estimate->value) return false;
  }
  return true;
}

int most_processes(const Suite& suite) { return std::max(4 * suite.processes, 8); }

std::vector<std::vector<PendingRow>> split(std::vector<PendingRow> rows) {
  std::size_t sides = 1;
  std::map<std::string, std::size_t> places;  // of contenders, in order of first appearance
  for (const PendingRow& row : rows) {
    sides = std::max(sides, row.side + 1);
    places.try_emplace(row.job.contender.name(), places.size());
  }
  const std::size_t most_contenders = 16 / sides;
  std::vector<std::vector<PendingRow>> batches((places.size() + most_contenders - 1) / most_contenders);
  for (PendingRow& row : rows)
    batches[places[row.job.contender.name()] * batches.size() / places.size()].push_back(std::move(row));
  return batches;
}

}  // namespace gnomon
