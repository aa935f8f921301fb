#pragma once
#include "measure/worker/worker_server.h"

namespace gnomon {

/// Answers what a worker is asked of techniques and scenes before any of them is opened (roll_protocol.h).
void answer_roll(Answers& answers);

}  // namespace gnomon
