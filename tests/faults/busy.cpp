// Busy: build keeps its core busy for as many milliseconds as the environment says. Where it says so, a later call of build,
// the n-th of the process, throws or never comes back.
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

double number(const char* variable, double otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atof(text) : otherwise;
}

class Busy final : public Harmless {
 public:
  void build(const Scene&) override {
    ++calls_;
    if (calls_ == number("GNOMON_TEST_THROWS_AT", 0)) throw std::runtime_error("one too many");
    while (calls_ == number("GNOMON_TEST_HANGS_AT", 0)) std::this_thread::sleep_for(std::chrono::hours(1));
    const auto end = std::chrono::steady_clock::now() + milliseconds_;
    while (std::chrono::steady_clock::now() < end) {
    }
  }

 private:
  const std::chrono::duration<double, std::milli> milliseconds_{number("GNOMON_TEST_BUSY_MS", 0.1)};
  int calls_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(busy, Busy,
                 {.title = "Busy",
                  .summary = "Computes nothing for as long as the environment says.",
                  .source = "none",
                  .error = "All of it.",
                  .fails = "When it is told to."})
