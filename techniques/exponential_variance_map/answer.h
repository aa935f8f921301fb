#pragma once
#include <string_view>

namespace gnomon::exponential_variance_map {

/// Chebyshev's inequality on depths warped by exp(warps.x t), and with four components also by -exp(-warps.y t): the
/// smaller answer holds. The head defines COMPONENTS; `warps` are both exponents and the least deviation. A deviation of
/// warps.z in t is one of the warp's slope times as much.
inline constexpr std::string_view answer = R"(
float bound(vec2 mean, float warped, float slope) {
  float least = warps.z * slope, variance = max(mean.y - mean.x * mean.x, least * least), beyond = warped - mean.x;
  return beyond <= 0 ? 1 : variance / (variance + beyond * beyond);
}
float answer(vec4 mean, float t) {
  float near_warp = exp(warps.x * t), lit = bound(mean.xy, near_warp, warps.x * near_warp);
#if COMPONENTS == 4
  float far_warp = -exp(-warps.y * t);
  lit = min(lit, bound(mean.zw, far_warp, -warps.y * far_warp));
#endif
  return lit;
}
)";

}  // namespace gnomon::exponential_variance_map
