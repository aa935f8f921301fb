#pragma once
#include "measure/row/contender_worker.h"
#include "measure/row/row_frames.h"

namespace gnomon {

/// All of a row but its times: counts, memory, classes, causes, metrics against both truths, its OpenGL. The worker has gone to
/// `first` and ends there, under the headline truth. A row on a path is measured at every frame (see PathScore), and the answer
/// is that of the last one. The record gets the worst support of all frames, and there is no answer when one is unsupported.
/// `kept` gets every frame; it may be null.
std::optional<MeasuredRow> measure(Record& record, SceneRun& run, ContenderWorker& worker, const RowFrame& first,
                                   RowFrames* kept = nullptr);

}  // namespace gnomon
