// The common causes, one row each, and causes as counts and as numbers.
#include <algorithm>

#include "measure/cause/own_causes.h"

namespace gnomon {

std::span<const CauseInfo> cause_infos() {
  using enum Cause;
  // False dark in warm colors, false lit in cool ones, the rest between. Any two differ by 19 in CIE Lab, also for people
  // without one kind of cone, and each from every gray of the picture below; those of lights with area by 14.
  static constexpr CauseInfo rows[] = {
      {mask_shift, "mask_shift", "The whole mask is shifted, this pixel's shadow with it.", rgb(134, 62, 118)},
      {mask_gamma, "mask_gamma", "The whole mask went through a gamma curve: its values are not linear in the light.",
       rgb(236, 77, 183)},
      {mask_blur, "mask_blur", "The whole mask is blurred: the pixel holds values of its neighbors.", rgb(243, 173, 64)},
      {tessellation, "tessellation", "Right for the triangles, wrong for the exact shape that they approximate.",
       rgb(189, 230, 0)},
      {beyond_coverage, "beyond_coverage", "The technique says that it does not cover this point.", rgb(56, 0, 72)},
      {formula, "formula", "The technique's formula or setting is known to be wrong here; its exact one answers otherwise.",
       rgb(120, 87, 60)},
      {missing_caster, "missing_caster",
       "Lit in a shadow that the technique lacks almost entirely; its texels, if it has any, do not hold the caster.",
       rgb(32, 84, 148)},
      {edge_resolution, "edge_resolution", "A perfect map of the same texels would be wrong here too.", rgb(239, 220, 113)},
      {filter_width, "filter_width", "The filter is too wide: the texel at the point alone would be right.", rgb(40, 0, 124)},
      {lookup_shift, "lookup_shift", "The moved look-up point fell on the other side of a shadow edge.", rgb(155, 230, 164)},
      {acne, "acne", "The receiver's own surface, stored at a texel, shadows it: too little bias.", rgb(224, 120, 0)},
      {over_dark, "over_dark", "Another object's surface, stored at a texel, darkens a point that it does not shadow.",
       rgb(194, 21, 0)},
      {peter_panning, "peter_panning", "Every caster of the point is nearer than the bias: too much bias.", rgb(46, 145, 183)},
      {leak_layered, "leak_layered", "The bias skips the near caster, and the farther one does not cover the texel.",
       rgb(61, 1, 246)},
      {leak_representation, "leak_representation", "The texels are in shadow, but their stored values say light.",
       rgb(85, 218, 255)},
      {crack, "crack", "At most four connected pixels, away from every shadow edge, as numerical cracks are.",
       rgb(248, 0, 255)},
      {edge_raster, "edge_raster",
       "Drawn shadows: within 1.5 pixels of a shadow edge of the reference, or on an edge that no pixel shows.",
       rgb(173, 136, 89)},
      {edge, "edge", "Shadows that are not drawn: within 1.5 pixels of a shadow edge, or on an edge that no pixel shows.",
       rgb(106, 37, 187)},
      {region, "region", "More than four connected pixels, away from every shadow edge; the technique names no cause.",
       rgb(107, 17, 4)},
      {reference_error, "reference_error", "Light with area: within four standard errors of the reference.",
       rgb(214, 210, 201)},
      {false_sample, "false_sample",
       "Light with area: at sampled points of the light the technique and the reference disagree.", rgb(139, 178, 133)},
      {horizon, "horizon",
       "Light with area: the part of the light below the point's horizon was counted, as visible or as hidden.",
       rgb(15, 112, 8)},
      {hard_shadow, "hard_shadow", "Light with area: the hard shadow of one point of the light.", rgb(175, 10, 246)},
      {banding, "banding", "Light with area: few levels, because neighboring pixels sample the same few points of the light.",
       rgb(196, 176, 105)},
      {noise, "noise", "Light with area: within the error of so many samples, which differ from pixel to pixel.",
       rgb(200, 226, 242)},
      {caster_fusion, "caster_fusion",
       "Light with area: overlapping penumbrae were joined by product or minimum, as if their casters were independent.",
       rgb(160, 97, 206)},
      {lost_umbra, "lost_umbra",
       "Light with area: the point sees no part of the light, nor of one four times its size, but the mask is lit.",
       rgb(116, 0, 112)},
      {too_wide, "too_wide", "Light with area: the penumbra is wider than that of the light.", rgb(202, 126, 61)},
      {too_narrow, "too_narrow", "Light with area: the penumbra is narrower than that of the light.", rgb(91, 32, 81)},
      {shifted, "shifted", "Light with area: the penumbra is displaced.", rgb(188, 142, 239)},
      {unexplained, "unexplained", "No other cause holds; meant to be 0.", rgb(255, 255, 255)},
  };
  return rows;
}

std::string_view name(Cause cause) {
  return cause == Cause::none ? "none" : cause_infos()[static_cast<std::size_t>(cause) - 1].name;
}

std::map<std::string, std::uint64_t> count_causes(std::span<const Cause> causes, std::span<const CauseInfo> own) {
  std::map<std::string, std::uint64_t> counts;
  std::array<std::uint64_t, 256> by_cause{};
  for (const Cause cause : causes) ++by_cause[static_cast<std::size_t>(cause)];
  for (const CauseInfo& info : with_common(own))
    counts[std::string(info.name)] = by_cause[static_cast<std::size_t>(info.cause)];
  return counts;
}

std::vector<Cause> causes_from_numbers(std::span<const float> numbers,
                                       const std::optional<std::map<std::string, std::uint64_t>>& counts,
                                       std::span<const CauseInfo> own) {
  // A name that became a common one later is still the technique's in its record.
  const auto is_own = [&](std::string_view name) { return std::ranges::find(own, name, &CauseInfo::name) != own.end(); };
  const auto counted = [&](std::string_view name) { return !is_own(name) && counts && counts->contains(std::string(name)); };
  std::vector<Cause> known{Cause::none};
  for (const CauseInfo& info : cause_infos()) {
    // Programs without lights with area kept the number before the last for a cause that no pixel ever had.
    if (info.cause == Cause::unexplained && counted("penumbra")) known.push_back(Cause::unexplained);
    if (!counts || counted(info.name)) known.push_back(info.cause);
  }
  for (const CauseInfo& info : own) known.push_back(info.cause);
  std::vector<Cause> causes;
  for (const float number : numbers) {
    if (!(number >= 0 && number < static_cast<float>(known.size()) && number == std::floor(number)))
      throw Error("a cause is {}; it is a whole number, 0 .. {}", number, known.size() - 1);
    causes.push_back(known[static_cast<std::size_t>(number)]);
  }
  return causes;
}

}  // namespace gnomon
