// The rows of each batch, and when it has had enough processes.
#include "measure/run/batch.h"

namespace gnomon {

std::string timed_together(const Job& job) {
  return fmt::format("{} {} {}x{} {} {}", job.light, job.view, job.width, job.height, job.path, job.motion());
}

bool is_narrow(const Record& record, double interval) {
  for (const Stage stage : motion_stages) {  // update has no times where the geometry stands still
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

std::vector<std::vector<PendingRow*>> timed_groups(std::vector<PendingRow>& rows) {
  std::map<std::string, std::size_t> numbers;
  std::vector<std::vector<PendingRow*>> groups;
  for (PendingRow& row : rows) {
    const std::size_t number = numbers.try_emplace(timed_together(row.job), groups.size()).first->second;
    if (number == groups.size()) groups.emplace_back();
    groups[number].push_back(&row);
  }
  return groups;
}

double share_overhead(std::vector<PendingRow>& batch, double seconds) {
  double processes = 0;
  const auto count = [](const PendingRow& row) {
    return std::max<double>(1, static_cast<double>(row.record.times(Stage::resolve).size()));
  };
  for (const PendingRow& row : batch) {
    seconds -= row.record.seconds.value_or(0);
    processes += count(row);
  }
  const double share = std::max(0.0, seconds) / processes;
  for (PendingRow& row : batch) row.record.seconds = row.record.seconds.value_or(0) + share * count(row);
  return share;
}

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
