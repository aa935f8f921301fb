// Exits: ends the process from resolve.
#include <cstdlib>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Exits final : public Harmless {
 public:
  void resolve(const GBuffer&, VisibilityMask&) override { std::exit(3); }
};

}  // namespace

GNOMON_TECHNIQUE(exits, Exits,
                 {.title = "Exits",
                  .summary = "Ends the process from resolve.",
                  .source = "none",
                  .error = "It is the error.",
                  .fails = "Always."})
