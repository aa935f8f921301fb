#pragma once
#include "measure/frame/pixel_windows.h"
#include "measure/score/metrics.h"

namespace gnomon {

/// Both masks along a line across the reference's penumbra: through a point of its line V = 0.5 along the slope of V there,
/// from where both are dark (V <= 0.02) to where both are lit (V >= 0.98). All of it is tested and on one object.
///
/// Widths are 6 times the integral of V (1 - V) over the line, which is the width of a ramp, and grows with it whatever the
/// curve. The shift is the integral of V_ref - V: how far an edge of any width has moved. Neither uses a slope or the place
/// where a number is crossed, so that noise hardly moves them: it takes 1 / n from a width of n random samples, and nothing
/// from a shift.
struct PenumbraProfile {
  std::size_t pixel;    ///< that shows where the line begins, at V_ref = 0.5
  double theirs, ours;  ///< widths in pixels, of the reference and of the technique
  double shift;         ///< in pixels; positive where the shadow is too large
  glm::dvec2 way;       ///< unit, toward the light side
};

/// Of all points where the reference's line crosses between neighbors along a row or column, and that have such a line. A
/// reference narrower than 2 px has no penumbra to compare; the technique's may reach four times as far as the reference's.
std::vector<PenumbraProfile> penumbra_profiles(const Evidence& evidence, const PixelWindows& windows);

}  // namespace gnomon
