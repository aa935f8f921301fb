#pragma once
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#define CALLGRIND_DUMP_STATS_AT(stage)
#endif

namespace gnomon {

/// While it lives, callgrind counts the instructions of one stage, where the program runs under valgrind (scripts/instructions)
/// and was built with its header; else nothing happens. At the end callgrind writes the count under the stage's name.
class CountedStage {
 public:
  explicit CountedStage(const char* stage) : stage_(stage) { CALLGRIND_START_INSTRUMENTATION; }
  CountedStage(const CountedStage&) = delete;
  CountedStage& operator=(const CountedStage&) = delete;
  ~CountedStage() {
    CALLGRIND_STOP_INSTRUMENTATION;
    CALLGRIND_DUMP_STATS_AT(stage_);
  }

 private:
  [[maybe_unused]] const char* stage_;  ///< unused without the header
};

}  // namespace gnomon
