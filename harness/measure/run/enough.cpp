#include "measure/run/enough.h"

#include <algorithm>

namespace gnomon {

bool is_narrow(const Record& record, double interval) {
  for (const Stage stage : {Stage::relight, Stage::resolve}) {
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

}  // namespace gnomon
