#pragma once
#include "measure/cause/causes.h"
#include "measure/frame/light_rays.h"

namespace gnomon {

/// A wrong pixel and what the technique says of it.
struct ExplainedPixel {
  std::uint32_t pixel;
  const Explanation* why;
  bool is_missing = false;  ///< false lit in a shadow that the mask hardly has
};

/// The causes of pixels whose explanation has taps (missing_caster to leak_representation, then unexplained), in their order;
/// docs/causes.md derives each step. Runs on all threads.
///
/// Taps from the center of a light with area: attribution and rays have that point as light, and the reference is that of the
/// light, with AnswerKind::fraction. `none` where the taps are right and the error comes of their footprint in place of the
/// light.
std::vector<Cause> find_tap_causes(const Attribution& attribution, const LightRays& rays,
                                   std::span<const ExplainedPixel> pixels);

}  // namespace gnomon
