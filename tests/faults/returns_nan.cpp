// Returns NaN: one pixel of its mask is no number.
#include <limits>

#include "faults/harmless.h"

namespace {
using namespace gnomon;

class ReturnsNan final : public Harmless {
 public:
  void resolve(const GBuffer&, VisibilityMask& mask) override {
    std::ranges::fill(mask.pixels(), 1.0f);
    mask.pixels()[7] = std::numeric_limits<float>::quiet_NaN();
  }
};

}  // namespace

GNOMON_TECHNIQUE(returns_nan, ReturnsNan,
                 {.title = "Returns NaN",
                  .summary = "One pixel of its mask is no number.",
                  .source = "none",
                  .error = "It is the error.",
                  .fails = "Always."})
