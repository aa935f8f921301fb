// Moment shadow map: a texel holds four powers of depth, so that means of texels determine where two layers of depth lie.
#include <gnomon/kit/maps/filtered_map.h>
#include <gnomon/registry.h>

#include "moment_map/answer.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Moment shadow map",
    .summary = "Four moments of the depths around a texel bound how much of the light arrives.",
    .source =
        "Peters and Klein 2015 (Hamburger's moment problem, with the corrections of the authors' version; the moments that 16 "
        "bits hold best)",
    .error =
        "The sharpest bound that four moments allow, toward light: exact for two layers of depth but for moment_bias and "
        "rounding; under three light leaks by a seventh of what variance leaks in the worst case. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails = "Three layers and more between light and receiver: leaves, fences before walls.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

class MomentMap final : public FilteredMap {
  Number<double> moment_bias = Number<double>(
      this, "moment_bias", 3e-5, {.min = 3e-6, .max = 0.1, .log = true}, Stage::resolve,
      "Share of the moments that is replaced by those of depth spread evenly over both ends, against rounding; bits=16 and "
      "prefilter=table, which round more, add to it.");

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &MomentMap::made_); }

 private:
  Texel texel() const override { return {.channels = 4, .is_within_one = true}; }
  Method method() const override {
    const std::string head = moment_map::stored(has_16_bits());
    return {.encode = head + R"(
vec4 encode(float t) {
  float s = 0.1 + 0.8 * t;
  return to_stored(vec4(s, s * s, s * s * s, s * s * s * s));
}
)",
            .answer = head + std::string(moment_map::answer) + R"(
// What moment_bias and rounding make dark, less than 1/512, is lit.
float answer(vec4 mean, float t) {
  return clamp(least_lit(from_stored(mean), 0.1 + 0.8 * t) * (512.0 / 511.0), 0, 1);
}
)",
            .constants = "float moment_bias;"};
  }
  void set_constants(const Program& program) const override {
    // 4e-5 for each store of 16 bits (2^-17), and in proportion of a table's.
    const double needed = has_16_bits() ? 4e-5 * stores() : 400 * rounding().absolute;
    program.set_if_used("moment_bias", static_cast<float>(moment_bias + needed));
  }
};

}  // namespace

GNOMON_TECHNIQUE(moment_map, MomentMap, about)
