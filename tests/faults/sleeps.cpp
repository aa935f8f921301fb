// Sleeps: relight and resolve take as many milliseconds as the environment says, so that a test can make a program slower.
#include <chrono>
#include <cstdlib>
#include <thread>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Sleeps final : public Harmless {
 public:
  void relight(const Light&) override { sleep("GNOMON_TEST_RELIGHT_MS"); }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    sleep("GNOMON_TEST_RESOLVE_MS");
    Harmless::resolve(gbuffer, mask);
  }

 private:
  static void sleep(const char* name) {
    const char* text = std::getenv(name);
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(text ? std::atof(text) : 2));
  }
};

}  // namespace

GNOMON_TECHNIQUE(sleeps, Sleeps,
                 {.title = "Sleeps",
                  .summary = "Takes as long as the environment says.",
                  .source = "none",
                  .error = "All of it.",
                  .fails = "Nowhere."})
