#pragma once
#include "measure/record/record.h"
#include "measure/worker/worker_client.h"

namespace gnomon {

/// Does a stage so many times untimed, fewer where that takes long, and by a card until times hold. What the fastest one took,
/// milliseconds: other work on the machine only adds.
double warmed_up_ms(WorkerClient& worker, Stage stage, int warmups);

/// Times of the frame's bare pass in this process, warmed up.
Record::FloorTimes floor_times(WorkerClient& worker, int repetitions);

}  // namespace gnomon
