// Exponential variance shadow map: a variance map of depths that are warped by exponentials first.
#include <gnomon/kit/maps/filtered_map.h>
#include <gnomon/registry.h>

#include "exponential_variance_map/answer.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Exponential variance shadow map",
    .summary = "Mean and variance of exponentials of the depths around a texel bound how much of the light arrives.",
    .source = "Lauritzen and McCool 2008 (layered variance shadow maps, section on exponential warps)",
    .error =
        "Leaks of a variance map shrink by the exponential between the two casters; with four components a second warp, the "
        "other way round, bounds what the first leaks. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails = "Casters close above each other along the ray, over the whole depth range of a large scene.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

class ExponentialVarianceMap final : public FilteredMap {
  Choice components{this, "components", "4", {"2", "4"}, Stage::setup, "Moments of the first warp alone, or of both."};
  // The square of a warp must be a float32: exp(2 * 42) = 3.03e36.
  Number<double> exponent{this, "exponent", 40, {.min = 1, .max = 42}, Stage::relight, "Of the first warp, exp(exponent t)."};
  Number<double> negative_exponent = Number<double>(this, "negative_exponent", 5, {.min = 1, .max = 35}, Stage::relight,
                                                    "Of the second warp, -exp(-negative_exponent t); for components=4.");
  Number<double> least_deviation =
      Number<double>(this, "least_deviation", 0.1, {.unit = "permille", .min = 0, .max = 100}, Stage::resolve,
                     "Depths count as spread by at least this share of the image's depth range, against rounding and acne.");

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ExponentialVarianceMap::made_); }

 private:
  Texel texel() const override {
    return {.channels = components.is("2") ? 2 : 4, .to_one = glm::vec4(std::exp(-exponent), std::exp(-2 * exponent), -1, 1)};
  }
  Method method() const override {
    // What storing takes off a variance: off the mean square, and twice off the mean.
    const StoredRounding lost = has_table() ? StoredRounding{.absolute = 1, .share = rounding().absolute} : rounding();
    std::string head = fmt::format("#define COMPONENTS {}\n", components.text());
    if (lost.share > 0)
      head += fmt::format("#define ROUNDED {:.6e}\n#define ROUNDED_BELOW {:.6e}\n", 3 * lost.share, has_table() ? 1 : 0x1p-14);
    return {.encode = head + R"(
vec4 encode(float t) {
  float near_warp = exp(warps.x * t), far_warp = COMPONENTS == 4 ? -exp(-warps.y * t) : 0;
  return vec4(near_warp, near_warp * near_warp, far_warp, far_warp * far_warp);
}
)",
            .answer = head + std::string(exponential_variance_map::answer),
            .constants = "vec3 warps;"};
  }
  Support method_support() const override {
    const double steepest = std::max(exponent.value(), components.is("2") ? 0 : negative_exponent.value());
    // The square of a warp: exp(2 * 5.54) = 64860.
    if (has_16_bits() && steepest > 5.54)
      return Support::unsupported(
          fmt::format("exponent {:g}: a float of 16 bits holds squares up to 65504, exponents up to 5.54", steepest));
    if (has_table() && steepest > 5)
      return Support::unsupported(
          fmt::format("exponent {:g}: sums of whole numbers tell squares of exponents up to 5 from rounding", steepest));
    return Support::full();
  }
  void set_constants(const Program& program) const override {
    program.set_if_used("warps", glm::vec3(exponent.value(), negative_exponent.value(), 1e-3 * least_deviation));
  }
};

}  // namespace

GNOMON_TECHNIQUE(exponential_variance_map, ExponentialVarianceMap, about)
