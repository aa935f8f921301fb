#pragma once
#include <string_view>

namespace gnomon::exponential_variance_map {

/// Chebyshev's inequality on depths warped by exp(warps.x t), and with four components also by -exp(-warps.y t): the
/// smaller answer holds. The head defines COMPONENTS; `warps` are both exponents and the least deviation. A deviation of
/// warps.z in t is one of the warp's slope times as much. Where storing rounds, the head defines by what share of the mean
/// square a variance may be off (ROUNDED), and the share of the largest square below which it is no smaller (ROUNDED_BELOW).
inline constexpr std::string_view answer = R"(
float bound(vec2 mean, float warped, float slope, float largest) {
  float least = warps.z * slope, spread = least * least;
#ifdef ROUNDED
  spread += ROUNDED * max(mean.y, ROUNDED_BELOW * largest);
#endif
  float variance = max(mean.y - mean.x * mean.x, spread), beyond = warped - mean.x;
  return beyond <= 0 ? 1 : variance / (variance + beyond * beyond);
}
float answer(vec4 mean, float t) {
  float near_warp = exp(warps.x * t), lit = bound(mean.xy, near_warp, warps.x * near_warp, exp(2 * warps.x));
#if COMPONENTS == 4
  float far_warp = -exp(-warps.y * t);
  lit = min(lit, bound(mean.zw, far_warp, -warps.y * far_warp, 1));
#endif
  return lit;
}
)";

}  // namespace gnomon::exponential_variance_map
