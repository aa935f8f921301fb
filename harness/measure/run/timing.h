#pragma once
#include <functional>
#include <string>
#include <vector>

namespace gnomon {

/// One contender's stage to be timed.
struct TimingTask {
  int repetitions = 3;
  int iterations = 1;                    ///< per repetition; their mean is the sample
  std::function<double()> milliseconds;  ///< does the stage once and says how long it took; may throw
  std::vector<double> samples;           ///< out: one per repetition, milliseconds
  std::string failure;                   ///< out: why there are no more samples
};

/// Times all tasks with Google Benchmark, repetitions of different tasks interleaved at random. Times are manual: what the
/// task itself reports. A task that throws costs its own samples only.
void time_interleaved(std::vector<TimingTask>& tasks);

}  // namespace gnomon
