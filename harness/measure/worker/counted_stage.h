#pragma once
#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#define GNOMON_CALLGRIND 1
#else
#define GNOMON_CALLGRIND 0
#endif

namespace gnomon {

/// While it lives the instructions of one stage are counted, where the program runs under valgrind's callgrind
/// (scripts/instructions) and was built where its header is; else it does nothing. At the end callgrind writes them under the
/// stage's name.
class CountedStage {
 public:
  explicit CountedStage([[maybe_unused]] const char* stage) {
#if GNOMON_CALLGRIND
    stage_ = stage;
    CALLGRIND_START_INSTRUMENTATION;
#endif
  }
  CountedStage(const CountedStage&) = delete;
  CountedStage& operator=(const CountedStage&) = delete;
  ~CountedStage() {
#if GNOMON_CALLGRIND
    CALLGRIND_STOP_INSTRUMENTATION;
    CALLGRIND_DUMP_STATS_AT(stage_);
#endif
  }

 private:
#if GNOMON_CALLGRIND
  const char* stage_;
#endif
};

}  // namespace gnomon
