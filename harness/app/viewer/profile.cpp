// Masks and reference along a line.
#include "app/viewer/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gnomon::viewer {

namespace {

/// The value of a mask at a pixel of the picture; NAN where it has none.
float value_at(const Composition& composition, int side, const ComposeSide& mask, const glm::ivec2& pixel) {
  if (!has_mask(mask)) return NAN;
  const auto index = frame_pixel(composition, side, pixel.x, pixel.y);
  if (!index) return NAN;
  const GBuffer& g = mask.frame->gbuffer;
  if (g.is_background(*index)) return NAN;
  return visibility_at(mask, g, static_cast<int>(*index % g.width), static_cast<int>(*index / g.width));
}

std::string cell(float value) { return std::isnan(value) ? std::string() : fmt::format("{:.9g}", value); }

}  // namespace

Profile profile_along(const Composition& composition, const ProfileLine& line) {
  Profile profile;
  ComposeSide truths[2];
  for (int side = 0; side < 2; ++side) {
    truths[side] = reference_side(composition, side);
    const ComposeSide& own = composition.sides[side];
    profile.is_reference[side] = has_mask(own) && own.mask.data() == truths[side].mask.data();
  }
  // The reference as the first side that is judged by it sees it.
  const int judged = profile.is_reference[0] || !has_mask(truths[0]) ? 1 : 0;
  const int of = has_mask(truths[judged]) ? judged : 1 - judged;
  const Verdict* const verdict = verdict_of(composition.sides[of]);
  profile.is_irradiance =
      verdict && verdict->estimates == LightShareKind::irradiance && !verdict->reference->irradiance.empty();
  ComposeSide errors = truths[of];
  errors.mask = reference_error(composition, of);

  const double length = glm::distance(line.from, line.to);
  const int steps = std::max(static_cast<int>(std::lround(length)), 1);
  for (int k = 0; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    const glm::ivec2 pixel(glm::floor(line.from + share * (line.to - line.from)));
    profile.distance.push_back(share * length);
    profile.pixel.push_back(pixel);
    for (int side = 0; side < 2; ++side)
      profile.sides[side].push_back(value_at(composition, side, composition.sides[side], pixel));
    profile.reference.push_back(value_at(composition, of, truths[of], pixel));
    if (!errors.mask.empty()) profile.error.push_back(value_at(composition, of, errors, pixel));
  }
  return profile;
}

std::string profile_csv(const Profile& profile) {
  std::string text = "distance_pixels,column,row,left,right,reference,standard_error\n";
  for (std::size_t k = 0; k < profile.distance.size(); ++k)
    text += fmt::format("{:.6g},{},{},{},{},{},{}\n", profile.distance[k], profile.pixel[k].x, profile.pixel[k].y,
                        cell(profile.sides[0][k]), cell(profile.sides[1][k]), cell(profile.reference[k]),
                        profile.error.empty() ? std::string() : cell(profile.error[k]));
  return text;
}

}  // namespace gnomon::viewer
