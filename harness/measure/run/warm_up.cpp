#include "measure/run/warm_up.h"

#include <algorithm>

#include "measure/run/timing.h"

namespace gnomon {

namespace {

/// A card raises its clocks under load: goes on until three calls in a row take the same by its clock, within 3 %, but no
/// longer than half a second.
void settle(WorkerClient& worker, Stage stage) {
  constexpr double slack = 1.03, most_ms = 500;
  std::vector<double> device_ms;
  for (double sum = 0; sum < most_ms;) {
    sum += worker.time(stage);
    device_ms.push_back(worker.other_clocks().device.value_or(0));
    if (device_ms.size() < 3) continue;
    const auto [least, most] = std::minmax_element(device_ms.end() - 3, device_ms.end());
    if (*most <= *least * slack) return;
  }
}

}  // namespace

double warmed_up_ms(WorkerClient& worker, Stage stage, int warmups) {
  constexpr double most_ms = 300;
  double least = 0, sum = 0;
  for (int k = 0; k < warmups && sum < most_ms; ++k) {
    const double ms = worker.time(stage);
    least = k == 0 ? ms : std::min(least, ms);
    sum += ms;
  }
  if (warmups > 0 && worker.other_clocks().device) settle(worker, stage);
  return least;
}

Record::FloorTimes floor_times(WorkerClient& worker, int repetitions) {
  const int iterations = std::min(iterations_for(worker.time_floor(1)), most_floor_times);
  std::vector<double> ms, device_ms;
  for (int k = 0; k < repetitions; ++k) {
    ms.push_back(worker.time_floor(iterations) / iterations);
    if (worker.other_clocks().device) device_ms.push_back(*worker.other_clocks().device / iterations);
  }
  Record::FloorTimes times;
  times.ms.push_back(std::move(ms));
  if (!device_ms.empty()) times.device_ms.push_back(std::move(device_ms));
  return times;
}

}  // namespace gnomon
