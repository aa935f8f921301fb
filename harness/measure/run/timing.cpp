#include "measure/run/timing.h"

#include <benchmark/benchmark.h>

#include "measure/notice.h"

namespace gnomon {

namespace {

/// Collects raw repetitions; benchmark names are indices of tasks.
class RawReporter final : public benchmark::BenchmarkReporter {
 public:
  explicit RawReporter(std::vector<TimingTask>& tasks) : tasks_(tasks) {}
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      TimingTask& task = tasks_.at(std::stoul(run.run_name.function_name));
      if (task.failure.empty() && run.run_type == Run::RT_Iteration) task.samples.push_back(run.GetAdjustedRealTime());
    }
  }

 private:
  std::vector<TimingTask>& tasks_;
};

void run_task(benchmark::State& state, TimingTask& task) {
  for (auto _ : state) {
    if (task.failure.empty()) try {
        state.SetIterationTime(task.milliseconds(task.iterations) / task.iterations / 1000);
        continue;
      } catch (const std::exception& error) {
        task.failure = message_of(error);
      }
    state.SkipWithError(task.failure.c_str());
    break;
  }
}

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

int iterations_for(double ms) {
  constexpr double wanted_ms = 2, most = 64;
  return static_cast<int>(std::clamp(std::exp2(std::round(std::log2(wanted_ms / std::max(ms, 1e-3)))), 1.0, most));
}

void time_interleaved(std::vector<TimingTask>& tasks) {
  [[maybe_unused]] static const bool is_initialized = [] {
    char program[] = "gnomon", interleave[] = "--benchmark_enable_random_interleaving=true";
    char* argv[] = {program, interleave, nullptr};
    int argc = 2;
    benchmark::Initialize(&argc, argv);
    return true;
  }();
  benchmark::ClearRegisteredBenchmarks();
  for (std::size_t k = 0; k < tasks.size(); ++k)
    benchmark::RegisterBenchmark(std::to_string(k).c_str(), [&tasks, k](benchmark::State& state) { run_task(state, tasks[k]); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1)  // for Google Benchmark, which reports the mean only: the task does all of them at once
        ->Repetitions(tasks[k].repetitions);
  RawReporter reporter(tasks);
  if (!tasks.empty()) benchmark::RunSpecifiedBenchmarks(&reporter, ".*");
  benchmark::ClearRegisteredBenchmarks();
}

void add_samples(Record& record, Stage stage, const TimingTask& task) {
  record.times(stage).push_back(task.samples);
  if (!task.others.device.empty()) record.device_times(stage).push_back(task.others.device);
  if (!task.others.harness.empty()) record.harness_times(stage).push_back(task.others.harness);
}

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
    if (const auto device = worker.other_clocks().device) device_ms.push_back(*device / iterations);
  }
  Record::FloorTimes times;
  times.ms.push_back(std::move(ms));
  if (!device_ms.empty()) times.device_ms.push_back(std::move(device_ms));
  return times;
}

}  // namespace gnomon
