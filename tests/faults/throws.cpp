// Throws: an exception out of build.
#include <stdexcept>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Throws final : public Harmless {
 public:
  void build(const Scene&) override { throw std::runtime_error("the tree has no root"); }
};

}  // namespace

GNOMON_TECHNIQUE(throws, Throws,
                 {.title = "Throws",
                  .summary = "Throws an exception out of build.",
                  .source = "none",
                  .error = "It is the error.",
                  .fails = "Always."})
