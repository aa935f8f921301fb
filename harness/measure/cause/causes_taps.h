#pragma once
#include <span>

#include "measure/cause/causes.h"
#include "measure/frame/light_rays.h"

namespace gnomon {

/// A wrong pixel of a technique that decides by taps.
struct TapCase {
  std::uint32_t pixel;
  const Explanation* why;   ///< with taps
  bool is_missing = false;  ///< false lit in a shadow that the mask hardly has
};

/// The causes that taps tell apart (missing_caster to leak_representation, then unexplained), in the order of the
/// cases; docs/causes.md derives each step. Runs on all threads.
std::vector<Cause> find_tap_causes(const Attribution& attribution, const LightRays& rays, std::span<const TapCase> cases);

/// The same for taps from the center of a light with area: attribution and rays have that point for light, the reference is
/// that of the light. `none` where the taps are right, and what is wrong is that their footprint stands for the light.
std::vector<Cause> find_soft_tap_causes(const Attribution& attribution, const LightRays& rays, std::span<const TapCase> cases);

}  // namespace gnomon
