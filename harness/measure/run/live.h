#pragma once
#include <filesystem>

#include "measure/run/jobs.h"
#include "measure/run/progress.h"
#include "measure/run/worker.h"

namespace gnomon {

struct LiveOptions {
  Suite suite;
  std::string filter;         ///< as for run
  std::filesystem::path out;  ///< gets `base` and `contender`, each a run of its own
  WorkerOptions worker;       ///< of this program, the contender
  std::string base_program;
};

/// Runs every job with two programs side by side: workers of both live at once and their repetitions are interleaved at
/// random, so that what the machine does to one it does to the other. The scenes, G-buffers and references are this program's.
/// Both folders carry the same mark in the context of their records, by which compare knows that their processes are pairs.
/// Throws Error when the other program cannot work for this one, and when a folder holds records already.
void run_live(const LiveOptions& options, SceneLibrary& library, Progress& progress);

}  // namespace gnomon
