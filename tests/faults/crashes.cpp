// Crashes: dies of a segmentation fault in resolve.
#include <csignal>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Crashes final : public Harmless {
 public:
  void resolve(const GBuffer&, VisibilityMask&) override {
    std::signal(SIGSEGV, SIG_DFL);  // a sanitizer would end the process in a way of its own
    std::raise(SIGSEGV);
  }
};

}  // namespace

GNOMON_TECHNIQUE(crashes, Crashes,
                 {.title = "Crashes",
                  .summary = "Dies of a segmentation fault in resolve.",
                  .source = "none",
                  .error = "It is the error.",
                  .fails = "Always."})
