#pragma once
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>
#include <vector>

namespace gnomon {

/// What the calls of one side took, call by call.
class Timings {
 public:
  /// Calls `work` once; returns the seconds it took.
  template <class Work>
  double add(const Work& work) {
    const std::clock_t cpu_start = std::clock();
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds_.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    cpu_seconds_.push_back(static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
    return seconds_.back();
  }
  double median() { return middle(seconds_); }
  /// Of the processor time of all threads.
  double cpu_median() { return middle(cpu_seconds_); }

 private:
  static double middle(std::vector<double>& values) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, place);
    return *place;
  }
  std::vector<double> seconds_, cpu_seconds_;
};

/// Runs contender and floor by turns, so that a busy machine slows both. `ratio` is the ratio of their medians; `cpu_ratio`
/// that of their processor time, which other programs disturb less, and which says nothing where a GPU does the work. The
/// benchmark must use manual time.
template <class Contender, class Floor>
void alternate(benchmark::State& state, const Contender& contender, const Floor& floor) {
  Timings of_contender, of_floor;
  for (int i = 0; i < 3; ++i) contender(), floor();
  for (auto _ : state) {
    state.SetIterationTime(of_contender.add(contender));
    of_floor.add(floor);
  }
  state.counters["floor_ms"] = 1000 * of_floor.median();
  state.counters["median_ms"] = 1000 * of_contender.median();
  state.counters["ratio"] = of_contender.median() / of_floor.median();
  state.counters["cpu_ratio"] = of_contender.cpu_median() / of_floor.cpu_median();
}

/// Registers a benchmark whose iterations report their own time, in milliseconds.
template <class... Arguments>
benchmark::internal::Benchmark* add_timed(const std::string& name, const Arguments&... arguments) {
  return benchmark::RegisterBenchmark(name.c_str(), arguments...)->UseManualTime()->Unit(benchmark::kMillisecond);
}

}  // namespace gnomon
