// Percentage-closer soft shadows: the casters before a point determine how wide its penumbra is, and so over how many texels
// the comparisons with one depth image are averaged.
#include <gnomon/kit/maps/area_map.h>
#include <gnomon/registry.h>

#include <cmath>
#include <numbers>

#include "percentage_closer_soft/shader.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Percentage-closer soft shadows",
    .summary =
        "A depth image from the light's center, compared over the penumbra that the mean depth of the casters found makes.",
    .source = "Fernando 2005 (search, mean depth, filter); Reeves, Salesin and Cook 1987 (filter)",
    .error =
        "Exact for one caster in a plane across the image's axis but for texels and taps: n taps tell n + 1 shares apart. "
        "Casters of several depths get one filter for their mean. It estimates the share of the light's area. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails =
        "Casters behind one another, of which the image holds the nearest; near casters before far ones; penumbrae wider than "
        "most_radius.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

/// Places of the light that the shader samples.
std::vector<glm::dvec2> places(bool is_disc, int count, double turn) {
  std::vector<glm::dvec2> all;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * turn + k * std::numbers::pi * (3 - std::sqrt(5.0));
    const glm::dvec2 square =
        glm::fract(0.5 + turn * glm::dvec2(1, 1.6180340) + double(k) * glm::dvec2(0.75487767, 0.56984029));
    all.push_back(is_disc ? std::sqrt((k + 0.5) / count) * glm::dvec2(std::cos(angle), std::sin(angle)) : 2.0 * square - 1.0);
  }
  return all;
}

class PercentageCloserSoft final : public AreaMap {
  Number<int> search_taps =
      Number<int>(this, "search_taps", 16, {.min = 1, .max = 256, .log = true}, Stage::resolve,
                  "Texels that are searched for casters, spread over those that may hide some of the light.");
  Number<int> filter_taps = Number<int>(this, "filter_taps", 32, {.min = 1, .max = 1024, .log = true}, Stage::resolve,
                                        "Comparisons, spread over the figure of the light as wide as the penumbra.");
  Choice pattern =
      Choice(this, "pattern", "turned", {"shared", "turned"}, Stage::setup,
             "Where taps go: alike at all pixels, or turned (rectangles: shifted) anew at each, noise in place of steps.");
  Choice search = Choice(this, "search", "nearest", {"near_plane", "nearest"}, Stage::setup,
                         "How far casters are searched: as far as one at the image's near end, or as the nearest one there "
                         "is, can hide anything.");

 public:
  PercentageCloserSoft() : AreaMap({.resolution = 1024, .most_radius = 64}) {}
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &PercentageCloserSoft::made_); }
  /// The taps are those of the filter, or of a search that found nothing. Where the center is below the point's horizon there
  /// is no ray from it to the point's lit side, and the mask alone shows what is wrong.
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces(index)) return why;
    if (const AreaPoint p = point(index); p.image->layer >= 0 && p.facing > 0) why = explain_look_up(index, p);
    explain_glass(why, index);
    return why;
  }

 private:
  Explanation explain_look_up(std::size_t index, const AreaPoint& p) const {
    const glm::vec4 account = accounts()[index];
    const bool is_search = account.z <= 0;
    Explanation why;
    why.texel_width = p.image->largest_texel(p.seen);
    const double stretch = glm::length(p.seen) / p.seen.z;
    why.bias = (p.bias + (p.facing * p.seen.z - p.depth) / p.facing) * stretch;
    for (const glm::dvec2& place : places(p.is_disc, is_search ? search_taps : filter_taps, account.w)) {
      if (!is_search && !p.is_above_horizon(place)) continue;
      const glm::dvec2 at = glm::dvec2(account) + p.offset(std::abs(account.z), place);
      why.taps.push_back(camera().tap(*p.image, depths(), glm::ivec2(glm::floor(at)), 1));
    }
    for (Tap& tap : why.taps) tap.weight = 1.0 / double(why.taps.size());
    why.cause = alpha_cause(index);
    return why;
  }
  std::string body() const override {
    return fmt::format("#define TURNED {}\n#define SEARCH_ALL {}\n{}", int(pattern.is("turned")), int(search.is("near_plane")),
                       percentage_closer_soft::body);
  }
  void set_uniforms(const Program& program) const override {
    program.set_if_used("search_taps", search_taps.value());
    program.set_if_used("filter_taps", filter_taps.value());
  }
};

}  // namespace

GNOMON_TECHNIQUE(percentage_closer_soft, PercentageCloserSoft, about)
