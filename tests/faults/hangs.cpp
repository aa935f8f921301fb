// Hangs: never comes back from relight. It sleeps, so that it costs nobody else his processor.
#include <chrono>
#include <thread>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Hangs final : public Harmless {
 public:
  void relight(const Light&) override {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
};

}  // namespace

GNOMON_TECHNIQUE(hangs, Hangs,
                 {.title = "Hangs",
                  .summary = "Never comes back from relight.",
                  .source = "none",
                  .error = "It is the error.",
                  .fails = "Always."})
