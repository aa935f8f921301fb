// Tires: well in its first process, which leaves the file that the environment names; throws in setup where that file is.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Tires final : public Harmless {
 public:
  void setup() override {
    const char* file = std::getenv("GNOMON_TEST_TIRED");
    if (!file) return;
    if (std::filesystem::exists(file)) throw std::runtime_error("enough for today");
    std::ofstream(file) << "tired\n";
  }
};

}  // namespace

GNOMON_TECHNIQUE(tires, Tires,
                 {.title = "Tires",
                  .summary = "Throws in the setup of its second process.",
                  .source = "none",
                  .error = "All of it.",
                  .fails = "In its second process."})
