// Times that contradict each other. Whoever makes times up knows these rules, too: they find mistakes.
#include <cmath>

#include "measure/submission/rules.h"

namespace gnomon {

namespace {

struct ClockTimes {
  std::string_view name;
  const std::array<ProcessTimes, std::size(stage_names)>& stages;
};

double sum_of(const ProcessTimes& times) {
  double sum = 0;
  for (const std::vector<double>& process : times)
    for (const double ms : process) sum += ms;
  return sum;
}

std::vector<double> all_of(const ProcessTimes& times) {
  std::vector<double> all;
  for (const std::vector<double>& process : times) all.insert(all.end(), process.begin(), process.end());
  return all;
}

/// The harness waits for relight and resolve while the row's wall time runs. Setup and build are shared with other rows.
void check_sum(const Record& record, Faults& faults) {
  double seconds = 0;
  for (const Stage stage : {Stage::relight, Stage::resolve}) {
    const auto iterations = record.iterations.find(std::string(name(stage)));
    if (iterations != record.iterations.end())
      seconds += sum_of(record.times(stage)) / 1000 * static_cast<double>(iterations->second);
  }
  constexpr double rounding = 1e-6;
  if (!record.seconds)
    faults.add("it has times and no wall time", record);
  else if (seconds > *record.seconds * (1 + rounding) + rounding)
    faults.add("its repetitions of relight and resolve take longer together than the row", record);
}

/// A clock that counts nanoseconds does not give one number five times.
void check_equal(const Record& record, Faults& faults) {
  constexpr std::size_t fewest = 5;
  constexpr double coarse_ms = 0.001;
  for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) {
    const std::vector<double> all = all_of(record.times(stage));
    const bool is_one = std::ranges::all_of(all, [&](double ms) { return ms == all.front(); });
    if (all.size() >= fewest && is_one && all.front() > coarse_ms)
      faults.add(fmt::format("all its times of {} are one number", name(stage)), record);
  }
}

/// The device works while the harness waits for it.
void check_clocks(const Record& record, Faults& faults) {
  constexpr double slack = 1.25, call_ms = 0.05;
  for (const Stage stage : {Stage::setup, Stage::build, Stage::relight, Stage::resolve}) {
    const auto device = median_of_medians(record.device_times(stage)), host = median_of_medians(record.times(stage));
    if (device && host && *device > slack * *host + call_ms)
      faults.add(fmt::format("its {} takes longer by the device's clock than by the harness's", name(stage)), record);
  }
}

}  // namespace

std::vector<std::string> time_faults(std::span<const Record> records) {
  Faults faults;
  for (const Record& record : records) {
    const ClockTimes clocks[] = {{"stages", record.stages},
                                 {"moving_stages", record.moving_stages},
                                 {"device_stages", record.device_stages},
                                 {"harness_stages", record.harness_stages}};
    bool has_any = false;
    for (const ClockTimes& clock : clocks)
      for (const ProcessTimes& times : clock.stages)
        for (const double ms : all_of(times)) {
          has_any = true;
          if (!(ms >= 0) || !std::isfinite(ms)) faults.add(fmt::format("a time of its {} is below 0", clock.name), record);
        }
    if (record.status != Status::ok) {
      if (has_any) faults.add("it has times, and no answer", record);
      continue;
    }
    for (const Stage stage : {Stage::relight, Stage::resolve})
      if (all_of(record.times(stage)).empty()) faults.add(fmt::format("it has no times of {}", name(stage)), record);
    check_sum(record, faults);
    check_equal(record, faults);
    check_clocks(record, faults);
  }
  return faults.lines();
}

}  // namespace gnomon
