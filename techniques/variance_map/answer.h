#pragma once
#include <string_view>

namespace gnomon::variance_map {

/// Chebyshev's inequality, one-sided: of depths with this mean and variance at least so many reach t. Constant: least_variance.
inline constexpr std::string_view answer = R"(
float answer(vec4 mean, float t) {
  float variance = max(mean.y - mean.x * mean.x, least_variance), beyond = t - mean.x;
  return beyond <= 0 ? 1 : variance / (variance + beyond * beyond);
}
)";

}  // namespace gnomon::variance_map
