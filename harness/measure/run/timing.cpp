#include "measure/run/timing.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

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
      if (run.error_occurred)
        task.failure = run.error_message;
      else if (run.run_type == Run::RT_Iteration)
        task.samples.push_back(run.GetAdjustedRealTime());
    }
  }

 private:
  std::vector<TimingTask>& tasks_;
};

void run_task(benchmark::State& state, TimingTask& task) {
  for (auto _ : state) {
    if (!task.failure.empty()) {
      state.SkipWithError(task.failure.c_str());
      break;
    }
    try {
      state.SetIterationTime(task.milliseconds(task.iterations) / task.iterations / 1000);
    } catch (const std::exception& error) {
      task.failure = message_of(error);
      state.SkipWithError(task.failure.c_str());
      break;
    }
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
        ->Iterations(1)  // for Google Benchmark, which knows the mean only: the task does all of them at once
        ->Repetitions(tasks[k].repetitions);
  RawReporter reporter(tasks);
  if (!tasks.empty()) benchmark::RunSpecifiedBenchmarks(&reporter, ".*");
  benchmark::ClearRegisteredBenchmarks();
}

}  // namespace gnomon
