#pragma once
#include <functional>
#include <string>
#include <vector>

namespace gnomon {

/// Milliseconds of every repetition by clocks beside the one that counts; empty where there is none.
struct OtherSamples {
  std::vector<double> device, harness;
};

/// One contender's stage to be timed.
struct TimingTask {
  int repetitions = 3;
  int iterations = 1;                       ///< per repetition; their mean is the sample
  std::function<double(int)> milliseconds;  ///< does the stage so many times and says how long all took together; may throw
  std::vector<double> samples;              ///< out: one per repetition, milliseconds
  OtherSamples others;                      ///< the same by other clocks, where whoever gave the task has some
  std::string failure;                      ///< out: why there are no more samples
};

/// Iterations of a repetition of a stage that takes `ms`: the power of two that takes about two milliseconds, 1 .. 64. A power
/// of two, so that runs whose first call took a little longer or shorter choose the same number.
int iterations_for(double ms);

/// Times all tasks with Google Benchmark, repetitions of different tasks interleaved at random. Times are manual: what the
/// task itself reports. A task that throws costs its own samples only.
void time_interleaved(std::vector<TimingTask>& tasks);

}  // namespace gnomon
