#pragma once
#include <string_view>

namespace gnomon::exponential_variance_map {

/// Chebyshev's inequality on depths warped by exp(exponent t), and with four components also by -exp(-negative_exponent t): the
/// smaller answer holds. The head defines COMPONENTS. A deviation of `least_deviation` in t is one of the warp's slope times as
/// much.
inline constexpr std::string_view answer = R"(
float bound(vec2 mean, float warped, float slope) {
  float least = least_deviation * slope, variance = max(mean.y - mean.x * mean.x, least * least), beyond = warped - mean.x;
  return beyond <= 0 ? 1 : variance / (variance + beyond * beyond);
}
float answer(vec4 mean, float t) {
  float near_warp = exp(exponent * t), lit = bound(mean.xy, near_warp, exponent * near_warp);
#if COMPONENTS == 4
  float far_warp = -exp(-negative_exponent * t);
  lit = min(lit, bound(mean.zw, far_warp, -negative_exponent * far_warp));
#endif
  return lit;
}
)";

}  // namespace gnomon::exponential_variance_map
