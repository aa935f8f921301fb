// Variance shadow map: a texel holds depth and its square, so that means of texels tell mean and variance of the depths below.
#include <gnomon/kit/filtered_map.h>
#include <gnomon/registry.h>

#include "variance_map/answer.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Variance shadow map",
    .summary = "Mean and variance of the depths around a texel bound how much of the light arrives.",
    .source = "Donnelly and Lauritzen 2006 (Chebyshev's inequality); Lauritzen 2007 (leak_reduction)",
    .error =
        "The bound is one of two: at least so much light may arrive. It is exact for one planar caster over one planar "
        "receiver, and light leaks where depths vary more: under two casters, behind the edge of the nearer.",
    .fails = "Layers of casters at many depths: leaves, fences before walls. leak_reduction hides leaks and widens shadows.",
    .needs_gl = true};

class VarianceMap final : public FilteredMap {
  Number<double> least_deviation{
      this,
      "least_deviation",
      0.5,
      {.unit = "permille", .min = 0, .max = 100},
      Stage::resolve,
      "Depths count as spread by at least this share of the image's depth range, against rounding and acne."};

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &VarianceMap::made_); }

 private:
  Method method() const override {
    return {.format = GL_RG32F,
            .encode = "vec4 encode(float t) { return vec4(t, t * t, 0, 0); }\n",
            .answer = std::string(variance_map::answer),
            .constants = "float least_variance;"};
  }
  void set_constants(const Program& program) const override {
    const double deviation = 1e-3 * least_deviation;
    constexpr double rounding = 1e-7;  // of a square near 1 in float32
    program.set_if_used("least_variance", static_cast<float>(deviation * deviation + rounding));
  }
};

}  // namespace

GNOMON_TECHNIQUE(variance_map, VarianceMap, about)
