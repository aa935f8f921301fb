// Unshadowed: every point is lit.
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <algorithm>

namespace {
using namespace gnomon;

constexpr About about{.title = "Unshadowed",
                      .summary = "Every point is lit: the floor of cost and the ceiling of error.",
                      .source = "none",
                      .error = "Every shadow is missing.",
                      .fails = "Wherever there is a shadow.",
                      .role = Role::baseline,
                      .handles = with_gray_transmission};

class Unshadowed final : public Technique {
 public:
  Support supports(const Scene&, const Light&, const View&) const override { return Support::full(); }
  void setup() override {}
  void build(const Scene&) override {}
  void relight(const Light&) override {}
  void resolve(const GBuffer&, VisibilityMask& mask) override { std::ranges::fill(mask.pixels(), 1.0f); }
  Counts counts() const override { return {{.name = "bytes", .value = 0, .unit = "byte"}}; }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this); }
};

}  // namespace

GNOMON_TECHNIQUE(unshadowed, Unshadowed, about)
