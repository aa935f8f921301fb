// Variance shadow map: a texel holds depth and its square, so that means of texels give mean and variance of the depths below.
#include <gnomon/kit/maps/filtered_map.h>
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
        "receiver, and light leaks where depths vary more: under two casters, behind the edge of the nearer. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails = "Layers of casters at many depths: leaves, fences before walls. leak_reduction hides leaks and widens shadows.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

class VarianceMap final : public FilteredMap {
  Number<double> least_deviation = Number<double>(
      this, "least_deviation", 0.5, {.unit = "permille", .min = 0, .max = 100}, Stage::resolve,
      "Depths count as spread by at least this share of the image's depth range, against acne, and by more where 16 bits "
      "round.");

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &VarianceMap::made_); }

 private:
  Texel texel() const override { return {.channels = 2, .is_within_one = true}; }
  Method method() const override {
    return {.encode = "vec4 encode(float t) { return vec4(t, t * t, 0, 0); }\n",
            .answer = std::string(variance_map::answer),
            .constants = "float least_variance;"};
  }
  void set_constants(const Program& program) const override {
    // Rounding of a square near 1 in float32; and of the mean square, and twice that of the mean, where they are stored.
    const double deviation = 1e-3 * least_deviation, rounded = 1e-7 + 3 * rounding().absolute;
    program.set_if_used("least_variance", static_cast<float>(deviation * deviation + rounded));
  }
};

}  // namespace

GNOMON_TECHNIQUE(variance_map, VarianceMap, about)
