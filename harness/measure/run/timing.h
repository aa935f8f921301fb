#pragma once
#include "measure/record/record.h"
#include "measure/worker/worker_client.h"

namespace gnomon {

/// Milliseconds of every repetition by clocks beside the one that counts; empty where there is none.
struct OtherSamples {
  std::vector<double> device, harness;
};

/// One contender's stage to be timed.
struct TimingTask {
  int repetitions = 3;
  int iterations = 1;                       ///< per repetition; their mean is the sample
  std::function<double(int)> milliseconds;  ///< does the stage so many times, returns how long all took together; may throw
  std::vector<double> samples;              ///< out: one per repetition, milliseconds
  OtherSamples others;                      ///< the same by other clocks, where the owner of the task has some
  std::string failure;                      ///< out: why there are no more samples
};

/// Iterations of a repetition of a stage that takes `ms`: the power of two that takes about two milliseconds, 1 .. 64. A power
/// of two, so that runs whose first call took a little longer or shorter choose the same number.
int iterations_for(double ms);

/// Times all tasks with Google Benchmark, repetitions of different tasks interleaved at random. Times are manual: what the
/// task itself reports. A task that throws costs its own samples only.
void time_interleaved(std::vector<TimingTask>& tasks);

/// Adds the samples of one process to the stage's times, and those of other clocks.
void add_samples(Record& record, Stage stage, const TimingTask& task);

/// Does a stage so many times untimed, fewer where that takes long, and by a card until times are stable. Returns the time of
/// the fastest one, milliseconds: other work on the machine only adds.
double warmed_up_ms(WorkerClient& worker, Stage stage, int warmups);

/// Times of the frame's bare pass in this process, warmed up.
Record::FloorTimes floor_times(WorkerClient& worker, int repetitions);

}  // namespace gnomon
