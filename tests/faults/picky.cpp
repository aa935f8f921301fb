// Picky: takes a light at the right of the middle, and says so only in supports(). One call for all lights of a path is too
// few.
#include "faults/harmless.h"

namespace {
using namespace gnomon;

class Picky final : public Harmless {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    const auto* point = std::get_if<PointLight>(&light.kind);
    if (!point || point->position.x < -0.1f) return Support::unsupported("the light is at the left");
    if (point->position.x < 1) return Support::approximate("the light is near the middle");
    return Support::full();
  }
};

}  // namespace

GNOMON_TECHNIQUE(picky, Picky,
                 {.title = "Picky",
                  .summary = "Takes no light at the left.",
                  .source = "none",
                  .error = "All of it.",
                  .fails = "With a light at the left."})
